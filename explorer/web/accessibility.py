"""Keyboard and readers of the screen: a script in the page (accessibility.js) gives viser's markup roles and names,
keeps the focus where HTML is replaced, and speaks what has changed."""

import html
import json
from collections.abc import Mapping
from pathlib import Path

import viser

from explorer.web.connection import run_script

SCRIPT = Path(__file__).with_name("accessibility.js")


def install(client: viser.ClientHandle, hints: Mapping[str, str]) -> None:
    """Start the script in the browser; `hints` are those of controls and buttons, by their labels."""
    run_script(client, SCRIPT.read_text(encoding="utf-8").replace("HINTS", json.dumps(dict(hints))))


def spoken(kind: str, text: str) -> str:
    """The attribute of an element whose text is spoken when that of its kind has changed."""
    return f'data-rn-say="{html.escape(kind)}: {html.escape(text)}"'
