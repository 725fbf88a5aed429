"""One step of the complementary filter on SO(3): Heun's method on the group, order 2, with k1 constant or scheduled.

The misalignment s that the schedule goes by is part of what is integrated: between two samples it relaxes towards the
mean of what the vectors say at both ends, exactly, so that no step is too long for its memory.
"""

import numpy as np

from rangenav.kernels import rotation as rot
from rangenav.kernels.jit import inlined, kernel
from rangenav.kernels.layout import Parameters
from rangenav.kernels.vectors import at, mostly, shared

LANES = 16
"""Filters side by side: each step waits for the step before it, so that eight would wait for a third of the time."""


@kernel
def unpacked(n):
    """The parameters from `Parameters.packed`."""
    return Parameters(
        gravity=(n[0], n[1], n[2]),
        magnetic=(n[3], n[4], n[5]),
        b4=n[6],
        variance=n[7],
        v=(n[8], n[9], n[10], n[11]),
        p0=(n[12], n[13], n[14], n[15]),
        k1=n[16],
        rho1=n[17],
        rho2=n[18],
        scheduled=shared(n[19]) != 0.0,
        k1_steady=n[20],
        halfway=n[21],
        memory=n[22],
        symmetric=shared(n[23]) != 0.0,
        matched=shared(n[24]) != 0.0,
        range_sigma=n[25],
        accel_density=n[26],
        gyro_density=n[27],
    )


@inlined
def gain(s, p):
    """k1 at a misalignment s: constant, or between its two ends in equal ratios (attitude.Schedule)."""
    if mostly(not p.scheduled):
        return p.k1
    square = s * s
    return p.k1_steady * (p.k1 / p.k1_steady) ** (square / (square + p.halfway * p.halfway))


@inlined
def rate(m, g, s, gyro, mag, gravity, p):
    """ω_y + k1(s) (ρ1 m_y × R̂ᵀm + ρ2 ĝ_B × R̂ᵀg), body axes, and the misalignment of the vectors, 0 if nobody asks.

    m and g: R̂ᵀm and R̂ᵀg; all vectors are tuples of three.
    """
    k1, seen = gain(s, p), 0.0
    c1, c2 = k1 * p.rho1, k1 * p.rho2
    if p.scheduled:
        square = g[0] * g[0] + g[1] * g[1] + g[2] * g[2]
        weight = p.rho2 * square
        size = gravity[0] * gravity[0] + gravity[1] * gravity[1] + gravity[2] * gravity[2]
        along = gravity[0] * g[0] + gravity[1] * g[1] + gravity[2] * g[2]
        magnetic = 1 - (mag[0] * m[0] + mag[1] * m[1] + mag[2] * m[2])
        seen = (p.rho1 * magnetic + weight * (1 - 2 * along / (size + square))) / (p.rho1 + weight)
    return (
        gyro[0] + c1 * (mag[1] * m[2] - mag[2] * m[1]) + c2 * (gravity[1] * g[2] - gravity[2] * g[1]),
        gyro[1] + c1 * (mag[2] * m[0] - mag[0] * m[2]) + c2 * (gravity[2] * g[0] - gravity[0] * g[2]),
        gyro[2] + c1 * (mag[0] * m[1] - mag[1] * m[0]) + c2 * (gravity[0] * g[1] - gravity[1] * g[0]),
        seen,
    )


@inlined
def _seen_from(r, p):
    """R̂ᵀm and R̂ᵀg."""
    m, g = p.magnetic, p.gravity
    return rot.apply_inverse(r, m[0], m[1], m[2]), rot.apply_inverse(r, g[0], g[1], g[2])


@inlined
def step(r, s, gyro0, gyro1, mag0, mag1, gravity0, gravity1, h, p):
    """R̂ and the misalignment s after h seconds, from the signals at both ends."""
    kept, (m, g) = _kept(h, p), _seen_from(r, p)
    sx, sy, sz, seen0 = rate(m, g, s, gyro0, mag0, gravity0, p)
    turn = rot.exp(h * sx, h * sy, h * sz)
    m, g = rot.apply_inverse(turn, m[0], m[1], m[2]), rot.apply_inverse(turn, g[0], g[1], g[2])
    ex, ey, ez, seen1 = rate(m, g, seen0 + kept * (s - seen0), gyro1, mag1, gravity1, p)
    turn = rot.exp(h / 2 * (sx + ex), h / 2 * (sy + ey), h / 2 * (sz + ez))
    mean = (seen0 + seen1) / 2
    return rot.orthonormal(rot.multiply(r, turn)), mean + kept * (s - mean)


@inlined
def _kept(h, p):
    return np.exp(-h / p.memory) if p.scheduled else 1.0


@kernel
def run(time, gyro, mag, gravity, truth, starts, rotations, errors, misaligned, packed):
    """One filter from each of many R̂(0), LANES side by side, over a record whose ĝ_B is known: all of them share it.

    rotations[j, k] ← R̂ of filter j at sample k. errors[j, k] ← the angle (rad) of R R̂ᵀ, R = truth[k]. Either may have
    no rows, and is then not computed. Each filter has to the last bit what `step` gives it alone.
    """
    w, p = np.empty(10 * LANES), unpacked(packed)
    lanes = at(w, 0, LANES)
    for first in range(0, len(starts), LANES):
        count = min(LANES, len(starts) - first)
        for c in range(LANES):
            for i in range(9):
                w[LANES * i + c] = starts[first + min(c, count - 1), i // 3, i % 3]
        lanes[9] = misaligned
        r, s = rot.load_at(lanes, 0), lanes[9]
        for k in range(len(time)):
            if k > 0:
                r, s = step(
                    r, s, rot.row(gyro, k - 1), rot.row(gyro, k), rot.row(mag, k - 1), rot.row(mag, k),
                    rot.row(gravity, k - 1), rot.row(gravity, k), time[k] - time[k - 1], p,
                )  # fmt: skip
            if len(rotations) > 0:
                rot.store_at(r, lanes, 0)
                for c in range(count):
                    for i in range(9):
                        rotations[first + c, k, i // 3, i % 3] = w[LANES * i + c]
            if len(errors) > 0:
                lanes[0] = rot.angle(rot.load(truth[k]), r)
                for c in range(count):
                    errors[first + c, k] = w[c]
