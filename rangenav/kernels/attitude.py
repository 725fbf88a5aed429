"""One step of the complementary filter on SO(3): Heun's method on the group, order 2, with k1 constant or scheduled.

The misalignment s that the schedule goes by is part of what is integrated: between two samples it relaxes towards the
mean of what the vectors say at both ends, exactly, so that no step is too long for its memory.
"""

import numpy as np

from rangenav.kernels import rotation as rot
from rangenav.kernels.jit import kernel


@kernel
def gain(s, p):
    """k1 at a misalignment s: constant, or between its two ends in equal ratios (attitude.Schedule)."""
    if not p.scheduled:
        return p.k1
    square = s * s
    return p.k1_steady * (p.k1 / p.k1_steady) ** (square / (square + p.halfway * p.halfway))


@kernel
def rate(r, s, gyro, mag, gravity, p):
    """ω_y + k1(s) (ρ1 m_y × R̂ᵀm + ρ2 ĝ_B × R̂ᵀg), body axes, and the misalignment of the vectors, 0 if nobody asks.

    gyro, mag and gravity (ĝ_B) are tuples of three.
    """
    mx, my, mz = rot.apply_inverse(r, p.magnetic[0], p.magnetic[1], p.magnetic[2])
    gx, gy, gz = rot.apply_inverse(r, p.gravity[0], p.gravity[1], p.gravity[2])
    k1, seen = gain(s, p), 0.0
    c1, c2 = k1 * p.rho1, k1 * p.rho2
    if p.scheduled:
        square = gx * gx + gy * gy + gz * gz
        weight = p.rho2 * square
        size = gravity[0] * gravity[0] + gravity[1] * gravity[1] + gravity[2] * gravity[2]
        along = gravity[0] * gx + gravity[1] * gy + gravity[2] * gz
        magnetic = 1 - (mag[0] * mx + mag[1] * my + mag[2] * mz)
        seen = (p.rho1 * magnetic + weight * (1 - 2 * along / (size + square))) / (p.rho1 + weight)
    return (
        gyro[0] + c1 * (mag[1] * mz - mag[2] * my) + c2 * (gravity[1] * gz - gravity[2] * gy),
        gyro[1] + c1 * (mag[2] * mx - mag[0] * mz) + c2 * (gravity[2] * gx - gravity[0] * gz),
        gyro[2] + c1 * (mag[0] * my - mag[1] * mx) + c2 * (gravity[0] * gy - gravity[1] * gx),
        seen,
    )


@kernel
def step(r, s, gyro0, gyro1, mag0, mag1, gravity0, gravity1, h, p):
    """R̂ and the misalignment s after h seconds, from the signals at both ends."""
    sx, sy, sz, seen0 = rate(r, s, gyro0, mag0, gravity0, p)
    trial = rot.multiply(r, rot.exp(h * sx, h * sy, h * sz))
    kept = np.exp(-h / p.memory) if p.scheduled else 1.0
    ex, ey, ez, seen1 = rate(trial, seen0 + kept * (s - seen0), gyro1, mag1, gravity1, p)
    turn = rot.exp(h / 2 * (sx + ex), h / 2 * (sy + ey), h / 2 * (sz + ez))
    mean = (seen0 + seen1) / 2
    return rot.orthonormal(rot.multiply(r, turn)), mean + kept * (s - mean)
