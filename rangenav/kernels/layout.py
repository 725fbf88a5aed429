"""The types that cross from Python into the kernels. This module does not import numba, so importing it is cheap."""

from itertools import accumulate, pairwise
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

SMOOTHING = 0.1
"""The share of each new d² in the mean that gives the variance of the ranges after it. The mean never holds the noise
of the range that it weighs, which would bias y by −2σ²."""
LEAST_VARIANCE = 1e-8
"""m²: ranges count as no better than 0.1 mm, so that those without noise have a finite weight."""
RANK_TOLERANCE = 1e-13
"""The collected ranges have rank 13 if every diagonal entry of their triangle exceeds this share of the largest one."""
KNOWN_SHARE = 1.0
"""The matched gains start once the 1-σ position of the collected ranges is below this share of the distance. With .5, 1
and 2 all of 60 starts up to 10 km on each of five motions end within e_BᵀP⁻¹e_B = 36; paper-slow starts after 6.1, 5.8
and 5.6 s."""
IMU_SHARE = 0.75
"""A collection begins anew when the IMU's noise is more than this share of the variance of its ranges on average: older
ranges then no longer help. It also keeps blind motions blind: on ten of them, 300 s each, the 1-σ position never falls
below the distance, although noise alone makes every triangle one of rank 13. Matched gains that are not running then
start from a P that excludes nothing: on trial 21 of BROAD with an anchor 100 m away they are 9 m off after 105 s with
an own σ of 10 m, where constant gains are 15 m off with .3 m."""
MOST_REFUSED = 16
"""A collection begins anew when more ranges than these and half of the others are outliers: it began with one."""
CLEAN_SHARE = 0.125
"""Matched gains start from a P that excludes nothing only if no larger share of the ranges were outliers, and if χ²/m
of the others is below LOOSEST_SCALE: otherwise they would follow outliers."""
CHECK_GROWTH = 1.02
"""A collection is solved again when it has become this much longer: .1 µs a step on average."""
GATE = 36.0
"""An innovation of more than 6 σ belongs to an outlier, and its range corrects nothing: 2e-9 of all innovations."""
OUTLIER = 4.0
"""What an outlier counts in the window's sum. One adds 3 to its mean of 64, so that it makes no alarm; 23 make one."""
ALARM_RANGES = 64
"""Innovations in a window."""
ALARM = 132.79
"""χ² with 64 degrees of freedom exceeds this with probability 1e-6: the false-alarm rate of a window."""
LOOSEST_SCALE = 9.0
"""Gate and alarm grow with the misfit χ²/(m − 13) of the collection, and at an alarm with the mean NIS of its window,
at most to this: noise of up to three times the stated one is overconfidence, which `range_fit` states, and no false
solution, whose NIS is 17 to 7000. With a gyro bias of 1°/s, lissajous and paper-slow end .4 m off and their NIS is 2;
with constant gains at every alarm they ended 7–11 and 3 m off."""
MILD_SCALE = 36.0
"""Above LOOSEST_SCALE and up to this mean NIS, the most that a window with a gate of 36 can show, an alarm is mild: the
gains go on with P multiplied by that mean and with the loosest gate, while ranges are collected. The next alarm, unless
it is mild again, gives them up. A bias of the gyro makes such alarms, and constant gains, which would run in place of
the matched ones, follow a bias far away: with 1°/s about one axis, soft ended 10 and 14 m off in two of three seeds of
20 s (now 1.2 and 1.6 m), and lissajous lost and 6 to 8 m off in all three of 60 s (now 1 m). A false solution
contradicts the collected ranges, or is alarmed again."""
CONTRADICTION = 30.66
"""χ² with 3 degrees of freedom exceeds this with probability 1e-6: the position of the matched gains then contradicts
the collected ranges."""
REOPENINGS = 3
"""Collections that alarms may begin (not mild ones), and starts from a P that excludes nothing; gains that are given up
after these are lost."""
MATCHED_V = (1e-6, 1e-6, 1e-6, 1e-6)
"""The floor of the process noise of matched gains, in the four blocks: the least v that is allowed."""

