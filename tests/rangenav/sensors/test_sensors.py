"""What the sensors report: the formulas without noise, the statistics with it, and clocks that do not always divide.

What the paper does not model has its own tests, in test_sensors_unmodelled.
"""

import re
from dataclasses import fields, replace
from pathlib import Path

import msgspec
import numpy as np
import pytest
import scipy.stats
from hypothesis import example, given
from hypothesis import strategies as st

from rangenav import cascade, motion, preset, record, reference, sensors
from rangenav.sensors import Measurements, Noise, Sensors
from tests.support.refusals import exactly

pytestmark = pytest.mark.slow


SLOW = preset.load("paper-slow")
P = msgspec.structs.replace(SLOW, world=msgspec.structs.replace(SLOW.world, anchor=(0.3, -0.2, 1.5)))
SILENT = Noise(gyro=0.0, accel=0.0, mag=0.0, range=0.0)
VECTORS = ("gyro", "accel", "mag")
ONE_IN_A_MILLION = 1e-6


def truth(rate, duration=20.0):
    return motion.simulate(
        P.path, P.angular_velocity, world=P.world, initial_rotation=P.initial_rotation, duration=duration, rate=rate
    )


def measured(*, seed=0, duration=20.0, noise=None, **rates):
    chosen = Sensors(noise=noise or Noise(), **rates)
    moved = truth(chosen.imu_rate, duration)
    return sensors.measure(moved, path=P.path, world=P.world, sensors=chosen, rng=np.random.default_rng(seed))


def assert_same(a, b, *names):
    for name in names:
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)


def test_without_noise_the_sensors_are_their_formulas():
    z, t = measured(noise=SILENT), truth(200.0)
    np.testing.assert_array_equal(z.gyro, t.angular_velocity)
    np.testing.assert_array_equal(z.accel, t.apparent_acceleration)
    turned_back = np.swapaxes(t.rotation, -1, -2)
    np.testing.assert_allclose(z.mag, turned_back @ np.asarray(P.world.magnetic), atol=4 * np.finfo(float).eps)
    np.testing.assert_allclose(z.range, np.linalg.norm(P.path(z.range_time) - np.asarray(P.world.anchor), axis=-1))


def test_the_same_seed_gives_the_same_record_to_the_last_bit_and_another_seed_another():
    names = [field.name for field in fields(Measurements)]
    assert_same(measured(seed=7), measured(seed=7), *names)
    for name in (*VECTORS, "range"):
        assert np.all(getattr(measured(seed=7), name) != getattr(measured(seed=8), name))


@pytest.mark.parametrize("changed", [*VECTORS, "range"])
def test_changing_one_noise_leaves_the_other_sensors_to_the_last_bit(changed):
    before, after = measured(), measured(noise=msgspec.structs.replace(Noise(), **{changed: 0.7}))
    assert_same(before, after, *({*VECTORS, "range"} - {changed}))
    assert np.all(getattr(before, changed) != getattr(after, changed))


@pytest.mark.parametrize("rates", [{"range_rate": 200.0}, {"range_rate": 33.3}, {"mag_rate": 20.0}])
def test_changing_one_rate_leaves_the_other_sensors_to_the_last_bit(rates):
    before, after = measured(), measured(**rates)
    others = ("gyro", "accel") + (("range", "range_time") if "mag_rate" in rates else ("mag",))
    assert_same(before, after, *others)


def test_a_slower_magnetometer_keeps_the_samples_it_still_gives():
    fast, slow = measured(), measured(mag_rate=50.0)
    np.testing.assert_array_equal(slow.mag[::4], fast.mag[::4])


@pytest.mark.parametrize("name", [*VECTORS, "range"])
def test_noise_is_proportional_to_its_standard_deviation(name):
    exact, once, twice = (measured(noise=msgspec.structs.replace(Noise(), **{name: s})) for s in (0.0, 0.25, 0.5))
    first, second = (getattr(z, name) - getattr(exact, name) for z in (once, twice))
    np.testing.assert_allclose(second, 2 * first, atol=1e-14)  # a sum of a few units, rounded


