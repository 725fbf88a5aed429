"""Keys, and the way to a control: a script in the page (keys.js) lets keys belong to what has the focus, gives labels
their hints, and opens the tab and the folders of a control that was chosen in the palette."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import viser

from explorer.web.connection import run_script
from explorer.web.elements import Step

SCRIPT = Path(__file__).parent / "keys.js"


def install(client: viser.ClientHandle, hints: Mapping[str, str]) -> None:
    """Start the script in the browser; `hints` are those of the labels, by their texts."""
    run_script(client, SCRIPT.read_text(encoding="utf-8").replace("HINTS", json.dumps(dict(hints))))


def go_to(client: viser.ClientHandle, steps: Sequence[Step], target: str) -> None:
    """Open tabs and folders one after the other, and show a control (by its label) or a plot (by its name)."""
    run_script(client, f"window.rnKeys.go({json.dumps(list(steps))}, {json.dumps(target)})")


def go_to_tab(client: viser.ClientHandle, tab: str) -> None:
    """Bring a tab to the front."""
    go_to(client, [("tab", tab)], tab)
