"""What sensors do beyond the paper: each effect by its formula, its statistics, its own stream, and what it costs."""

import math

import numpy as np
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace
from scipy.spatial.transform import Rotation

from rangenav import analysis, cascade, motion, preset, record, reference, report, sensors, so3
from rangenav.sensors import MODELLED, Effects, Noise, Sensors, antenna, sensor_sets
from rangenav.signals import Flown, Multisine, Tone
from tests.support.effect_examples import EVERYTHING, example
from tests.support.records import SILENT
from tests.support.refusals import exactly

pytestmark = pytest.mark.slow


SLOW = preset.load("paper-slow")
ONE_IN_A_MILLION = 1e-6
ARRAYS = ("time", "gyro", "accel", "mag", "range_time", "range")
ROWS = sensors.effects.rows()
NAMES = tuple(row.name for row in ROWS.values() if row.name)


def measured(*, seed=0, noise=SILENT, duration=20.0, rate=200.0, **effects):
    """The slow path's record with some effects on."""
    chosen = Sensors(range_rate=rate, noise=noise, unmodelled=Effects(**effects))
    return record.measured(record.truth_inputs(replace(SLOW, duration=duration)), chosen, seed)


def assert_same(a, b, *names):
    for name in names:
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)


def limits_of_a_share(probability, count):
    """Between which numbers of hits a share may lie, but for one seed in a million."""
    return scipy.stats.binom.ppf([ONE_IN_A_MILLION / 2, 1 - ONE_IN_A_MILLION / 2], count, probability)


@pytest.mark.parametrize(
    ("effect", "sensor", "value"),
    [
        ("gyro_bias", "gyro", (0.01, -0.02, 0.5)),
        ("accel_bias", "accel", (0.1, 2.0, -0.3)),
        ("range_bias", "range", -0.7),
    ],
)
def test_a_bias_is_added_to_its_sensor_and_to_no_other(effect, sensor, value):
    before, after = measured(noise=Noise()), measured(noise=Noise(), **{effect: value})
    assert_same(before, after, *({*ARRAYS} - {sensor}))
    difference = getattr(after, sensor) - getattr(before, sensor)
    np.testing.assert_allclose(difference, np.broadcast_to(value, difference.shape), atol=1e-14)  # units, rounded


@pytest.mark.parametrize(
    "effects",
    [
        {"outlier_probability": 0.2},
        {"dropout_probability": 0.3},
        {"burst_start": 3.0, "burst_length": 4.0},
        {"lever_arm": (0.1, 0.2, 0.3)},
    ],
)
def test_what_happens_to_ranges_leaves_imu_and_magnetometer_to_the_last_bit(effects):
    assert_same(measured(noise=Noise()), measured(noise=Noise(), **effects), "time", "gyro", "accel", "mag")


def test_outliers_and_drop_outs_do_not_disturb_each_others_draws_nor_the_noise():
    both = measured(noise=Noise(), outlier_probability=0.2, dropout_probability=0.3)
    clean, struck = measured(noise=Noise()), measured(noise=Noise(), outlier_probability=0.2)
    thinned = measured(noise=Noise(), dropout_probability=0.3)
    kept = np.isin(clean.range_time, thinned.range_time)
    assert_same(both, thinned, "range_time")
    np.testing.assert_array_equal(thinned.range, clean.range[kept])
    np.testing.assert_array_equal(both.range, struck.range[kept])
    spared = struck.range == clean.range
    low, high = limits_of_a_share(0.8, len(spared))
    assert low < spared.sum() < high


def test_more_of_an_effect_keeps_what_less_of_it_did():
    """A slider moved a little changes a little: outliers stay outliers, and what was lost stays lost."""
    clean = measured()
    few, many = (measured(outlier_probability=share).range - clean.range for share in (0.1, 0.3))
    np.testing.assert_array_equal(few[few > 0], many[few > 0])
    thin, thinner = (measured(dropout_probability=share).range_time for share in (0.1, 0.3))
    assert np.isin(thinner, thin).all()
    once, twice = (measured(outlier_probability=0.3, outlier_size=size).range - clean.range for size in (1.0, 2.0))
    np.testing.assert_allclose(twice, 2 * once, atol=1e-14)


def test_a_longer_flight_begins_as_the_shorter_one_did():
    short, long = (
        measured(noise=Noise(), duration=duration, outlier_probability=0.2, dropout_probability=0.3, range_bias=0.1)
        for duration in (10.0, 20.0)
    )
    begun = long.range_time <= 10.0
    np.testing.assert_array_equal(short.range_time, long.range_time[begun])
    np.testing.assert_array_equal(short.range, long.range[begun])


