"""The curves of the compared runs, added to a plot behind the picture's own: `with_comparison(plot, picture, …)`.

The pinned run A repeats some curves of every plot. Other estimators, and the median of many seeds with its band from
10 to 90 %, are added to the plots of errors. The curves of a plot share one time axis, the picture's: a compared run is
sampled at the picture's times. Without compared runs a plot is returned as it is.
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

PINNED_DASHES = (9.0, 3.0, 2.0, 3.0, 2.0, 3.0), (4.0, 3.0)
"""The dashes of A's first and second curve in a plot; no other curve has them."""
ESTIMATOR_CURVES: dict[Name, Curve] = {
    "EKF": Curve(label="EKF", color=palette.ESTIMATORS["EKF"], dash=(12.0, 2.0), width=1.25),
    "refined": Curve(label="refined", color=palette.ESTIMATORS["refined"], dash=(5.0, 2.0), width=1.25),
}
ERROR_PLOTS = ("position", "velocity", "gravity", "attitude")
"""The plots that show the error of this name."""
BAND_EDGE = 0.5
"""px: width of the edges of a band."""
MAX_WIDENING = 100.0
"""A band or another estimator may widen a log axis by at most this factor beyond the runs."""


class PinnedDrawing(NamedTuple):
    """The pinned run as one plot draws it; computed once while it stays pinned."""

    picture: Picture
    drawing: Drawing


class AddedCurves(NamedTuple):
    """Curves that are added to a plot, sampled at the plot's times."""

    curves: tuple[Curve, ...]
    values: Float[Array, "n k"]
    drawn: Float[Array, "n k"]
    axis: Range
    """The axis for which `drawn` was computed."""
    max_widening: float = np.inf
    """The factor by which they may widen the plot's axis."""
    band: bool = False
    """Whether the second and third curve are the edges of a band; without labels, they are shown and hidden with the
    first."""


def pinned(plot: Plot, picture: Picture | None, before: PinnedDrawing | None) -> PinnedDrawing | None:
    """The drawing of the pinned run in a plot, computed only when another run is pinned."""
    if picture is None:
        return None
    if before is not None and before.picture is picture:
        return before
    return PinnedDrawing(picture, plot.draw(picture))


def with_comparison(
    plot: Plot, picture: Picture, comparison: Comparison, pinned_run: PinnedDrawing | None
) -> tuple[Plot, Drawing]:
    """A plot with the curves of all compared runs, and its drawing."""
    drawing = plot.draw(picture)
    added = _added_curves(plot, drawing, comparison, pinned_run)
    if not added:
        return plot, drawing
    axis = _common_axis(drawing.axis, added)
    parts = [onto_axis(drawing.values, drawing.drawn, drawing.axis, axis) if plot.log else drawing.drawn]
    parts += [onto_axis(more.values, more.drawn, more.axis, axis) if plot.log else more.drawn for more in added]
    firsts = np.cumsum([len(plot.curves), *(len(more.curves) for more in added)])
    bands = tuple((int(k) + 1, int(k) + 2) for k, more in zip(firsts, added, strict=False) if more.band)
    values = np.concatenate([drawing.values, *(more.values for more in added)], axis=1)
    shown = replace(drawing, values=values, drawn=np.concatenate(parts, axis=1), axis=axis)
    more_curves = tuple(curve for more in added for curve in more.curves)
    return replace(plot, curves=plot.curves + more_curves, bands=plot.bands + bands), shown


def _added_curves(
    plot: Plot, drawing: Drawing, comparison: Comparison, pinned_run: PinnedDrawing | None
) -> list[AddedCurves]:
    added, errors = [], plot.name in ERROR_PLOTS
    if errors and comparison.seeds is not None:
        added.append(_seed_curves(plot, drawing.time, comparison.seeds))
    if pinned_run is not None:
        columns = [column for column in plot.pinned_curves if column not in pinned_run.drawing.hidden]
        added += [_pinned_curves(drawing.time, plot, pinned_run, columns)] if columns else []
    if errors:
        added += [_estimator_curve(plot, drawing.time, baseline) for baseline in comparison.baselines]
    return added


