"""Recorded flights: what their IMU alone tells of observability, what a rest tells of the world, and a real one."""

import functools
from dataclasses import replace

import msgspec
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rangenav import analysis, cascade, formats, logs, preset, record, rest
from rangenav.formats import recorded_flight
from rangenav.formats.recorded_flight import Flight, Frame
from rangenav.observability import spectrum
from rangenav.sensors import Noise
from tests.support.present import present
from tests.support.real_files import shared
from tests.support.records import SILENT
from tests.support.refusals import exactly

pytestmark = pytest.mark.slow


FIELD = np.array([0.0, 0.36, -0.93])
ANCHORS = ((1.5, 1.2, 0.2), (-1.5, 1.0, 0.0), (2.0, -2.0, 0.5))
"""Points about 2.7 m from where BROAD's sensor was moved about."""


def flown(name, *, noise: Noise | None = None, **changes) -> tuple[preset.Preset, Flight]:
    """A preset and the log of its run."""
    p = msgspec.structs.replace(preset.load(name), **changes)
    if noise is not None:
        p = msgspec.structs.replace(p, sensors=msgspec.structs.replace(p.sensors, noise=noise))
    z = record.run(p).measurements
    truth = record.run(p).truth.motion
    return p, Flight(
        time=z.time,
        gyro=z.gyro,
        accel=z.accel,
        mag=z.mag,
        range_time=z.range_time,
        range=z.range,
        rotation=truth.rotation,
        position=truth.position,
        frame="z-down",
    )


def seen(flight, window, **changes):
    asked = {"range_sigma": 0.1, "requirement": 0.5, "noise": (0.01, 0.1, 0.0)} | changes
    return logs.informative(flight, window=window, **asked)


@pytest.mark.parametrize(
    ("name", "rank"), [("hover", 5), ("line", 5), ("circle", 11), ("helix", 11), ("paper-slow", 13), ("soft", 13)]
)
def test_a_noisy_imu_alone_tells_the_rank_that_the_true_path_has(name, rank):
    """Noise makes every singular value positive, so a rank by rounding would be 13 for a hover too."""
    p, flight = flown(name)
    informative = seen(flight, p.requirement.window)
    assert set(informative.rank.tolist()) == {rank}
    assert analysis.analyse(p).rank == rank
    assert (informative.verdict == "blind") == (rank < 13)


@pytest.mark.parametrize("name", ["paper", "paper-slow", "soft", "lissajous", "wiggle"])
def test_its_predicted_accuracy_is_that_of_the_true_path(name):
    """From noisy IMU and noisy ranges instead of the path: 15% covers the worst window's seed and grid."""
    p, flight = flown(name)
    informative, truth = seen(flight, p.requirement.window), analysis.analyse(p)
    assert np.nanmax(informative.sigma) == pytest.approx(truth.lifted_end.position, rel=0.15)


def test_a_window_has_at_least_the_rank_of_every_shorter_window_inside_it():
    """Noise of the IMU, integrated over 16 s, hides what 3 s of the same record determine; it takes nothing away."""
    _, flight = flown("paper")
    flight = recorded_flight.with_some_ranges(flight, np.arange(len(flight.range)) % 20 == 0)
    asked = {"range_sigma": 0.1, "requirement": 0.5, "noise": (0.03, 0.3, 0.02)}
    informative = logs.informative(flight, window=16.0, **asked)
    assert set(informative.rank.tolist()) == {13}
    begin = informative.start[-1] + 13.0
    last = logs.informative(recorded_flight.between(flight, begin, begin + 3.0), window=2.9, **asked)
    assert informative.sigma[-1] <= 1.2 * last.sigma[-1]


@pytest.mark.parametrize("name", ["paper-slow", "soft"])
def test_without_noise_its_spectrum_is_the_gramians_without_the_path(name):
    """Two ways to D: twice integrated in gyro-turned axes, and from positions of the path. 1 kHz, trapezoids."""
    p, flight = flown(name, noise=SILENT, duration=14.0, requirement=preset.Requirement(window=6.0))
    fast = msgspec.structs.replace(p, sensors=msgspec.structs.replace(p.sensors, imu_rate=1000.0, mag_rate=1000.0))
    z = record.run(fast).measurements
    flight = recorded_flight.replace(
        flight, time=z.time, gyro=z.gyro, accel=z.accel, mag=z.mag, rotation=None, position=None
    )
    informative = seen(flight, 6.0, noise=(0.0, 0.0, 0.0))
    exact = spectrum.window_spectra(p.path, p.world.gravity, informative.start, 6.0)
    np.testing.assert_allclose(informative.scaled, exact.scaled, rtol=2e-2)  # the least is 1e-8 of the largest
    np.testing.assert_allclose(informative.scaled[:, :9], exact.scaled[:, :9], rtol=1e-4)
    assert set(informative.rank.tolist()) == {13}


