"""The types that cross from Python into the kernels. This module does not import numba, so importing it is cheap."""

from typing import NamedTuple

import numpy as np

ROUNDING = 1e-14
"""Each prediction increases every variance by this share, as much as rounding may have taken from it. Without it, P of
an unobservable motion with q = 1e5, v = 1e-6, p0 = 1e4 becomes indefinite (an eigenvalue of -5e-8) within 10⁶ steps,
while P grows to 1e19."""

CONSISTENCY_TIME = 10.0
"""s. The noise-matched observer is corrected with the constraint ξ1 = ½|p|², which the lift forgets. The variance of
this correction covers the linearisation's error ½|e|² as if the error e stayed the same for so long.
Steady position error on paper, paper-slow and soft, ranges at 200 Hz, median (worst) of 30 seeds in m:
without the correction .043 (.072), .073 (.117), .21 (.40); with 100 s .038 (.066), .068 (.108), .20 (.34);
with 10 s .035 (.054), .056 (.075), .16 (.23); with 1 s .036 (.051), .048 (.59), .13 (.29)."""


NO_FAULT, TIME_FAULT, GYRO_FAULT, ACCEL_FAULT, MAG_FAULT, RANGE_FAULT, RANGE_TIME_FAULT = range(7)
"""What the kernel `cascade.step` returns: the first thing that is wrong with a sample."""


class Parameters(NamedTuple):
    """What stays constant over a record: numbers only, since an array would be reference-counted at every call."""

    gravity: tuple[float, float, float]
    magnetic: tuple[float, float, float]
    b4: float
    """Input into ξ4: 3|g|², or |g|² in the printed form."""
    variance: float
    """Of one correction with y (m⁴), used unless matched."""
    v: tuple[float, float, float, float]
    """Process-noise density of the four blocks ξ, position, velocity, gravity."""
    k1: float
    rho1: float
    rho2: float
    scheduled: bool
    """Whether k1 falls from `k1` to `k1_steady` as the vectors agree; else it is constant, and the next three numbers
    are not used."""
    k1_steady: float
    halfway: float
    memory: float
    symmetric: bool
    """Halve each correction around the reading of the estimate."""
    matched: bool
    """Noise-matched: variances from the range's and the IMU's noise at the current estimate."""
    range_sigma: float
    accel_density: float
    gyro_density: float


class Arrays(NamedTuple):
    """Everything that changes, written in place by the kernels; `cascade.State` reads it for a caller."""

    x: np.ndarray
    """13, turned axes."""
    P: np.ndarray
    """169: 13 × 13 row by row, turned axes, symmetric."""
    turned: np.ndarray
    """3 × 3, from body axes to turned axes."""
    rotation: np.ndarray
    """3 × 3, R̂."""
    gyro: np.ndarray
    accel: np.ndarray
    mag: np.ndarray
    """The last vector measured, turned by the gyro between two samples of the magnetometer."""
    misaligned: np.ndarray
    """1 number: the low-passed misalignment s that the schedule of k1 depends on."""
    pending: np.ndarray
    """(y, variance) of a correction due at the start of the next interval; NaN if none."""


class Strapdown(NamedTuple):
    """What the nine-state estimators know beforehand: the world, and the sensors' noise."""

    gravity: tuple[float, float, float]
    across1: tuple[float, float, float]
    across2: tuple[float, float, float]
    """Unit vectors with across1 × across2 = m."""
    range_variance: float
    """m²"""
    mag_variance: float
    accel_density: float
    """(m/s²)²/Hz"""
    gyro_density: float
    """(rad/s)²/Hz"""
