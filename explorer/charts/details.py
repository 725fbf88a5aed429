"""The plots of "In depth" and "Twin": functions Picture -> Drawing over its details, with their curves and sentences.

All of them live on the page's one time axis: a window of length δ stands at t = δ, a moment τ of a window at t = τ.
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
"""Labels at 0, 7 and 14; the 13 has a line of its own."""
SMALLEST = 1e-15
"""m; ranges that differ by less differ by rounding, and a log axis has no place for 0."""


def scaled(picture: Picture) -> Drawing:
    """The 13 singular values in units of 1 m and δ, and the tolerance below which they do not count."""
    found = picture.details.spectrum
    tolerance = found.tolerance[:, None]
    ascending = found.scaled[:, ::-1]
    counts = ascending > tolerance
    read = np.concatenate([np.where(counts, ascending, -np.inf), tolerance], axis=1)
    axis = curves.decades(read)
    axis = (axis[0] / 10, axis[1])
    drawn = np.concatenate([np.where(counts, ascending, tolerance), tolerance], axis=1)
    time = picture.analysis.windows.start
    return Drawing(time=time, read=read, drawn=curves.onto_log_axis(drawn, axis), axis=axis)


def functions(picture: Picture) -> Drawing:
    """The 13 functions on the window of least rank, each drawn over its own greatest value and read as it is."""
    found = picture.details.functions
    peak = np.abs(found.values).max(axis=0)
    shape = found.values / np.where(peak > 0, peak, 1.0)
    return Drawing(time=found.tau, read=found.values, drawn=shape, axis=(-1.0, 1.0))


def rank_by_length(picture: Picture) -> Drawing:
    """Rank of the window from the start of the flight, and of the worst, by length."""
    found = picture.details.horizon
    read = curves.end_at_first_nan(np.column_stack([found.rank, np.full(len(found.length), float(STATES))]))
    return Drawing(time=found.length, read=read, drawn=read, axis=RANK_AXIS)


def sigma_by_length(picture: Picture) -> Drawing:
    """Predicted σ at the end of those windows; a blind one has none."""
    found = picture.details.horizon
    wanted = np.full(len(found.length), picture.preset.requirement.position_sigma)
    read = curves.end_at_first_nan(np.column_stack([found.sigma, wanted]))
    axis = curves.decades(read)
    return Drawing(time=found.length, read=read, drawn=curves.onto_log_axis(read, axis), axis=axis)


def ranges(picture: Picture) -> Drawing:
    """The range of the true motion and of its twin."""
    found = picture.details.twin
    if not isinstance(found, Twin):
        time, true = picture.motion.time, _true_range(picture)
        read = np.column_stack([true, true])
        return Drawing(time=time, read=read, drawn=read, axis=_from_zero(read), hidden=(1,))
    read = np.column_stack([found.range, found.twin_range])
    return Drawing(time=found.time, read=read, drawn=read, axis=_from_zero(read))


def apart(picture: Picture) -> Drawing:
    """How far off the twin is, and how little its range differs, on one log axis."""
    found = picture.details.twin
    if not isinstance(found, Twin):
        time = picture.motion.time
        read = np.full((len(time), 3), TOLERANCE)
        return Drawing(time=time, read=read, drawn=read, axis=curves.decades(read), hidden=(0, 1))
    distance = np.linalg.norm(found.shift + found.time[:, None] * found.drift, axis=-1)
    difference = np.abs(found.twin_range - found.range)
    read = np.column_stack([distance, difference, np.full_like(distance, TOLERANCE)])
    axis = curves.decades(np.maximum(read, SMALLEST), low_quantile=0.0)
    return Drawing(time=found.time, read=read, drawn=curves.onto_log_axis(read, axis), axis=axis)


def phi(picture: Picture) -> Drawing:
    """|φ| derived and printed, side by side whatever is switched on."""
    read = np.column_stack([np.linalg.norm(signal, axis=1) for signal in (picture.phi, picture.phi_printed)])
    return Drawing(time=picture.motion.time, read=read, drawn=read, axis=_from_zero(read))


def certificates(picture: Picture) -> Drawing:
    """The least eigenvalue of the excitation: derived, with each misprint and with both, and what is required."""
    windows, found, required = picture.analysis.windows, picture.details.printed, picture.preset.requirement.mu
    derived = np.where(windows.excitation[:, 0] > picture.analysis.mu_floor, windows.excitation[:, 0], 0.0)
    printed = (found.least_formula, found.least_axes, found.least_printed)
    largest = max(float(column.max()) for column in (derived, *printed))
    read = np.column_stack([derived, *printed, np.full_like(derived, required)])
    read = np.where(read > plots.EXCITATION_FLOOR * largest, read, 0.0)
    axis = curves.decades(np.append(read, [required / 10, required * 10]))
    return Drawing(time=windows.start, read=read, drawn=curves.onto_log_axis(read, axis), axis=axis)


def say_depth(picture: Picture) -> tuple[str, ...]:
    """How long to fly; which functions depend on which; what the frozen-time test would say."""
    found = picture.details
    tied, unseen = "; ".join(found.functions.relations), "; ".join(found.functions.unseen)
    relations = f"Not independent on the worst window: {tied}." if tied else "All 13 functions are independent."
    blind = f"So no range of it feels these changes of the state: {unseen}." if unseen else ""
    return tuple(
        line for line in (found.horizon.words, relations, blind, details.frozen_summary(picture.preset)) if line
    )


def say_twin(picture: Picture) -> tuple[str, ...]:
    """The twin or why there is none; what the printed condition certifies."""
    found = picture.details
    told = f"Twin: {found.twin.words}." if isinstance(found.twin, Twin) else f"{found.twin.reason}."
    return told[0].upper() + told[1:], found.printed.words


def _true_range(picture: Picture) -> Float[Array, "n"]:
    return np.linalg.norm(picture.motion.position - np.asarray(picture.preset.world.anchor), axis=1)


def _from_zero(values: Array) -> curves.Range:
    return curves.even_range(values, symmetric=False)
