"""Noise-matched gains use a good prior, give up a bad one, notice a false solution, and bear an outlier."""

import math
from dataclasses import replace as with_fields

import numpy as np
import pytest
import scipy.stats
from msgspec.structs import replace

from rangenav import acquisition, cascade, model, preset, range_fit, record, reference
from rangenav.acquisition import COLLECTING, CONSTANT, LOST, MATCHED
from rangenav.cascade import Estimate, ObserverConfig, Sample, Start
from rangenav.gains import Gains
from rangenav.kernels import layout
from rangenav.sensors import Effects, Measurements, Noise
from tests.support import records
from tests.support.present import present
from tests.support.records import Scene

GAINS = Gains(mode="noise-matched")
FAR = 36.0
"""Six σ of one axis: e_BᵀP⁻¹e_B of a position stays below it in all but 8e-8 of consistent estimates."""


@pytest.fixture(scope="module")
def scene() -> Scene:
    return records.scene("paper-slow", duration=30.0, range_rate=50.0)


def observed(scene: Scene, measurements: Measurements | None = None, start: Start | None = None) -> Estimate:
    return cascade.observe(measurements or scene.measurements, start or scene.start, scene.setting(GAINS))


def distance(scene: Scene, estimate: Estimate) -> float:
    """e_BᵀP⁻¹e_B of the last position."""
    error = (estimate.state - scene.truth.state)[-1, model.POSITION]
    return float(error @ np.linalg.solve(estimate.covariance[-1, 0], error))


def with_ranges(z: Measurements, ranges: np.ndarray) -> Measurements:
    return with_fields(z, range=ranges)


def away(position: list[float], velocity: list[float]) -> Start:
    lifted = model.lift(np.array(position), np.array(velocity), np.array([0.0, 0.0, 9.81]))
    return Start(state=lifted, rotation=np.diag([-1.0, -1.0, 1.0]))


def test_far_starts_end_alike_from_the_ranges_alone(scene: Scene):
    """Nothing is left of x̂(0): from two starts, 10 km and 1 km/s off, the matched gains compute the same bits."""
    one = observed(scene, start=away([6e3, -8e3, 0.0], [0.0, 600.0, 800.0]))
    other = observed(scene, start=away([0.0, 0.0, 1e4], [-1e3, 0.0, 0.0]))
    begun = np.flatnonzero(present(one.phase) == COLLECTING)[-1] + 1
    assert set(present(one.phase)[begun:]) == {MATCHED}
    np.testing.assert_array_equal(one.state[begun:], other.state[begun:])
    assert distance(scene, one) < FAR


def test_a_prior_that_is_right_is_used_from_the_first_range_on(scene: Scene):
    """The matched gains run at once, and the position is known better than by the prior long before the ranges alone
    determine it."""
    estimate, far = observed(scene), observed(scene, start=away([6e3, -8e3, 0.0], [0.0, 600.0, 800.0]))
    assert set(present(estimate.phase)) == {MATCHED}
    early = int(np.searchsorted(estimate.time, 5.0))
    assert present(far.phase)[early] == COLLECTING
    assert np.trace(estimate.covariance[early, 0]) < np.trace(estimate.covariance[0, 0]) / 2
    error = (estimate.state - scene.truth.state)[early, model.POSITION]
    assert error @ np.linalg.solve(estimate.covariance[early, 0], error) < FAR


def test_a_prior_that_contradicts_the_collected_ranges_is_given_up_without_an_alarm(scene: Scene):
    """Just before the ranges determine the state, x̂ is put 2 km off with a σ of 1 cm: no window has time to notice."""
    z, states = scene.measurements, [cascade.begin(sample(scene.measurements, 0), scene.start, scene.setting(GAINS))]
    while states[-1].arrays.acquisition[layout.COLLECTS] == 1:
        states.append(cascade.step(states[-1], sample(z, len(states))))
    before, k = states[-2], len(states) - 1
    before.arrays.x[4:7] += 2e3
    before.arrays.P[:] = 1e-4 * np.eye(13).ravel()
    after = cascade.step(before, sample(z, k))
    assert after.phase == "matched"
    error = after.state[model.POSITION] - scene.truth.state[k, model.POSITION]
    assert np.linalg.norm(error) < FAR**0.5 * np.linalg.norm(after.std[model.POSITION]) < 100