def test_gaps_and_uneven_stamps_do_not_change_what_a_record_tells():
    p, flight = flown("soft")
    kept = np.ones(len(flight.time), dtype=bool)
    kept[np.random.default_rng(0).random(len(kept)) < 0.3] = False
    kept[[0, -1]] = True
    thin = recorded_flight.replace(
        flight,
        **{name: getattr(flight, name)[kept] for name in ("time", "gyro", "accel")},
        **dict.fromkeys(("mag", "rotation", "position")),
    )
    whole, part = seen(flight, p.requirement.window), seen(thin, p.requirement.window)
    np.testing.assert_allclose(np.nanmedian(part.sigma), np.nanmedian(whole.sigma), rtol=0.05)


def test_fewer_than_13_ranges_determine_nothing_whatever_the_motion():
    p, flight = flown("soft")
    window = p.requirement.window
    every = recorded_flight.replace(flight, range_time=np.empty(0), range=np.empty(0))
    informative = seen(every, window)
    assert (informative.verdict, bool(np.isnan(informative.sigma).all())) == ("too few ranges", True)
    assert (set(informative.motion_rank.tolist()), set(informative.rank.tolist())) == ({13}, {0})
    step = window / 6
    times = np.arange(0.0, 20.0, step)
    sparse = recorded_flight.replace(flight, range_time=times, range=np.interp(times, flight.range_time, flight.range))
    informative = seen(sparse, window)
    assert informative.verdict == "too few ranges"
    assert informative.rank.max() <= informative.ranges.max() <= 7
    assert "of the 13 ranges that a window needs" in informative.summary


def test_the_whole_record_is_judged_first_and_the_window_that_suffices_is_named():
    """In windows of 6 s this flight is blind, and the whole of it determines the position."""
    _, flight = flown("barrel", duration=16.0)
    asked = {"range_sigma": 0.1, "requirement": 0.5, "noise": (0.01, 0.1, 0.0)}
    whole = logs.whole(flight, **asked)
    assert (whole.verdict, whole.all_of_it, whole.rank) == ("observable", True, 13)
    assert seen(flight, 6.0).each.count("blind") > 40
    suffices = present(whole.suffices)
    assert seen(flight, suffices).verdict == "observable"
    assert f"windows of {suffices:g} s suffice" in whole.summary
    doubted = logs.whole(flight, restriction="gravity was removed", **asked)
    assert (doubted.verdict, doubted.summary) == ("not judged", "not judged: gravity was removed")
    windows = seen(flight, suffices, restriction="gravity was removed")
    assert (set(windows.each), windows.verdict) == ({"not judged"}, "not judged")


def test_a_rest_before_a_flight_without_ranges_does_not_make_its_motion_blind():
    """More data cannot tell less: the part whose motion has rank 13 is found without ranges, too."""
    _, flight = flown("soft", duration=16.0)
    step, rest = float(np.median(np.diff(flight.time))), 120.0
    before = np.arange(0.0, rest, step)
    held = {name: np.broadcast_to(getattr(flight, name)[0], (len(before), 3)) for name in ("accel", "mag")}
    longer = recorded_flight.replace(
        flight,
        time=np.concatenate([before, rest + flight.time]),
        gyro=np.concatenate([np.zeros((len(before), 3)), flight.gyro]),
        **{name: np.concatenate([held[name], getattr(flight, name)]) for name in held},
        range_time=np.empty(0),
        range=np.empty(0),
        rotation=None,
        position=None,
    )
    asked = {"range_sigma": 0.1, "requirement": 0.5, "noise": (0.01, 0.1, 0.01)}
    whole = logs.whole(longer, **asked)
    assert (whole.verdict, whole.ranges, whole.motion_rank) == ("too few ranges", 0, 13)
    assert (whole.all_of_it, whole.end > rest) == (False, True)
    assert whole.summary.endswith("has no range; its motion has rank 13")
    resting = recorded_flight.between(longer, 0.0, rest - 1.0)
    still = logs.whole(resting, **asked)
    assert (still.verdict, still.motion_rank < 13) == ("blind", True)