def test_outliers_are_their_share_independent_and_exponential_and_never_negative():
    p, size = 0.25, 3.0
    excess = measured(duration=60.0, outlier_probability=p, outlier_size=size).range - measured(duration=60.0).range
    hit = excess > 1e-12  # of a mean of 3 m the smallest of 3000 is about a millimetre
    low, high = limits_of_a_share(p, len(hit))
    assert low < hit.sum() < high
    assert np.abs(excess[~hit]).max() == 0
    assert scipy.stats.kstest(excess[hit] / size, "expon").pvalue > ONE_IN_A_MILLION
    pairs = np.sum(hit[1:] & hit[:-1])  # of neighbours; were hits to come in runs there would be more
    assert abs(pairs - p**2 * len(hit)) < 5 * math.sqrt(p**2 * len(hit) * (1 + 2 * p))  # 5 σ of a sum of such pairs


def test_drop_outs_are_their_share_and_independent():
    p = 0.35
    all_times, arrived = measured(duration=60.0).range_time, measured(duration=60.0, dropout_probability=p).range_time
    lost = ~np.isin(all_times, arrived)
    low, high = limits_of_a_share(p, len(lost))
    assert low < lost.sum() < high
    runs = np.diff(np.flatnonzero(np.diff(np.concatenate([[0], lost, [0]]))))[::2]
    longest = np.bincount(runs, minlength=4)[1:4]  # runs of k losses: geometric, (1 − p) p^(k−1)
    expected = len(runs) * (1 - p) * p ** np.arange(3)
    chi2 = np.sum((longest - expected) ** 2 / expected)
    assert chi2 < scipy.stats.chi2.isf(ONE_IN_A_MILLION, 3)


def test_a_burst_silences_exactly_its_span_and_beyond_the_flight_nothing():
    clean, silent = measured(noise=Noise()), measured(noise=Noise(), burst_start=3.0, burst_length=4.5)
    kept = (clean.range_time < 3.0) | (clean.range_time >= 7.5)
    np.testing.assert_array_equal(silent.range_time, clean.range_time[kept])
    np.testing.assert_array_equal(silent.range, clean.range[kept])
    assert_same(clean, measured(noise=Noise(), burst_start=500.0, burst_length=100.0), *ARRAYS)


TUMBLING = Multisine(
    tones=(
        Tone(axis="x", amplitude=3.0, frequency=3.0),
        Tone(axis="y", amplitude=2.0, frequency=2.0, phase=1.0),
        Tone(axis="z", amplitude=1.0, frequency=3.0, phase=0.3),
    )
)


def flight(turning, *, rate, initial=(0.3, -0.2, 0.9), duration=5.0):
    return motion.simulate(SLOW.path, turning, world=SLOW.world, initial_rotation=initial, duration=duration, rate=rate)


@pytest.mark.parametrize("range_rate", [50.0, 33.3, 87.7])
def test_a_lever_arm_moves_the_range_to_the_antenna(range_rate):
    """Against scipy's Rotation, which knows where a body is that turns at a constant rate: exact but for rounding."""
    arm, turning, initial = (0.4, -0.3, 0.2), (1.0, -2.0, 0.5), (0.3, -0.2, 0.9)
    course = replace(SLOW, angular_velocity=Multisine(offset=turning), initial_rotation=initial, duration=9.0)
    chosen = Sensors(imu_rate=100.0, mag_rate=100.0, range_rate=range_rate, noise=SILENT)
    z = record.measured(
        record.truth_inputs(replace(course, sensors=chosen)), replace(chosen, unmodelled=Effects(lever_arm=arm)), 0
    )
    attitude = Rotation.from_rotvec(initial) * Rotation.from_rotvec(np.outer(z.range_time, turning))
    antenna_at = SLOW.path(z.range_time) + attitude.apply(arm)
    np.testing.assert_allclose(z.range, np.linalg.norm(antenna_at - np.array(SLOW.world.anchor), axis=-1), atol=1e-12)


def test_on_an_imu_sample_the_attitude_is_the_samples_own():
    moved = flight(TUMBLING, rate=50.0)
    np.testing.assert_array_equal(antenna.rotation(moved, moved.time), moved.rotation)


