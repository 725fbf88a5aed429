"""The map as HTML: cells in colours, the contour, hatching where the vehicle's limits are broken, marks, and a cross.

The cells are SVG in units of cells, stretched over the width of the dock; axes, numbers and sentences are text around
it, so that they grow with the page's type. Shapes say what colours say: a contour, hatching, × for a point that cannot
be computed, dots for a value that is infinite.
"""

import html
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from explorer.model import palette
from explorer.model.basin import on_scale as colour_at
from explorer.model.study_axes import Candidate
from explorer.model.study_judgement import broken_limits, contour, not_flyable, on_scale, shares
from explorer.model.study_map import Axis
from explorer.panels.gains.tradeoff_plot import ticks as log_ticks
from explorer.panels.studies.text import wanted, written
from explorer.web import cells
from explorer.web.accessibility import spoken
from explorer.widgets.html import upper_first
from rangenav.number_format import power_of_ten, quantity, significant
from rangenav.studies.maps import StudyMap
from rangenav.studies.metrics import METRICS
from rangenav.studies.parameters import Log
from rangenav.studies.requirements import Bound

PLACE = "map of two parameters"
"""By this name the page brings the picture into sight."""
EVENT = "map-take"
"""The event of a cell that is taken, in front of its two indices."""
SHADES = 32
"""Colours of the picture: few enough that neighbours share one element, too many to be told apart."""
MAX_TICKS = 5
SHORTER = 4
"""From this exponent on a power of ten is shorter than its digits."""
TICK_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
READ = "Point at a cell to read it; a click takes it as the design (one step to undo)."
KEYS = "Arrow keys move over the cells, Enter takes one."
BEYOND = "breaks the vehicle's limits"
WAITS = "not computed yet"
SCALE = "scale of colours, light to dark"
NOTICE = '<div role="status" class="rn-map-notice">⚠ {}.</div>'
LINE = '<path d="{}" fill="none" stroke="{}" stroke-width="{}" stroke-linecap="{}" vector-effect="non-scaling-stroke"/>'


@dataclass(frozen=True)
class Shown:
    """What the picture shows."""

    map: StudyMap
    axes: tuple[Axis, Axis]
    names: tuple[Candidate, Candidate]
    metric: str
    bound: Bound | None
    cross: tuple[float, float] | None
    """The present design, in indices; None where it lies outside, or the map is of another design."""
    sentence: str
    """What the map says in words."""
    outdated: str
    """Why the map is not of what is chosen now; empty if it is."""
    runs: int
    """Seeds at each point."""
    limits: Mapping[str, Bound]
    """The limits of the vehicle, by the metrics that they belong to."""
    preset: str
    """How the study names its preset."""
    windows: str
    """Which windows σ, μ and ranks come from."""


def markup(shown: Shown) -> str:
    """The whole block below the buttons."""
    title = titled(shown)
    across, upwards = (html.escape(name.caption) for name in shown.names)
    notice = NOTICE.format(html.escape(upper_first(shown.outdated))) if shown.outdated else ""
    state = " rn-map-outdated" if shown.outdated else ""
    return (
        f'{notice}<div class="rn-map{state}"><b>{html.escape(title)}</b>'
        f'<div class="rn-map-name">↑ {upwards}</div>{_frame(shown)}'
        f'<div class="rn-map-name rn-map-across">{across} →</div>'
        f"{_scale(shown)}{_legend(shown)}"
        f'<div class="rn-cells-read">{READ}</div>'
        f'<div class="rn-map-text" {_said(shown)}>{html.escape(shown.sentence)}</div></div>'
    )


def titled(shown: Shown) -> str:
    """The metric with its unit, and what is shown of several seeds."""
    metric = METRICS[shown.metric]
    title = f"{metric.title} ({metric.unit})" if metric.unit else metric.title
    return f"{title}, {metric.middle} of {shown.runs} seeds" if metric.needs == "run" and shown.runs > 1 else title