def test_noise_at_rest_needs_no_magnetometer():
    _, flight = flown("hover")
    bare = recorded_flight.replace(flight, mag=None)
    assert rest.noise_at_rest(bare) == rest.noise_at_rest(flight)


def test_where_a_record_is_blind_is_told_in_its_own_time():
    """A flight that stops: twenty seconds of motion, then rest."""
    _, flight = flown("soft")
    pause = np.arange(1, 3001) / 200
    force = flight.accel[-1] / np.linalg.norm(flight.accel[-1]) * 9.81
    rng = np.random.default_rng(1)
    still_part = {"gyro": np.zeros(3), "accel": force}
    noisy = {
        name: mean + s * rng.standard_normal((3000, 3))
        for (name, mean), s in zip(still_part.items(), (0.01, 0.1), strict=True)
    }
    both = recorded_flight.replace(
        flight,
        time=np.concatenate([flight.time, flight.time[-1] + pause]),
        gyro=np.vstack([flight.gyro, noisy["gyro"]]),
        accel=np.vstack([flight.accel, noisy["accel"]]),
        mag=None, rotation=None, position=None,
    )  # fmt: skip
    informative = seen(both, 6.0)
    assert informative.verdict == "partly"
    assert (informative.rank[informative.start > 21] < 13).all()
    assert "blind where they begin at" in informative.summary


def test_windows_that_do_not_fit_and_parts_that_are_empty_are_refused():
    _, flight = flown("soft")
    with pytest.raises(ValueError, match=exactly("the window must be shorter than the record's 20 s, got 20 s")):
        seen(flight, 20.0)
    with pytest.raises(ValueError, match="no two samples from 30 s to 40 s: the record goes from 0 s to 20 s"):
        recorded_flight.between(flight, 30.0, 40.0)
    none, soft = recorded_flight.replace(flight, range=np.empty(0), range_time=np.empty(0)), preset.load("soft")
    with pytest.raises(ValueError, match="no ranges"):
        logs.observe(none, soft.world, sensors=soft.sensors)
    with pytest.raises(ValueError, match="synthetic ranges need a true position"):
        recorded_flight.with_ranges(recorded_flight.replace(flight, position=None), (0.0, 0.0, 0.0), sigma=0.1, seed=0)


def test_observing_a_log_is_observing_its_measurements():
    p, flight = flown("soft")
    setting = cascade.ObserverConfig(world=p.world, sensors=p.sensors, gains=p.gains)
    start = cascade.Start(state=np.zeros(13), rotation=np.eye(3))
    wanted = cascade.observe(record.run(p).measurements, start, setting)
    observed = logs.observe(flight, p.world, sensors=p.sensors, gains=p.gains)
    np.testing.assert_array_equal(observed.estimate.state, wanted.state)
    late = flight.time > 15
    assert present(observed.position_error)[late].max() < 1.0
    assert np.degrees(present(observed.attitude_error)[late]).max() < 10
    blind = recorded_flight.replace(flight, position=None, rotation=None)
    assert logs.observe(blind, p.world, sensors=p.sensors).position_error is None


def test_synthetic_ranges_are_those_of_the_true_position_where_it_is_known():
    _, flight = flown("soft")
    position = present(flight.position).copy()
    position[100:300] = np.nan
    with_ranges = recorded_flight.with_ranges(
        recorded_flight.replace(flight, position=position), (1.0, 2.0, 3.0), sigma=0.05, seed=3
    )
    k = np.searchsorted(flight.time, with_ranges.range_time)
    assert not np.isin(k, np.arange(100, 300)).any()
    error = with_ranges.range - np.linalg.norm(position[k] - np.array([1.0, 2.0, 3.0]), axis=-1)
    assert np.std(error) == pytest.approx(0.05, rel=0.1)
    assert with_ranges.anchor == (1.0, 2.0, 3.0)


# --- rest


