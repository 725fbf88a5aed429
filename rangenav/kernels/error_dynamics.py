"""The error of the Riccati observer with constant gains over a whole record: e ← (I − K𝒞) Φ e, and P beside it.

In inertial axes: the blocks of V and P(0) are isotropic, so the axes do not matter, and ω does not occur. The
transition is moved by the same rows as P, and corrected by the same gain.
"""

import numpy as np

from rangenav.kernels import riccati
from rangenav.kernels.jit import kernel
from rangenav.kernels.riccati import N


@kernel
def run(time, accel, range_time, first, pending, marks, variance, symmetric, v, P, covariances, transitions):
    """covariances[k] ← P at sample marks[k]; transitions[k] ← the error's transition from marks[k] to marks[k + 1].

    accel: p̈ − g in inertial axes at each sample, n × 3. first: the first range after time[0]; pending: whether one
    stands at time[0]. P: 169, the initial covariance, overwritten. The splitting is that of `cascade.advance`.
    """
    moved, j, mark, share = np.eye(N).ravel(), first, 1, 2 if symmetric else 1
    covariances[0] = P
    for k in range(1, len(time)):
        if pending:
            _correct(P, moved, share * variance)
            pending = False
        t0, t1, reached = time[k - 1], time[k], 0.0
        while j < len(range_time) and range_time[j] <= t1:
            fraction = 1.0 if range_time[j] == t1 else (range_time[j] - t0) / (t1 - t0)
            if fraction > reached:
                _propagate(P, moved, accel[k - 1], accel[k], reached, fraction, t1 - t0, v)
                reached = fraction
            pending = symmetric and fraction == 1.0
            _correct(P, moved, share * variance if fraction == 1.0 else variance)
            j += 1
        if reached < 1.0:
            _propagate(P, moved, accel[k - 1], accel[k], reached, 1.0, t1 - t0, v)
        if mark < len(marks) and k == marks[mark]:
            covariances[mark], transitions[mark - 1] = P, moved
            moved[:] = 0.0
            for i in range(N):
                moved[(N + 1) * i] = 1.0
            mark += 1


@kernel
def _propagate(P, moved, accel0, accel1, begin, end, interval, v):
    h, middle = (end - begin) * interval, (begin + end) / 2
    ax = accel0[0] + middle * (accel1[0] - accel0[0])
    ay = accel0[1] + middle * (accel1[1] - accel0[1])
    az = accel0[2] + middle * (accel1[2] - accel0[2])
    riccati.add_block_noise(P, v, h / 2)
    riccati.transition_rows(moved, ax, ay, az, h)
    riccati.predict_covariance(P, ax, ay, az, h)
    riccati.add_block_noise(P, v, h / 2)


@kernel
def _correct(P, moved, variance):
    """moved ← (I − K𝒞) moved with K = P𝒞ᵀ/(P₁₁ + R), and P after the correction."""
    inverse = 1 / (P[0] + variance)
    row = moved[:N].copy()
    for i in range(N):
        gain = P[N * i] * inverse
        for c in range(N):
            moved[N * i + c] -= gain * row[c]
    riccati.correct(np.zeros(N), P, 0.0, variance)
