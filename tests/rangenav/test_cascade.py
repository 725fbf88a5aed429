"""The cascade as a whole: what converges, how far, from where, with which ranges, and that step() is observe()."""

import dataclasses

import numpy as np
import pytest
from msgspec.structs import replace
from scipy.spatial.transform import Rotation

from rangenav import cascade, model, record, reference
from rangenav.attitude import SCHEDULED, AttitudeGains
from rangenav.cascade import ObserverConfig, Sample, Start
from rangenav.gains import Gains, Guess
from rangenav.riccati import RiccatiGains
from rangenav.sensors import Measurements
from tests.support import records
from tests.support.present import present

MATCHED = Gains(mode="noise-matched")


def test_derived_observer_started_at_the_truth_stays_within_a_millimetre():
    """Paper's path, 1 kHz, 10 s, no noise: what is left is the splitting's h² error."""
    scene = records.scene(
        "paper", duration=10.0, imu_rate=1000.0, range_rate=1000.0, noise=records.SILENT, guess="truth"
    )
    assert scene.errors(scene.observe()).position.max() < 1e-3


def test_from_nothing_it_is_within_a_centimetre_and_a_degree_after_ten_seconds():
    """x̂(0) = 0, R̂(0) = I while R(0) = exp(π/2 [e2]x), as in the paper's scenario."""
    scene = records.scene("paper", duration=10.0, imu_rate=1000.0, range_rate=1000.0, noise=records.SILENT)
    np.testing.assert_allclose(scene.start.rotation, np.eye(3), atol=1e-15)
    assert not scene.start.state.any()
    errors = scene.errors(scene.observe())
    assert errors.position[-1] < 0.01
    assert np.degrees(errors.attitude[-1]) < 1.0


