"""Many runs at once are the same runs one by one, whatever the threads do; bands, random starts, a sphere of starts."""

import math
import threading
import time

import numpy as np
import pytest
from msgspec.structs import replace
from scipy.spatial.transform import Rotation

from rangenav import analysis, attitude, cascade, ensemble, errors, preset, record, so3
from rangenav.ensemble import pool, runs
from rangenav.gains import Gains, Guess
from rangenav.preset import Preset
from rangenav.progress import CancelledError
from tests.support.refusals import exactly

pytestmark = pytest.mark.slow


CURVES = ("position", "velocity", "gravity", "attitude")


def shortened(name: str, duration: float, **changes) -> Preset:
    p = preset.load(name)
    window = min(p.requirement.window, duration / 2)
    return replace(p, duration=duration, requirement=replace(p.requirement, window=window), **changes)


SHORT = shortened("paper", 6.0)


@pytest.mark.parametrize("mode", ["constant", "noise-matched"])
def test_each_run_is_the_run_of_its_seed_to_the_last_bit(mode):
    p = shortened("paper-slow", 3.0, gains=Gains(mode=mode), seed=7)
    together = ensemble.seeds(p, 5)
    np.testing.assert_array_equal(together.seed, np.arange(7, 12))
    for k, seed in enumerate(together.seed):
        alone = record.run_seed(p, int(seed))
        on_grid = np.isin(alone.estimate.time, together.time)
        assert on_grid.sum() == together.position.shape[1] == 401
        for name in CURVES:
            np.testing.assert_array_equal(getattr(together, name)[k], getattr(alone.errors, name)[on_grid])
        for name in ("steady_position", "steady_velocity", "steady_gravity", "steady_attitude_deg", "peak_position"):
            assert getattr(together, name)[k] == getattr(alone.summary, name)
        for name in ("position", "attitude"):
            settled = getattr(alone.summary, f"settle_{name}_s")
            assert getattr(together, f"settle_{name}")[k] == (np.inf if settled is None else settled)
        trace = np.trace(alone.estimate.covariance[on_grid, 0], axis1=1, axis2=2)
        np.testing.assert_array_equal(together.sigma[k], np.sqrt(trace))


def test_the_printed_model_is_passed_on():
    derived, printed = (ensemble.seeds(SHORT, 1, form=form) for form in ("derived", "printed"))
    assert printed.steady_position[0] == record.run(SHORT, form="printed").summary.steady_position
    assert printed.steady_position[0] > 10 * derived.steady_position[0]


def test_results_do_not_depend_on_the_order_in_which_threads_finish(monkeypatch):
    """Delays that differ from run to run, and another number of threads, change nothing."""
    expected = ensemble.seeds(SHORT, 6)
    drawn = record.drawn

    def delayed(course, sensors, seed):
        time.sleep(0.03 * (seed % 3))
        return drawn(course, sensors, seed)

    monkeypatch.setattr(record, "drawn", delayed)
    for threads in (1, 5):
        monkeypatch.setattr(pool.os, "cpu_count", lambda threads=threads: threads)
        for name, value in vars(ensemble.seeds(SHORT, 6)).items():
            np.testing.assert_array_equal(value, getattr(expected, name), err_msg=name)


def test_normalised_squares_are_those_of_the_run_collected_between_the_times_of_the_grid():
    p = shortened("paper-slow", 3.0, gains=Gains(mode="noise-matched"))
    every_run, alone = ensemble.seeds(p, 1), record.run(p)
    estimate, z = alone.estimate, alone.measurements
    on_grid = np.flatnonzero(np.isin(estimate.time, every_run.time))
    for j in (1, 100, 400):
        k = on_grid[j]
        e = estimate.state[k, 4:7] - alone.truth.state[k, 4:7]
        assert every_run.nees[0, j] == pytest.approx(e @ np.linalg.inv(estimate.covariance[k, 0]) @ e, rel=1e-6)
        inside = (z.range_time > every_run.time[j - 1]) & (z.range_time <= every_run.time[j])
        squares = estimate.innovation[inside, 0] ** 2 / estimate.innovation[inside, 1]
        assert every_run.nis_count[0, j] == len(squares)
        assert (
            every_run.nis[0, j] == pytest.approx(squares.mean(), rel=1e-12)
            if len(squares)
            else np.isnan(every_run.nis[0, j])
        )
    assert every_run.nis_count.sum() == len(z.range) - 1  # the one before the first step has no innovation


