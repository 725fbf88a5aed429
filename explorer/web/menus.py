"""Menus that are searched by typing: a script (menus.js) selects the text, takes the only option that is left by Enter,
and says what no option is called."""

from pathlib import Path

import viser

from explorer.web.connection import run_script

SCRIPT = Path(__file__).with_name("menus.js")


def install(client: viser.ClientHandle) -> None:
    """Start the script in the browser."""
    run_script(client, SCRIPT.read_text(encoding="utf-8"))