@pytest.mark.parametrize(("name", "metres"), [("paper", 1.0), ("paper-slow", 10.0)])
def test_printed_model_leaves_even_the_truth_by_metres(name: str, metres: float):
    scene = records.scene(name, duration=10.0, imu_rate=1000.0, range_rate=1000.0, noise=records.SILENT, guess="truth")
    errors = scene.errors(scene.observe(form="printed"))
    assert errors.position[len(errors.position) // 2 :].min() > metres / 4
    assert errors.position.max() > metres


def test_peaking_is_not_instability():
    """From x̂ = 0 the position error first grows well past its start, then converges: stable is not monotone."""
    scene = records.scene("paper-slow", duration=20.0, range_rate=50.0)
    errors = scene.errors(scene.observe())
    assert errors.position.max() > 4 * errors.position[0]
    assert errors.position[-1000:].max() < 0.3


@pytest.mark.parametrize("gains", [Gains(), Gains(mode="noise-matched", attitude=SCHEDULED)], ids=["paper", "ours"])
@pytest.mark.parametrize(
    ("range_rate", "mag_rate", "lost"), [(200.0, 200.0, 0.0), (200.0, 50.0, 0.4), (333.0, 57.0, 0.2)]
)
def test_one_sample_at_a_time_gives_the_same_numbers(gains: Gains, range_rate: float, mag_rate: float, lost: float):
    scene = records.scene("paper-slow", duration=2.0, range_rate=range_rate, mag_rate=mag_rate)
    rng = np.random.default_rng(5)
    z = records.without_ranges(scene.measurements, rng.random(len(scene.measurements.range)) < lost)
    setting = scene.setting(gains)
    batch = cascade.observe(z, scene.start, setting)
    symmetric = cascade.ranges_at_imu_rate(z, setting.sensors)
    assert symmetric == (range_rate == 200.0)
    state = cascade.begin(sample(z, 0), scene.start, setting, symmetric=symmetric)
    for k in range(1, len(z.time)):
        state = cascade.step(state, sample(z, k))
        np.testing.assert_array_equal(state.state, batch.state[k])
        np.testing.assert_array_equal(state.rotation, batch.rotation[k])
        assert state.k1 == present(batch.k1)[k]
    np.testing.assert_array_equal(state.std, batch.std[-1])


def sample(z: Measurements, k: int) -> Sample:
    before = z.time[k - 1] if k > 0 else -np.inf
    due = (z.range_time > before) & (z.range_time <= z.time[k])
    return Sample(z.time[k], z.gyro[k], z.accel[k], z.mag[k], z.range_time[due], z.range[due])


@pytest.mark.parametrize(("range_rate", "mag_rate"), [(200.0, 200.0), (333.0, 57.0)])
@pytest.mark.parametrize(
    "attitude", [AttitudeGains(), AttitudeGains(k1=40.0), SCHEDULED], ids=["constant", "large turns", "scheduled"]
)
def test_many_starts_at_once_are_each_what_it_is_alone(attitude: AttitudeGains, range_rate: float, mag_rate: float):
    """Nothing flows back from the attitude into x̂, so one x̂ serves all starts, to the last bit."""
    scene = records.scene("paper-slow", duration=2.0, range_rate=range_rate, mag_rate=mag_rate)
    setting = scene.setting(Gains(attitude=attitude))
    rotations = Rotation.random(5, np.random.default_rng(4)).as_matrix()
    together = cascade.attitudes(scene.measurements, scene.start, setting, rotations=rotations)
    truth = scene.truth.motion.rotation
    shared = cascade.observe(scene.measurements, scene.start, setting)
    angles = cascade.attitude_errors(scene.measurements, shared, setting, rotations=rotations, truth=truth)
    for rotation, computed, angle in zip(rotations, together, angles, strict=True):
        alone = cascade.observe(scene.measurements, Start(state=scene.start.state, rotation=rotation), setting)
        np.testing.assert_array_equal(computed, alone.rotation)
        np.testing.assert_array_equal(angle, scene.errors(alone).attitude)


def test_the_last_sample_above_a_limit_is_that_of_the_angles_whether_or_not_they_are_computed():
    """Limits that are an angle of one of the filters, where no bound of the cosine decides, and their neighbours."""
    scene = records.scene("paper-slow", duration=4.0)
    z, setting, truth, rng = scene.measurements, scene.setting(), scene.truth.motion.rotation, np.random.default_rng(6)
    rotations, estimate = Rotation.random(19, rng).as_matrix(), scene.observe()
    rotations[7], rotations[18] = truth[0], 40 * truth[0]  # no error at the start; no rotation, and soon no number
    angles = cascade.attitude_errors(z, estimate, setting, rotations=rotations, truth=truth)
    inputs = cascade.attitude_inputs(z, estimate, setting, truth=truth)
    assert np.isnan(angles[18, -1])
    exact = [angles[k % 18, place] for k, place in enumerate(rng.integers(1, angles.shape[1], 40))]
    for limit in (0.0, *exact, *np.nextafter(exact[:5], 4.0), np.pi):
        chosen = rng.random(len(z.time)) < rng.choice([0.0, 0.1, 1.0])
        some, above = cascade.attitude_settling(inputs, rotations=rotations, chosen=chosen, limit=float(limit))
        np.testing.assert_array_equal(some, angles[:, chosen])
        expected = [max(np.flatnonzero(~(one < limit)), default=-1) + 1 for one in angles]
        np.testing.assert_array_equal(above, expected)


@pytest.mark.parametrize(("range_rate", "mag_rate"), [(200.0, 200.0), (333.0, 57.0)])
@pytest.mark.parametrize(
    "attitude", [AttitudeGains(), AttitudeGains(k1=40.0), SCHEDULED], ids=["constant", "large turns", "scheduled"]
)
def test_runs_side_by_side_are_each_what_it_is_alone(attitude: AttitudeGains, range_rate: float, mag_rate: float):
    """Each with its own noise, start and gains, to the last bit; nine runs fill one vector and begin another."""
    scenes = [
        records.scene("paper-slow", duration=0.5, range_rate=range_rate, mag_rate=mag_rate, seed=k) for k in range(9)
    ]
    rotations = Rotation.random(9, np.random.default_rng(6)).as_matrix()
    starts = [Start(state=scene.truth.state[0] * k, rotation=rotations[k]) for k, scene in enumerate(scenes)]
    gains = [
        Gains(attitude=replace(attitude, k1=attitude.k1 * (1 + k / 8)), riccati=RiccatiGains(q=10.0 ** (k - 3)))
        for k in range(9)
    ]
    settings = [scene.setting(one) for scene, one in zip(scenes, gains, strict=True)]
    together = cascade.observe_each([scene.measurements for scene in scenes], starts, settings)
    for scene, start, setting, computed in zip(scenes, starts, settings, together, strict=True):
        assert_equal(computed, cascade.observe(scene.measurements, start, setting))


def test_runs_that_share_too_little_to_stand_side_by_side_are_made_alone():
    """Other stamps, a magnetometer that fails in one run, and noise-matched gains."""
    usual = records.scene("paper-slow", duration=0.5)
    z = usual.measurements
    failed = replace_arrays(z, mag=np.where(np.arange(len(z.time))[:, None] == 30, np.nan, z.mag))
    later = replace_arrays(z, time=z.time + 1.0, range_time=z.range_time + 1.0)
    for others in ([z, failed, later], [z, z, z]):
        settings = [usual.setting(), usual.setting(), usual.setting(MATCHED)]
        together = cascade.observe_each(others, [usual.start] * 3, settings)
        for one, setting, computed in zip(others, settings, together, strict=True):
            assert_equal(computed, cascade.observe(one, usual.start, setting))


def replace_arrays(z: Measurements, **arrays: np.ndarray) -> Measurements:
    return dataclasses.replace(z, **arrays)


def assert_equal(computed: cascade.Estimate, expected: cascade.Estimate) -> None:
    """All arrays, to the last bit."""
    for field in dataclasses.fields(expected):
        np.testing.assert_array_equal(getattr(computed, field.name), getattr(expected, field.name), err_msg=field.name)


def test_each_run_needs_a_record_a_start_and_a_setting():
    scene = records.scene("paper-slow", duration=0.5)
    with pytest.raises(ValueError, match="each run needs a record, a start and a setting, got 1, 2, 1"):
        cascade.observe_each([scene.measurements], [scene.start] * 2, [scene.setting()])


def test_many_starts_need_a_magnetometer_from_the_first_sample():
    scene = records.scene("paper-slow", duration=1.0)
    scene.measurements.mag[0, 1] = np.nan
    with pytest.raises(ValueError, match="many starts need a magnetometer sample at the first IMU sample"):
        cascade.attitudes(scene.measurements, scene.start, scene.setting(), rotations=np.eye(3)[None])


def test_a_schedule_halves_the_steady_attitude_error_and_a_constant_gain_stays_as_it_is():
    """All sensors at 200 Hz, noise-matched, last half of 20 s, median of ten seeds; constant k1 = 4 gives 0.73°."""
    steady = {}
    for attitude in (AttitudeGains(), SCHEDULED):
        computed = []
        for seed in range(10):
            scene = records.scene("paper", duration=20.0, seed=seed)
            estimate = scene.observe(Gains(mode="noise-matched", attitude=attitude))
            computed.append(np.sqrt(np.mean(scene.errors(estimate).attitude[2000:] ** 2)))
            if attitude.schedule is None:
                assert np.all(estimate.k1 == attitude.k1)
            else:
                assert present(estimate.k1)[0] > 7.9
                assert np.median(present(estimate.k1)[3000:]) < 0.6  # from 8 down to 0.5, and a little noise
        steady[attitude] = np.degrees(np.median(computed))
    assert steady[SCHEDULED] < min(0.4, steady[AttitudeGains()] / 2)


def test_step_leaves_the_state_it_was_given():
    scene = records.scene("paper-slow", duration=1.0)
    z = scene.measurements
    before = cascade.begin(sample(z, 0), scene.start, scene.setting())
    x = before.state.copy()
    first, again = cascade.step(before, sample(z, 1)), cascade.step(before, sample(z, 1))
    np.testing.assert_array_equal(before.state, x)
    np.testing.assert_array_equal(first.state, again.state)


def test_drop_outs_and_a_burst_do_not_stop_it():
    scene = records.scene("paper", duration=20.0, range_rate=50.0)
    z = scene.measurements
    lost = np.random.default_rng(3).random(len(z.range)) < 0.3
    lost |= (z.range_time > 12.0) & (z.range_time < 13.0)
    estimate = cascade.observe(records.without_ranges(z, lost), scene.start, scene.setting())
    assert scene.errors(estimate).position[-1000:].max() < 0.3


def test_noise_matched_gains_do_not_bias_the_output():
    """|mean(ξ̂1 − ξ1)| < .003 m² on the paper's path; the uncorrected ½σ² would be .005."""
    differences = []
    for seed in range(5):
        scene = records.scene("paper", duration=20.0, seed=seed)
        estimate = scene.observe(Gains(mode="noise-matched"))
        differences.append((estimate.state - scene.truth.state)[2000:, 0].mean())
    assert abs(np.mean(differences)) < 0.003


def test_noise_matched_beats_constant_gains_in_steady_state():
    scene = records.scene("paper-slow", duration=20.0)
    steady = [
        np.sqrt(np.mean(scene.errors(scene.observe(replace(Gains(), mode=mode))).position[2000:] ** 2))
        for mode in ("constant", "noise-matched")
    ]
    assert steady[1] < min(steady[0], 0.09)


@pytest.mark.parametrize(("name", "metres"), [("paper", 0.045), ("paper-slow", 0.075)])
def test_noise_matched_gains_reach_this_position(name: str, metres: float):
    """Median over ten seeds of the RMS over the last half of 20 s, ranges at 200 Hz, from x̂ = 0."""
    steady = []
    for seed in range(10):
        scene = records.scene(name, duration=20.0, seed=seed)
        steady.append(np.sqrt(np.mean(scene.errors(scene.observe(MATCHED)).position[2000:] ** 2)))
    assert np.median(steady) < metres


def test_noise_matched_gains_with_a_low_k1_reach_this_attitude():
    """k1 = .5, the paper's path: below .4° over the last half of 20 s (median of ten seeds); k1 = 4 gives .73°."""
    gains, steady = replace(MATCHED, attitude=replace(MATCHED.attitude, k1=0.5)), []
    for seed in range(10):
        scene = records.scene("paper", duration=20.0, seed=seed)
        steady.append(np.sqrt(np.mean(scene.errors(scene.observe(gains)).attitude[2000:] ** 2)))
    assert np.degrees(np.median(steady)) < 0.4


def test_noise_matched_gains_converge_from_anywhere():
    """Thirty starts: positions and velocities of 10 m and 10 m/s (1 σ on each axis), gravity in any direction."""
    rng = np.random.default_rng(7)
    for seed in range(30):
        scene = records.scene("paper-slow", duration=20.0, seed=seed)
        gravity = rng.standard_normal(3)
        gravity *= 9.81 / np.linalg.norm(gravity)
        state = model.lift(10 * rng.standard_normal(3), 10 * rng.standard_normal(3), gravity)
        estimate = cascade.observe(scene.measurements, Start(state=state, rotation=np.eye(3)), scene.setting(MATCHED))
        assert scene.errors(estimate).position[3000:].max() < 0.5


def test_noise_matched_position_errors_are_as_large_as_claimed():
    """Mean of eᵀP⁻¹e/3 over the last half of ten records: the reminder must not make it too sure."""
    ratios = []
    for seed in range(10):
        scene = records.scene("paper-slow", duration=20.0, seed=seed)
        estimate = scene.observe(MATCHED)
        error = (estimate.state - scene.truth.state)[2000:, model.POSITION]
        weighted = np.linalg.solve(estimate.covariance[2000:, 0], error[..., None])[..., 0]
        ratios.append(np.mean(np.sum(error * weighted, axis=-1)) / 3)
    assert 0.4 < np.mean(ratios) < 1.6  # errors within a record hang together


def test_the_riccati_observer_does_not_know_the_attitude():
    """A cascade: x̂ is the same to the last bit whatever R̂(0)."""
    scene = records.scene("paper-slow", duration=2.0)
    other = Start(state=scene.start.state, rotation=np.diag([1.0, -1.0, -1.0]))
    first = cascade.observe(scene.measurements, scene.start, scene.setting())
    second = cascade.observe(scene.measurements, other, scene.setting())
    np.testing.assert_array_equal(first.state, second.state)
    assert np.abs(first.rotation[0] - second.rotation[0]).max() > 1


def test_two_runs_are_bit_equal():
    scene = records.scene("paper-slow", duration=2.0, range_rate=77.0)
    np.testing.assert_array_equal(scene.observe().state, scene.observe().state)
    again = records.scene("paper-slow", duration=2.0, range_rate=77.0)
    np.testing.assert_array_equal(again.measurements.range, scene.measurements.range)


def test_the_turned_frame_stays_a_rotation_over_many_steps():
    scene = records.scene("paper-slow", duration=300.0)
    rotation = scene.observe().rotation[-1]
    assert np.abs(rotation.T @ rotation - np.eye(3)).max() < 1e-14


def test_guesses_mean_what_they_say():
    scene = records.scene("circle", duration=2.0)
    truth, R, world = scene.truth.state[0], scene.truth.motion.rotation[0], scene.preset.world
    offset = Guess(state="offset", position_offset=(1.0, 2.0, 3.0), attitude_axis=(0.0, 0.0, 2.0), attitude_angle=0.5)
    start = cascade.start(offset, state=truth, rotation=R, world=world)
    position = R @ start.state[model.POSITION] - R @ truth[model.POSITION]
    np.testing.assert_allclose(position, [1, 2, 3], atol=1e-12)
    p, v, g = (start.state[block] for block in (model.POSITION, model.VELOCITY, model.GRAVITY))
    np.testing.assert_allclose(start.state[:4], [p @ p / 2, p @ v, v @ v + p @ g, 3 * v @ g], rtol=1e-12, atol=1e-12)
    error = R @ start.rotation.T  # R̃ = exp(angle · axis)
    np.testing.assert_allclose(error[:2, :2], [[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]], atol=1e-14)
    np.testing.assert_array_equal(
        cascade.start(Guess(state="truth"), state=truth, rotation=R, world=world).state, truth
    )


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"time": -1.0}, "time must increase"),
        ({"gyro": np.array([np.nan, 0, 0])}, "must be finite"),
        ({"mag": np.array([np.inf, 0, 0])}, "mag must be finite"),
        ({"range": np.array([np.inf]), "range_time": np.array([0.005])}, "must be finite"),
        ({"range": np.array([1.0]), "range_time": np.array([0.1])}, "range_time must increase"),
        ({"range": np.array([1.0]), "range_time": np.array([0.0])}, "range_time must increase"),
    ],
)
def test_a_bad_sample_gets_a_sentence(change: dict, sentence: str):
    scene = records.scene("paper-slow", duration=1.0)
    z = scene.measurements
    state = cascade.begin(sample(z, 0), scene.start, scene.setting())
    with pytest.raises(ValueError, match=sentence):
        cascade.step(state, sample(z, 1)._replace(**change))


