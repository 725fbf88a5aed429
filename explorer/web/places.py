"""Where the visitor is on the page: a script (places.js) remembers the open tabs and folders over a reload, and notices
that the open preset was chosen once more."""

import json
from pathlib import Path

import viser

from explorer.web.connection import run_script

SCRIPT = Path(__file__).parent / "places.js"


def install(client: viser.ClientHandle, *, first: str = "") -> None:
    """Start the script in the browser; it needs that of the door. first: the tab that a new visitor sees, by its label;
    the first one if it is empty."""
    run_script(client, SCRIPT.read_text(encoding="utf-8").replace("FIRST", json.dumps(first)))
