"""How a map is judged and drawn: its requirement, its best cell, its scale of colours, and the contour.

judged(map, metric, bound)    the best cell, and the shares that meet the bound
contour                       where log₁₀ of the metric, or the metric, has the value of the bound
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import contourpy
import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from explorer.model.study_map import FLYABLE, Axis, Cell
from rangenav.preset import Preset
from rangenav.studies.maps import StudyMap
from rangenav.studies.metrics import METRICS, ROWS
from rangenav.studies.requirements import DEPENDENT, Bound, bound_of

DECADES = 4.0
"""Most of a logarithmic scale, from its best end: a blind map reaches 10⁸ m, and the rest would have one colour."""
LOGARITHMIC = frozenset({"mu", "sigma_lifted", "sigma_nonlinear", "snap", "nees"}) | {
    row.name for row in ROWS if row.name.startswith(("steady", "peak", "final"))
}


@dataclass(frozen=True)
class Judged:
    """What a map says in numbers."""

    best: Cell | None
    """The best cell that the vehicle can fly, or the best of all if it can fly none; of equal ones the nearest to the
    present design. None if no cell has a value."""
    equal: int
    """How many cells are as good."""
    meeting: float | None
    """The share of the computed cells that meet the bound and keep the vehicle's limits; None without a bound."""
    flyable: float | None
    """The share of the computed cells that keep the vehicle's limits; None if that was not computed."""


def judged(of: StudyMap, metric: str, bound: Bound | None, present: tuple[float, float] | None = None) -> Judged:
    """The best cell and the shares, of the cells that are computed. present: the design on the page, in indices."""
    count = int(of.computed.sum())
    can_fly = of.values[FLYABLE] == 1.0 if FLYABLE in of.values else None
    if count == 0:
        return Judged(None, 0, None, None)
    good = of.computed if can_fly is None else of.computed & can_fly
    meeting = None if bound is None else int((good & bound.met(of.values[metric])).sum()) / count
    flyable = None if can_fly is None else int((of.computed & can_fly).sum()) / count
    return Judged(*_best(of, metric, good, present), meeting, flyable)


def shares(of: StudyMap, metric: str) -> tuple[Float[Array, "n m"], tuple[float, float] | None]:
    """Where the values lie on the scale of colours, 0 at its light end and 1 at its dark one, NaN without a value; and
    the values at both ends, None if no value is finite. A value beyond the ends has the colour of the end; a scale by
    powers of ten ends with the cells that keep the vehicle's limits."""
    values = of.filled(metric)
    worst = 1.0 if METRICS[metric].better == "more" else -1.0
    log = _log(metric, values)
    with np.errstate(divide="ignore", invalid="ignore"):
        scaled = np.log10(values) if log else values
    finite = scaled[np.isfinite(scaled)]
    if not len(finite):
        return np.where(np.isnan(values), np.nan, 1.0), None
    can_fly = scaled[~not_flyable(of) & np.isfinite(scaled)]
    if log and len(can_fly):  # the best of what nobody can fly would push all else to the dark end
        finite = can_fly
    low, high = float(finite.min()), float(finite.max())
    if log and high - low > DECADES:
        low, high = (high - DECADES, high) if worst > 0 else (low, low + DECADES)
    light, dark = (high, low) if worst > 0 else (low, high)
    span = dark - light if dark != light else 1.0
    share = np.clip((scaled - light) / span, 0.0, 1.0)
    ends = (10.0**light, 10.0**dark) if log else (light, dark)
    return share, ends


def on_scale(metric: str, ends: tuple[float, float], value: float) -> float | None:
    """Where a value lies on the scale of colours, from 0 to 1; None if it lies beyond."""
    light, dark = ends
    if light == dark:
        return None
    if metric in LOGARITHMIC and min(light, dark, value) > 0:
        light, dark, value = (float(np.log10(one)) for one in (light, dark, value))
    share = (value - light) / (dark - light)
    return share if 0.0 <= share <= 1.0 else None


