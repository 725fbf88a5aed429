"""The evil twin: a second motion with the same IMU record and, within a tolerance, the same range.

The same gyro, magnetometer, accelerometer and attitude leave p̈ the same, so a twin is p + Δp + Δv s. `search` finds
twins, and `text` says what was found.

Without a magnetometer every motion has twins: the motion turned about the vertical through the anchor, with its body.
With a magnetometer, a body turned by O about the magnetic direction would be a twin too, if it felt ½s²(Oᵀ − I)g. Those
twins are not searched: an exact one needs n·(p̈ − g) ≡ 0, a motion that falls freely along n.
"""

from rangenav.twin.outcome import Refusal, Twin, TwinKind
from rangenav.twin.search import APART, MAX_APART, MAX_TOLERANCE, MIN_APART, TOLERANCE, turn_towards, twin
from rangenav.twin.text import ZERO

__all__ = [
    "APART",
    "MAX_APART",
    "MAX_TOLERANCE",
    "MIN_APART",
    "TOLERANCE",
    "ZERO",
    "Refusal",
    "Twin",
    "TwinKind",
    "turn_towards",
    "twin",
]
