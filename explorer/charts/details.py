"""The plots of the tabs "In depth" and "Twin": functions Picture -> Drawing on its details, and their sentences.

They use the time axis of all plots: a window of length δ is drawn at t = δ, a moment τ of a window at t = τ.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from explorer.charts import curves, plots
from explorer.charts.plots import STATES, Drawing
from explorer.model import details
from explorer.model.compute import Picture
from rangenav.twin import TOLERANCE, Twin

RANK_AXIS = (0.0, 14.0)
"""Labelled at 0, 7 and 14; the full rank, 13, has a line of its own."""
SMALLEST = 1e-15
"""m; a smaller difference of ranges is rounding. A log axis needs a value above 0."""


def scaled(picture: Picture) -> Drawing:
    """The 13 singular values in units of 1 m and δ, and the tolerance below which they do not count for the rank."""
    spectrum = picture.details.spectrum
    tolerance = spectrum.tolerance[:, None]
    ascending = spectrum.scaled[:, ::-1]
    counts = ascending > tolerance
    values = np.concatenate([np.where(counts, ascending, -np.inf), tolerance], axis=1)
    axis = curves.decades(values)
    axis = (axis[0] / 10, axis[1])
    drawn = np.concatenate([np.where(counts, ascending, tolerance), tolerance], axis=1)
    time = picture.at_rest.analysis.windows.start
    return Drawing(time=time, values=values, drawn=curves.onto_log_axis(drawn, axis), axis=axis)


def functions(picture: Picture) -> Drawing:
    """The 13 functions on the window of least rank, each drawn as a share of its own greatest value."""
    thirteen = picture.details.functions
    peak = np.abs(thirteen.values).max(axis=0)
    shape = thirteen.values / np.where(peak > 0, peak, 1.0)
    return Drawing(time=thirteen.tau, values=thirteen.values, drawn=shape, axis=(-1.0, 1.0))


def rank_by_length(picture: Picture) -> Drawing:
    """Rank by window length: of the window from the start of the flight, and of the worst window."""
    horizon = picture.details.horizon
    values = curves.end_at_first_nan(np.column_stack([horizon.rank, np.full(len(horizon.length), float(STATES))]))
    return Drawing(time=horizon.length, values=values, drawn=values, axis=RANK_AXIS)


def sigma_by_length(picture: Picture) -> Drawing:
    """Predicted σ at the end of the same windows; a blind window has none."""
    horizon = picture.details.horizon
    wanted = np.full(len(horizon.length), picture.preset.requirement.position_sigma)
    values = curves.end_at_first_nan(np.column_stack([horizon.sigma, wanted]))
    axis = curves.decades(values)
    return Drawing(time=horizon.length, values=values, drawn=curves.onto_log_axis(values, axis), axis=axis)


def ranges(picture: Picture) -> Drawing:
    """The range of the true motion and of its twin."""
    twin = picture.details.twin
    if not isinstance(twin, Twin):
        time, true = picture.motion.time, _true_range(picture)
        values = np.column_stack([true, true])
        return Drawing(time=time, values=values, drawn=values, axis=_from_zero(values), hidden=(1,))
    values = np.column_stack([twin.range, twin.twin_range])
    return Drawing(time=twin.time, values=values, drawn=values, axis=_from_zero(values))


def apart(picture: Picture) -> Drawing:
    """The distance of the twin and the difference of its range, on one log axis."""
    twin = picture.details.twin
    if not isinstance(twin, Twin):
        time = picture.motion.time
        values = np.full((len(time), 3), TOLERANCE)
        return Drawing(time=time, values=values, drawn=values, axis=curves.decades(values), hidden=(0, 1))
    distance = np.linalg.norm(twin.shift + twin.time[:, None] * twin.drift, axis=-1)
    difference = np.abs(twin.twin_range - twin.range)
    values = np.column_stack([distance, difference, np.full_like(distance, TOLERANCE)])
    axis = curves.decades(np.maximum(values, SMALLEST), low_quantile=0.0)
    return Drawing(time=twin.time, values=values, drawn=curves.onto_log_axis(values, axis), axis=axis)


def phi(picture: Picture) -> Drawing:
    """|φ| as derived and as printed, whatever is switched on."""
    values = np.column_stack([np.linalg.norm(signal, axis=1) for signal in (picture.phi, picture.phi_printed)])
    return Drawing(time=picture.motion.time, values=values, drawn=values, axis=_from_zero(values))


def certificates(picture: Picture) -> Drawing:
    """The least eigenvalue of the excitation: as derived, with each misprint, with both, and the required μ."""
    analysis, comparison, required = picture.at_rest.analysis, picture.details.printed, picture.preset.requirement.mu
    windows = analysis.windows
    derived = np.where(windows.excitation[:, 0] > analysis.mu_floor, windows.excitation[:, 0], 0.0)
    printed = (comparison.least_formula, comparison.least_axes, comparison.least_printed)
    largest = max(float(column.max()) for column in (derived, *printed))
    values = np.column_stack([derived, *printed, np.full_like(derived, required)])
    values = np.where(values > plots.EXCITATION_FLOOR * largest, values, 0.0)
    axis = curves.decades(np.append(values, [required / 10, required * 10]))
    return Drawing(time=windows.start, values=values, drawn=curves.onto_log_axis(values, axis), axis=axis)


def describe_depth(picture: Picture) -> tuple[str, ...]:
    """Sentences: how long to fly, which functions depend on which, and the verdict of the frozen-time test."""
    of_picture = picture.details
    tied, unseen = "; ".join(of_picture.functions.relations), "; ".join(of_picture.functions.unseen)
    relations = f"Not independent on the worst window: {tied}." if tied else "All 13 functions are independent."
    blind = f"So no range of it feels these changes of the state: {unseen}." if unseen else ""
    return tuple(
        line for line in (of_picture.horizon.summary, relations, blind, details.frozen_summary(picture.preset)) if line
    )


def describe_twin(picture: Picture) -> tuple[str, ...]:
    """Sentences: the twin, or why there is none; and what the printed condition certifies."""
    of_picture = picture.details
    twin = f"Twin: {of_picture.twin.summary}." if isinstance(of_picture.twin, Twin) else f"{of_picture.twin.reason}."
    return twin[0].upper() + twin[1:], of_picture.printed.summary


def _true_range(picture: Picture) -> Float[Array, "n"]:
    return np.linalg.norm(picture.motion.position - np.asarray(picture.preset.world.anchor), axis=1)


def _from_zero(values: Array) -> curves.Range:
    return curves.even_range(values, symmetric=False)
