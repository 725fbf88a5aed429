"""The trade-off of a search as two small plots: settling time against the error afterwards, position and attitude.

Both axes are logarithmic, as the search is. A line is what none of the gains tried beats in both; dots on it or beside
it are those that can be picked. Drawn as SVG in the colour of the text, so that it is read on white and on black.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from explorer.model import palette
from rangenav import tradeoff
from rangenav.tradeoff import Measure, Point

WIDTH, HEIGHT = 340, 172
"""px of one plot in the dock; it shrinks with it."""
LEFT, RIGHT, TOP, BOTTOM = 40, 12, 24, 32
BLUE, VERMILLION, PURPLE = palette.BLUE, palette.VERMILLION, palette.PURPLE
NARROWEST = 2.0
"""Ratio of the ends of an axis, at least: figures that are all alike are not torn apart."""
SPARE = 1.12
"""Factor beyond the outermost figures."""
FEWEST_TICKS, MOST_TICKS = 3, 7
ROUND = (1.0, 2.0, 2.5, 5.0)
"""Steps between places on a short axis; on a long one places are these times a power of ten, without 2.5."""
Range = tuple[float, float]


class Plane(NamedTuple):
    """One plot: what is told across and upwards."""

    name: str
    settle: Measure
    steady: Measure
    unit: str
    scale: float
    """From SI to the unit."""


POSITION = Plane("position", "settle_position", "steady_position", "m", 1.0)
ATTITUDE = Plane("attitude", "settle_attitude", "steady_attitude", "°", math.degrees(1.0))


class Marked(NamedTuple):
    """The points that have a sign of their own."""

    start: Point
    found: Point
    picked: Point
    walk: tuple[Point, ...]
    """Those that can be picked, soonest first."""


def plot(plane: Plane, seen: Iterable[Point], marked: Marked) -> str:
    """One plot, with a legend of its own for a reader that draws nothing."""
    seen = tuple(seen)
    front = tradeoff.front(seen, plane.settle, plane.steady)
    shown = (*front, *marked.walk, marked.start, marked.found, marked.picked)
    at, error = zip(*(_figures(plane, point) for point in shown), strict=True)
    across, upwards = span(at), span(error)

    def spot(point: Point) -> tuple[float, float]:
        x, y = _figures(plane, point)
        return (
            LEFT + _share(x, across) * (WIDTH - LEFT - RIGHT),
            HEIGHT - BOTTOM - _share(y, upwards) * (HEIGHT - TOP - BOTTOM),
        )

    tried = [spot(point) for point in seen if _within(_figures(plane, point), across, upwards)]
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in map(spot, front))
    parts = [
        _frame(plane, across, upwards),
        _dots(tried),
        f'<polyline points="{line}" stroke="{BLUE}" stroke-width="1.5"/>',
        *(_pickable(plane, point, spot(point)) for point in marked.walk),
        _square(*spot(marked.start)),
        _diamond(*spot(marked.found)),
        _ring(*spot(marked.picked)),
    ]
    words = f"{plane.name}: error afterwards against settling time; {told(plane, marked.picked)} is picked"
    style = "display:block;width:100%;height:auto;overflow:visible"
    head = f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" style="{style}" fill="none" role="img" aria-label="{words}">'
    return f"{head}{''.join(parts)}</svg>"


def signs() -> str:
    """What the signs of a plot mean."""
    named = (
        (_square(9, 7), "start"),
        (_diamond(9, 7), "found"),
        (_ring(9, 7), "picked"),
        (f'<circle cx="9" cy="7" r="3.2" fill="{BLUE}"/>', "to pick"),
        ('<circle cx="9" cy="7" r="1.8" fill="currentColor" fill-opacity="0.5"/>', "tried"),
        (f'<path d="M0 7h18" stroke="{BLUE}" stroke-width="1.5"/>', "none better in both"),
    )
    style = "vertical-align:-2px;margin-right:2px;overflow:visible"
    entry = '<span style="white-space:nowrap"><svg width="18" height="14" fill="none" style="{}">{}</svg>{}</span>'
    entries = " ".join(entry.format(style, sign, word) for sign, word in named)
    return f'<div style="display:flex;flex-wrap:wrap;gap:0 0.7em">{entries}</div>'


def told(plane: Plane, point: Point) -> str:
    """Both figures of a point in words."""
    at, error = _figures(plane, point)
    unit = "°" if plane.unit == "°" else f" {plane.unit}"
    return f"settles at {at:.3g} s, then {error:.3g}{unit}"


def span(values: Sequence[float]) -> Range:
    """The ends of a log axis that holds positive values, with a little room."""
    low, high = min(values) / SPARE, max(values) * SPARE
    missing = max(1.0, NARROWEST / (high / low))
    return low / math.sqrt(missing), high * math.sqrt(missing)


def ticks(axis: Range) -> list[float]:
    """Three to seven round places on a log axis: 1, 2 and 5 times powers of ten or, on a short one, equal steps."""
    low, high = axis
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for mantissas in ((1.0,), (1.0, 2.0, 5.0)):
        places = [m * 10.0**k for k in decades for m in mantissas if low <= m * 10.0**k <= high]
        if len(places) >= FEWEST_TICKS:
            return places[:: -(-len(places) // MOST_TICKS)]
    steps = (m * 10.0**k for k in reversed(range(decades.start - 2, decades.stop)) for m in reversed(ROUND))
    counts = ((step, math.ceil(low / step), math.floor(high / step)) for step in steps)
    step, first, last = next(found for found in counts if found[2] - found[1] + 1 >= FEWEST_TICKS)
    return [k * step for k in range(first, last + 1)]


def _figures(plane: Plane, point: Point) -> tuple[float, float]:
    """Settling time (s), and the error afterwards in the plane's unit."""
    return getattr(point, plane.settle), plane.scale * getattr(point, plane.steady)


