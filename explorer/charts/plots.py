"""The numbers of each plot: functions Picture -> Drawing. No viser here.

A Drawing holds `values`, which the legend shows at the cursor (+∞ for a blind window, −∞ for a value below the floor),
and `drawn`, the same numbers moved outside the axes where a plot cannot show them.
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
"""Share of the samples of an error that may lie below a log axis: an error may be close to 0 for a moment."""
EXCITATION_FLOOR = 1e-13
"""Eigenvalues below this share of the greatest one are rounding noise, and are shown as 0."""
STATES = 13
FLATTENING = 2.0
"""A limit above this multiple of the greatest value is in the legend but not drawn: it would flatten the curve."""


@dataclass(frozen=True, kw_only=True)
class Curve:
    """Style and label of a curve. A curve without a label is linked to the labelled one before it."""

    label: str
    color: str
    dash: Dash = SOLID
    width: float = 1.5
    filled: bool = False
    """Whether the area below the curve is tinted."""
    unit: str | None = None
    """None for the plot's unit."""
    name: str = ""
    """The name in files; empty if it is the label."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Drawing:
    """The numbers of one plot, one column for each of its curves."""

    time: Float[Array, "n"]
    values: Float[Array, "n k"]
    """The numbers that the legend shows at the cursor: NaN for no value, +∞ for blind, −∞ for below the floor."""
    drawn: Float[Array, "n k"]
    axis: curves.Range
    hidden: tuple[int, ...] = ()
    """Columns that this picture has no curve for."""


@dataclass(frozen=True, kw_only=True)
class Plot:
    """One plot of the page."""

    name: str
    title: str
    unit: str
    curves: tuple[Curve, ...]
    draw: Callable[[Picture], Drawing]
    definition: definitions.Definition
    inputs: tuple[str, ...] | None = None
    """What `draw` reads of a picture, besides its motion and what is computed from both at its first use: while all of
    it stays as it is, nothing is drawn. None for a plot that is always drawn."""
    log: bool = True
    pinned_curves: tuple[int, ...] = (0,)
    """The columns that the pinned run A repeats."""
    bands: tuple[tuple[int, int], ...] = ()
    """Pairs of curves, upper and lower, between which the plot is tinted."""
    x_name: str = "t"
    """The quantity (s) along the horizontal axis, which has the same length in all plots."""
    empty: str = ""
    """Why there is nothing to see where the `deciding` curves have no number but zeros."""
    deciding: tuple[int, ...] = (0,)
    """Columns."""

    @property
    def along_flight(self) -> bool:
        """Whether the horizontal axis is the time of the flight, so that the cursor belongs there."""
        return self.x_name in ("t", "window start")

    def reason_if_empty(self, drawing: "Drawing") -> str:
        """Why there is nothing to see; empty where there is something."""
        values = drawing.values[:, [column for column in self.deciding if column not in drawing.hidden]]
        return "" if np.any(np.isfinite(values) & (values != 0.0)) else self.empty

    @property
    def in_legend(self) -> tuple[int, ...]:
        """The columns that have an entry in the legend."""
        return tuple(i for i, curve in enumerate(self.curves) if curve.label)

    def linked(self, column: int) -> tuple[int, ...]:
        """A labelled column and the columns without a label that are shown and hidden with it."""
        following = [i for i in self.in_legend if i > column]
        return tuple(range(column, min(following, default=len(self.curves))))


def _log_drawing(time: Array, columns: tuple[Array, ...], *, low_quantile: float = SMALLEST_SHARE) -> Drawing:
    """A Drawing on a log axis that holds all columns."""
    values = curves.end_at_first_nan(np.stack(columns, axis=1))
    axis = curves.decades(values, low_quantile=low_quantile)
    return Drawing(time=time, values=values, drawn=curves.onto_log_axis(values, axis), axis=axis)


def _linear_drawing(time: Array, columns: tuple[Array, ...], *, symmetric: bool) -> Drawing:
    values = curves.end_at_first_nan(np.stack(columns, axis=1))
    return Drawing(time=time, values=values, drawn=values, axis=curves.even_range(values, symmetric=symmetric))


def _limited_drawing(picture: Picture, columns: tuple[Array, ...], limits: tuple[str, ...]) -> Drawing:
    """Quantities from zero up, and the vehicle's limit on each; a limit that the vehicle does not have is hidden."""
    time = picture.motion.time
    bounds = [vehicle.bound(picture.preset.vehicle, limit) for limit in limits]
    greatest = max(float(np.nanmax(column)) for column in columns)
    near = [bound for bound in bounds if bound is not None and bound < FLATTENING * greatest]
    values = np.stack([*columns, *(np.full_like(time, bound or 0.0) for bound in bounds)], axis=1)
    axis = curves.even_range(np.array([greatest, *near]), symmetric=False)
    hidden = tuple(len(columns) + k for k, bound in enumerate(bounds) if bound is None)
    return Drawing(time=time, values=values, drawn=values, axis=axis, hidden=hidden)


def _sigma(picture: Picture, block: int) -> Float[Array, "n"]:
    """√trace of a block of P (0 position, 1 velocity, 2 gravity); NaN where that is not finite or negative."""
    trace = np.trace(picture.estimate.covariance[:, block], axis1=-2, axis2=-1)
    with np.errstate(invalid="ignore"):
        return np.where(np.isfinite(trace) & (trace >= 0), np.sqrt(np.abs(trace)), np.nan)


