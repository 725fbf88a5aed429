"""Draw docs/architecture.svg: the rooms of the library and of the page, who imports whom, and the two flows.

    python docs/draw_architecture.py
The names of the rooms stand in LIBRARY and PAGE, from top to bottom: a room imports only rooms below it.
"""

from html import escape
from pathlib import Path

LIBRARY = (
    ("command line", ("commands", "explanation", "report"), "#e8e8e8"),
    ("certificates, files", ("repair", "certificate", "formats", "logs"), "#fde7d3"),
    ("many runs", ("studies", "tune", "tradeoff", "ensemble", "comparison"), "#fdf3c8"),
    ("one run", ("preset", "analysis", "record"), "#fdf3c8"),
    ("observers", ("refine", "baselines", "cascade", "riccati", "attitude"), "#d9edd9"),
    ("observability", ("observability",), "#d6e8f5"),
    ("true motion, sensors", ("model", "sensors", "motion", "signals", "so3"), "#d6e8f5"),
    ("foundation", ("inputs", "kernels"), "#e8e8e8"),
)
PAGE = (
    ("start", ("__main__", "server"), "#e8e8e8"),
    ("handout", ("handout",), "#e8e8e8"),
    ("one browser tab", ("session", "shared"), "#e8e8e8"),
    ("controls", ("panels",), "#fde7d3"),
    ("3-D view and plots", ("scene", "charts"), "#fde7d3"),
    ("parts of controls", ("widgets",), "#fdf3c8"),
    ("browser, lessons", ("web", "lessons"), "#fdf3c8"),
    ("what is kept", ("storage",), "#d9edd9"),
    ("what follows", ("model",), "#d6e8f5"),
)
FLOWS = (
    (
        "A slider is moved",
        (
            "callback: an event is set",
            "loop: panels → Settings",
            "compute: stages, cached by their inputs",
            "scene and charts draw, in one message",
        ),
    ),
    (
        "A preset is certified",
        (
            "bytes of the TOML file",
            "Preset",
            "bounds of μ, ranks, σ, limits, jumps",
            "requirements → certificate beside the file",
        ),
    ),
)
NOTES = (
    "A room imports rooms of its own row or of rows below it, never above.",
    "explorer/lessons, storage and model do not import viser.",
    "rangenav imports neither viser nor explorer.",
    "Only rangenav/kernels imports numba.",
)
FONT = "font-family='DejaVu Sans, Verdana, sans-serif'"
INK, LINE = "#222222", "#777777"
MARGIN, LABEL, ROW, GAP = 24, 150, 40, 12
LIBRARY_WIDTH, PAGE_WIDTH, BETWEEN = 620, 440, 66


def text(x: float, y: float, words: str, *, size: int = 14, anchor: str = "start", bold: bool = False) -> str:
    """One line of text."""
    weight = " font-weight='bold'" if bold else ""
    place = f"x='{x:g}' y='{y:g}' text-anchor='{anchor}'"
    return f"<text {place} font-size='{size}' fill='{INK}'{weight}>{escape(words)}</text>"


def box(x: float, y: float, width: float, height: float, fill: str) -> str:
    """One rectangle."""
    return f"<rect x='{x:g}' y='{y:g}' width='{width:g}' height='{height:g}' rx='5' fill='{fill}' stroke='{LINE}'/>"


def arrow(x1: float, y1: float, x2: float, y2: float) -> str:
    """One arrow."""
    return f"<path d='M{x1:g},{y1:g} L{x2:g},{y2:g}' stroke='{INK}' stroke-width='1.5' marker-end='url(#tip)'/>"


def house(
    x: float, y: float, width: float, title: str, rooms: tuple[tuple[str, tuple[str, ...], str], ...]
) -> list[str]:
    """A house: a row for each group of rooms, and an arrow down its left side."""
    height = len(rooms) * (ROW + GAP) + GAP
    parts = [text(x, y - 12, title, size=16, bold=True), box(x, y, width, height, "#ffffff")]
    for k, (label, names, fill) in enumerate(rooms):
        top = y + GAP + k * (ROW + GAP)
        parts.append(text(x + 28, top + ROW / 2 + 5, label, size=12))
        space = width - LABEL - 40
        each = (space - (len(names) - 1) * 8) / len(names)
        for j, name in enumerate(names):
            left = x + LABEL + 28 + j * (each + 8)
            parts.append(box(left, top, each, ROW, fill))
            size = 13 if len(name) * 8.2 < each else 11
            parts.append(text(left + each / 2, top + ROW / 2 + 5, name, size=size, anchor="middle"))
    parts.append(arrow(x + 14, y + GAP, x + 14, y + height - GAP))
    return parts


def flow(x: float, y: float, width: float, title: str, steps: tuple[str, ...]) -> list[str]:
    """Steps from left to right."""
    parts = [text(x, y - 10, title, size=14, bold=True)]
    each = (width - (len(steps) - 1) * 26) / len(steps)
    for k, step in enumerate(steps):
        left = x + k * (each + 26)
        parts.append(box(left, y, each, ROW, "#f4f4f4"))
        parts.append(text(left + each / 2, y + ROW / 2 + 4, step, size=11, anchor="middle"))
        if k:
            parts.append(arrow(left - 26, y + ROW / 2, left - 4, y + ROW / 2))
    return parts


def drawing() -> str:
    """The whole picture."""
    width = 2 * MARGIN + LIBRARY_WIDTH + BETWEEN + PAGE_WIDTH
    top = MARGIN + 28
    library_height = len(LIBRARY) * (ROW + GAP) + GAP
    page_height = len(PAGE) * (ROW + GAP) + GAP
    right = MARGIN + PAGE_WIDTH + BETWEEN
    parts = house(MARGIN, top, PAGE_WIDTH, "explorer: the page in the browser", PAGE)
    parts += house(right, top, LIBRARY_WIDTH, "rangenav: the library and its command line", LIBRARY)
    parts.append(arrow(MARGIN + PAGE_WIDTH + 4, top + page_height / 2, right - 4, top + page_height / 2))
    parts.append(
        text(MARGIN + PAGE_WIDTH + BETWEEN / 2, top + page_height / 2 - 8, "imports", size=12, anchor="middle")
    )
    for k, words in enumerate(NOTES):
        column, line = divmod(k, 2)
        parts.append(text((MARGIN, right)[column], top + library_height + 28 + 19 * line, words, size=12))
    y = top + library_height + 100
    for title, steps in FLOWS:
        parts += flow(MARGIN, y, width - 2 * MARGIN, title, steps)
        y += ROW + 46
    height = y - 46 + MARGIN
    head = (
        f"<svg xmlns='http://www.w3.org/2000/svg' width='{width:g}' height='{height:g}'"
        f" viewBox='0 0 {width:g} {height:g}' {FONT}>"
        "<title>The rooms of explorer and rangenav, who imports whom, and two flows</title>"
        "<defs><marker id='tip' markerWidth='8' markerHeight='8' refX='6' refY='3' orient='auto'>"
        f"<path d='M0,0 L7,3 L0,6 z' fill='{INK}'/></marker></defs>"
        f"<rect width='{width:g}' height='{height:g}' fill='#ffffff'/>"
    )
    return "\n".join([head, *parts, "</svg>", ""])


if __name__ == "__main__":
    Path(__file__).with_name("architecture.svg").write_text(drawing(), encoding="utf-8")