def test_the_band_holds_eight_of_ten_runs_at_every_time():
    every_run = ensemble.seeds(SHORT, 20)
    for name in (*CURVES, "sigma"):
        band, curves = every_run.band(name), getattr(every_run, name)
        assert np.all((band.low <= band.median) & (band.median <= band.high))
        held = np.sum((curves >= band.low) & (curves <= band.high), axis=0)
        np.testing.assert_array_equal(held[1:], 17)  # from the 2nd to the 18th of 20; at the start all are equal
    assert ensemble.spread(every_run.peak_position).median == np.sort(every_run.peak_position)[9]


def test_runs_that_never_settle_count_as_infinite_and_leave_the_rest_alone():
    spread = ensemble.spread(np.array([1.0, 2.0, 3.0, np.inf, np.nan]))
    assert spread == (1.0, 3.0, np.inf)


def test_a_motion_that_cannot_be_seen_settles_in_no_run_and_a_good_one_in_all():
    blind = ensemble.seeds(shortened("hover", 8.0), 4)
    assert not blind.settled.any()
    assert not blind.held.any()
    seen = ensemble.seeds(shortened("paper", 8.0), 4)
    assert seen.settled.all()
    assert seen.held.all()


def test_from_random_starts_nearly_all_hold_three_decimetres_and_five_degrees():
    """The paper's path, 10 s, default gains: 99.8 to 100 % of a thousand; here 200."""
    every_run = ensemble.starts(shortened("paper", 10.0), 200, np.random.default_rng(5))
    assert every_run.held.mean() >= 0.99
    assert np.isfinite(every_run.settle_attitude).mean() >= 0.99


def test_random_starts_are_spread_evenly_over_the_rotations():
    """The angle of a uniform rotation has density (1 − cos θ)/π, so its mean is π/2 + 2/π and its deviation 0.65."""
    every_run = ensemble.starts(shortened("paper", 0.5), 2000, np.random.default_rng(1))
    assert every_run.attitude[:, 0].mean() == pytest.approx(np.pi / 2 + 2 / np.pi, abs=4 * 0.65 / np.sqrt(2000))
    assert np.abs(np.diff(every_run.position[::10, 0])).max() == 0  # x̂ = 0 everywhere


