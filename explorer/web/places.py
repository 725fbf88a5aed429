"""Where the visitor is on the page: a script (places.js) remembers the open tabs and folders over a reload, and notices
that the open preset was chosen once more."""

from pathlib import Path

import viser

from explorer.web.connection import run_script

SCRIPT = Path(__file__).parent / "places.js"


def install(client: viser.ClientHandle) -> None:
    """Start the script in the browser; it needs that of the door."""
    run_script(client, SCRIPT.read_text(encoding="utf-8"))
