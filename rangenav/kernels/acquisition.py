"""The start of noise-matched gains and their alarm; `rangenav.acquisition` states the formulas.

All that it keeps lies in one flat array `a`, in the places that `layout` names: a step then copies one array more.
"""

import numpy as np

from rangenav.kernels import riccati
from rangenav.kernels.jit import kernel
from rangenav.kernels.layout import (
    ALARM,
    ALARM_RANGES,
    CHECK_GROWTH,
    CLEAN_SHARE,
    COLLECTING,
    COLLECTS,
    CONTRADICTION,
    COUNT,
    ELAPSED,
    FIT,
    GATE,
    IMU_SHARE,
    KNOWN_SHARE,
    LEAST_VARIANCE,
    LOOSEST_SCALE,
    LOST,
    MATCHED,
    MEAN_SQUARE,
    MILD_SCALE,
    MOMENTS,
    MOST_REFUSED,
    NEXT_CHECK,
    OUTLIER,
    PHASE,
    RANK_TOLERANCE,
    REFUSED,
    REOPENED,
    REOPENINGS,
    RESPONSE,
    SCALE,
    SMOOTHING,
    WEIGHT,
    WINDOW_COUNT,
    WINDOW_SIZE,
    WINDOW_SUM,
)

N = 13
WIDTH = N + 1
VELOCITY_RESPONSE = RESPONSE + 7


@kernel
def collect_anew(a):
    """Forget the collected ranges: a collection begins now. The gains in force and their watch remain."""
    a[:PHASE] = 0.0
    a[COLLECTS], a[ELAPSED], a[COUNT], a[REFUSED], a[FIT], a[WEIGHT], a[NEXT_CHECK] = 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


@kernel
def propagate(a, ax, ay, az, h, b4):
    """Move the response to the inputs and the moments of D on by h seconds of constant apparent acceleration."""
    m, t = MOMENTS, a[ELAPSED]
    wx, wy, wz = a[m + 6], a[m + 7], a[m + 8]
    aa, a_d = ax * ax + ay * ay + az * az, ax * a[m + 3] + ay * a[m + 4] + az * a[m + 5]
    a_w, h2 = ax * wx + ay * wy + az * wz, h * h
    a[m] += 2 * h * a[m + 1] + h2 * (a[m + 2] + a_d) + h2 * h * a_w + aa * t * h2 * h2 / 4
    a[m + 1] += h * (a[m + 2] + a_d) + 1.5 * h2 * a_w + aa * t * h2 * h / 2
    a[m + 2] += 2 * h * a_w + aa * t * h2
    a[m + 3] += h * wx + ax * t * h2 / 2
    a[m + 4] += h * wy + ay * t * h2 / 2
    a[m + 5] += h * wz + az * t * h2 / 2
    a[m + 6] += ax * t * h
    a[m + 7] += ay * t * h
    a[m + 8] += az * t * h
    a[ELAPSED] = t + h
    riccati.predict_state(a[RESPONSE : RESPONSE + N], ax, ay, az, h, b4)


@kernel
def collect(a, y, p):
    """Rotate the weighted row of one y = ½d² into the triangle; the square of what is left adds to the misfit."""
    s2, t = max(p.range_sigma * p.range_sigma, LEAST_VARIANCE), a[ELAPSED]
    square = max(2 * y, 0.0)
    mean = square if a[COUNT] == 0 else a[MEAN_SQUARE]
    imu = mean * (p.accel_density * t * t * t / 3 + p.gyro_density * a[MOMENTS])
    variance = mean * s2 + s2 * s2 / 2 + imu
    weight = 1 / np.sqrt(variance)
    row = np.empty(WIDTH)
    row[0], row[1], row[2], row[3] = weight, t * weight, t * t / 2 * weight, t * t * t / 6 * weight
    for i in range(3):
        d = a[RESPONSE + 4 + i] * weight
        row[4 + i], row[7 + i], row[10 + i] = d, t * d, t * t / 2 * d
    row[N] = (y - a[RESPONSE]) * weight
    if _misfits(a, row):
        a[REFUSED] += 1
        return
    a[MEAN_SQUARE] = mean + SMOOTHING * (square - mean)
    for i in range(N):
        if row[i] != 0.0:
            o = WIDTH * i
            length = np.sqrt(a[o + i] * a[o + i] + row[i] * row[i])
            c, s = a[o + i] / length, row[i] / length
            a[o + i] = length
            for j in range(i + 1, WIDTH):
                kept = a[o + j]
                a[o + j] = c * kept + s * row[j]
                row[j] = c * row[j] - s * kept
    a[FIT] += row[N] * row[N]
    a[COUNT] += 1
    a[WEIGHT] += imu / variance


