"""Curves of what stands beside a picture, added to its plots behind the picture's own: `over(plot, picture, beside)`.

A pinned run (A) gives every plot its curves once more; other estimators, and the median of many seeds with the band
from 10 to 90 %, go into the plots of errors. All of a plot's curves share one time axis, the picture's: those beside
it are read off at its times. With nothing beside, a plot is what it was, at no cost.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from explorer.charts import curves, plots
from explorer.charts.curves import Range
from explorer.charts.plots import Curve, Drawing, Plot
from explorer.model import palette
from explorer.model.comparison import Baseline, Comparison, Name
from explorer.model.compute import Picture
from rangenav.ensemble import Ensemble

PINNED_DASH, PINNED_AGAIN_DASH = (9.0, 3.0, 2.0, 3.0, 2.0, 3.0), (4.0, 3.0)
"""Of A's first curve in a plot, and of its second; no curve of a picture has either."""
RIVALS: dict[Name, Curve] = {
    "EKF": Curve(label="EKF", color=palette.ESTIMATORS["EKF"], dash=(12.0, 2.0), width=1.25),
    "refined": Curve(label="refined", color=palette.ESTIMATORS["refined"], dash=(5.0, 2.0), width=1.25),
}
ERRORS = ("position", "velocity", "gravity", "attitude")
"""Plots that hold the error of this name."""
EDGE = 0.5
"""px: the edges of a band."""
REACH = 100.0
"""A band, or an estimator that went astray, may widen a log axis by so much beyond the runs, and no more."""


class Pinned(NamedTuple):
    """A pinned run, as one plot draws it; kept while it stays pinned."""

    picture: Picture
    drawing: Drawing


class Layer(NamedTuple):
    """Curves that are added to a plot, already on its times."""

    curves: tuple[Curve, ...]
    read: Float[Array, "n k"]
    drawn: Float[Array, "n k"]
    axis: Range
    """On which they were drawn."""
    reach: float = np.inf
    """How far they may widen the plot's axis."""
    band: bool = False
    """Whether the second and third are the edges of a band; without names, they come and go with the first."""


def pinned(plot: Plot, picture: Picture | None, before: Pinned | None) -> Pinned | None:
    """A's drawing in a plot, made once."""
    if picture is None or (before is not None and before.picture is picture):
        return before if picture is not None else None
    return Pinned(picture, plot.draw(picture))


def over(plot: Plot, picture: Picture, beside: Comparison, kept: Pinned | None) -> tuple[Plot, Drawing]:
    """A plot with everything that stands beside the picture, and its drawing."""
    drawing = plot.draw(picture)
    layers = list(_layers(plot, drawing, picture, beside, kept))
    if not layers:
        return plot, drawing
    axis = _axis(plot, drawing.axis, layers)
    parts = [_placed(drawing.read, drawing.drawn, drawing.axis, axis) if plot.log else drawing.drawn]
    parts += [_placed(layer.read, layer.drawn, layer.axis, axis) if plot.log else layer.drawn for layer in layers]
    added = tuple(curve for layer in layers for curve in layer.curves)
    firsts = np.cumsum([len(plot.curves), *(len(layer.curves) for layer in layers)])
    bands = tuple((int(k) + 1, int(k) + 2) for k, layer in zip(firsts, layers, strict=False) if layer.band)
    read = np.concatenate([drawing.read, *(layer.read for layer in layers)], axis=1)
    shown = replace(drawing, read=read, drawn=np.concatenate(parts, axis=1), axis=axis)
    return replace(plot, curves=plot.curves + added, bands=plot.bands + bands), shown


def _layers(plot: Plot, drawing: Drawing, picture: Picture, beside: Comparison, kept: Pinned | None) -> list[Layer]:
    errors = plot.name in ERRORS
    found = [_seeds(plot, drawing.time, beside.seeds)] if errors and beside.seeds is not None else []
    found += [_again(plot, drawing.time, kept)] if kept is not None and plot.again else []
    return found + ([_rival(plot, drawing.time, baseline) for baseline in beside.baselines] if errors else [])