def picture(shown: Shown) -> str:
    """The cells and everything over them as SVG, in units of cells; the second axis upwards."""
    n, m = shown.map.computed.shape
    share, _ = shares(shown.map, shown.metric)
    invalid = shown.map.computed & (shown.map.reason != "")
    infinite = np.isinf(shown.map.values[shown.metric])
    hatched = not_flyable(shown.map) & ~invalid
    parts = [
        *_cells(np.where(invalid, np.nan, share)),
        f'<path d="{_squares(invalid)}" fill="{palette.MAP_INVALID}"/>',
        *_twice(_marks(hatched, m, "M{x} {y1}L{x1} {y}"), 1.0),
        *_twice(_marks(infinite, m, "M{xm} {ym}h0"), 2.5),
        *_twice(_marks(invalid, m, "M{xa} {ya}L{xb} {yb}M{xb} {ya}L{xa} {yb}"), 1.0),
        *_twice("".join(_line(line, m) for line in contour(shown.map, shown.metric, shown.bound)), 2.0),
    ]
    style = "position:absolute;inset:0;width:100%;height:100%;overflow:hidden"
    return (
        f'<svg viewBox="0 0 {n} {m}" preserveAspectRatio="none" style="{style}" aria-hidden="true">'
        f"{''.join(parts)}</svg>{_cross(shown.cross, n, m)}"
    )


def ticks(axis: Axis) -> list[tuple[float, str]]:
    """Round values along an axis: where they lie, from 0 to 1 between its outer edges, and how they are written."""
    count = axis.count or 2
    if isinstance(axis, Log):
        values = log_ticks((axis.low, axis.high))
        values = values[:: -(-len(values) // MAX_TICKS)]
        places = [math.log(value / axis.low) / math.log(axis.high / axis.low) for value in values]
    else:
        values = _even(axis.low, axis.high)
        places = [(value - axis.low) / (axis.high - axis.low) for value in values]
    return [((place * (count - 1) + 0.5) / count, _written(value)) for place, value in zip(places, values, strict=True)]


def _written(value: float) -> str:
    """A tick's value; of a power of ten the power, where it is shorter."""
    exponent = round(math.log10(value)) if value > 0 else 0
    return power_of_ten(exponent) if abs(exponent) >= SHORTER and value == 10.0**exponent else significant(value)


def _even(low: float, high: float) -> list[float]:
    """Three to five round values by equal steps."""
    size = 10.0 ** math.floor(math.log10((high - low) / MAX_TICKS))
    step = next(size * k for k in TICK_STEPS if (high - low) / (size * k) <= MAX_TICKS - 1)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]


def _frame(shown: Shown) -> str:
    """The cells with the numbers along both axes."""
    first, second = shown.axes
    numbers = [f'<span class="rn-map-x" style="left:{100 * at:.1f}%">{text}</span>' for at, text in ticks(first)]
    numbers += [f'<span class="rn-map-y" style="bottom:{100 * at:.1f}%">{text}</span>' for at, text in ticks(second)]
    label = html.escape(f"Map. {shown.sentence} {KEYS}")
    return (
        f'<div class="rn-map-frame" data-rn-place="{PLACE}">'
        f'<div class="rn-map-cells" aria-label="{label}" {_content(shown)}>{picture(shown)}'
        f'<div class="rn-cells-cursor"></div></div>{"".join(numbers)}</div>'
    )


def _content(shown: Shown) -> str:
    """What the script reads: the texts of all cells."""
    of = shown.map
    values, reasons = of.values[shown.metric], of.reason
    beyond = not_flyable(of)
    notes: dict[str, int] = {"": 0}
    texts, noted = [], []
    for place in np.ndindex(of.computed.shape):
        if not of.computed[place]:
            text, note = WAITS, ""
        elif reasons[place]:
            text, note = "no value", str(reasons[place])
        else:
            text = written(shown.metric, float(values[place]))
            note = _beyond(shown, place) if beyond[place] else ""
        texts.append(text)
        noted.append(notes.setdefault(note, len(notes)))
    axes = tuple(
        (name.label, [quantity(float(value), name.unit) for value in line])
        for name, line in zip(shown.names, (of.first, of.second), strict=True)
    )
    n, m = of.computed.shape
    start = (n // 2, m // 2) if shown.cross is None else (round(shown.cross[0]), round(shown.cross[1]))
    return cells.attributes(EVENT, axes, texts, (list(notes), noted), start)  # pyright: ignore[reportArgumentType]


def _beyond(shown: Shown, cell: tuple[int, ...]) -> str:
    """That a cell breaks the vehicle's limits, and which."""
    titles = broken_limits(shown.map, shown.limits, (cell[0], cell[1]))
    return f"{BEYOND}: {', '.join(titles)}" if titles else BEYOND


def _scale(shown: Shown) -> str:
    """The colours with the values at both ends, and where the requirement lies between them."""
    _, ends = shares(shown.map, shown.metric)
    if ends is None:
        return ""
    stops = ",".join(palette.MAP_SCALE)
    mark = ""
    if shown.bound is not None:
        at = on_scale(shown.metric, ends, shown.bound.level)
        mark = "" if at is None else f'<i style="left:{100 * at:.1f}%"></i>'
    gradient = f"background:linear-gradient(to right,{stops})"
    bar = f'<span class="rn-map-bar" role="img" aria-label="{SCALE}" style="{gradient}">'
    light, dark = (end_of_scale(shown.metric, end) for end in ends)
    return f'<div class="rn-map-scale">{light}{bar}{mark}</span>{dark}</div>'


def end_of_scale(metric: str, value: float) -> str:
    """The value at an end of the scale, without a unit."""
    return written(metric, value).removesuffix(" of the runs") if METRICS[metric].middle == "share" else _written(value)


def _legend(shown: Shown) -> str:
    """What the signs mean; only of those that the map has."""
    of, entries = shown.map, []
    if shown.bound is not None and contour(of, shown.metric, shown.bound):
        entries.append((_sign("M1 7H17", 2.0), wanted(shown.metric, shown.bound)))
    if not_flyable(of).any():
        entries.append((_sign("M1 13L9 1M9 13L17 1", 1.0), BEYOND))
    if np.isinf(of.values[shown.metric]).any():
        entries.append((_sign("M9 7h0", 2.5), "infinite"))
    if np.any(of.reason != ""):
        entries.append((_sign("M4 2L14 12M14 2L4 12", 1.0), "cannot be computed"))
    if shown.cross is not None:
        entries.append((_sign("M9 0V14M2 7H16", 2.0), "present design"))
    signs = "".join(f"<span>{sign}{html.escape(text)}</span>" for sign, text in entries)
    return f'<div class="rn-map-legend">{signs}</div>'


def _sign(path: str, width: float) -> str:
    return f'<svg width="18" height="14" aria-hidden="true">{"".join(_twice(path, width))}</svg>'


def _said(shown: Shown) -> str:
    """The sentence is spoken when the map is complete, not at every level."""
    return spoken("map", shown.sentence) if shown.map.computed.all() else ""


def _cells(share: Float[Array, "n m"]) -> Iterable[str]:
    """One element for each colour; neighbours along the first axis are one rectangle."""
    shade = np.where(np.isnan(share), -1, np.round(np.nan_to_num(share) * (SHADES - 1))).astype(int)
    colours = colour_at(np.linspace(0.0, 1.0, SHADES))
    for k in np.unique(shade[shade >= 0]).tolist():
        red, green, blue = colours[k].tolist()
        yield f'<path shape-rendering="crispEdges" d="{_squares(shade == k)}" fill="#{red:02x}{green:02x}{blue:02x}"/>'


def _squares(where: Bool[Array, "n m"]) -> str:
    """Rectangles over cells; neighbours along the first axis are one."""
    m = where.shape[1]
    path = []
    for j in range(m):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], where[:, j].astype(int), [0]])))
        for begin, end in edges.reshape(-1, 2).tolist():
            path.append(f"M{begin} {m - 1 - j}h{end - begin}v1h{begin - end}z")
    return "".join(path)