def _pinned_curves(time: Float[Array, "n"], plot: Plot, pinned_run: PinnedDrawing, columns: list[int]) -> AddedCurves:
    """The curves of A."""
    drawing, several = pinned_run.drawing, len(columns) > 1
    added = tuple(
        Curve(
            label=f"A {plot.curves[column].label}" if several else "A",
            color=f"{palette.PINNED}{palette.TRANSLUCENT}",
            dash=dash,
            width=1.75,
        )
        for column, dash in zip(columns, PINNED_DASHES, strict=False)
    )
    values, drawn = (sampled_at(drawing.time, of_run[:, columns], time) for of_run in (drawing.values, drawing.drawn))
    return AddedCurves(added, values, drawn, drawing.axis)


def _estimator_curve(plot: Plot, time: Float[Array, "n"], baseline: Baseline) -> AddedCurves:
    """The error of another estimator. While that is being computed the curve is NaN, so that the legend keeps its
    entry."""
    values = np.full((len(time), 1), np.nan)
    if baseline.candidate is not None:
        error = _in_unit(plot, getattr(baseline.candidate.errors, plot.name))
        values = curves.end_at_first_nan(np.where(np.isfinite(error), error, np.nan)[:, None])
    axis = curves.decades(values, low_quantile=plots.SMALLEST_SHARE)
    drawn = curves.onto_log_axis(values, axis)
    return AddedCurves((ESTIMATOR_CURVES[baseline.name],), values, drawn, axis, MAX_WIDENING)


def _seed_curves(plot: Plot, time: Float[Array, "n"], runs: Ensemble) -> AddedCurves:
    """The median error of many seeds, and the edges of the band around it."""
    band = runs.band(plot.name)  # pyright: ignore[reportArgumentType]  (one of ERROR_PLOTS)
    stacked = np.stack([band.median, band.high, band.low], axis=1)
    values = sampled_at(runs.time, _in_unit(plot, stacked), time)
    edge = Curve(label="", color=f"{palette.SEEDS_EDGE}{palette.TRANSLUCENT}", width=BAND_EDGE)
    median = Curve(label=f"{len(runs.seed)} seeds", color=palette.SEEDS, width=2.25)
    axis = curves.decades(values, low_quantile=plots.SMALLEST_SHARE)
    drawn = curves.onto_log_axis(values, axis)
    return AddedCurves((median, edge, edge), values, drawn, axis, MAX_WIDENING, band=True)


def sampled_at(time: Float[Array, "m"], values: Float[Array, "m k"], at: Float[Array, "n"]) -> Float[Array, "n k"]:
    """The rows at other times (s): for each, the last row that is not later. The first row serves all times before it;
    after the last row has ended there is NaN."""
    if len(time) == len(at) and np.array_equal(time, at):
        return values
    if not len(time):
        return np.full((len(at), values.shape[1]), np.nan)
    step = time[1] - time[0] if len(time) > 1 else 0.0
    rows = np.searchsorted(time, at + 1e-9, side="right") - 1
    return np.where((at > time[-1] + step)[:, None], np.nan, values[np.maximum(rows, 0)])


def _in_unit(plot: Plot, error: Array) -> Array:
    return np.degrees(error) if plot.name == "attitude" else error


def _common_axis(own: Range, added: list[AddedCurves]) -> Range:
    """One axis for all curves: the hull of the axes of all runs, widened for the others by at most their factor."""
    low, high = own
    for more in added:
        if more.max_widening == np.inf:
            low, high = min(low, more.axis[0]), max(high, more.axis[1])
    runs = (low, high)
    for more in added:
        if more.max_widening < np.inf and np.isfinite(more.values).any():
            low = min(low, max(more.axis[0], runs[0] / more.max_widening))
            high = max(high, min(more.axis[1], runs[1] * more.max_widening))
    return low, high


def onto_axis(values: Array, drawn: Array, before: Range, axis: Range) -> Array:
    """Values for another log axis; `drawn` are those for the axis `before`. What was moved outside that axis is moved
    outside this one."""
    with np.errstate(invalid="ignore"):
        positive = np.isfinite(values) & (values > 0)
        below, above = ~positive & (drawn < before[0]), ~positive & (drawn > before[1])
    moved = np.where(positive, values, np.where(below, 0.0, np.where(above, np.inf, drawn)))
    return curves.onto_log_axis(moved, axis)