def resting(seconds=5.0, *, rate=100.0, tilt=(0.3, -0.2, 0.9), truth=True, frame: Frame = "z-up") -> Flight:
    """A noisy body at rest at some attitude, then turning; true attitude from the start, if asked for."""
    rng = np.random.default_rng(7)
    t = np.arange(int((seconds + 5) * rate)) / rate
    after = np.clip(t - seconds, 0, None)[:, None] * np.array([0.0, 0.5, 1.0])
    R = (Rotation.from_rotvec(tilt) * Rotation.from_rotvec(after)).as_matrix()
    bias = np.array([0.004, -0.003, 0.002])
    gyro = (
        np.where(t[:, None] > seconds, np.array([0.0, 0.5, 1.0]), 0.0) + bias + 0.002 * rng.standard_normal((len(t), 3))
    )
    up = np.array([0.0, 0.0, 9.81 if frame == "z-up" else -9.81])
    field = FIELD if frame == "z-up" else FIELD * [1, -1, -1]
    accel = np.einsum("nij,i->nj", R, up) + 0.02 * rng.standard_normal((len(t), 3))
    mag = np.einsum("nij,i->nj", R, field) + 0.01 * rng.standard_normal((len(t), 3))
    return Flight(
        time=t, gyro=gyro, accel=accel, mag=mag, range_time=np.empty(0), range=np.empty(0),
        rotation=R if truth else None, frame=frame,
    )  # fmt: skip


@pytest.mark.parametrize("frame", ["z-up", "z-down"])
def test_a_still_start_tells_gravity_field_and_noise_in_the_frame_of_the_truth(frame):
    flight = resting(frame=frame)
    seconds = rest.rest_seconds(flight)
    assert seconds == pytest.approx(5.0, abs=0.2)
    at_rest = rest.rest_of(flight, seconds)
    sign = -1.0 if frame == "z-up" else 1.0
    np.testing.assert_allclose(at_rest.gravity, [0, 0, sign * 9.81], atol=0.01)
    wanted = FIELD if frame == "z-up" else FIELD * [1, -1, -1]
    np.testing.assert_allclose(at_rest.magnetic, wanted / np.linalg.norm(wanted), atol=0.01)
    assert at_rest.gyro_noise == pytest.approx(0.002, rel=0.1)
    assert at_rest.accel_noise == pytest.approx(0.02, rel=0.1)
    np.testing.assert_allclose(at_rest.gyro_bias, [0.004, -0.003, 0.002], atol=3e-4)
    assert at_rest.aligned
    assert "s are still and give gravity 9.8" in at_rest.summary
    assert "in the frame of the file's attitude" in at_rest.summary


@pytest.mark.parametrize("frame", ["z-up", "z-down"])
def test_without_a_truth_the_world_is_laid_by_gravity_and_magnetic_north(frame):
    at_rest = rest.rest_of(resting(truth=False, frame=frame), 4.0)
    sign = 1.0 if frame == "z-up" else -1.0
    assert at_rest.gravity[:2] == (0.0, 0.0)
    assert at_rest.gravity[2] == pytest.approx(-sign * 9.81, abs=0.01)
    x, y, z = at_rest.magnetic
    length = np.linalg.norm(FIELD)
    assert (x, y, z) == (pytest.approx(0.36 / length, abs=0.01), 0.0, pytest.approx(-sign * 0.93 / length, abs=0.01))
    assert not at_rest.aligned


def test_the_world_is_asked_for_and_not_assumed():
    flight = resting()
    world, questions, _ = rest.world_of(flight, anchor=(1.0, 0.0, 0.0))
    assert world is None
    assert [(q.key, q.suggestion) for q in questions] == [("world", "still")]
    assert "s are still and give gravity 9.8" in questions[0].evidence
    world, questions, told = rest.world_of(flight, anchor=(1.0, 0.0, 0.0), confirmed=True)
    assert (questions, present(world).anchor) == ((), (1.0, 0.0, 0.0))
    assert "are still and give gravity 9.8" in told
    given = ((0.0, 0.0, -9.8), (1.0, 0.0, 0.0))
    world, _, _ = rest.world_of(flight, anchor=(0.0, 0.0, 0.0), vectors=given)
    assert present(world).gravity == given[0]


def test_a_record_that_starts_moving_has_no_rest_to_tell_the_world():
    _, flight = flown("paper-slow")
    assert rest.rest_seconds(flight) == 0.0
    _, questions, _ = rest.world_of(
        recorded_flight.replace(flight, gravity=None), anchor=(0.0, 0.0, 0.0), confirmed=True
    )
    assert (questions[0].suggestion, "does not start still" in questions[0].evidence) == (None, True)


# --- BROAD, trial 21 (Laidig et al., CC BY 4.0)


@functools.cache
def broad() -> Flight:
    path = shared("imu/broad_21_undisturbed_fast_combined.mat")
    return present(formats.settled(formats.read(path, "mat", confirm={"mag": "uT"})).flight)


def rms(values, where):
    return float(np.sqrt(np.nanmean(values[where] ** 2)))


