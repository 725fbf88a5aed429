"""The values at a moment: the numbers in the legends, the window that starts there, and the status line."""

import numpy as np

from explorer.charts.plots import Drawing
from explorer.model.compute import Picture
from rangenav.number_format import significant

ROUND_OFF_DIGITS = 9
"""Decimals of a length (m); further decimals are rounding errors."""


def legend_text(value: float) -> str:
    """A value in a legend: a number, or why there is none."""
    if np.isinf(value):
        return "blind" if value > 0 else "< floor"
    return significant(float(value))


def status_line(picture: Picture, time: float) -> str:
    """Time (s), distance from the anchor and errors of the estimate at a time, in one line of HTML."""
    motion, errors = picture.motion, picture.errors
    k = int(np.clip(np.searchsorted(motion.time, time - 1e-9), 0, len(motion.time) - 1))
    distance = float(np.linalg.norm(motion.position[k] - np.asarray(picture.preset.world.anchor)))
    anchor_distance, position_error = (
        f"{significant(round(length, ROUND_OFF_DIGITS))} m" for length in (distance, float(errors.position[k]))
    )
    error = f"error <b>{position_error}</b>, <b>{significant(float(np.degrees(errors.attitude[k])))}°</b>"
    away = f'<span class="rn-distance">{anchor_distance} from the anchor · </span>'
    return f'<span class="rn-wide"><b>{time:.2f} s</b> · {away}estimate’s </span>{error}'


def window_at(picture: Picture, time: float) -> tuple[float, float]:
    """Start and length, as shares of the duration, of the window that starts at a time, or of the last one before."""
    duration, length = float(picture.motion.time[-1]), picture.preset.requirement.window
    return min(max(time, 0.0), duration - length) / duration, length / duration


def row_at(drawing: Drawing, time: float) -> np.ndarray:
    """The row at a time (s); NaN later than one step after the last row, and if there are no rows."""
    if not len(drawing.time):
        return np.full(drawing.values.shape[1], np.nan)
    step = drawing.time[1] - drawing.time[0] if len(drawing.time) > 1 else 0.0
    if time > drawing.time[-1] + step:
        return np.full(drawing.values.shape[1], np.nan)
    return drawing.values[max(int(np.searchsorted(drawing.time, time + 1e-9)) - 1, 0)]
