"""What the 3-D picture shows at a moment, in sentences: for whoever does not see it.

verdict · place of the vehicle and its distance from the anchor · error of the estimate and its own σ · what is blind
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from explorer.model import assessment
from explorer.model.compute import Picture
from rangenav.number_format import quantity, significant

ROUND_OFF_DIGITS = 9
"""Decimals of a length (m); further decimals are rounding errors."""
DIGITS = 2
"""Decimals of a place (m)."""


def spoken(picture: Picture, time: float) -> str:
    """What changes from moment to moment, at a time (s)."""
    return " ".join((*_verdict(picture), *_moment(picture, time)))


def written(picture: Picture, time: float) -> str:
    """The same, and what the picture shows besides: the motion as a whole, the blind directions, broken limits."""
    return " ".join((*_verdict(picture), *_moment(picture, time), *_whole(picture)))


def _verdict(picture: Picture) -> Iterator[str]:
    yield f"Verdict: {picture.analysis.verdict.word}, {assessment.decisive(assessment.answers(picture)).summary}."


def _moment(picture: Picture, time: float) -> Iterator[str]:
    """Where the vehicle and the estimate are."""
    motion, errors = picture.motion, picture.errors
    k = int(np.clip(np.searchsorted(motion.time, time - 1e-9), 0, len(motion.time) - 1))
    away = motion.position[k] - np.asarray(picture.preset.world.anchor)
    yield (
        f"At {time:.2f} s the vehicle is at {_place(motion.position[k])}, "
        f"{_length(float(np.linalg.norm(away)))} from the anchor."
    )
    off, turned = float(errors.position[k]), float(np.degrees(errors.attitude[k]))
    if not np.isfinite(off):
        yield "There is no estimate."
        return
    variance = float(np.trace(picture.estimate.covariance[k, 0]))
    sigma = f"; its own σ is {_length(variance**0.5)}" if np.isfinite(variance) and variance >= 0 else ""
    yield f"The estimate is off by {_length(off)} and {significant(turned)}°{sigma}."


def _whole(picture: Picture) -> Iterator[str]:
    spans = np.ptp(picture.motion.position, axis=0)
    sizes = " × ".join(significant(round(float(span), DIGITS)) for span in spans)
    yield f"The anchor is at {_place(np.asarray(picture.preset.world.anchor))}."
    yield f"The true path spans {sizes} m along x, y and z."
    blind = [direction.summary for direction in picture.analysis.directions]
    if blind:
        yield f"Blind: {'; '.join(blind)}."
    if picture.breaks:
        yield f"Limits: {'; '.join(f'{one.summary} at {one.at:.1f} s' for one in picture.breaks)}."


def _place(position: Float[Array, "3"]) -> str:
    x, y, z = (f"{round(float(entry), DIGITS) + 0.0:g}" for entry in position)
    return f"({x}, {y}, {z}) m"


def _length(length: float) -> str:
    return quantity(round(length, ROUND_OFF_DIGITS), "m")