def test_a_partly_missing_magnetometer_sample_counts_as_missing():
    scene = records.scene("paper-slow", duration=1.0)
    z = scene.measurements
    estimates = []
    for hole in (slice(None), slice(1, 2)):
        mag = z.mag.copy()
        mag[50, hole] = np.nan
        holed = Measurements(time=z.time, gyro=z.gyro, accel=z.accel, mag=mag, range_time=z.range_time, range=z.range)
        estimates.append(cascade.observe(holed, scene.start, scene.setting()).rotation)
    assert np.isfinite(estimates[1]).all()
    np.testing.assert_array_equal(estimates[0], estimates[1])


def test_ranges_older_than_the_imu_record_are_left_out_and_one_at_its_start_is_used():
    scene = records.scene("paper-slow", duration=2.0, range_rate=50.0)
    z = scene.measurements
    late = Measurements(
        time=z.time[8:], gyro=z.gyro[8:], accel=z.accel[8:], mag=z.mag[8:], range_time=z.range_time, range=z.range
    )
    cut = records.without_ranges(late, z.range_time < z.time[8])
    whole, exact = (cascade.observe(record_, scene.start, scene.setting()).state for record_ in (late, cut))
    np.testing.assert_array_equal(whole, exact)
    witness = reference.observe(late, scene.start, scene.setting()).state
    np.testing.assert_allclose(whole, witness, atol=1e-8 * np.abs(witness).max())