def contour(of: StudyMap, metric: str, bound: Bound | None) -> list[Float[Array, "k 2"]]:
    """Lines where a metric has the value of its bound, in indices of the two parameters; of the finest level that is
    complete. Infinite values count as a decade beyond the largest finite one."""
    if bound is None or of.step == 0:
        return []
    values = of.values[metric][:: of.step, :: of.step]
    log = _log(metric, values) and bound.level > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        scaled = np.log10(values) if log else values.copy()
    level = float(np.log10(bound.level)) if log else bound.level
    finite = scaled[np.isfinite(scaled)]
    if min(scaled.shape) < 2 or not len(finite):
        return []
    scaled[np.isposinf(scaled)] = max(float(finite.max()), level) + 1.0
    scaled[np.isneginf(scaled)] = min(float(finite.min()), level) - 1.0
    across, upwards = (np.arange(count) * float(of.step) for count in scaled.shape)
    drawn = contourpy.contour_generator(across, upwards, np.ma.masked_invalid(scaled.T))
    return [np.asarray(line) for line in drawn.lines(level)]


def limits_of(preset: Preset, axes: Sequence[Axis]) -> dict[str, Bound]:
    """The limits of a preset's vehicle that are metrics, too; none where an axis of the map varies the vehicle."""
    if any(axis.path.startswith("vehicle.") for axis in axes):
        return {}
    bounds = {row.name: bound_of(row.name, preset) for row in ROWS if row.needs == "motion" and row.name in DEPENDENT}
    return {name: bound for name, bound in bounds.items() if bound is not None}


def broken_limits(of: StudyMap, limits: Mapping[str, Bound], cell: Cell) -> tuple[str, ...]:
    """The titles of the metrics that are beyond their limits at a cell."""
    known = {name: bound for name, bound in limits.items() if name in of.values}
    values = {name: of.values[name][cell][None] for name in known}
    return tuple(METRICS[name].title for name, bound in known.items() if not bound.met(values[name]).all())


def without_effect(of: StudyMap, metric: str) -> tuple[int, ...]:
    """The axes, 0 across and 1 upwards, along which no computed value of a metric differs from another; none before
    the first level is complete, and none where no two values can be compared."""
    values = np.where(of.computed & (of.reason == ""), of.values[metric], np.nan)
    if of.step == 0 or not np.isfinite(values).any():
        return ()
    return tuple(axis for axis in (0, 1) if _constant(values, axis))


def _constant(values: Float[Array, "n m"], axis: int) -> bool:
    known = ~np.isnan(values)
    several = known.sum(axis=axis) > 1
    most = np.where(known, values, -np.inf).max(axis=axis)
    least = np.where(known, values, np.inf).min(axis=axis)
    return bool(several.any() and (most == least)[several].all())


def not_flyable(of: StudyMap) -> Bool[Array, "n m"]:
    """Where a vehicle's limit is broken; cells that are not computed yet are like the nearest coarser one."""
    if FLYABLE not in of.values:
        return np.zeros(of.computed.shape, dtype=bool)
    return of.filled(FLYABLE) == 0.0


def _log(metric: str, values: Array) -> bool:
    return metric in LOGARITHMIC and bool(np.any(values[np.isfinite(values)] > 0))


def _best(
    of: StudyMap, metric: str, good: Bool[Array, "n m"], present: tuple[float, float] | None
) -> tuple[Cell | None, int]:
    """The best cell, and how many are as good."""
    values = of.values[metric]
    for among in (good, of.computed):
        usable = among & np.isfinite(values)
        if usable.any():
            away = np.abs(np.log(np.maximum(values, 1e-300))) if METRICS[metric].better == "neither" else values
            away = np.where(usable, -away if METRICS[metric].better == "more" else away, np.inf)
            equal = np.argwhere(away == away.min())
            steps = np.zeros(len(equal)) if present is None else np.sum((equal - np.array(present)) ** 2, axis=1)
            i, j = equal[int(np.argmin(steps))].tolist()
            return (i, j), len(equal)
    return None, 0
