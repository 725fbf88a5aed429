"""Which curves each plot shows: functions Picture -> Drawing, one for each plot. No viser here.

A Drawing holds what is read at the cursor (true numbers; +∞ for a blind window, −∞ for below the floor) and what is
drawn (the same, moved out of the axes where a plot cannot show it).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from explorer.charts import curves, definitions
from explorer.model.compute import Picture
from rangenav import sensors, vehicle

Dash = tuple[float, ...]
SOLID: Dash = ()
DASHED, DOTTED, DASH_DOT = (7.0, 4.0), (2.0, 3.0), (8.0, 3.0, 2.0, 3.0)
LONG, SPARSE, LONG_DOT = (14.0, 4.0), (3.0, 7.0), (14.0, 3.0, 2.0, 3.0)
SMALLEST_SHARE = 0.01
"""Of an error's samples: momentary zero crossings may leave a log axis at the bottom."""
EXCITATION_FLOOR = 1e-13
"""Times the greatest eigenvalue: what is smaller is rounding noise, and is said to be 0."""
STATES = 13
NEAR = 2.0
"""A limit that is more times the greatest value away is told in the legend, but does not flatten the curve."""


@dataclass(frozen=True, kw_only=True)
class Curve:
    """How one curve looks, and its name in the legend; one without goes with the named curve before it."""

    label: str
    color: str
    dash: Dash = SOLID
    width: float = 1.5
    filled: bool = False
    """Tint everything below the curve."""
    unit: str | None = None
    """Where it is not the plot's."""
    name: str = ""
    """In files, where it is not the label."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Drawing:
    """The numbers of one plot, one column for each of its curves."""

    time: Float[Array, "n"]
    read: Float[Array, "n k"]
    """What the legend says at the cursor: NaN nothing, +∞ blind, −∞ below the floor."""
    drawn: Float[Array, "n k"]
    axis: curves.Range
    hidden: tuple[int, ...] = ()
    """Columns that are switched off."""


@dataclass(frozen=True, kw_only=True)
class Plot:
    """One plot of the page."""

    name: str
    title: str
    unit: str
    curves: tuple[Curve, ...]
    draw: Callable[[Picture], Drawing]
    words: definitions.Words
    log: bool = True
    again: tuple[int, ...] = (0,)
    """The curves that are drawn once more for a pinned run."""
    bands: tuple[tuple[int, int], ...] = ()
    """Pairs of curves, upper and lower, between which the plot is tinted."""
    across: str = "t"
    """What (in s) runs along its axis, which is as long as the time axis of all."""

    @property
    def named(self) -> tuple[int, ...]:
        """The columns that are in the legend."""
        return tuple(i for i, curve in enumerate(self.curves) if curve.label)

    def together(self, column: int) -> tuple[int, ...]:
        """A named column, and those without a name that are shown and hidden with it."""
        following = [i for i in self.named if i > column]
        return tuple(range(column, min(following, default=len(self.curves))))


def _log(time: Array, columns: tuple[Array, ...], *, low_quantile: float = SMALLEST_SHARE) -> Drawing:
    """A Drawing on a log axis that takes in all columns."""
    read = curves.end_at_first_nan(np.stack(columns, axis=1))
    axis = curves.decades(read, low_quantile=low_quantile)
    return Drawing(time=time, read=read, drawn=curves.onto_log_axis(read, axis), axis=axis)


def _linear(time: Array, columns: tuple[Array, ...], *, symmetric: bool) -> Drawing:
    read = curves.end_at_first_nan(np.stack(columns, axis=1))
    return Drawing(time=time, read=read, drawn=read, axis=curves.even_range(read, symmetric=symmetric))


def _limited(picture: Picture, columns: tuple[Array, ...], limits: tuple[str, ...]) -> Drawing:
    """Quantities from zero up, and behind them what the vehicle allows of each; hidden where it allows everything."""
    time = picture.motion.time
    bounds = [vehicle.bound(picture.preset.vehicle, limit) for limit in limits]
    greatest = max(float(np.nanmax(column)) for column in columns)
    near = [bound for bound in bounds if bound is not None and bound < NEAR * greatest]
    read = np.stack([*columns, *(np.full_like(time, bound or 0.0) for bound in bounds)], axis=1)
    axis = curves.even_range(np.array([greatest, *near]), symmetric=False)
    hidden = tuple(len(columns) + k for k, bound in enumerate(bounds) if bound is None)
    return Drawing(time=time, read=read, drawn=read, axis=axis, hidden=hidden)


def _sigma(picture: Picture, block: int) -> Float[Array, "n"]:
    """√trace of a block of P (0 position, 1 velocity, 2 gravity); NaN where P is no covariance any more."""
    trace = np.trace(picture.estimate.covariance[:, block], axis1=-2, axis2=-1)
    with np.errstate(invalid="ignore"):
        return np.where(np.isfinite(trace) & (trace >= 0), np.sqrt(np.abs(trace)), np.nan)


def _finite(values: Array) -> Array:
    return np.where(np.isfinite(values), values, np.nan)


def position_error(picture: Picture) -> Drawing:
    return _log(picture.motion.time, (_finite(picture.errors.position), _sigma(picture, 0)))


def velocity_error(picture: Picture) -> Drawing:
    return _log(picture.motion.time, (_finite(picture.errors.velocity), _sigma(picture, 1)))


def gravity_error(picture: Picture) -> Drawing:
    return _log(picture.motion.time, (_finite(picture.errors.gravity), _sigma(picture, 2)))


def attitude_error(picture: Picture) -> Drawing:
    return _log(picture.motion.time, (np.degrees(_finite(picture.errors.attitude)),))


def snap(picture: Picture) -> Drawing:
    """φ, its components and its norm; the printed one beside it when that switch is on."""
    printed = picture.settings.printed.excitation
    derived = _with_norm(picture.phi)
    both = np.concatenate([derived, _with_norm(picture.phi_printed) if printed else np.zeros_like(derived)], axis=1)
    axis = curves.even_range(both, symmetric=True)
    hidden = () if printed else (4, 5, 6, 7)
    return Drawing(time=picture.motion.time, read=both, drawn=both, axis=axis, hidden=hidden)


def _with_norm(vectors: Array) -> Array:
    return np.concatenate([vectors, np.linalg.norm(vectors, axis=1, keepdims=True)], axis=1)


def excitation(picture: Picture) -> Drawing:
    """Eigenvalues over windows by start time, the threshold μ, and the printed ones when a switch changes them."""
    windows, mu = picture.analysis.windows, picture.preset.requirement.mu
    shown = picture.settings.printed.excitation or picture.settings.printed.body_axes
    printed = picture.printed_excitation if shown else np.full_like(windows.excitation, mu)
    threshold = np.full((len(windows.start), 1), mu)
    read = np.concatenate([windows.excitation, threshold, printed], axis=1)
    read = np.where(read > EXCITATION_FLOOR * np.nanmax(read), read, 0.0)
    axis = curves.decades(read)
    axis = (min(axis[0], curves.decades(threshold)[0] / 10), max(axis[1], mu * 10))
    axis = curves.decades(np.asarray(axis))
    hidden = () if shown else (4, 5, 6)
    return Drawing(time=windows.start, read=read, drawn=curves.onto_log_axis(read, axis), axis=axis, hidden=hidden)


def gramian(picture: Picture) -> Drawing:
    """The 13 eigenvalues over windows by start time, and the floor: what lies below it is noise, and is not drawn."""
    windows = picture.analysis.windows
    floor = windows.floor[:, None]
    told = windows.gramian > floor
    read = np.concatenate([np.where(told, windows.gramian, -np.inf), floor], axis=1)
    axis = curves.decades(read)
    axis = (axis[0] / 10, axis[1])
    drawn = np.concatenate([np.where(told, windows.gramian, floor), floor], axis=1)
    return Drawing(time=windows.start, read=read, drawn=curves.onto_log_axis(drawn, axis), axis=axis)


def predicted(picture: Picture) -> Drawing:
    """σ at each window's end (drawn at its start, like all windows), and what the observer's error is at that time."""
    windows, time = picture.analysis.windows, picture.motion.time
    ends = np.clip(np.searchsorted(time, windows.start + windows.window - 1e-9), 0, len(time) - 1)
    actual = _finite(picture.errors.position)[ends]
    sigmas = (np.where(np.isfinite(s), s, np.inf) for s in (windows.sigma_lifted, windows.sigma_nonlinear))
    wanted = np.full_like(windows.start, picture.preset.requirement.position_sigma)
    return _log(windows.start, (*sigmas, actual, wanted), low_quantile=0.0)


def innovation(picture: Picture) -> Drawing:
    """(y − ŷ)/σ by P at each range; ranges before the first step have none."""
    value, variance = picture.estimate.innovation.T
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = _finite(value / np.sqrt(variance))
    has = np.isfinite(ratio)
    time = picture.measurements.range_time
    if not has.any():
        return _linear(time, (np.full_like(time, np.nan),), symmetric=True)
    return _linear(time[has], (ratio[has],), symmetric=True)


def distance(picture: Picture) -> Drawing:
    """True and measured range of the antenna at the ranges' own times."""
    z, p = picture.measurements, picture.preset
    arm = p.sensors.unmodelled.lever_arm
    true = sensors.distance(picture.motion, z.range_time, path=p.path, world=p.world, lever_arm=arm)
    return _linear(z.range_time, (z.range, true), symmetric=False)


def speed(picture: Picture) -> Drawing:
    """Speed, and the most the vehicle may have."""
    return _limited(picture, (np.linalg.norm(picture.motion.velocity, axis=1),), ("speed",))


def effort(picture: Picture) -> Drawing:
    """Thrust over weight, and body rate (rad/s), which share an axis because they are of one size; and their limits."""
    motion = picture.motion
    weight = float(np.linalg.norm(picture.preset.world.gravity))
    thrust = np.linalg.norm(motion.apparent_acceleration, axis=1) / weight
    rate = np.linalg.norm(motion.angular_velocity, axis=1)
    return _limited(picture, (thrust, rate), ("thrust_to_weight", "body_rate"))
