"""What is read at a moment: values in the legends, the window that begins there, the 3-D picture in one line."""

import numpy as np

from explorer.charts import curves
from explorer.charts.plots import Drawing
from explorer.model.compute import Picture


def said(value: float) -> str:
    """A value in a legend: a number, or why there is none."""
    if np.isinf(value):
        return "blind" if value > 0 else "< floor"
    return curves.number(float(value))


def sentence(picture: Picture, time: float) -> str:
    """What the 3-D picture shows, in one line."""
    motion, errors = picture.motion, picture.errors
    k = int(np.clip(np.searchsorted(motion.time, time - 1e-9), 0, len(motion.time) - 1))
    distance = float(np.linalg.norm(motion.position[k] - np.asarray(picture.preset.world.anchor)))
    away, position = (curves.number(round(size, 9)) for size in (distance, float(errors.position[k])))  # no round-off
    attitude = curves.number(float(np.degrees(errors.attitude[k])))
    return f"<b>{time:.2f} s</b> · {away} m from the anchor · estimate off by <b>{position} m</b>, <b>{attitude}°</b>"


def window_at(picture: Picture, time: float) -> tuple[float, float]:
    """Start and length, as shares of the duration, of the window that starts at a time, or of the last one before."""
    duration, length = float(picture.motion.time[-1]), picture.preset.requirement.window
    return float(np.clip(time, 0.0, duration - length)) / duration, length / duration


def row_at(drawing: Drawing, time: float) -> np.ndarray:
    """The row at a time; NaN after the last window has started, and where no range has ever come."""
    if not len(drawing.time):
        return np.full(drawing.read.shape[1], np.nan)
    step = drawing.time[1] - drawing.time[0] if len(drawing.time) > 1 else 0.0
    if time > drawing.time[-1] + step:
        return np.full(drawing.read.shape[1], np.nan)
    return drawing.read[max(int(np.searchsorted(drawing.time, time + 1e-9)) - 1, 0)]
