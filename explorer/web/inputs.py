"""Every input of a visitor arrives, once it is complete: a script (inputs.js) sends what viser's page would drop when
inputs follow each other quickly, and of a text that is typed the whole instead of every letter."""

from pathlib import Path

import viser

from explorer.web.connection import run_script

SCRIPT = Path(__file__).with_name("inputs.js")


def install(client: viser.ClientHandle) -> None:
    """Start the script in the browser, before those that write into boxes."""
    run_script(client, SCRIPT.read_text(encoding="utf-8"))