CONSTANT, COLLECTING, MATCHED, LOST = range(4)
"""The phase of an observer: constant gains by choice; constant gains while ranges are collected; noise-matched gains;
constant gains because matched ones were alarmed once too often."""
RESPONSE, MOMENTS = 13 * 14, 13 * 14 + 13
"""Places in `Arrays.acquisition`. Before RESPONSE stands the triangle of the collected rows, 13 × 14, its last column
the right-hand side. RESPONSE: 13, the state that the inputs alone have made of zero. MOMENTS: the integrals over r of
|D|², D·W, |W|², D and W, where W(s, r) is the rate of D(s, r)."""
(
    PHASE, COLLECTS, ELAPSED, COUNT, REFUSED, FIT, WEIGHT, MEAN_SQUARE, NEXT_CHECK, SCALE, WINDOW_COUNT, WINDOW_SUM,
    WINDOW_SIZE, REOPENED, ACQUISITION,
) = range(MOMENTS + 9, MOMENTS + 24)  # fmt: skip
"""More places. COLLECTS: 1 while ranges are collected, which begins with the record; 2 in a collection that a mild
alarm has begun, which counts as one of the three only if gains are given up in it. ELAPSED: s since the collection
began; COUNT and REFUSED: of its ranges and outliers; FIT: its χ²; WEIGHT: the sum of the IMU's shares of the variances;
MEAN_SQUARE: m², the smoothed d². SCALE: of gate and alarm. WINDOW_SIZE: as WINDOW_SUM, but outliers count GATE.
ACQUISITION: the length."""

(
    X_AT, P_AT, TURNED_AT, ROTATION_AT, GYRO_AT, ACCEL_AT, MAG_AT, GRAVITY_AT, MISALIGNED_AT, PENDING_AT, TIME_AT,
    ACQUISITION_AT, LENGTH,
) = (0, *accumulate((13, 169, 9, 9, 3, 3, 3, 3, 1, 3, 1, ACQUISITION)))  # fmt: skip
"""Places in the packed state of an observer, one array of LENGTH numbers: what each part is, `Arrays` says. A kernel
that takes one array is called in a fifth of the time of one that takes ten."""

NO_FAULT, TIME_FAULT, GYRO_FAULT, ACCEL_FAULT, MAG_FAULT, RANGE_FAULT, RANGE_TIME_FAULT, SHAPE_FAULT = range(8)
"""What the kernel `one_sample.step` returns: the first thing that is wrong with a sample."""


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
    p0: tuple[float, float, float, float]
    """Initial variance of the four blocks."""
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

    def packed(self) -> np.ndarray:
        """All numbers one after the other, as the kernel `attitude.unpacked` reads them."""
        nested = [value if isinstance(value, tuple) else (value,) for value in self]
        return np.array([float(number) for numbers in nested for number in numbers])


class Arrays(NamedTuple):
    """Everything that changes, as views of the packed state, which the kernels write in place."""

    x: np.ndarray
    """13, turned axes; as P without the correction that is due."""
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
    gravity: np.ndarray
    """ĝ_B of the estimate, body axes."""
    misaligned: np.ndarray
    """1 number: the low-passed misalignment s that the schedule of k1 depends on."""
    pending: np.ndarray
    """(y, variance, shown variance) of a correction due at the start of the next interval; variance 0 if none is. The
    estimate shows it with the third number as its variance, and not at all if that is 0."""
    time: np.ndarray
    """1 number: s, of the last sample."""
    acquisition: np.ndarray
    """What the start of noise-matched gains collects and watches, in the places that `PHASE` and the others name."""


def views(packed: np.ndarray) -> Arrays:
    """The parts of a packed state; what is written into them is written into it."""
    ends = (X_AT, P_AT, TURNED_AT, ROTATION_AT, GYRO_AT, ACCEL_AT, MAG_AT, GRAVITY_AT, MISALIGNED_AT, PENDING_AT)
    parts = [packed[begin:end] for begin, end in pairwise((*ends, TIME_AT, ACQUISITION_AT, LENGTH))]
    parts[2], parts[3] = parts[2].reshape(3, 3), parts[3].reshape(3, 3)
    return Arrays(*parts)


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