def _within(figures: tuple[float, float], across: Range, upwards: Range) -> bool:
    return across[0] <= figures[0] <= across[1] and upwards[0] <= figures[1] <= upwards[1]


def _share(value: float, axis: Range) -> float:
    return math.log(value / axis[0]) / math.log(axis[1] / axis[0])


def _frame(plane: Plane, across: Range, upwards: Range) -> str:
    """Grid, numbers and the names of both axes."""
    bottom, right = HEIGHT - BOTTOM, WIDTH - RIGHT
    lines, numbers = [], []
    for value in ticks(across):
        x = LEFT + _share(value, across) * (right - LEFT)
        lines.append(f"M{x:.1f} {TOP}V{bottom}")
        numbers.append(f'<text x="{x:.1f}" y="{bottom + 13}" text-anchor="middle">{value:.3g}</text>')
    for value in ticks(upwards):
        y = bottom - _share(value, upwards) * (bottom - TOP)
        lines.append(f"M{LEFT} {y:.1f}H{right}")
        numbers.append(f'<text x="{LEFT - 5}" y="{y + 3.5:.1f}" text-anchor="end">{value:.3g}</text>')
    names = (
        f'<text x="0" y="12"><tspan font-weight="600">{plane.name}</tspan>: error afterwards ({plane.unit})</text>'
        f'<text x="{right}" y="{HEIGHT - 4}" text-anchor="end">settles after (s)</text>'
    )
    grid = f'<path d="{"".join(lines)}" stroke="currentColor" stroke-opacity="0.18"/>'
    return f'{grid}<g fill="currentColor" font-size="11">{"".join(numbers)}{names}</g>'


def _dots(places: Iterable[tuple[float, float]]) -> str:
    """Lines of no length, which round ends make dots: one element for hundreds of them."""
    lines = "".join(f"M{x:.1f} {y:.1f}h0" for x, y in places)
    look = 'stroke="currentColor" stroke-opacity="0.35" stroke-width="3.5" stroke-linecap="round"'
    return f'<path d="{lines}" {look}/>'


def _pickable(plane: Plane, point: Point, place: tuple[float, float]) -> str:
    x, y = place
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.2" fill="{BLUE}"><title>{told(plane, point)}</title></circle>'


def _square(x: float, y: float) -> str:
    return f'<rect x="{x - 4:.1f}" y="{y - 4:.1f}" width="8" height="8" stroke="currentColor" stroke-width="2"/>'


def _diamond(x: float, y: float) -> str:
    return f'<path d="M{x:.1f} {y - 6:.1f}l5.5 6-5.5 6-5.5-6z" fill="{VERMILLION}"/>'


def _ring(x: float, y: float) -> str:
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="7.5" stroke="{PURPLE}" stroke-width="2.5"/>'