@pytest.mark.parametrize("name", [*VECTORS, "range"])
def test_the_noise_has_its_standard_deviation_no_mean_and_no_memory(name):
    noise = Noise(gyro=0.02, accel=0.3, mag=0.05, range=0.4)
    z, exact = (measured(noise=n, range_rate=200.0) for n in (noise, SILENT))
    scaled = (getattr(z, name) - getattr(exact, name)) / getattr(noise, name)
    n = scaled.size
    # each statement fails for one seed in a million if the noise is white, Gaussian and of unit variance
    low, high = scipy.stats.chi2.ppf([ONE_IN_A_MILLION / 2, 1 - ONE_IN_A_MILLION / 2], n)
    assert low < np.sum(scaled**2) < high
    limit = scipy.stats.norm.isf(ONE_IN_A_MILLION / 2)
    assert abs(scaled.sum()) < limit * np.sqrt(n)
    assert abs(np.sum(scaled[1:] * scaled[:-1])) < limit * np.sqrt(n)
    assert scipy.stats.kstest(scaled.ravel(), "norm").pvalue > ONE_IN_A_MILLION


def test_no_two_sensors_and_no_two_axes_share_their_noise():
    noise = Noise(gyro=1.0, accel=1.0, mag=1.0, range=1.0)
    z, exact = (measured(noise=n, range_rate=200.0) for n in (noise, SILENT))
    columns = [getattr(z, name) - getattr(exact, name) for name in VECTORS] + [(z.range - exact.range)[:, None]]
    correlation = np.corrcoef(np.concatenate(columns, axis=1).T) - np.eye(10)
    limit = scipy.stats.norm.isf(ONE_IN_A_MILLION / 45)  # 45 pairs
    assert np.abs(correlation).max() < limit / np.sqrt(len(z.time))


@pytest.mark.parametrize("divisor", [1, 2, 4, 10])
def test_a_magnetometer_at_a_fraction_of_the_imus_rate_gives_every_kth_sample(divisor):
    z = measured(mag_rate=200.0 / divisor, duration=3.0)
    given_at = ~np.isnan(z.mag).any(axis=1)
    np.testing.assert_array_equal(np.flatnonzero(given_at), np.arange(0, 601, divisor))
    assert np.isnan(z.mag[~given_at]).all()


@given(st.floats(1, 200))
def test_a_magnetometer_at_any_rate_is_spread_evenly_over_the_imus_samples(rate):
    z = measured(mag_rate=rate, duration=3.0)
    given_at = np.flatnonzero(~np.isnan(z.mag[:, 0]))
    assert given_at[0] == 0
    assert len(given_at) == int(np.floor(3.0 * rate + 1e-9)) + 1
    if len(given_at) > 2:
        assert np.ptp(np.diff(given_at)) <= 1  # gaps of k or k + 1 samples, never anything else


@pytest.mark.parametrize(("imu", "ranging"), [(200.0, 200.0), (200.0, 50.0), (1000.0, 8.0), (100.0, 1.0)])
def test_ranges_stand_exactly_on_imu_stamps_where_the_rates_divide(imu, ranging):
    z = measured(imu_rate=imu, mag_rate=imu, range_rate=ranging, duration=5.0)
    np.testing.assert_array_equal(z.range_time, z.time[:: round(imu / ranging)])


@pytest.mark.parametrize("ranging", [30.0, 60.0, 199.0, 333.3, 400.0, 7919.0])
def test_ranges_at_any_other_rate_have_a_clock_of_their_own(ranging):
    z = measured(range_rate=ranging, duration=5.0)
    np.testing.assert_allclose(z.range_time, np.arange(len(z.range_time)) / ranging, atol=1e-15)
    assert len(z.range_time) == int(5.0 * ranging + 1e-9) + 1