@pytest.mark.parametrize(
    ("turning", "most"),
    [(TUMBLING, 1e-8), (Flown(yaw="sin(2*t)"), 1e-5)],
    ids=["a tumbling body, 10 rad/s²", "a flown one, 35 rad/s²"],
)
def test_between_samples_the_attitude_is_of_fifth_order_in_the_step(turning, most):
    """Against the same body sampled 16 times as often: the turn since the last sample, so that nothing accumulates."""
    fine, errors = 16, []
    for rate in (25.0, 50.0, 100.0):
        coarse, witness = flight(turning, rate=rate), flight(turning, rate=fine * rate)
        k = np.arange(len(witness.time)) // fine
        turned = np.swapaxes(coarse.rotation[k], -1, -2) @ antenna.rotation(coarse, witness.time)
        true = np.swapaxes(witness.rotation[k * fine], -1, -2) @ witness.rotation
        errors.append(so3.angle(np.swapaxes(true, -1, -2) @ turned).max())
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    assert (ratios > 24).all()  # 2⁵ = 32 in the limit of short steps
    assert errors[1] < most  # rad, at 50 Hz


def test_an_antenna_in_the_imu_has_the_range_of_the_paper():
    moved = flight(TUMBLING, rate=50.0)
    time = np.linspace(0, 5, 77)
    computed = sensors.distance(moved, time, path=SLOW.path, world=SLOW.world, lever_arm=(0.0, 0.0, 0.0))
    np.testing.assert_array_equal(computed, np.linalg.norm(SLOW.path(time) - np.array(SLOW.world.anchor), axis=-1))


def test_many_ranges_are_the_same_as_few_at_a_time():
    moved, arm = flight(TUMBLING, rate=50.0), (0.1, 0.2, 0.3)
    time = np.linspace(0, 5, 2 * antenna.AT_ONCE + 5)

    def computed(at):
        return sensors.distance(moved, at, path=SLOW.path, world=SLOW.world, lever_arm=arm)

    np.testing.assert_allclose(computed(time)[::7], computed(time[::7]), rtol=1e-14)
    assert len(computed(time[:0])) == 0


@given(st.floats(0, 0.99), st.floats(0, 30), st.floats(0, 30))
def test_a_record_with_losses_is_in_order_and_passes_its_check(lost, start, length):
    z = measured(duration=8.0, rate=33.3, dropout_probability=lost, burst_start=start, burst_length=length)
    sensors.check(z)
    assert len(z.range) == len(z.range_time)


def sensors_with(**effects):
    return Sensors(unmodelled=Effects(**effects))


def test_nothing_is_said_where_nothing_is_on():
    assert sensors.effect_sentences(Sensors()) == ()
    assert sensors.effect_sentences(sensors_with(outlier_probability=0.5, outlier_size=0.0)) == ()
    assert sensors.effect_sentences(sensors_with(burst_start=3.0)) == ()
    assert Sensors().unmodelled == MODELLED


def test_every_effect_that_is_on_gets_one_sentence_with_its_name_and_size():
    said = sensors.effect_sentences(Sensors(unmodelled=EVERYTHING))
    assert sensors.active_effects(Sensors(unmodelled=EVERYTHING)) == NAMES
    assert [sentence.split(":")[0] for sentence in said] == list(NAMES)
    assert all(sentence.endswith(".") and "\n" not in sentence for sentence in said)
    by_name = dict(zip(NAMES, said, strict=True))
    assert "(0.01, -0.02, 0.03) rad/s" in by_name["gyro bias"]
    assert "25 of 100 ranges are too long, by 0.5 m on average" in by_name["outliers"]
    assert "from 5 s to 10 s" in by_name["burst"]


@pytest.mark.parametrize("field", ROWS)
def test_every_effect_changes_the_record(field):
    """An effect that nobody applies in the simulation leaves the record to the last bit, and fails here."""
    main = ROWS[field].shapes
    off = {main: example(main)} if main else {}
    before, after = measured(noise=Noise(), **off), measured(noise=Noise(), **off, **{field: example(field)})
    assert any(not np.array_equal(getattr(before, name), getattr(after, name), equal_nan=True) for name in ARRAYS)


@pytest.mark.parametrize("field", ROWS)
def test_a_field_that_shapes_an_effect_does_nothing_while_that_effect_is_off(field):
    if ROWS[field].shapes:
        assert_same(measured(noise=Noise()), measured(noise=Noise(), **{field: example(field)}), *ARRAYS)
        assert sensors.effect_sentences(sensors_with(**{field: example(field)})) == ()
    else:
        assert len(sensors.effect_sentences(sensors_with(**{field: example(field)}))) == 1


def test_every_field_has_one_complete_row():
    assert tuple(ROWS) == Effects.__struct_fields__
    for field, row in ROWS.items():
        assert row.label
        assert row.hint.endswith(".")
        assert row.limits[0] < row.limits[1]
        assert row.shown_unit or row.limits == (0.0, 1.0)
        assert bool(row.name) == (row.text is not None) == (not row.shapes)
        assert row.shapes == "" or row.shapes in ROWS
        assert getattr(EVERYTHING, field) != getattr(MODELLED, field)
    assert len({row.label for row in ROWS.values()}) == len(ROWS)


