"""One step of the complementary filter on SO(3): Heun's method on the group, order 2, with k1 constant or scheduled.

The misalignment s that the schedule goes by is part of what is integrated: between two samples it relaxes towards the
mean of what the vectors say at both ends, exactly, so that no step is too long for its memory.
"""

import numpy as np

from rangenav.kernels import rotation as rot
from rangenav.kernels.jit import inlined, kernel
from rangenav.kernels.layout import Parameters

LANES = 8
"""Filters side by side: two vectors of four, or one of eight."""
MOVED, SIZE, ANGLE = 9 * LANES, 18 * LANES, 19 * LANES
"""Places in the one array that they share, after their rotations: of loops of eight the compiler makes vector code only
where it need not ask, while they run, whether two arrays overlap."""


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
        scheduled=n[19] != 0.0,
        k1_steady=n[20],
        halfway=n[21],
        memory=n[22],
        symmetric=n[23] != 0.0,
        matched=n[24] != 0.0,
        range_sigma=n[25],
        accel_density=n[26],
        gyro_density=n[27],
    )


@inlined
def gain(s, p):
    """k1 at a misalignment s: constant, or between its two ends in equal ratios (attitude.Schedule)."""
    if not p.scheduled:
        return p.k1
    square = s * s
    return p.k1_steady * (p.k1 / p.k1_steady) ** (square / (square + p.halfway * p.halfway))


@inlined
def rate(m, g, s, gyro, mag, gravity, scheduled, p):
    """ω_y + k1(s) (ρ1 m_y × R̂ᵀm + ρ2 ĝ_B × R̂ᵀg), body axes, and the misalignment of the vectors, 0 if nobody asks.

    m and g: R̂ᵀm and R̂ᵀg; all vectors are tuples of three. scheduled: p.scheduled.
    """
    k1, seen = gain(s, p) if scheduled else p.k1, 0.0
    c1, c2 = k1 * p.rho1, k1 * p.rho2
    if scheduled:
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


@kernel
def step(r, s, gyro0, gyro1, mag0, mag1, gravity0, gravity1, h, p):
    """R̂ and the misalignment s after h seconds, from the signals at both ends."""
    kept, (m, g) = _kept(h, p), _seen_from(r, p)
    sx, sy, sz, seen0 = rate(m, g, s, gyro0, mag0, gravity0, p.scheduled, p)
    turn = rot.exp(h * sx, h * sy, h * sz)
    m, g = rot.apply_inverse(turn, m[0], m[1], m[2]), rot.apply_inverse(turn, g[0], g[1], g[2])
    ex, ey, ez, seen1 = rate(m, g, seen0 + kept * (s - seen0), gyro1, mag1, gravity1, p.scheduled, p)
    turn = rot.exp(h / 2 * (sx + ex), h / 2 * (sy + ey), h / 2 * (sz + ez))
    mean = (seen0 + seen1) / 2
    return rot.orthonormal(rot.multiply(r, turn)), mean + kept * (s - mean)


@inlined
def _kept(h, p):
    return np.exp(-h / p.memory) if p.scheduled else 1.0


@inlined
def small_step(r, z0, z1, h, p):
    """The same of a constant gain, and the sum of the squares of both turns (rad²): right only where this is below
    SMALL_SQUARE.

    z0, z1: gyro, mag and gravity at both ends.
    """
    m, g = _seen_from(r, p)
    sx, sy, sz, _ = rate(m, g, 0.0, z0[0], z0[1], z0[2], False, p)
    ax, ay, az = h * sx, h * sy, h * sz
    turn = rot.small(ax, ay, az)
    m, g = rot.apply_inverse(turn, m[0], m[1], m[2]), rot.apply_inverse(turn, g[0], g[1], g[2])
    ex, ey, ez, _ = rate(m, g, 0.0, z1[0], z1[1], z1[2], False, p)
    bx, by, bz = h / 2 * (sx + ex), h / 2 * (sy + ey), h / 2 * (sz + ez)
    size = (ax * ax + ay * ay + az * az) + (bx * bx + by * by + bz * bz)
    return rot.orthonormal(rot.multiply(r, rot.small(bx, by, bz))), size


@kernel
def run(time, gyro, mag, gravity, truth, starts, rotations, errors, misaligned, packed):
    """One filter from each of many R̂(0), eight side by side, over a record whose ĝ_B is known: all of them share it.

    rotations[j, k] ← R̂ of filter j at sample k. errors[j, k] ← the angle (rad) of R R̂ᵀ, R = truth[k]. Either may have
    no rows, and is then not computed. Each filter has to the last bit what `step` gives it alone.
    """
    w, s, p = np.empty(20 * LANES), np.empty(LANES), unpacked(packed)
    for first in range(0, len(starts), LANES):
        count = min(LANES, len(starts) - first)
        s[:] = misaligned
        for c in range(LANES):
            _put(w, c, rot.load(starts[first + min(c, count - 1)]))
        for k in range(len(time)):
            if k > 0:
                z0 = rot.row(gyro, k - 1), rot.row(mag, k - 1), rot.row(gravity, k - 1)
                z1, h = (rot.row(gyro, k), rot.row(mag, k), rot.row(gravity, k)), time[k] - time[k - 1]
                if p.scheduled or not _lanes(w, z0, z1, h, p):
                    for c in range(LANES):
                        r, s[c] = step(_lane(w, c), s[c], z0[0], z1[0], z0[1], z1[1], z0[2], z1[2], h, p)
                        _put(w, c, r)
            if len(rotations) > 0:
                for c in range(count):
                    rot.store(_lane(w, c), rotations[first + c, k])
            if len(errors) > 0:
                _angles(w, rot.load(truth[k]))
                for c in range(count):
                    errors[first + c, k] = w[ANGLE + c]


@kernel
def _lanes(w, z0, z1, h, p):
    """`small_step` of every lane, as vector code, if it is right for all of them; returns whether it is."""
    for c in range(LANES):
        r, w[SIZE + c] = small_step(_lane(w, c), z0, z1, h, p)
        _put(w, MOVED + c, r)
    largest = 0.0
    for c in range(LANES):
        largest = max(largest, w[SIZE + c])
    if not largest < rot.SMALL_SQUARE:
        return False
    for i in range(MOVED):
        w[i] = w[MOVED + i]
    return True


@kernel
def _angles(w, truth):
    for c in range(LANES):
        w[ANGLE + c] = rot.angle(truth, _lane(w, c))


@inlined
def _lane(w, c):
    """The rotation of one lane: nine numbers, each beside those of the other lanes."""
    n = LANES
    return (
        w[c], w[n + c], w[2 * n + c], w[3 * n + c], w[4 * n + c], w[5 * n + c], w[6 * n + c], w[7 * n + c], w[8 * n + c]
    )  # fmt: skip


@inlined
def _put(w, c, r):
    n = LANES
    w[c], w[n + c], w[2 * n + c] = r[0], r[1], r[2]
    w[3 * n + c], w[4 * n + c], w[5 * n + c] = r[3], r[4], r[5]
    w[6 * n + c], w[7 * n + c], w[8 * n + c] = r[6], r[7], r[8]
