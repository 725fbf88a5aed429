"""The tradeoff of a search as two small plots: settling time against the steady error, of position and of attitude.

Both axes are logarithmic, as the objective of the search is. The line joins the gains that no others beat in both
figures; dots mark the gains that can be picked. The plots are SVG in the colour of the text, readable on white and on
black.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from explorer.model import palette
from rangenav import tradeoff
from rangenav.number_format import significant
from rangenav.tradeoff import Measure, Point

WIDTH, HEIGHT = 340, 172
"""px of one plot; it shrinks with the dock."""
LEFT, RIGHT, TOP, BOTTOM = 40, 12, 24, 32
BLUE, VERMILLION, PURPLE = palette.BLUE, palette.VERMILLION, palette.PURPLE
MIN_RATIO = 2.0
"""Least ratio of the ends of an axis, so that nearly equal figures stay close together."""
MARGIN = 1.12
"""Factor between the outermost figures and the ends of an axis."""
MIN_TICKS, MAX_TICKS = 3, 7
ROUND_STEPS = (1.0, 2.0, 2.5, 5.0)
"""Mantissas of the steps between the ticks of an axis shorter than a decade."""
Range = tuple[float, float]


class PlotAxes(NamedTuple):
    """The two measures that one plot shows, across and upwards."""

    name: str
    settle: Measure
    steady: Measure
    unit: str
    scale: float
    """From SI to the unit."""


POSITION = PlotAxes("position", "settle_position", "steady_position", "m", 1.0)
ATTITUDE = PlotAxes("attitude", "settle_attitude", "steady_attitude", "°", math.degrees(1.0))


class MarkedPoints(NamedTuple):
    """The points that are drawn with signs of their own."""

    start: Point
    best: Point
    picked: Point
    choices: tuple[Point, ...]
    """Those that can be picked, in the order of their settling times."""


def plot(axes: PlotAxes, tried: Iterable[Point], marked: MarkedPoints) -> str:
    """One plot as SVG, with a label for screen readers."""
    tried = tuple(tried)
    front = tradeoff.front(tried, axes.settle, axes.steady)
    shown = (*front, *marked.choices, marked.start, marked.best, marked.picked)
    at, error = zip(*(_figures(axes, point) for point in shown), strict=True)
    across, upwards = axis_limits(at), axis_limits(error)

    def pixel(point: Point) -> tuple[float, float]:
        x, y = _figures(axes, point)
        return (
            LEFT + _share(x, across) * (WIDTH - LEFT - RIGHT),
            HEIGHT - BOTTOM - _share(y, upwards) * (HEIGHT - TOP - BOTTOM),
        )

    tried_pixels = [pixel(point) for point in tried if _within(_figures(axes, point), across, upwards)]
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in map(pixel, front))
    parts = [
        _frame(axes, across, upwards),
        _dots(tried_pixels),
        f'<polyline points="{line}" stroke="{BLUE}" stroke-width="1.5"/>',
        *(_pickable(axes, point, pixel(point)) for point in marked.choices),
        _square(*pixel(marked.start)),
        _diamond(*pixel(marked.best)),
        _ring(*pixel(marked.picked)),
    ]
    label = f"{axes.name}: error once settled against settling time; {point_text(axes, marked.picked)} is picked"
    style = "display:block;width:100%;height:auto;overflow:visible"
    head = f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" style="{style}" fill="none" role="img" aria-label="{label}">'
    return f"{head}{''.join(parts)}</svg>"


def legend() -> str:
    """The legend of the signs."""
    named = (
        (_square(9, 7), "start"),
        (_diamond(9, 7), "best for w"),
        (_ring(9, 7), "picked"),
        (f'<circle cx="9" cy="7" r="3.2" fill="{BLUE}"/>', "can be picked"),
        ('<circle cx="9" cy="7" r="1.8" fill="currentColor" fill-opacity="0.5"/>', "other sets tried"),
        (f'<path d="M0 7h18" stroke="{BLUE}" stroke-width="1.5"/>', "no set tried is better in both"),
    )
    style = "vertical-align:-2px;margin-right:2px;overflow:visible"
    entry = '<span style="white-space:nowrap"><svg width="18" height="14" fill="none" style="{}">{}</svg>{}</span>'
    entries = " ".join(entry.format(style, sign, label) for sign, label in named)
    return f'<div style="display:flex;flex-wrap:wrap;gap:0 0.7em">{entries}</div>'


def point_text(axes: PlotAxes, point: Point) -> str:
    """Both figures of a point as text."""
    at, error = _figures(axes, point)
    unit = "°" if axes.unit == "°" else f" {axes.unit}"
    return f"settles at {significant(at)} s, then {significant(error)}{unit}"


def axis_limits(values: Sequence[float]) -> Range:
    """The ends of a logarithmic axis for positive values, with a margin."""
    low, high = min(values) / MARGIN, max(values) * MARGIN
    missing = max(1.0, MIN_RATIO / (high / low))
    return low / math.sqrt(missing), high * math.sqrt(missing)


def ticks(axis: Range) -> list[float]:
    """Three to seven round values on a logarithmic axis: powers of ten times 1, 2, 5, or else equal steps."""
    low, high = axis
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for mantissas in ((1.0,), (1.0, 2.0, 5.0)):
        values = [m * 10.0**k for k in decades for m in mantissas if low <= m * 10.0**k <= high]
        if len(values) >= MIN_TICKS:
            return values[:: -(-len(values) // MAX_TICKS)]
    steps = (m * 10.0**k for k in reversed(range(decades.start - 2, decades.stop)) for m in reversed(ROUND_STEPS))
    candidates = ((step, math.ceil(low / step), math.floor(high / step)) for step in steps)
    step, first, last = next(candidate for candidate in candidates if candidate[2] - candidate[1] + 1 >= MIN_TICKS)
    return [k * step for k in range(first, last + 1)]


def _figures(axes: PlotAxes, point: Point) -> tuple[float, float]:
    """Settling time (s), and the error afterwards in the unit of the axes."""
    return getattr(point, axes.settle), axes.scale * getattr(point, axes.steady)


def _within(figures: tuple[float, float], across: Range, upwards: Range) -> bool:
    return across[0] <= figures[0] <= across[1] and upwards[0] <= figures[1] <= upwards[1]


def _share(value: float, axis: Range) -> float:
    return math.log(value / axis[0]) / math.log(axis[1] / axis[0])


def _frame(axes: PlotAxes, across: Range, upwards: Range) -> str:
    """Grid, numbers and the names of both axes."""
    bottom, right = HEIGHT - BOTTOM, WIDTH - RIGHT
    lines, numbers = [], []
    for value in ticks(across):
        x = LEFT + _share(value, across) * (right - LEFT)
        lines.append(f"M{x:.1f} {TOP}V{bottom}")
        numbers.append(f'<text x="{x:.1f}" y="{bottom + 13}" text-anchor="middle">{significant(value)}</text>')
    for value in ticks(upwards):
        y = bottom - _share(value, upwards) * (bottom - TOP)
        lines.append(f"M{LEFT} {y:.1f}H{right}")
        numbers.append(f'<text x="{LEFT - 5}" y="{y + 3.5:.1f}" text-anchor="end">{significant(value)}</text>')
    names = (
        f'<text x="0" y="12"><tspan font-weight="600">{axes.name}</tspan>: error once settled ({axes.unit})</text>'
        f'<text x="{right}" y="{HEIGHT - 4}" text-anchor="end">settles after (s)</text>'
    )
    grid = f'<path d="{"".join(lines)}" stroke="currentColor" stroke-opacity="0.18"/>'
    return f'{grid}<g fill="currentColor" font-size="11">{"".join(numbers)}{names}</g>'


def _dots(values: Iterable[tuple[float, float]]) -> str:
    """Dots, drawn as lines of no length with round ends: one element holds hundreds of them."""
    lines = "".join(f"M{x:.1f} {y:.1f}h0" for x, y in values)
    style = 'stroke="currentColor" stroke-opacity="0.35" stroke-width="3.5" stroke-linecap="round"'
    return f'<path d="{lines}" {style}/>'


def _pickable(axes: PlotAxes, point: Point, place: tuple[float, float]) -> str:
    x, y = place
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.2" fill="{BLUE}"><title>{point_text(axes, point)}</title></circle>'


def _square(x: float, y: float) -> str:
    return f'<rect x="{x - 4:.1f}" y="{y - 4:.1f}" width="8" height="8" stroke="currentColor" stroke-width="2"/>'


def _diamond(x: float, y: float) -> str:
    return f'<path d="M{x:.1f} {y - 6:.1f}l5.5 6-5.5 6-5.5-6z" fill="{VERMILLION}"/>'


def _ring(x: float, y: float) -> str:
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="7.5" stroke="{PURPLE}" stroke-width="2.5"/>'