@kernel
def _misfits(a, row):
    """Whether a row is an outlier: ν²/(1 + |u|²) > 36 misfits, u = R⁻ᵀh, ν what the least squares leave of it."""
    if a[COUNT] <= N:
        return False
    u, left, size = np.empty(N), row[N], 1.0
    for i in range(N):
        u[i] = row[i]
        for k in range(i):
            u[i] -= a[WIDTH * k + i] * u[k]
        u[i] /= a[WIDTH * i + i]
        left -= u[i] * a[WIDTH * i + N]
        size += u[i] * u[i]
    misfit = max(1.0, a[FIT] / (a[COUNT] - N))
    return left * left > GATE * misfit * size  # False for NaN, before the rank is 13


@kernel
def start(a, x, P, p):
    """At the end of an interval: x̂, P and the matched gains from the collected ranges, if these tell the position.

    Matched gains that run from the prior go on, unless their position contradicts that of the ranges.
    """
    outweighed = a[WEIGHT] > IMU_SHARE * a[COUNT]
    if outweighed or a[REFUSED] > MOST_REFUSED + a[COUNT] / 2:
        clean = a[FIT] <= LOOSEST_SCALE * a[COUNT] and a[REFUSED] <= CLEAN_SHARE * a[COUNT]
        collects = a[COLLECTS]
        collect_anew(a)
        a[COLLECTS] = collects
        if outweighed and clean and a[PHASE] == COLLECTING:
            _widen(a, x, P, p)
        return
    if a[COUNT] <= N or a[ELAPSED] < a[NEXT_CHECK]:
        return
    a[NEXT_CHECK] = a[ELAPSED] * CHECK_GROWTH
    n, t = len(x), a[ELAPSED]  # not the constant 13: loops that stay loops compile in half the time
    root = np.empty((n, n))
    if not _inverse(a, root):
        return
    misfit, spread = max(1.0, a[FIT] / (a[COUNT] - N)), 0.0
    for j in range(n):
        _carry(root[:, j], t, a)
        for i in range(4, 7):
            spread += misfit * root[i, j] * root[i, j]
    if not spread < KNOWN_SHARE * KNOWN_SHARE * a[MEAN_SQUARE]:
        return
    scale, state, covariance = 2 * (1 + a[WEIGHT]) * misfit, np.empty(n), np.empty(n * n)
    for i in range(n):
        state[i] = a[RESPONSE + i]
        for k in range(n):
            state[i] += root[i, k] * a[WIDTH * k + N]
        for j in range(i + 1):
            total = 0.0
            for k in range(n):
                total += root[i, k] * root[j, k]
            covariance[N * i + j] = covariance[N * j + i] = scale * total
    riccati.add_imu_noise(covariance, state, p.accel_density, p.gyro_density, 2 * t)
    a[COLLECTS] = 0.0
    if a[PHASE] == MATCHED and not _contradict(x, P, state, covariance):
        return
    x[:], P[:] = state, covariance
    a[PHASE], a[SCALE] = MATCHED, min(misfit, LOOSEST_SCALE)
    a[WINDOW_COUNT] = a[WINDOW_SUM] = a[WINDOW_SIZE] = 0.0


@kernel
def _widen(a, x, P, p):
    """Matched gains from x̂ and P that exclude no place at the measured distance, and no speed below 1, 10 or 100 times
    that of P(0); lost at the fourth time."""
    if a[REOPENED] == REOPENINGS:
        a[PHASE], a[COLLECTS] = LOST, 0.0
        return
    square, speed, gravity = a[MEAN_SQUARE], np.sqrt(p.p0[2]) * 10.0 ** a[REOPENED], np.sqrt(p.p0[3])
    distance = np.sqrt(square)
    x[:], P[:] = 0.0, 0.0
    x[0], P[0] = square / 2, square * square
    P[N + 1] = square * speed * speed
    P[2 * (N + 1)] = (speed * speed + distance * gravity) ** 2
    P[3 * (N + 1)] = (3 * speed * gravity) ** 2
    for i in range(3):
        P[(N + 1) * (4 + i)], P[(N + 1) * (7 + i)], P[(N + 1) * (10 + i)] = square, speed * speed, gravity * gravity
    a[REOPENED] += 1
    a[PHASE], a[SCALE] = MATCHED, 1.0
    a[WINDOW_COUNT] = a[WINDOW_SUM] = a[WINDOW_SIZE] = 0.0


