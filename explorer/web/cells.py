"""A picture of cells in the page's own HTML: a script (cells.js) reads the cell under the mouse, moves a cursor by the
arrow keys, and says by the door which cell was clicked or taken with Enter."""

import html
import json
from collections.abc import Sequence
from pathlib import Path

import viser

from explorer.web.connection import run_script

SCRIPT = Path(__file__).with_name("cells.js")


def install(client: viser.ClientHandle) -> None:
    """Start the script in the browser."""
    run_script(client, SCRIPT.read_text(encoding="utf-8"))


def attributes(
    name: str,
    axes: tuple[tuple[str, Sequence[str]], tuple[str, Sequence[str]]],
    texts: Sequence[str],
    notes: tuple[Sequence[str], Sequence[int]],
    start: tuple[int, int],
) -> str:
    """The attributes of the element that the cells fill.

    name: of the event; the page sends `name-3-5` for the cell 3 to the right and 5 upwards. axes: the name of each and
    the texts of its values; the first lies across. texts: of all cells, the second index fastest. notes: sentences, and
    for each cell which of them is said, too. start: the cell at which the cursor of the keyboard begins.
    """
    (across, x), (upwards, y) = axes
    content = {
        "axes": [across, upwards],
        "x": list(x),
        "y": list(y),
        "texts": list(texts),
        "notes": list(notes[0]),
        "noted": list(notes[1]),
        "start": list(start),
    }
    text = html.escape(json.dumps(content, ensure_ascii=False, separators=(",", ":")))
    return f'tabindex="0" role="application" data-rn-grid="{html.escape(name)}" data-rn-cells="{text}"'
