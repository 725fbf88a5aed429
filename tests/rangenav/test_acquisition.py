"""Noise-matched gains start without a prior, notice a false solution, and are not shaken by an outlier."""

from dataclasses import replace as with_fields

import numpy as np
import pytest
import scipy.stats
from msgspec.structs import replace

from rangenav import acquisition, cascade, model, reference
from rangenav.acquisition import COLLECTING, CONSTANT, LOST, MATCHED
from rangenav.cascade import Estimate, ObserverConfig, Sample, Start
from rangenav.gains import Gains
from rangenav.kernels import layout
from rangenav.sensors import Measurements
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


def test_far_starts_end_where_near_ones_do(scene: Scene):
    """The matched gains use neither x̂(0) nor P(0): from 10 km and 1 km/s they are those from x̂ = 0."""
    near = observed(scene)
    body = (np.array([6e3, -8e3, 0.0]), np.array([0.0, 600.0, 800.0]), np.array([0.0, 0.0, 9.81]))
    far = observed(scene, start=Start(state=model.lift(*body), rotation=np.diag([-1.0, -1.0, 1.0])))
    assert np.linalg.norm(far.state[0, model.POSITION]) > 9e3
    matched = present(near.phase) == MATCHED
    np.testing.assert_array_equal(near.phase, far.phase)
    np.testing.assert_array_equal(near.state[matched], far.state[matched])
    assert distance(scene, far) < FAR


@pytest.mark.parametrize("away", [30.0, 1000.0])
def test_the_covariance_is_true_with_a_far_anchor(away: float):
    scene = records.scene("lissajous", duration=30.0, range_rate=50.0)
    world = replace(scene.preset.world, anchor=(away, 0.0, 0.0))
    moved = replace(scene.preset, world=world)
    inputs = records.record.truth_inputs(moved)
    truth, z = records.record.simulated(inputs), records.record.drawn(inputs, moved.sensors, 0)
    estimate = cascade.observe(z, scene.start, ObserverConfig(world=world, sensors=moved.sensors, gains=GAINS))
    matched = present(estimate.phase) == MATCHED
    assert matched[-1]
    error = (estimate.state - truth.state)[matched][:, model.POSITION]
    P = estimate.covariance[matched, 0]
    assert np.einsum("ni,ni->n", error, np.linalg.solve(P, error[..., None])[..., 0]).max() < FAR
    assert np.sqrt(np.trace(P[-1])) < away


def test_a_blind_motion_keeps_constant_gains():
    """A circle has rank 11: noise alone gives the triangle rank 13, but never a position below the distance."""
    circle = records.scene("circle", duration=60.0, range_rate=50.0)
    assert set(present(observed(circle).phase)) == {COLLECTING}


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


def test_a_false_solution_begins_another_collection_and_arrives(scene: Scene):
    """The matched gains are put 50 m off with a σ of 1 cm, as one who believes in a mirror image."""
    z, setting = scene.measurements, scene.setting(GAINS)
    state = cascade.begin(sample(z, 0), scene.start, setting)
    phases = []
    for k in range(1, len(z.time)):
        state = cascade.step(state, sample(z, k))
        if state.phase == "matched" and "matched" not in phases:
            state.arrays.x[4:7] += 50.0
            state.arrays.P[:] = 1e-4 * np.eye(13).ravel()
        phases.append(state.phase)
    changes = [phase for phase, before in zip(phases, [None, *phases], strict=False) if phase != before]
    assert changes[:3] == ["collecting", "matched", "collecting"]
    assert changes[-1] == "matched"
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


def test_the_reference_collects_starts_and_alarms_as_the_kernel_does():
    """The axes of the collection, Φ and the least squares are others: the closed form and rotations against products
    of `model.transition` and numpy's QR."""
    scene = records.scene("paper", duration=4.0)
    z, setting = scene.measurements, scene.setting(GAINS)
    ranges = z.range + np.where(z.range_time > 2.0, 5.0, 0.0)
    fast = cascade.observe(with_ranges(z, ranges), scene.start, setting)
    slow = reference.observe(with_ranges(z, ranges), scene.start, setting)
    np.testing.assert_array_equal(fast.phase, slow.phase)
    phase = present(fast.phase)
    assert {COLLECTING, MATCHED} == set(phase)
    assert np.sum((phase[:-1] == MATCHED) & (phase[1:] == COLLECTING)) >= 1
    for name in ("state", "covariance", "innovation"):
        one, other = getattr(fast, name), getattr(slow, name)
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-7 * np.nanmax(np.abs(other)), err_msg=name)


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