@pytest.mark.parametrize("range_rate", [199.0, 200.0])
def test_normalised_innovations_of_matched_noise_have_variance_one_at_any_rate(range_rate: float):
    """Their variance is P₁₁ + R also where a correction is halved: in the symmetric scheme nothing else changes."""
    scene = records.scene("paper-slow", duration=40.0, range_rate=range_rate)
    matched = scene.observe(Gains(mode="noise-matched")).innovation[len(scene.measurements.range) // 2 :]
    assert np.mean(matched[:, 0] ** 2 / matched[:, 1]) == pytest.approx(1.0, abs=0.15)
    constant = scene.observe().innovation[len(scene.measurements.range) // 2 :]
    assert constant[:, 1].mean() == pytest.approx(range_rate / 5e3, rel=0.3)  # R = 1/(q T), and a little of P


def test_a_bad_record_is_named_by_its_sample():
    scene = records.scene("paper-slow", duration=1.0)
    accel = scene.measurements.accel.copy()
    accel[17, 1] = np.inf
    z = scene.measurements
    broken = Measurements(time=z.time, gyro=z.gyro, accel=accel, mag=z.mag, range_time=z.range_time, range=z.range)
    with pytest.raises(ValueError, match=r"accel must be finite: broken at sample 17"):
        cascade.observe(broken, scene.start, scene.setting())


def test_estimated_position_is_seen_from_the_anchor():
    scene = records.scene("circle", duration=2.0, guess="truth")
    estimate = scene.observe()
    world = scene.preset.world
    exact = cascade.Estimate(
        time=estimate.time,
        state=scene.truth.state,
        covariance=estimate.covariance,
        xi_variance=estimate.xi_variance,
        rotation=scene.truth.motion.rotation,
        k1=estimate.k1,
        innovation=estimate.innovation,
    )
    np.testing.assert_allclose(exact.position(world), scene.truth.motion.position, atol=1e-12)


def test_a_hovering_covariance_is_called_diverged():
    """Hover is unobservable: with strong process noise the observer's own σ passes 100 m and the summary says so."""
    scene = records.scene("hover", duration=120.0)
    gains = replace(Gains(), riccati=replace(Gains().riccati, v=replace(Gains().riccati.v, velocity=100.0)))
    estimate = scene.observe(gains)
    assert record.summarise(estimate, scene.measurements, scene.errors(estimate), 1.0, range_sigma=0.1).diverged
    calm = records.scene("paper", duration=10.0)
    seen = calm.observe()
    assert not record.summarise(seen, calm.measurements, calm.errors(seen), 1.0, range_sigma=0.1).diverged


def test_settling_is_counted_from_the_last_time_above_the_limit():
    time = np.arange(5.0)
    assert record.settled(time, np.array([1, 0.1, 1, 0.1, 0.1]), 0.3) == 3.0
    assert record.settled(time, np.array([1, 0.1, 1, 0.1, 0.4]), 0.3) is None
    assert record.settled(time, np.array([0.1] * 5), 0.3) == 0.0
    assert record.settled(time, np.array([0.1] * 4 + [np.nan]), 0.3) is None


@pytest.mark.parametrize(
    ("duration", "since", "settled"), [(7.28, 7.18, False), (20.0, 18.1, False), (20.0, 17.9, True)]
)
def test_an_error_that_is_small_only_in_the_last_tenth_of_a_run_has_not_settled(duration, since, settled):
    time = np.linspace(0, duration, 2001)
    found = record.settled(time, np.where(time < since, 1.0, 0.1), 0.3)
    assert found == (pytest.approx(since, abs=duration / 2000) if settled else None)


def test_setting_carries_the_model_form():
    scene = records.scene("paper", duration=1.0)
    derived = cascade.parameters(scene.setting(), symmetric=True)
    printed = cascade.parameters(ObserverConfig(**{**vars(scene.setting()), "form": "printed"}), symmetric=True)
    assert derived.b4 == pytest.approx(3 * 9.81**2)
    assert printed.b4 == pytest.approx(9.81**2)