@given(st.floats(1, 1000), st.floats(1, 1000))
@example(1.0000000000000002, 2.0)
def test_ranges_come_in_order_and_never_after_the_last_imu_sample(imu, ranging):
    z = measured(imu_rate=imu, mag_rate=imu, range_rate=ranging, duration=3.0)
    sensors.check(z)
    assert z.range_time[0] == 0
    assert z.range_time[-1] <= z.time[-1]
    assert z.range_time[-1] > z.time[-1] - 1.000001 / ranging


def test_noisy_ranges_near_the_anchor_are_not_clipped():
    at_anchor = msgspec.structs.replace(P.path, tones=(), offset=P.world.anchor)
    moved = motion.simulate(
        at_anchor, P.angular_velocity, world=P.world, initial_rotation=P.initial_rotation, duration=5.0, rate=200.0
    )
    z = sensors.measure(moved, path=at_anchor, world=P.world, sensors=Sensors(), rng=np.random.default_rng(0))
    assert 0.3 < np.mean(z.range < 0) < 0.7  # 251 fair coins


def as_first_published(moved, path, world, chosen, seed):
    """The measurements as version 0.1 made them, before there were biases and the like; its clocks are tested above."""
    gyro_rng, accel_rng, mag_rng, range_rng = np.random.default_rng(seed).spawn(4)
    noise, time = chosen.noise, moved.time
    turned = np.einsum("nij,i->nj", moved.rotation, np.array(world.magnetic))
    distance = np.linalg.norm(path(chosen_times(chosen, time)) - np.array(world.anchor), axis=-1)
    return {
        "gyro": moved.angular_velocity + noise.gyro * gyro_rng.standard_normal((len(time), 3)),
        "accel": moved.apparent_acceleration + noise.accel * accel_rng.standard_normal((len(time), 3)),
        "mag": turned + noise.mag * mag_rng.standard_normal((len(time), 3)),
        "range": distance + noise.range * range_rng.standard_normal(len(distance)),
    }


def chosen_times(chosen, time):
    return time[:: round(chosen.imu_rate / chosen.range_rate)]


@pytest.mark.parametrize("name", preset.shipped())
def test_every_shipped_preset_measures_what_it_did_before_there_were_unmodelled_effects(name):
    """To the last bit: a seed that somebody has noted keeps its meaning."""
    p = preset.load(name)
    z, moved = record.run(p).measurements, record.simulated(record.truth_inputs(p)).motion
    for sensor, expected in as_first_published(moved, p.path, p.world, p.sensors, p.seed).items():
        np.testing.assert_array_equal(getattr(z, sensor), expected, err_msg=sensor)


def test_the_first_noise_of_seed_1_is_what_it_was():
    """Figures printed by version 0.1: the hover's truth is exact, so they hold on any machine."""
    z = record.run(preset.load("hover")).measurements
    assert z.gyro[7, 1] == -0.010204156759513543
    assert z.accel[7, 1] == 0.042350969051537596
    assert z.mag[0, 1] == -0.08901141637955547
    assert z.range[5] == 2.7916262377138685


@given(st.floats(1e-9, 10), st.floats(1, 10_000))
def test_noise_per_sample_and_its_density_are_one_noise_at_one_rate(sigma, rate):
    assert sensors.per_sample(sensors.density(sigma, rate), rate) == pytest.approx(sigma, rel=1e-15)
    given_both = Noise(gyro=sigma, accel=2 * sigma, mag=0.3, range=0.4)
    as_density = sensors.in_unit(given_both, "density", rate=rate)
    assert as_density == Noise(
        gyro=sensors.density(sigma, rate),
        accel=sensors.density(2 * sigma, rate),
        mag=0.3,
        range=0.4,
        imu_unit="density",
    )
    assert sensors.in_unit(as_density, "density", rate=7.0) is as_density
    assert sensors.in_unit(given_both, "sample", rate=7.0) is given_both


