"""What the search of a twin answers: a twin, or the reason why there is none."""

from typing import Literal

from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Vec3
from rangenav.results import result
from rangenav.signals import Signal

TwinKind = Literal["turned", "mirrored", "nearby"]


@result
class Twin:
    """Another motion that range and IMU cannot tell from the true motion. Both motions have the same attitude."""

    kind: TwinKind
    """Turned and mirrored ones are exact; a nearby one only agrees within the tolerance."""
    path: Signal
    """m, inertial frame: a preset with it instead of its own has the same IMU record."""
    turn: Vec3
    """rad: the turn about the anchor, a rotation vector; zero unless turned."""
    axis: Vec3 | None
    """The only axis it may be turned about; None if any will do, or none."""
    shift: Float[Array, "3"]
    """Δp (m), at t = 0."""
    drift: Float[Array, "3"]
    """Δv (m/s)."""
    time: Float[Array, "n"]
    """s: where both ranges were compared."""
    range: Float[Array, "n"]
    """m, of the true path."""
    twin_range: Float[Array, "n"]
    mismatch: float
    """m: the largest difference of the two ranges."""
    nearest: float
    """m between the two motions, at their nearest and at their farthest."""
    farthest: float
    summary: str
    """How it is made, how far off it is, and how well its range agrees."""

    @property
    def draggable(self) -> bool:
        """Whether it is one of a family that `turn` runs through."""
        return self.kind == "turned"


@result
class Refusal:
    """Why there is no twin."""

    kind: Literal["locally blind", "too near", "observable", "too large"]
    reason: str
    sensitivity: float
    """The least singular value: metres of range (RMS) for a metre of difference. Above 0 it forbids a twin nearby."""
    mismatch: float
    """m: the largest difference of the ranges, for the best candidate at the distance that was asked for."""
