"""The choices of a user for the cascade: its gains (paper, eq. 8–9) and its initial guess."""

import math
from typing import Literal

import numpy as np

from rangenav.attitude import AttitudeGains
from rangenav.inputs import Input, Vec3, require
from rangenav.riccati import RiccatiGains

MAX_OFFSET = 1e4
"""m, m/s, m/s²: the longest offset of a guess."""


class Gains(Input, frozen=True, kw_only=True):
    """All gains of the cascade."""

    mode: Literal["constant", "noise-matched"] = "constant"
    """noise-matched: q and v follow from the sensors' noise at the current estimate, and the estimate is corrected with
    the constraint ξ1 = ½|p|², which the linear observer does not enforce. They start from x̂(0) and p0. Where the
    ranges contradict these, constant gains run until the matched ones can start without them (see `acquisition`). The
    theorem assumes constant gains and no such correction."""
    riccati: RiccatiGains = RiccatiGains()
    attitude: AttitudeGains = AttitudeGains()


class Guess(Input, frozen=True, kw_only=True):
    """The observer's start: x̂(0) and the attitude error R̃(0) = R(0) R̂(0)ᵀ = exp(angle [axis]x)."""

    state: Literal["zero", "truth", "offset"] = "zero"
    """zero: x̂ = 0; truth: the lifted true state; offset: the lift of the truth plus the offsets below."""
    position_offset: Vec3 = (0.0, 0.0, 0.0)
    """m, inertial axes."""
    velocity_offset: Vec3 = (0.0, 0.0, 0.0)
    """m/s, inertial axes."""
    gravity_offset: Vec3 = (0.0, 0.0, 0.0)
    """m/s², inertial axes."""
    attitude_axis: Vec3 = (0.0, 1.0, 0.0)
    """Inertial axes; any length but zero."""
    attitude_angle: float = 0.0
    """rad, −π to π."""

    def __post_init__(self) -> None:
        super().__post_init__()
        length = math.hypot(*self.attitude_axis)  # unlike numpy's norm it does not overflow
        require(length > 1e-9, "attitude_axis must not be the zero vector")
        require(length < 1e9, f"attitude_axis must be shorter than 1e9, got {length:g}")
        require(
            abs(self.attitude_angle) <= np.pi + 1e-12,
            f"attitude_angle must lie in [-π, π] rad, got {self.attitude_angle:g}",
        )
        for name in ("position_offset", "velocity_offset", "gravity_offset"):
            size = math.hypot(*getattr(self, name))
            require(size <= MAX_OFFSET, f"{name} must not be longer than {MAX_OFFSET:g}, got {size:g}")