def test_with_a_density_a_faster_imu_is_noisier_sample_by_sample_and_mag_and_range_are_not():
    noise = Noise(gyro=1e-3, accel=1e-2, mag=0.1, range=0.1, imu_unit="density")
    slow, fast = (Sensors(imu_rate=rate, mag_rate=50.0, noise=noise).sigma for rate in (100.0, 400.0))
    assert (fast.gyro, fast.accel) == pytest.approx((2 * slow.gyro, 2 * slow.accel), rel=1e-15)
    assert (slow.gyro, slow.accel) == pytest.approx((1e-2, 1e-1), rel=1e-15)
    assert (slow.mag, slow.range) == (fast.mag, fast.range) == (0.1, 0.1)
    assert Sensors().sigma is Sensors().noise


@pytest.mark.parametrize("rate", [50.0, 800.0])
def test_integrated_gyro_noise_walks_by_its_density_times_the_root_of_time_at_any_rate(rate):
    """Angle random walk, what a density is for; 3 axes of 200 seeds, each statement wrong for one seed in a million."""
    n, duration = 2e-3, 2.0
    noise = Noise(gyro=n, accel=0.0, mag=0.0, range=0.0, imu_unit="density")
    chosen = Sensors(imu_rate=rate, mag_rate=rate, noise=noise)
    moved = truth(rate, duration)
    rngs = (np.random.default_rng(seed) for seed in range(200))
    walks = [
        (sensors.measure(moved, path=P.path, world=P.world, sensors=chosen, rng=rng).gyro - moved.angular_velocity)[:-1]
        for rng in rngs
    ]
    angle = np.sum(walks, axis=1) / rate
    low, high = scipy.stats.chi2.ppf([ONE_IN_A_MILLION / 2, 1 - ONE_IN_A_MILLION / 2], angle.size)
    assert low < np.sum(angle**2) / (n**2 * duration) < high


@pytest.mark.parametrize("mode", ["constant", "noise-matched"])
def test_all_that_computes_sees_the_same_noise_whichever_way_it_was_given(mode):
    """A density and the same noise per sample give the same record, gains and estimate to the last bit."""
    density = Noise(gyro=2e-3, accel=1e-2, mag=0.05, range=0.2, imu_unit="density")
    base = msgspec.structs.replace(SLOW, duration=8.0, gains=msgspec.structs.replace(SLOW.gains, mode=mode))
    given = Sensors(noise=density)
    runs = [
        record.run(msgspec.structs.replace(base, sensors=msgspec.structs.replace(given, noise=noise)))
        for noise in (density, given.sigma)
    ]
    assert_same(runs[0].measurements, runs[1].measurements, "gyro", "accel", "mag", "range")
    assert_same(runs[0].estimate, runs[1].estimate, "state", "covariance", "rotation")
    settings = [
        cascade.ObserverConfig(world=r.preset.world, sensors=r.preset.sensors, gains=r.preset.gains) for r in runs
    ]
    assert len({cascade.parameters(setting, symmetric=False) for setting in settings}) == 1
    start = cascade.Start(state=np.zeros(13), rotation=np.eye(3))
    short = measured(duration=0.5)
    plainly = [reference.observe(short, start, setting) for setting in settings]
    assert_same(*plainly, "state", "covariance")


def test_no_module_computes_with_the_noise_as_it_was_given():
    """`sensors.noise` may hold densities; only `sensors.sigma` is per sample. It may be handed on, but not opened."""
    opened = re.compile(r"(?<!\")sensors\.noise(\.(?!imu_unit)|,|\s*$)", re.MULTILINE)  # in quotes: a field's key
    root = Path(sensors.__file__).parent.parent.parent
    files = [file for folder in ("rangenav", "explorer", "benchmarks") for file in (root / folder).rglob("*.py")]
    assert len(files) > 50
    assert [file.name for file in files if opened.search(file.read_text(encoding="utf-8"))] == []
    assert opened.search("x = p.sensors.noise.gyro**2")
    assert opened.search("world, noise = p.world, p.sensors.noise\n")