def test_positions_contradict_each_other_where_both_covariances_exclude_it():
    x, P, other = np.zeros(13), 9.0 * np.eye(13), 16.0 * np.eye(13)
    assert scipy.stats.chi2.sf(layout.CONTRADICTION, 3) == pytest.approx(1e-6, rel=1e-2)
    for length, wanted in ((27.0, False), (28.0, True)):  # 5 σ times √30.66 is 27.7
        assert acquisition.contradict(x, P, x + np.eye(13)[5] * length, other) == wanted


@pytest.mark.parametrize("far", [30.0, 1000.0])
def test_the_covariance_is_true_with_a_far_anchor(far: float):
    scene = records.scene("lissajous", duration=30.0, range_rate=50.0)
    world = replace(scene.preset.world, anchor=(far, 0.0, 0.0))
    moved = replace(scene.preset, world=world)
    inputs = records.record.truth_inputs(moved)
    truth, z = records.record.simulated(inputs), records.record.drawn(inputs, moved.sensors, 0)
    estimate = cascade.observe(z, scene.start, ObserverConfig(world=world, sensors=moved.sensors, gains=GAINS))
    prior_given_up = np.flatnonzero(present(estimate.phase) == COLLECTING)
    matched = np.arange(len(estimate.time)) > (prior_given_up[-1] if len(prior_given_up) else -1)
    assert present(estimate.phase)[-1] == MATCHED
    error = (estimate.state - truth.state)[matched][:, model.POSITION]
    P = estimate.covariance[matched, 0]
    assert np.einsum("ni,ni->n", error, np.linalg.solve(P, error[..., None])[..., 0]).max() < FAR
    assert np.sqrt(np.trace(P[-1])) < far


@pytest.mark.parametrize("name", ["circle", "wiggle"])
def test_where_the_ranges_alone_do_not_determine_the_position_the_matched_gains_exclude_no_place(name: str):
    """A circle has rank 11: noise alone gives the triangle rank 13, but never a position below the distance. Wiggle has
    rank 13 and is weak. After a wrong guess constant gains run for 20 s, then matched ones whose P is true."""
    weak = records.scene(name, duration=30.0, range_rate=50.0)
    estimate = observed(weak, start=away([6e3, -8e3, 0.0], [0.0, 600.0, 800.0]))
    changes = np.flatnonzero(np.diff(present(estimate.phase)))
    assert present(estimate.phase)[changes].tolist() == [MATCHED, COLLECTING]
    assert weak.measurements.time[changes] == pytest.approx([1.3, 21.6], abs=0.2)
    assert distance(weak, estimate) < FAR
    assert np.sqrt(np.trace(estimate.covariance[-1, 0])) > 1.0


def test_constant_gains_have_one_phase(scene: Scene):
    assert set(present(scene.observe(Gains()).phase)) == {CONSTANT}


def test_one_outlier_is_no_loss(scene: Scene):
    """100 m too long, in the steady state or among the collected ranges: as if that range were missing."""
    z, plain = scene.measurements, observed(scene)
    late, early = z.range.copy(), z.range.copy()
    late[1250] += 100.0
    shaken = observed(scene, with_ranges(z, late))
    np.testing.assert_array_equal(shaken.phase, plain.phase)
    dropped = observed(scene, records.without_ranges(z, np.arange(len(z.range)) == 1250))
    np.testing.assert_allclose(shaken.state[-1], dropped.state[-1], rtol=1e-9, atol=1e-9)
    early[150] += 100.0
    collected = observed(scene, with_ranges(z, early))
    dropped = observed(scene, records.without_ranges(z, np.arange(len(z.range)) == 150))
    np.testing.assert_array_equal(collected.phase, dropped.phase)
    np.testing.assert_allclose(collected.state[-1], dropped.state[-1], rtol=1e-6, atol=1e-6)