def test_broads_rest_tells_berlins_gravity_and_field():
    at_rest = rest.rest_of(broad(), rest.rest_seconds(broad()))
    assert np.linalg.norm(at_rest.gravity) == pytest.approx(9.813, abs=0.02)
    assert at_rest.gravity[2] < -9.8
    dip = np.degrees(np.arcsin(-at_rest.magnetic[2]))
    assert dip == pytest.approx(68, abs=3)  # Berlin's is 68°; there is iron in a laboratory
    assert np.degrees(np.linalg.norm(at_rest.gyro_bias)) == pytest.approx(0.31, abs=0.05)


@pytest.mark.parametrize("anchor", ANCHORS)
def test_on_a_real_imu_with_ranges_of_5_cm_the_observer_finds_its_place(anchor):
    """From x̂ = 0, 2.7 m off and R̂ = I: decimetres to a metre after ten seconds, for as long as the motion lasts."""
    world, _, _ = rest.world_of(broad(), anchor=anchor, confirmed=True)
    flight = recorded_flight.between(recorded_flight.with_ranges(broad(), anchor, sigma=0.05, seed=0), 36.3, 154.2)
    assert np.nanmean(np.linalg.norm(present(flight.position) - np.array(anchor), axis=-1)) == pytest.approx(
        2.77, abs=0.05
    )
    observed = logs.observe(flight, present(world), sensors=logs.sensors_of(flight, range_sigma=0.05))
    since = flight.time - flight.time[0]
    for begin in range(10, 110, 10):
        part = (since >= begin) & (since < begin + 10)
        assert rms(observed.position_error, part) < 1.3
        assert np.degrees(rms(observed.attitude_error, part)) < 8
    settled = (since > 10) & (since < 105)
    assert rms(observed.position_error, settled) < 0.9
    assert np.degrees(rms(observed.attitude_error, settled)) < 5.5


def test_where_broads_motion_ends_the_imu_alone_says_so_and_the_observer_loses_its_place():
    still = rest.rest_of(broad(), rest.rest_seconds(broad()))
    noise = (still.gyro_noise, still.accel_noise, float(np.linalg.norm(still.gyro_bias)))
    flight = recorded_flight.between(recorded_flight.with_ranges(broad(), ANCHORS[0], sigma=0.05, seed=0), 36.3, 154.2)
    informative = seen(flight, 6.0, range_sigma=0.05, noise=noise)
    assert (informative.rank[:-1] == 13).all()
    assert informative.sigma[-1] > 20  # only its beginning moves
    assert np.nanmedian(informative.sigma) < 0.7
    assert informative.sigma[-2] > 1.5  # the window before the last is half at rest
    world, _, _ = rest.world_of(broad(), anchor=ANCHORS[0], confirmed=True)
    observed = logs.observe(flight, present(world), sensors=logs.sensors_of(flight, range_sigma=0.05))
    since = flight.time - flight.time[0]
    assert rms(observed.position_error, since > 112) > 2 * rms(observed.position_error, (since > 10) & (since < 105))


def test_before_broads_motion_begins_no_window_is_informative():
    still = rest.rest_of(broad(), rest.rest_seconds(broad()))
    noise = (still.gyro_noise, still.accel_noise, float(np.linalg.norm(still.gyro_bias)))
    informative = seen(recorded_flight.between(broad(), 0.0, 35.0), 6.0, noise=noise)
    assert (informative.verdict, int(informative.motion_rank.max())) == ("blind", 5)
    assert informative.summary == "nowhere informative: no window of 6 s reaches rank 13"


def test_the_still_start_is_offered_only_where_it_tells_gravity_and_field():
    """A record in motion at its start, or one whose accelerometer reads no gravity, has to be told where they point."""
    n = 400
    time, still = np.arange(n) / 100, np.zeros((n, 3))
    gravity, field = np.tile([0.0, 0.0, 9.81], (n, 1)), np.tile([0.6, 0.0, 0.8], (n, 1))
    flight = Flight(time=time, gyro=still, accel=gravity, mag=field, range_time=time, range=1 + time)

    def offered(record: Flight) -> tuple[tuple[str, ...], str]:
        _, (question,), _ = rest.world_of(record, anchor=(0.0, 0.0, 0.0))
        return question.options, question.evidence

    given = "given --gravity X Y Z --magnetic X Y Z"
    assert offered(flight)[0] == ("still", given)
    assert "a field 53.1° above the horizon" in offered(flight)[1]
    assert offered(replace(flight, accel=0.01 * gravity))[0] == (given,)
    assert offered(replace(flight, gyro=still + 1.0))[0] == (given,)