def broken(name, index, value):
    """A good record with one entry changed."""
    z = measured(duration=1.0)
    array = getattr(z, name).copy()
    array[index] = value
    return replace(z, **{name: array})


@pytest.mark.parametrize(
    ("name", "index", "value", "sentence"),
    [
        ("time", 5, 0.02, "time must increase: broken at sample 5"),
        ("time", 9, 0.5, "time must increase: broken at sample 10"),
        ("time", 7, np.nan, "time must increase: broken at sample 7"),
        ("range_time", 3, 0.0, "range_time must increase: broken at sample 3"),
        ("gyro", (11, 2), np.nan, "gyro must be finite: broken at sample 11"),
        ("accel", (12, 0), np.inf, "accel must be finite: broken at sample 12"),
        ("range", 13, -np.inf, "range must be finite: broken at sample 13"),
        ("mag", (14, 1), np.inf, "mag must be finite, or NaN where there is none: broken at sample 14"),
        ("time", 200, np.inf, "time must be finite: broken at sample 200"),
    ],
)
def test_check_names_the_first_bad_sample(name, index, value, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        sensors.check(broken(name, index, value))


def test_check_names_the_first_of_several_bad_samples():
    z = broken("gyro", (slice(40, 60), 1), np.nan)
    with pytest.raises(ValueError, match=r"sample 40$"):
        sensors.check(z)


def test_check_accepts_a_record_without_a_magnetometer_or_ranges_but_not_one_of_a_single_sample():
    z = measured(duration=1.0)
    sensors.check(replace(z, mag=np.full_like(z.mag, np.nan), range=np.zeros(0), range_time=np.zeros(0)))
    with pytest.raises(ValueError, match="at least two IMU samples, got 1"):
        sensors.check(replace(z, **{name: getattr(z, name)[:1] for name in ("time", *VECTORS)}))


@pytest.mark.parametrize(
    ("build", "sentence"),
    [
        (lambda: Noise(gyro=-0.01), "noise gyro must be 0, or lie between 1e-09 and 1000, got -0.01"),
        (lambda: Noise(range=1e4), "noise range must be 0, or lie between 1e-09 and 1000, got 10000"),
        (lambda: Noise(range=1e-200), "noise range must be 0, or lie between 1e-09 and 1000, got 1e-200"),
        (lambda: Noise(mag=np.nan), "mag must be a finite number, got nan"),
        (
            lambda: Noise(gyro=1e-12, imu_unit="density"),
            "noise gyro must be 0, or lie between 1e-11 and 1000, got 1e-12",
        ),
        (
            lambda: Noise(range=1e-10, imu_unit="density"),
            "noise range must be 0, or lie between 1e-09 and 1000, got 1e-10",
        ),
        (
            lambda: Sensors(imu_rate=900.0, noise=Noise(accel=50.0, imu_unit="density")),
            "noise accel must be 0, or lie between 1e-09 and 1000, got 1500 per sample at 900 Hz",
        ),
        (lambda: Sensors(imu_rate=0.5), "imu_rate must lie between 1 and 10000 Hz, got 0.5"),
        (lambda: Sensors(imu_rate=1e9), "imu_rate must lie between 1 and 10000 Hz, got 1e+09"),
        (lambda: Sensors(mag_rate=201.0), "mag_rate must lie between 1 Hz and imu_rate, got 201"),
        (lambda: Sensors(range_rate=0.0), "range_rate must lie between 0.1 and 10000 Hz, got 0"),
        (lambda: Sensors(range_rate=np.inf), "range_rate must be a finite number, got inf"),
    ],
)
def test_sensors_that_cannot_be_are_refused_in_one_sentence(build, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        build()