def test_noise_of_twice_the_stated_size_is_overconfidence_and_no_loss(scene: Scene):
    """From 10 s on. Alarms go off, but the gains stay, and the position is as good as noise of that size allows."""
    z = scene.measurements
    extra = np.sqrt(3.0) * 0.1 * np.random.default_rng(1).standard_normal(len(z.range))
    estimate = observed(scene, with_ranges(z, z.range + np.where(z.range_time > 10.0, extra, 0.0)))
    assert set(present(estimate.phase)) == {MATCHED}
    assert range_fit.of(estimate).word == "overconfident"
    late = estimate.time > 15.0
    off, plain = ((run.state - scene.truth.state)[late, model.POSITION] for run in (estimate, observed(scene)))
    assert np.sqrt(np.mean(off**2)) < 4 * np.sqrt(np.mean(plain**2))


def biased(seed: int, duration: float = 20.0) -> Scene:
    """soft with a gyro bias of −1°/s about x, which makes an alarm with a mean NIS of 36 at 15.4 s."""
    p = preset.load("soft")
    effects = Effects(gyro_bias=(-math.radians(1.0), 0.0, 0.0))
    p = replace(p, sensors=replace(p.sensors, unmodelled=effects), duration=duration)
    inputs = record.truth_inputs(p)
    truth, z = record.simulated(inputs), record.measured(inputs, p.sensors, seed)
    start = cascade.start(p.guess, state=truth.state[0], rotation=truth.motion.rotation[0], world=p.world)
    return Scene(preset=p, truth=truth, measurements=z, start=start)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_bias_of_a_gyro_is_overconfidence_and_does_not_hand_over_to_constant_gains_which_would_follow_it(seed: int):
    scene = biased(seed)
    estimate = observed(scene)
    assert set(present(estimate.phase)) == {MATCHED}
    assert range_fit.of(estimate).word == "overconfident"
    off = (estimate.state - scene.truth.state)[3 * len(estimate.time) // 4 :, model.POSITION]
    assert np.sqrt(np.mean(np.sum(off**2, axis=1))) < 2.0  # 10 and 14 m with constant gains from 15.4 s on


def test_a_mild_alarm_is_the_same_in_the_kernel_and_in_the_reference():
    scene = biased(1, duration=16.0)
    fast, plain = observed(scene), reference.observe(scene.measurements, scene.start, scene.setting(GAINS))
    np.testing.assert_allclose(fast.state, plain.state, rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(fast.covariance[-1], plain.covariance[-1], rtol=1e-5)
    before, after = (np.trace(fast.covariance[np.searchsorted(fast.time, t), 0]) for t in (15.2, 15.6))
    assert after > 9 * before  # P was multiplied


def test_a_false_solution_begins_another_collection_and_arrives(scene: Scene):
    """The matched gains are put 50 m off with a σ of 1 cm, as one who believes in a mirror image."""
    z, setting = scene.measurements, scene.setting(GAINS)
    state = cascade.begin(sample(z, 0), scene.start, setting)
    phases = []
    for k in range(1, len(z.time)):
        state = cascade.step(state, sample(z, k))
        if k == 2000:
            state.arrays.x[4:7] += 50.0
            state.arrays.P[:] = 1e-4 * np.eye(13).ravel()
        phases.append(state.phase)
    changes = [phase for phase, before in zip(phases, [None, *phases], strict=False) if phase != before]
    assert changes == ["matched", "collecting", "matched"]
    assert np.linalg.norm(state.state[model.POSITION] - scene.truth.state[-1, model.POSITION]) < 1.0


def test_ranges_that_no_motion_explains_end_as_lost():
    """Ranges to an anchor that jumps 20 m back and forth every 8 s: three more collections, then constant gains."""
    scene = records.scene("paper-slow", duration=90.0, range_rate=50.0)
    z = scene.measurements
    jump = 20.0 * (np.floor(z.range_time / 8.0) % 2)
    phase = present(observed(scene, with_ranges(z, z.range + jump)).phase)
    begun = np.flatnonzero((phase[1:] == COLLECTING) & (phase[:-1] == MATCHED))
    assert len(begun) == layout.REOPENINGS
    assert phase[-1] == LOST
    assert np.all(phase[np.flatnonzero(phase == LOST)[0] :] == LOST)


def test_the_alarm_has_the_stated_rate():
    assert scipy.stats.chi2.sf(layout.ALARM, layout.ALARM_RANGES) == pytest.approx(1e-6, rel=1e-2)
    assert scipy.stats.chi2.sf(layout.GATE, 1) < 1e-8
    watch, outlier = acquisition.watch(1.0), False
    for square in [1.0] * 63 + [1e6]:
        watch, outlier = acquisition.watched(watch, np.sqrt(square), 1.0)
    assert outlier
    assert watch.total < layout.ALARM


@pytest.mark.parametrize("change", ["jump", "noise", "poor IMU"])
def test_the_reference_collects_starts_and_alarms_as_the_kernel_does(change: str):
    """The axes of the collection, Φ and the least squares are others: the closed form and rotations against products
    of `model.transition` and numpy's QR."""
    poor = change == "poor IMU"
    scene = records.scene("paper", duration=4.0, noise=Noise(gyro=0.3, accel=5.0, range=0.05) if poor else None)
    z, setting = scene.measurements, scene.setting(GAINS)
    error = 5.0 if change == "jump" else 0.2 * np.random.default_rng(1).standard_normal(len(z.range)) * (not poor)
    start = away([1e3, 0.0, 0.0], [0.0, 0.0, 0.0]) if poor else scene.start
    ranges = z.range + np.where(z.range_time > 2.0, error, 0.0)
    fast = cascade.observe(with_ranges(z, ranges), start, setting)
    slow = reference.observe(with_ranges(z, ranges), start, setting)
    np.testing.assert_array_equal(fast.phase, slow.phase)
    assert set(present(fast.phase)) == ({MATCHED} if change == "noise" else {COLLECTING, MATCHED})
    assert not poor or present(fast.phase)[-1] == MATCHED
    for name in ("state", "covariance", "innovation"):
        one, other = getattr(fast, name), getattr(slow, name)
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-7 * np.nanmax(np.abs(other)), err_msg=name)


def test_one_sample_at_a_time_goes_through_the_same_phases_with_the_same_bits():
    """A wrong guess, an alarm, constant gains, and matched ones that exclude no place."""
    scene = records.scene("paper", duration=4.0, noise=Noise(gyro=0.3, accel=5.0, range=0.05))
    z, setting, start = scene.measurements, scene.setting(GAINS), away([1e3, 0.0, 0.0], [0.0, 0.0, 0.0])
    batch = cascade.observe(z, start, setting)
    assert set(present(batch.phase)) == {COLLECTING, MATCHED}
    state = cascade.begin(sample(z, 0), start, setting)
    for k in range(1, len(z.time)):
        state = cascade.step(state, sample(z, k))
        np.testing.assert_array_equal(state.state, batch.state[k])
        assert state.phase == acquisition.PHASES[present(batch.phase)[k]]


def test_the_moments_are_the_integrals_that_they_are_said_to_be():
    """∫|D(s, r)|² dr against the sum over the ends r of all steps, with D from its definition."""
    rng = np.random.default_rng(4)
    accel, h, n = rng.standard_normal((400, 3)) - np.array([0, 0, 9.8]), 0.005, 400
    collection = acquisition.collection()
    for a in accel:
        collection = acquisition.moved(collection, np.eye(3), a, h, gravity_norm=9.81, form="derived")
    velocity = np.concatenate([np.zeros((1, 3)), np.cumsum(h * accel, axis=0)])
    steps = h * velocity[:-1] + h**2 / 2 * accel
    position = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    rest = h * (n - np.arange(n + 1))[:, None]
    D, W = position[-1] - position - rest * velocity, velocity[-1] - velocity
    sums = [h * np.sum(u[1:] * w[1:]) for u, w in ((D, D), (D, W), (W, W))]
    np.testing.assert_allclose(collection.squares, sums, rtol=1e-9)
    np.testing.assert_allclose(collection.vectors, [h * D[1:].sum(0), h * W[1:].sum(0)], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(collection.response[model.POSITION], position[-1], rtol=1e-12)


def sample(z: Measurements, k: int) -> Sample:
    before = z.time[k - 1] if k > 0 else -np.inf
    due = (z.range_time > before) & (z.range_time <= z.time[k])
    return Sample(z.time[k], z.gyro[k], z.accel[k], z.mag[k], z.range_time[due], z.range[due])
