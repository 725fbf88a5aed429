"""One step of the complementary filter on SO(3): Heun's method on the group, order 2, with k1 constant or scheduled.

The misalignment s that the schedule goes by is part of what is integrated: between two samples it relaxes towards the
mean of what the vectors say at both ends, exactly, so that no step is too long for its memory.
"""

import numpy as np

from rangenav.kernels import rotation as rot
from rangenav.kernels.jit import inlined, kernel
from rangenav.kernels.layout import Parameters
from rangenav.kernels.vectors import at, choose, everywhere, mostly, shared

LANES = 16
"""Filters side by side: each step waits for the step before it, so that eight would wait for a third of the time."""
BLOCK = 32
"""Samples whose angles are computed together: their work space fits into the first cache."""
CERTAIN = 1e-9
"""Where 2 cos θ is farther than this from that of a limit, it tells on which side θ is, and θ need not be computed."""


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
def run(time, gyro, mag, gravity, truth, starts, rotations, chosen, errors, limit, above, misaligned, packed):
    """One filter from each of many R̂(0), LANES side by side, over a record whose ĝ_B is known: all of them share it.

    rotations[j, k] ← R̂ of filter j at sample k. errors[j] ← the angles (rad) of R R̂ᵀ at the samples that are chosen,
    R = truth[k]. above[j] ← how many samples there are up to the last whose angle is not below the limit, 0 to π.
    Rotations, or errors and above, may have no rows, and are then not computed. Each filter has to the last bit what
    `step` gives it alone.
    """
    w, p, asked = np.empty((10 + 2 * BLOCK) * LANES), unpacked(packed), np.empty(2 * BLOCK, dtype=np.int64)
    lanes, middle = at(w, 0, LANES), 2 * np.cos(limit)
    for first in range(0, len(starts), LANES):
        end, many, few, column = min(first + LANES, len(starts)), 0, 0, 0
        for c in range(LANES):
            for i in range(9):
                w[LANES * i + c] = starts[min(first + c, end - 1), i // 3, i % 3]
        lanes[9] = 0.0
        r, s = rot.load_at(lanes, 0), lanes[9] + misaligned
        for k in range(len(time)):
            if k > 0:
                r, s = step(
                    r, s, rot.row(gyro, k - 1), rot.row(gyro, k), rot.row(mag, k - 1), rot.row(mag, k),
                    rot.row(gravity, k - 1), rot.row(gravity, k), time[k] - time[k - 1], p,
                )  # fmt: skip
            if len(rotations) > 0:
                rot.store_at(r, lanes, 0)
                for j in range(first, end):
                    for i in range(9):
                        rotations[j, k, i // 3, i % 3] = w[LANES * i + j - first]
            if len(errors) > 0:
                cosine, due = rot.cosine(rot.load(truth[k]), r), chosen[k]
                if not everywhere(cosine > middle + CERTAIN):
                    lanes[9] = choose(middle - cosine > CERTAIN, k + 1.0, lanes[9])
                    due = due or not everywhere(abs(cosine - middle) > CERTAIN)
                if due:
                    asked[many], asked[BLOCK + few] = k, many
                    lanes[10 + 2 * many], lanes[11 + 2 * many] = rot.sine_square(rot.load(truth[k]), r), cosine
                    many, few = many + 1, few + chosen[k]
                if many == BLOCK or k == len(time) - 1:
                    _angles(w, asked, many, few, errors, first, end, column, limit)
                    many, few, column = 0, 0, column + few
        for j in range(first, min(end, len(above))):
            above[j] = w[LANES * 9 + j - first]


@kernel
def _angles(w, asked, many, few, errors, first, end, column, limit):
    """The angles at the samples asked[:many], which do not wait for each other, from what stands at places 10 and on.

    asked[BLOCK : BLOCK + few]: which of them are chosen; they go into the errors of filters first ≤ j < end from a
    column on. Place 9 ← one past the last of all samples so far whose angle is not below the limit.
    """
    lanes = at(w, 0, LANES)
    above = lanes[9]
    for i in range(many):
        angle, after = rot.angle_at(lanes[10 + 2 * i], lanes[11 + 2 * i]), asked[i] + 1.0
        lanes[10 + i], above = angle, choose(angle < limit, above, choose(above < after, after, above))
    lanes[9] = above
    for j in range(first, end):
        for i in range(few):
            errors[j, column + i] = w[LANES * (10 + asked[BLOCK + i]) + j - first]