def _marks(where: Bool[Array, "n m"], m: int, sign: str) -> str:
    """A sign in each cell."""
    return "".join(
        sign.format(
            x=i, x1=i + 1, xm=i + 0.5, xa=i + 0.25, xb=i + 0.75,
            y=m - 1 - j, y1=m - j, ym=m - 0.5 - j, ya=m - 0.75 - j, yb=m - 0.25 - j,
        )
        for i, j in np.argwhere(where).tolist()
    )  # fmt: skip


def _line(points: Float[Array, "k 2"], m: int) -> str:
    text = "L".join(f"{x + 0.5:.2f} {m - 0.5 - y:.2f}" for x, y in points.tolist())
    return f"M{text}"


def _twice(path: str, width: float) -> Sequence[str]:
    """A light line with dark edges, which is seen on every colour."""
    if not path:
        return ()
    return (
        LINE.format(path, palette.MAP_EDGE, width + 2.0, "round"),
        LINE.format(path, palette.MAP_LINE, width, "round"),
    )


def _cross(at: tuple[float, float] | None, n: int, m: int) -> str:
    """The present design, of a size that does not depend on that of the cells."""
    if at is None:
        return ""
    left, bottom = 100 * (at[0] + 0.5) / n, 100 * (at[1] + 0.5) / m
    signs = "".join(_twice("M11 1V21M1 11H21", 2.0))
    place = f"left:{left:.2f}%;bottom:{bottom:.2f}%"
    return f'<svg class="rn-map-cross" width="22" height="22" style="{place}" aria-hidden="true">{signs}</svg>'