def test_a_random_start_is_the_run_that_starts_there():
    p = shortened("paper", 4.0)  # of the three one is held, one settles too late to be held, and one never settles
    rng = np.random.default_rng(3)
    rotations = Rotation.from_quat(rng.standard_normal((66, 4))).as_matrix()
    every_run = ensemble.starts(p, 66, np.random.default_rng(3))
    np.testing.assert_array_equal(every_run.seed, p.seed + np.arange(66) // 64)
    for k in (0, 19, 65):
        seed = int(every_run.seed[k])
        truth, z = record.simulated(record.truth_inputs(p)), record.measured(record.truth_inputs(p), p.sensors, seed)
        start = cascade.Start(state=np.zeros(13), rotation=rotations[k])
        setting = cascade.ObserverConfig(world=p.world, sensors=p.sensors, gains=p.gains)
        estimate = cascade.observe(z, start, setting)
        alone = errors.of(estimate, truth=truth.state, rotation=truth.motion.rotation)
        on_grid = np.isin(z.time, every_run.time)
        np.testing.assert_array_equal(every_run.attitude[k], alone.attitude[on_grid])
        np.testing.assert_array_equal(every_run.position[k], alone.position[on_grid])
        settled = record.settled(z.time, alone.attitude, record.SETTLED_ATTITUDE)
        assert every_run.settle_attitude[k] == (np.inf if settled is None else settled)
        assert every_run.steady_attitude_deg[k] == math.degrees(record.steady(alone.attitude))
        last = z.time >= z.time[-1] - runs.HOLD
        small = (alone.attitude[last] < record.SETTLED_ATTITUDE) & (alone.position[last] < record.SETTLED_POSITION)
        assert every_run.held[k] == small.all()
    assert every_run.held[[0, 19, 65]].tolist() == [True, False, False]
    assert np.isfinite(every_run.settle_attitude[[0, 19, 65]]).tolist() == [True, True, False]


def test_the_sphere_of_starts_begins_at_its_angle_and_settles_as_each_axis_would_alone():
    p = shortened("paper", 6.0)
    region = ensemble.basin(p, 2.5, 40)
    np.testing.assert_allclose(region.attitude[:, 0], 2.5, rtol=1e-12)
    for k in (0, 17, 39):
        guess = replace(p.guess, attitude_axis=tuple(region.axis[k].tolist()), attitude_angle=2.5)
        alone = record.run(replace(p, guess=guess)).errors.attitude
        np.testing.assert_allclose(region.final[k], alone[-1], atol=1e-9)  # the same start but for its last digit
        expected = record.settled(record.simulated(record.truth_inputs(p)).motion.time, alone, record.SETTLED_ATTITUDE)
        assert region.settle[k] == (np.inf if expected is None else expected)


def silenced(p: Preset) -> Preset:
    """Exact sensors and x̂ known, so that nothing but the attitude filter decides."""
    silent = replace(p.sensors.noise, gyro=0.0, accel=0.0, mag=0.0, range=0.0)
    return replace(p, sensors=replace(p.sensors, noise=silent), guess=Guess(state="truth"))


def test_near_a_half_turn_starts_linger_on_the_whole_sphere():
    p = silenced(shortened("paper", 8.0))
    near, far = (np.median(ensemble.basin(p, angle, 100).settle) for angle in (np.pi - 0.01, 2.0))
    assert near > 1.5 * far


def test_about_the_slowest_axis_many_starts_follow_the_closed_form():
    """About the eigenvector of M's largest eigenvalue λ the error stays on its axis: θ̇ = −k1 (tr M − λ) sin θ."""
    p = silenced(shortened("paper", 6.0))
    truth, z = record.simulated(record.truth_inputs(p)), record.drawn(record.truth_inputs(p), p.sensors, 0)
    eigenvalues, axes = np.linalg.eigh(attitude.decay_matrix(p.gains.attitude, p.world))
    rate = p.gains.attitude.k1 * (eigenvalues[0] + eigenvalues[1])
    angle = np.array([0.5, 2.0, 3.0, 3.1])  # closer to π the saddle magnifies the error of the integration
    rotations = so3.exp(-angle[:, None] * axes[:, 2]) @ truth.motion.rotation[0]
    computed = runs.attitude_errors(p, truth, z, rotations)
    expected = 2 * np.arctan(np.tan(angle / 2)[:, None] * np.exp(-rate * z.time))
    np.testing.assert_allclose(computed, expected, atol=2e-3)  # (h rate)² of Heun and of the turn between two samples


def test_the_points_of_the_sphere_are_spread_evenly():
    axes = ensemble.sphere(500)
    np.testing.assert_allclose(np.linalg.norm(axes, axis=1), 1, rtol=1e-14)
    np.testing.assert_allclose(axes.T @ axes / 500, np.eye(3) / 3, atol=2e-3)  # the second moment of the sphere
    cosine = axes @ axes.T - 2 * np.eye(500)
    nearest = np.arccos(cosine.max(axis=1))
    ideal = np.sqrt(8 * np.pi / (np.sqrt(3) * 500))  # of a hexagonal lattice with the same region for each point
    assert nearest.min() > 0.75 * ideal


def test_predicted_and_reached_accuracy_stand_at_the_ends_of_the_windows():
    p = shortened("paper", 8.0)
    six, analysed = ensemble.seeds(p, 6), analysis.analyse(p)
    both = ensemble.achieved(six, analysed)
    np.testing.assert_array_equal(both.time, analysed.windows.start + analysed.windows.window)
    assert both.time[-1] == pytest.approx(8.0)
    assert both.achieved[-1] == pytest.approx(np.sqrt(np.mean(six.position[:, -1] ** 2)), rel=1e-12)
    assert both.estimated[-1] == np.sort(six.sigma[:, -1])[2]
    np.testing.assert_array_equal(both.cramer_rao, analysed.windows.sigma_nonlinear)
    assert np.all(both.cramer_rao < 1.1 * both.lifted)  # a bound, by a quadrature good to 7 % near the anchor


def test_progress_rises_to_one_in_the_callers_thread():
    seen = []
    ensemble.seeds(SHORT, 24, progress=lambda share: seen.append((share, threading.current_thread())))
    shares, threads = zip(*seen, strict=True)
    assert list(shares) == [1 / 3, 2 / 3, 1]  # eight runs at once
    assert set(threads) == {threading.current_thread()}


@pytest.mark.parametrize("job", [ensemble.seeds, ensemble.basin], ids=["seeds", "basin"])
def test_cancelled_work_stops_and_leaves_no_thread_behind(job):
    before, seen = set(threading.enumerate()), []

    def cancelled():
        return len(seen) >= 2

    arguments = (SHORT, 500) if job is ensemble.seeds else (SHORT, 1.0, 500)
    with pytest.raises(CancelledError):
        job(*arguments, progress=seen.append, cancelled=cancelled)
    assert len(seen) == 2
    assert set(threading.enumerate()) <= before


def test_cancelling_is_noticed_while_the_first_run_still_works():
    """Between two runs nothing tells the pool; it asks by itself."""
    asked, release = [], threading.Event()

    def cancelled():
        asked.append(True)
        if len(asked) == 3:
            release.set()
        return len(asked) >= 3

    with pytest.raises(CancelledError):
        ensemble.each(lambda _: release.wait(10), range(3), samples=1, progress=lambda _: None, cancelled=cancelled)


def test_the_first_error_of_a_run_is_raised_and_the_rest_is_dropped():
    done = []

    def work(k):
        if k == 1:
            raise ValueError("accel must be finite")
        time.sleep(0.01)
        done.append(k)

    with pytest.raises(ValueError, match="accel must be finite"):
        ensemble.each(work, range(200), samples=1, progress=lambda _: None, cancelled=lambda: False)
    assert len(done) < 100


def test_long_records_are_taken_fewer_at_once_and_in_parts(monkeypatch):
    """However many cores there are, memory is bounded; the numbers stay the same."""
    expected = ensemble.basin(SHORT, 2.0, 12)
    monkeypatch.setattr(runs, "BATCH", 1)
    np.testing.assert_array_equal(ensemble.basin(SHORT, 2.0, 12).attitude, expected.attitude)
    working, most = [], []

    def work(k):
        working.append(k)
        most.append(len(working))
        time.sleep(0.01)
        working.remove(k)

    monkeypatch.setattr(pool.os, "cpu_count", lambda: 64)
    nothing = {"progress": lambda _: None, "cancelled": lambda: False}
    ensemble.each(work, range(12), samples=pool.MAX_AT_ONCE // 2, **nothing)
    assert max(most) <= 2


@pytest.mark.parametrize(
    ("work", "sentence"),
    [
        (lambda: ensemble.seeds(SHORT, 0), "the number of runs must lie between 1 and 10000, got 0"),
        (lambda: ensemble.seeds(SHORT, 10_001), "the number of runs must lie between 1 and 10000, got 10001"),
        (
            lambda: ensemble.starts(replace(SHORT, duration=600.0), 2000, np.random.default_rng(0)),
            "runs × duration × IMU rate must not exceed 200000000 samples, got 240000000",
        ),
        (lambda: ensemble.basin(SHORT, 1.0, 0), "the number of axes must lie between 1 and 2000, got 0"),
        (lambda: ensemble.basin(SHORT, 3.2), "angle must lie between 0 and 3.14159 rad, got 3.2"),
        (lambda: ensemble.basin(SHORT, np.nan), "angle must lie between 0 and 3.14159 rad, got nan"),
    ],
)
def test_too_much_work_is_refused_in_one_sentence(work, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        work()


def test_the_errors_of_attitudes_are_angles_of_the_true_against_the_estimated():
    p = shortened("paper", 1.0)
    region = ensemble.basin(p, 0.7, 3)
    truth = record.simulated(record.truth_inputs(p)).motion
    start = so3.exp(-0.7 * region.axis[1]) @ truth.rotation[0]
    assert so3.angle(truth.rotation[0] @ start.T) == pytest.approx(region.attitude[1, 0])