def _finite(values: Array) -> Array:
    return np.where(np.isfinite(values), values, np.nan)


def position_error(picture: Picture) -> Drawing:
    return _log_drawing(picture.motion.time, (_finite(picture.errors.position), _sigma(picture, 0)))


def velocity_error(picture: Picture) -> Drawing:
    return _log_drawing(picture.motion.time, (_finite(picture.errors.velocity), _sigma(picture, 1)))


def gravity_error(picture: Picture) -> Drawing:
    return _log_drawing(picture.motion.time, (_finite(picture.errors.gravity), _sigma(picture, 2)))


def attitude_error(picture: Picture) -> Drawing:
    return _log_drawing(picture.motion.time, (np.degrees(_finite(picture.errors.attitude)),))


def snap(picture: Picture) -> Drawing:
    """Components and norm of φ; and of the printed φ when that switch is on."""
    printed = picture.settings.printed.excitation
    derived = _with_norm(picture.phi)
    both = np.concatenate([derived, _with_norm(picture.phi_printed) if printed else np.zeros_like(derived)], axis=1)
    axis = curves.even_range(both, symmetric=True)
    hidden = () if printed else (4, 5, 6, 7)
    return Drawing(time=picture.motion.time, values=both, drawn=both, axis=axis, hidden=hidden)


def _with_norm(vectors: Array) -> Array:
    return np.concatenate([vectors, np.linalg.norm(vectors, axis=1, keepdims=True)], axis=1)


def excitation(picture: Picture) -> Drawing:
    """Eigenvalues of each window's excitation, the required μ, and printed eigenvalues if a printed switch is on."""
    windows, mu = picture.analysis.windows, picture.preset.requirement.mu
    shown = picture.settings.printed.excitation or picture.settings.printed.body_axes
    printed = picture.printed_excitation if shown else np.full_like(windows.excitation, mu)
    threshold = np.full((len(windows.start), 1), mu)
    values = np.concatenate([windows.excitation, threshold, printed], axis=1)
    values = np.where(values > EXCITATION_FLOOR * np.nanmax(values), values, 0.0)
    axis = curves.decades(values)
    axis = (min(axis[0], curves.decades(threshold)[0] / 10), max(axis[1], mu * 10))
    axis = curves.decades(np.asarray(axis))
    hidden = () if shown else (4, 5, 6)
    return Drawing(
        time=windows.start, values=values, drawn=curves.onto_log_axis(values, axis), axis=axis, hidden=hidden
    )


def gramian(picture: Picture) -> Drawing:
    """The 13 eigenvalues of each window, and the noise floor. An eigenvalue below the floor is drawn along it."""
    windows = picture.analysis.windows
    floor = windows.floor[:, None]
    above = windows.gramian > floor
    values = np.concatenate([np.where(above, windows.gramian, -np.inf), floor], axis=1)
    axis = curves.decades(values)
    axis = (axis[0] / 10, axis[1])
    drawn = np.concatenate([np.where(above, windows.gramian, floor), floor], axis=1)
    return Drawing(time=windows.start, values=values, drawn=curves.onto_log_axis(drawn, axis), axis=axis)


def predicted(picture: Picture) -> Drawing:
    """Predicted σ at each window's end, and the observer's error at that time; drawn at the window's start."""
    windows, time = picture.analysis.windows, picture.motion.time
    ends = np.clip(np.searchsorted(time, windows.start + windows.window - 1e-9), 0, len(time) - 1)
    actual = _finite(picture.errors.position)[ends]
    sigmas = (np.where(np.isfinite(s), s, np.inf) for s in (windows.sigma_lifted, windows.sigma_nonlinear))
    wanted = np.full_like(windows.start, picture.preset.requirement.position_sigma)
    return _log_drawing(windows.start, (*sigmas, actual, wanted), low_quantile=0.0)


def innovation(picture: Picture) -> Drawing:
    """(y − ŷ)/σ, with σ by P, at each range; ranges before the observer's first step have none."""
    value, variance = picture.estimate.innovation.T
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = _finite(value / np.sqrt(variance))
    finite = np.isfinite(ratio)
    time = picture.measurements.range_time
    if not finite.any():
        return _linear_drawing(time, (np.full_like(time, np.nan),), symmetric=True)
    return _linear_drawing(time[finite], (ratio[finite],), symmetric=True)


def distance(picture: Picture) -> Drawing:
    """The measured and the true range of the antenna at the times of the ranges."""
    z, p = picture.measurements, picture.preset
    arm = p.sensors.unmodelled.lever_arm
    true = sensors.distance(picture.motion, z.range_time, path=p.path, world=p.world, lever_arm=arm)
    return _linear_drawing(z.range_time, (z.range, true), symmetric=False)


def speed(picture: Picture) -> Drawing:
    """Speed and the vehicle's limit."""
    return _limited_drawing(picture, (np.linalg.norm(picture.motion.velocity, axis=1),), ("speed",))


def effort(picture: Picture) -> Drawing:
    """Thrust by weight, body rate (rad/s), and the limits on both: on one axis, as they are of similar size."""
    motion = picture.motion
    weight = float(np.linalg.norm(picture.preset.world.gravity))
    thrust = np.linalg.norm(motion.apparent_acceleration, axis=1) / weight
    rate = np.linalg.norm(motion.angular_velocity, axis=1)
    return _limited_drawing(picture, (thrust, rate), ("thrust_to_weight", "body_rate"))