@pytest.mark.parametrize("field", ROWS)
def test_a_value_beyond_its_limit_is_refused_with_the_fields_name(field):
    row = ROWS[field]
    beyond = 1.001 * row.limits[1]
    Effects(**{field: example(field)})
    with pytest.raises(ValueError, match=f"^{field} must .*, got "):
        replace(MODELLED, **{field: (0.0, beyond, 0.0) if row.body_vector else beyond})


def run(**effects):
    """The slow path without noise, 50 ranges a second."""
    return record.run(replace(SLOW, sensors=Sensors(noise=SILENT, unmodelled=Effects(**effects))))


@pytest.mark.parametrize(
    "effects",
    [
        {"gyro_bias": (0.01, 0.0, 0.0)},
        {"accel_bias": (0.1, 0.0, 0.0)},
        {"range_bias": 0.2},
        {"outlier_probability": 0.1},
        {"lever_arm": (0.1, 0.0, 0.0)},
    ],
    ids=lambda effects: next(iter(effects)),
)
def test_the_error_that_the_words_promise_to_stay_stays(effects):
    """Without noise the observer ends 0.1 mm off; with one effect it does not come below a decimetre."""
    assert run().summary.steady_position < 2e-4
    assert run(**effects).summary.steady_position > 0.1


def test_drop_outs_and_a_burst_without_noise_only_delay_the_observer():
    for effects in ({"dropout_probability": 0.5}, {"burst_start": 8.0, "burst_length": 5.0}):
        flight = run(**effects)
        assert flight.summary.steady_position < 1e-3
        assert not flight.summary.diverged


def test_over_a_burst_the_error_grows_until_ranges_return():
    """Medians of 7 seeds with the usual noise: in the burst's last second twice as far off as in the second before."""
    on = Sensors(unmodelled=Effects(burst_start=12.0, burst_length=4.0))
    runs = [record.run_seed(replace(SLOW, sensors=on), seed) for seed in range(7)]

    def error(begin, end):
        return np.median(
            [r.errors.position[(r.truth.motion.time >= begin) & (r.truth.motion.time < end)].mean() for r in runs]
        )

    assert error(15.0, 16.0) > 2 * error(11.0, 12.0)
    assert error(19.0, 20.0) < error(15.0, 16.0)


def test_without_any_range_the_observer_predicts_and_the_run_is_called_diverged():
    flight = record.run(replace(SLOW, sensors=Sensors(unmodelled=Effects(burst_length=100.0))))
    assert len(flight.measurements.range) == 0
    assert np.isfinite(flight.estimate.state).all()
    assert flight.summary.diverged


@pytest.mark.parametrize("mode", ["constant", "noise-matched"])
def test_the_plain_observer_agrees_on_a_record_with_everything_on(mode):
    """As on clean records the two differ by rounding, which outliers of metres do not enlarge past a micrometre."""
    chosen = Sensors(unmodelled=EVERYTHING)
    p = replace(SLOW, duration=8.0, sensors=chosen, gains=replace(SLOW.gains, mode=mode))
    truth, z = record.simulated(record.truth_inputs(p)), record.measured(record.truth_inputs(p), chosen, 3)
    start = cascade.start(p.guess, state=truth.state[0], rotation=truth.motion.rotation[0], world=p.world)
    setting = cascade.ObserverConfig(world=p.world, sensors=chosen, gains=p.gains)
    fast, plainly = cascade.observe(z, start, setting), reference.observe(z, start, setting)
    scale = np.abs(plainly.state).max()
    np.testing.assert_allclose(fast.state, plainly.state, atol=1e-9 * scale)


def test_the_predicted_accuracy_says_what_it_does_not_know_and_thins_its_ranges():
    assert sensors.noise_assumption(Sensors()) == "ranges at 50 Hz with 0.1 m noise, no IMU noise"
    assert sensors.noise_assumption(sensors_with(dropout_probability=0.2)) == (
        "ranges at 50 Hz with 0.1 m noise, 20 of 100 of them lost, no IMU noise"
    )
    said = sensors.noise_assumption(Sensors(unmodelled=EVERYTHING))
    assert said.endswith(f"and nothing of what is on besides: {', '.join(n for n in NAMES if n != 'drop-outs')}")