def _again(plot: Plot, time: Float[Array, "n"], kept: Pinned) -> Layer:
    """A's own curves; those it hides stay away."""
    columns, drawing = list(plot.again), kept.drawing
    several = len(columns) > 1
    looks = tuple(
        Curve(
            label=f"A {plot.curves[column].label}" if several else "A",
            color=f"{palette.PINNED}{palette.TRANSLUCENT}",
            dash=dash,
            width=1.75,
        )
        for column, dash in zip(columns, (PINNED_DASH, PINNED_AGAIN_DASH), strict=False)
    )
    away = np.array([column in drawing.hidden for column in columns])
    read, drawn = (
        np.where(away, np.nan, taken(drawing.time, values[:, columns], time))
        for values in (drawing.read, drawing.drawn)
    )
    return Layer(looks, read, drawn, drawing.axis)


def _rival(plot: Plot, time: Float[Array, "n"], baseline: Baseline) -> Layer:
    """Another estimator's error; nothing while it is at work, so that the legend need not come and go."""
    read = np.full((len(time), 1), np.nan)
    if baseline.candidate is not None:
        error = _in_unit(plot, getattr(baseline.candidate.errors, plot.name))
        read = curves.end_at_first_nan(np.where(np.isfinite(error), error, np.nan)[:, None])
    axis = curves.decades(read, low_quantile=plots.SMALLEST_SHARE)
    return Layer((RIVALS[baseline.name],), read, curves.onto_log_axis(read, axis), axis, REACH)


def _seeds(plot: Plot, time: Float[Array, "n"], runs: Ensemble) -> Layer:
    """The middle of many runs."""
    band = runs.band(plot.name)  # pyright: ignore[reportArgumentType]  (one of ERRORS)
    stacked = np.stack([band.median, band.high, band.low], axis=1)
    read = taken(runs.time, _in_unit(plot, stacked), time)
    edge = Curve(label="", color=f"{palette.SEEDS_EDGE}{palette.TRANSLUCENT}", width=EDGE)
    median = Curve(label=f"{len(runs.seed)} seeds", color=palette.SEEDS, width=2.25)
    axis = curves.decades(read, low_quantile=plots.SMALLEST_SHARE)
    return Layer((median, edge, edge), read, curves.onto_log_axis(read, axis), axis, REACH, band=True)


def taken(time: Float[Array, "m"], values: Float[Array, "m k"], at: Float[Array, "n"]) -> Float[Array, "n k"]:
    """Rows at other times: the last one before each; NaN once they have ended, and the first one before they begin."""
    if len(time) == len(at) and np.array_equal(time, at):
        return values
    if not len(time):
        return np.full((len(at), values.shape[1]), np.nan)
    step = time[1] - time[0] if len(time) > 1 else 0.0
    rows = np.searchsorted(time, at + 1e-9, side="right") - 1
    return np.where((at > time[-1] + step)[:, None], np.nan, values[np.maximum(rows, 0)])


def _in_unit(plot: Plot, error: Array) -> Array:
    return np.degrees(error) if plot.name == "attitude" else error


def _axis(plot: Plot, own: Range, layers: list[Layer]) -> Range:
    """An axis for all curves: whole decades stay whole, round ends round."""
    low, high = own
    for layer in layers:
        if layer.reach == np.inf:
            low, high = min(low, layer.axis[0]), max(high, layer.axis[1])
    runs = (low, high)
    for layer in layers:
        if layer.reach < np.inf and np.isfinite(layer.read).any():
            low = min(low, max(layer.axis[0], runs[0] / layer.reach))
            high = max(high, min(layer.axis[1], runs[1] * layer.reach))
    return low, high


def _placed(read: Array, drawn: Array, before: Range, axis: Range) -> Array:
    """Values that were put outside one log axis put outside another; all others as they are."""
    with np.errstate(invalid="ignore"):
        true = np.isfinite(read) & (read > 0)
        below, above = ~true & (drawn < before[0]), ~true & (drawn > before[1])
    moved = np.where(true, read, np.where(below, 0.0, np.where(above, np.inf, drawn)))
    return curves.onto_log_axis(moved, axis)
