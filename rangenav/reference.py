"""The reference implementation of the cascaded observer, in numpy and body axes: slow, readable, and a second witness.

The splitting is the kernel's, the coordinates are others. Here the transition is 𝒜's exponential turned by exp(−ω h), P
is in body axes, and the input matrices of the noise are written out; the kernel works in the gyro-integrated frame and
never turns P.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import acquisition, attitude, riccati, so3
from rangenav.acquisition import Collection, Watch
from rangenav.cascade import Estimate, ObserverConfig, Start, checked_start, ranges_at_imu_rate
from rangenav.kernels import layout
from rangenav.kernels.layout import MATCHED_V
from rangenav.model import GRAVITY, POSITION, STATES, VELOCITY, XI, ModelForm
from rangenav.results import result
from rangenav.sensors import Measurements, check


def observe(measurements: Measurements, start: Start, setting: ObserverConfig) -> Estimate:
    """Run both observers over a record; same arguments, result and errors as `cascade.observe`."""
    z, start = check(measurements), checked_start(start)
    observer = _Observer(setting, symmetric=ranges_at_imu_rate(z, setting.sensors))
    R, now = start.rotation.copy(), observer.begin(start.state.copy())
    mag = np.where(np.isnan(z.mag[0]), R.T @ np.asarray(setting.world.magnetic), z.mag[0])
    pending = _due_at_start(z, observer, now)
    j = int(np.searchsorted(z.range_time, z.time[0], side="right"))
    s, chosen = attitude.MISALIGNED, setting.gains.attitude
    rows, innovation = [(now.x, now.P, R, attitude.gain(chosen, s), now.phase)], np.full((len(z.range), 2), np.nan)
    for k in range(1, len(z.time)):
        gravity = now.x[GRAVITY]
        if pending is not None:
            now = observer.corrected(now, *pending)
            pending = None
        t0, t1, reached, turned = z.time[k - 1], z.time[k], 0.0, np.eye(3)
        gyro, accel = (z.gyro[k - 1], z.gyro[k]), (z.accel[k - 1], z.accel[k])
        while j < len(z.range_time) and z.range_time[j] <= t1:
            fraction = 1.0 if z.range_time[j] == t1 else (z.range_time[j] - t0) / (t1 - t0)
            if fraction > reached:
                now, turned = observer.propagate(now, turned, gyro, accel, reached, fraction, t1 - t0)
                reached = fraction
            y, variance = observer.output(z.range[j]), observer.variance(now)
            innovation[j] = y - now.x[0], now.P[0, 0] + variance
            if observer.symmetric and fraction == 1.0:
                variance *= 2
                pending = (y, variance)
            now = observer.corrected(now, y, variance)
            j += 1
        if reached < 1.0:
            now, turned = observer.propagate(now, turned, gyro, accel, reached, 1.0, t1 - t0)
        now = observer.ended(now, t1 - t0)
        new_mag = turned.T @ mag if np.isnan(z.mag[k]).any() else z.mag[k]
        R, s = attitude.step(
            R, s, gyro, (mag, new_mag), (gravity, now.x[GRAVITY]), t1 - t0, gains=chosen, world=setting.world
        )
        mag = new_mag
        rows.append((now.x, now.P, R, attitude.gain(chosen, s), now.phase))
    return _estimate(z, rows, innovation)


@result
class _Now:
    """The Riccati observer between two corrections, body axes."""

    x: Float[Array, "13"]
    P: Float[Array, "13 13"]
    phase: int
    """As in `Estimate.phase`."""
    collection: Collection | None
    """None while no ranges are collected."""
    counted: bool
    """Whether the collection is the first one, or one of the three that alarms may begin; a mild alarm's is neither."""
    watch: Watch
    reopened: int
    """Alarms that have begun a collection."""