@kernel
def _contradict(x, P, state, covariance):
    """Whether two positions differ by more than both covariances allow: eᵀ(P + P')⁻¹e > 30.66, by Cholesky."""
    root, e = np.empty((3, 3)), np.empty(3)
    square = 0.0
    for i in range(3):
        e[i] = state[4 + i] - x[4 + i]
        for j in range(i + 1):
            at = N * (4 + i) + 4 + j
            root[i, j] = P[at] + covariance[at]
            for k in range(j):
                root[i, j] -= root[i, k] * root[j, k]
            root[i, j] = np.sqrt(root[i, i]) if i == j else root[i, j] / root[j, j]
        for k in range(i):
            e[i] -= root[i, k] * e[k]
        e[i] /= root[i, i]
        square += e[i] * e[i]
    return not square <= CONTRADICTION


@kernel
def _inverse(a, out):
    """out ← the inverse of the triangle; False, and nothing of use in it, where the rank is below 13."""
    n, largest = len(out), 0.0
    for i in range(n):
        largest = max(largest, a[WIDTH * i + i])
    for i in range(n):
        if not a[WIDTH * i + i] > RANK_TOLERANCE * largest:
            return False
    out[:] = 0.0
    for j in range(n):
        out[j, j] = 1 / a[WIDTH * j + j]
        for i in range(j - 1, -1, -1):
            total = 0.0
            for k in range(i + 1, j + 1):
                total += a[WIDTH * i + k] * out[k, j]
            out[i, j] = -total / a[WIDTH * i + i]
    return True


@kernel
def _carry(c, t, a):
    """c ← Φ c for a column c, in closed form over the whole span t; D = ∬a and V = ∫a are part of the response."""
    dp = dv = dg = vp = vv = vg = 0.0
    for i in range(3):
        D, V = a[RESPONSE + 4 + i], a[VELOCITY_RESPONSE + i]
        dp, dv, dg = dp + D * c[4 + i], dv + D * c[7 + i], dg + D * c[10 + i]
        vp, vv, vg = vp + V * c[4 + i], vv + V * c[7 + i], vg + V * c[10 + i]
    t2 = t * t / 2
    c[0] += t * c[1] + t2 * c[2] + t * t2 / 3 * c[3] + dp + t * dv + t2 * dg
    c[1] += t * c[2] + t2 * c[3] + vp + dv + t * vv + t * dg + t2 * vg
    c[2] += t * c[3] + 2 * vv + dg + 2 * t * vg
    c[3] += 3 * vg
    for i in range(3):
        c[4 + i] += t * c[7 + i] + t2 * c[10 + i]
        c[7 + i] += t * c[10 + i]


@kernel
def outlier(a, innovation, variance):
    """Count one innovation in the window; whether it is so large that its range corrects nothing."""
    square = innovation * innovation / (variance * a[SCALE])
    large = not square <= GATE
    a[WINDOW_COUNT] += 1
    a[WINDOW_SUM] += OUTLIER if large else square
    a[WINDOW_SIZE] += GATE if large else square
    return large


@kernel
def watch(a, P, p):
    """At an alarm: widen gate and alarm, inflate P, or give up the gains, and collect ranges. A window without one is
    over."""
    alarm = not a[WINDOW_SUM] <= ALARM
    if a[WINDOW_COUNT] < ALARM_RANGES and not alarm:
        return
    scale, collects = a[SCALE] * a[WINDOW_SIZE] / a[WINDOW_COUNT], a[COLLECTS]
    a[WINDOW_COUNT] = a[WINDOW_SUM] = a[WINDOW_SIZE] = 0.0
    if not alarm:
        return
    mild, counted, left = LOOSEST_SCALE < scale <= MILD_SCALE, collects == 1, a[REOPENED] < REOPENINGS
    if scale <= LOOSEST_SCALE:
        a[SCALE] = scale
    elif mild:
        a[SCALE] = LOOSEST_SCALE
        for i in range(N * N):
            P[i] *= scale
    else:
        a[PHASE] = COLLECTING if counted or left else LOST
        P[:] = 0.0
        for i in range(N):
            P[(N + 1) * i] = p.p0[0 if i < 4 else (i - 1) // 3]
    if collects == 0 and (mild or left):
        collect_anew(a)
        a[COLLECTS] = 2.0
    if a[COLLECTS] == 2 and not mild:
        if a[PHASE] == LOST:
            a[COLLECTS] = 0.0
        elif scale > LOOSEST_SCALE or collects == 0:
            a[COLLECTS] = 1.0
            a[REOPENED] += 1