def test_with_three_of_four_ranges_lost_the_predicted_accuracy_is_twice_as_poor():
    """Information adds up, so σ goes with the root of the expected number of ranges, whatever the window."""
    whole, thinned = (
        analysis.analyse(replace(SLOW, sensors=sensors_with(dropout_probability=share))) for share in (0.0, 0.75)
    )
    assert thinned.lifted_end.position / whole.lifted_end.position == pytest.approx(2.0, rel=1e-9)
    assert thinned.nonlinear_end.position / whole.nonlinear_end.position == pytest.approx(2.0, rel=1e-9)
    np.testing.assert_allclose(thinned.windows.sigma_lifted, 2 * whole.windows.sigma_lifted, rtol=1e-9)
    assert thinned.rank == whole.rank


def test_the_reports_name_what_is_on_and_are_as_they_were_where_nothing_is():
    p = replace(SLOW, sensors=Sensors(unmodelled=EVERYTHING))
    assert report.analysis_report(p, analysis.analyse(p), name="x")["accuracy"]["assumes"] == sensors.noise_assumption(
        p.sensors
    )
    assert report.analysis_report(p, analysis.analyse(p), name="x")["accuracy"]["range_rate"] == 50
    assert report.simulation_report(record.run(p), [], name="x")["unmodelled"] == list(
        sensors.effect_sentences(p.sensors)
    )
    assert "assumes" not in report.analysis_report(SLOW, analysis.analyse(SLOW), name="x")["accuracy"]
    assert "unmodelled" not in report.simulation_report(record.run(SLOW), [], name="x")


@pytest.mark.parametrize(
    ("effects", "sentence"),
    [
        ({"gyro_bias": (8.0, 8.0, 0.0)}, "gyro_bias must not be longer than 10 rad/s, got 11.3137"),
        ({"gyro_bias": (1e200, 0.0, 1e200)}, "gyro_bias must not be longer than 10 rad/s, got 1.41421e+200"),
        ({"accel_bias": (0.0, -101.0, 0.0)}, "accel_bias must not be longer than 100 m/s², got 101"),
        ({"accel_bias": (0.0, np.nan, 0.0)}, "accel_bias must be a finite number, got nan"),
        ({"lever_arm": (0.0, 0.0, 1e3)}, "lever_arm must not be longer than 100 m, got 1000"),
        ({"range_bias": -1001.0}, "range_bias must lie between -1000 and 1000 m, got -1001"),
        ({"range_bias": np.inf}, "range_bias must be a finite number, got inf"),
        ({"outlier_probability": 1.0}, "outlier_probability must lie between 0 and 1, 1 excluded, got 1"),
        ({"outlier_probability": -0.1}, "outlier_probability must lie between 0 and 1, 1 excluded, got -0.1"),
        ({"dropout_probability": 1.5}, "dropout_probability must lie between 0 and 1, 1 excluded, got 1.5"),
        ({"outlier_size": -1.0}, "outlier_size must lie between 0 and 1000 m, got -1"),
        ({"burst_start": -1.0}, "burst_start must lie between 0 and 10000 s, got -1"),
        ({"burst_length": 1e5}, "burst_length must lie between 0 and 10000 s, got 100000"),
    ],
)
def test_effects_that_cannot_be_are_refused_in_one_sentence(effects, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        Effects(**effects)


def test_the_catalogue_is_for_reading_and_fits_every_shipped_motion():
    names = [entry.name for entry in sensor_sets.CATALOGUE]
    assert len(set(names)) == len(names) == 6
    for entry in sensor_sets.CATALOGUE:
        assert entry.summary[0].isupper()
        assert entry.summary.endswith(".")
        for p in preset.shipped().values():
            replace(p, sensors=entry.sensors)  # raises where a preset cannot carry them
    assert preset.load("paper").sensors == sensor_sets.PAPER.sensors
    assert sensor_sets.PERFECT.sensors.sigma == SILENT
    assert (
        sensors.effect_sentences(sensor_sets.PAPER.sensors)
        == sensors.effect_sentences(sensor_sets.PERFECT.sensors)
        == ()
    )


@pytest.mark.parametrize("entry", sensor_sets.CATALOGUE, ids=lambda entry: entry.name)
def test_the_observer_settles_exactly_with_those_sets_that_are_as_the_paper_models_them(entry):
    """On the slow path, medians of 5 seeds: within 0.3 m to the end, or off by some decimetres to two metres."""
    runs = [record.run_seed(replace(SLOW, sensors=entry.sensors), seed).summary for seed in range(5)]
    steady = np.median([s.steady_position for s in runs])
    assert not any(s.diverged for s in runs)
    if sensors.effect_sentences(entry.sensors):
        assert 0.3 < steady < 2.0
    else:
        assert steady < 0.2
        assert sum(s.settle_position_s is not None for s in runs) >= 3