class _Observer:
    """The configuration unpacked once; the methods depend on it and on their arguments only."""

    def __init__(self, setting: ObserverConfig, *, symmetric: bool) -> None:
        gains, sensors = setting.gains, setting.sensors
        self.noise_matched = gains.mode == "noise-matched"
        self.symmetric = symmetric and not self.noise_matched
        self.gravity_norm = float(np.linalg.norm(setting.world.gravity))
        self.form: ModelForm = setting.form
        self.v, self.p0 = gains.riccati.v.diagonal(), np.diag(gains.riccati.p0.diagonal())
        self.constant_variance = sensors.range_rate / gains.riccati.q
        self.sensed = acquisition.Noise(
            range=sensors.sigma.range,
            accel_density=sensors.sigma.accel**2 / sensors.imu_rate,
            gyro_density=sensors.sigma.gyro**2 / sensors.imu_rate,
        )

    def begin(self, x: Float[Array, "13"]) -> _Now:
        """The observer at the first sample."""
        phase = acquisition.MATCHED if self.noise_matched else acquisition.CONSTANT
        begun, watch = acquisition.collection() if self.noise_matched else None, acquisition.watch(1.0)
        return _Now(x=x, P=self.p0, phase=phase, collection=begun, counted=True, watch=watch, reopened=0)

    def output(self, distance: float) -> float:
        """y = ½d², less the bias ½σ² when noise-matched."""
        return (distance**2 - (self.sensed.range**2 if self.noise_matched else 0.0)) / 2

    def variance(self, now: _Now) -> float:
        """Variance of one y (m⁴)."""
        if now.phase != acquisition.MATCHED:
            return self.constant_variance
        return max(2 * now.x[0], 0.0) * self.sensed.range**2 + self.sensed.range**4 / 2

    def corrected(self, now: _Now, y: float, variance: float) -> _Now:
        """The observer after a measurement of y, which outliers leave as it is."""
        if now.collection is not None:
            now = replace(now, collection=acquisition.collected(now.collection, y, self.sensed))
        if now.phase == acquisition.MATCHED:
            watch, outlier = acquisition.watched(now.watch, y - now.x[0], now.P[0, 0] + variance)
            now = replace(now, watch=watch)
            if outlier:
                return now
        x, P = riccati.correct(now.x, now.P, y, variance)
        return replace(now, x=x, P=P)

    def noise(self, x: Float[Array, "13"], phase: int) -> Float[Array, "13 13"]:
        """Process-noise density V."""
        if phase != acquisition.MATCHED:
            return np.diag(self.v)
        return np.diag(np.repeat(MATCHED_V, [4, 3, 3, 3])) + self.imu_noise(x)

    def imu_noise(self, x: Float[Array, "13"]) -> Float[Array, "13 13"]:
        """The part of V that the noise of accelerometer and gyro makes at x̂."""
        accel, gyro = np.zeros((STATES, 3)), np.zeros((STATES, 3))
        accel[1], accel[2], accel[3] = x[POSITION], 2 * x[VELOCITY], 3 * x[GRAVITY]
        accel[VELOCITY] = np.eye(3)
        for block in (POSITION, VELOCITY, GRAVITY):
            gyro[block] = so3.hat(x[block])
        return self.sensed.accel_density * accel @ accel.T + self.sensed.gyro_density * gyro @ gyro.T

    def propagate(
        self, now: _Now, turned: Array, gyro: tuple, accel: tuple, begin: float, end: float, interval: float
    ) -> tuple[_Now, Array]:
        """The observer from one fraction of the interval to another, and the turn since the interval's start."""
        h, middle = (end - begin) * interval, (begin + end) / 2
        rate = gyro[0] + middle * (gyro[1] - gyro[0])
        turn = so3.exp(h * rate)
        first, last = (accel[0] + fraction * (accel[1] - accel[0]) for fraction in (begin, end))
        mean, known = (first + turn @ last) / 2, {"gravity_norm": self.gravity_norm, "form": self.form}
        P = now.P + self.noise(now.x, now.phase) * (h / 2)
        x, P = riccati.predict(now.x, P, rate, mean, h, **known)
        P = P + self.noise(x, now.phase) * (h / 2)
        now = replace(now, x=x, P=P)
        if now.collection is not None:
            now = replace(now, collection=acquisition.moved(now.collection, turn, mean, h, **known))
        return now, turned @ turn

    def ended(self, now: _Now, interval: float) -> _Now:
        """The observer at the end of an interval: matched gains are reminded of ξ1 = ½|p|², given up, or start."""
        if now.phase == acquisition.MATCHED:
            x, P = riccati.remind(now.x, now.P, interval)
            now = self._judged(replace(now, x=x, P=P))
        return now if now.collection is None else self._started(now, now.collection)

    def _judged(self, now: _Now) -> _Now:
        alarm = not now.watch.total <= layout.ALARM
        if now.watch.count < layout.ALARM_RANGES and not alarm:
            return now
        scale, new = acquisition.size(now.watch), acquisition.watch(now.watch.scale)
        if not alarm:
            return replace(now, watch=new)
        collects, left = now.collection is not None, now.reopened < layout.REOPENINGS
        if layout.LOOSEST_SCALE < scale <= layout.MILD_SCALE:
            now = replace(now, watch=acquisition.watch(layout.LOOSEST_SCALE), P=scale * now.P)
            return now if collects else replace(now, collection=acquisition.collection(), counted=False)
        if scale <= layout.LOOSEST_SCALE:
            now = replace(now, watch=acquisition.watch(scale))
            return now if collects or not left else self._reopened(now, acquisition.collection())
        now = replace(now, watch=new, P=self.p0, phase=acquisition.COLLECTING)
        if collects and now.counted:
            return now
        if not left:
            return replace(now, phase=acquisition.LOST, collection=None)
        return self._reopened(now, now.collection or acquisition.collection())

    def _reopened(self, now: _Now, of: Collection) -> _Now:
        """One of the three collections that alarms may begin."""
        return replace(now, collection=of, counted=True, reopened=now.reopened + 1)

    def _started(self, now: _Now, of: Collection) -> _Now:
        if acquisition.outweighed(of) and acquisition.clean(of) and now.phase == acquisition.COLLECTING:
            return self._widened(now, of.mean_square)
        if acquisition.outweighed(of) or acquisition.refuted(of):
            return replace(now, collection=acquisition.collection())
        if of.count <= STATES or of.elapsed < of.next_check:
            return now
        solution = acquisition.solved(of)
        if solution is None:
            return replace(now, collection=replace(of, next_check=of.elapsed * layout.CHECK_GROWTH))
        x, P, misfit = solution
        turn = np.eye(STATES)
        for block in (POSITION, VELOCITY, GRAVITY):
            turn[block, block] = of.turned.T
        x, P = turn @ x, turn @ P @ turn.T
        P = P + 2 * of.elapsed * self.imu_noise(x)
        if now.phase == acquisition.MATCHED and not acquisition.contradict(now.x, now.P, x, P):
            return replace(now, collection=None)
        begun = {"phase": acquisition.MATCHED, "watch": acquisition.watch(misfit)}
        return replace(now, x=x, P=P, collection=None, **begun)

    def _widened(self, now: _Now, square: float) -> _Now:
        if now.reopened == layout.REOPENINGS:
            return replace(now, phase=acquisition.LOST, collection=None)
        x, P = acquisition.anywhere(square, self.p0, now.reopened)
        now = replace(now, x=x, P=P, phase=acquisition.MATCHED, watch=acquisition.watch(1.0))
        return self._reopened(now, acquisition.collection())


def _due_at_start(z: Measurements, observer: _Observer, now: _Now) -> tuple[float, float] | None:
    at_start = z.range_time == z.time[0]
    if not at_start.any():
        return None
    return observer.output(z.range[at_start][-1]), observer.variance(now) * (2 if observer.symmetric else 1)


def _estimate(z: Measurements, rows: list, innovation: Array) -> Estimate:
    states, covariances, rotations, k1, phase = (np.array(part) for part in zip(*rows, strict=True))
    blocks = [covariances[:, block, block] for block in (POSITION, VELOCITY, GRAVITY)]
    return Estimate(
        time=z.time,
        state=states,
        covariance=np.stack(blocks, axis=1),
        xi_variance=np.diagonal(covariances[:, XI, XI], axis1=-2, axis2=-1),
        rotation=rotations,
        k1=k1,
        innovation=innovation,
        phase=phase.astype(np.int8),
    )
