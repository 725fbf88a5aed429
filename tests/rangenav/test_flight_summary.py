"""The few numbers that sum up a recorded flight: quarters of an error, missing truth, windows by verdict."""

from dataclasses import replace

import numpy as np
import pytest

from rangenav.flight_summary import failure, more_ranges, ranges_source, summarise_observer, summarise_windows
from rangenav.formats.recorded_flight import Flight
from rangenav.logs import Informative, Observed
from rangenav.motion import World
from tests.support.records import scene


def observed(position_error, attitude_error=None) -> Observed:
    made = scene("soft", duration=2.0, guess="truth")
    estimate, z = made.observe(), made.measurements
    n = len(estimate.time)
    return Observed(
        estimate=estimate,
        world=World(),
        range_time=z.range_time,
        range=z.range,
        range_sigma=0.1,
        position=np.tile([1.0, 2.0, 3.0], (n, 1)),
        position_error=None if position_error is None else np.resize(position_error, n),
        attitude_error=None if attitude_error is None else np.resize(attitude_error, n),
    )


def test_a_constant_error_is_its_own_root_mean_square_in_every_quarter_and_its_own_median():
    summary = summarise_observer(observed(0.25, np.radians(3.0)))
    assert summary.position is not None
    assert summary.attitude is not None
    assert summary.position.quarters == pytest.approx((0.25,) * 4)
    assert summary.position.median == pytest.approx(0.25)
    assert summary.attitude.quarters == pytest.approx((3.0,) * 4)
    assert summary.final_position == (1.0, 2.0, 3.0)


def test_an_observer_that_ends_far_from_the_truth_has_failed_and_one_that_is_settling_has_not():
    near, far = summarise_observer(observed(1.4)), summarise_observer(observed(9.0))
    assert failure(near, required=0.5) is None
    assert failure(far, required=0.5) == "the observer is 9 m off in the last quarter of the record"
    assert (
        failure(summarise_observer(observed(np.inf)), required=0.5) is None
    )  # no truth there, and the estimate is sound


def test_an_observer_whose_innovations_are_far_above_their_deviation_has_diverged_by_the_same_figure():
    """Divergence and the fit of the ranges are one judgement: no estimate fits the ranges and has diverged by them."""
    sound = observed(None)
    innovation = sound.estimate.innovation.copy()
    innovation[:, 0] = 20 * np.sqrt(innovation[:, 1])
    summary = summarise_observer(replace(sound, estimate=replace(sound.estimate, innovation=innovation, phase=None)))
    assert summary.fit.word == "overconfident"
    assert summary.fit.factor == pytest.approx(20.0)
    assert summary.diverged == "its innovations are 20 times as large as it expects"
    assert "has diverged" in str(failure(summary, required=0.5))


def test_without_a_truth_there_is_no_error_and_an_overflow_is_none_and_never_infinite():
    summary = summarise_observer(observed(None))
    assert summary.position is None
    assert summary.attitude is None
    overflowed = summarise_observer(observed(np.inf)).position
    assert overflowed is not None
    assert overflowed.quarters == (None,) * 4
    assert not overflowed.complete


def test_windows_are_counted_by_verdict_and_a_blind_worst_window_has_no_position_error():
    informative = Informative(
        start=np.array([0.0, 1.0, 2.0]),
        window=6.0,
        eigenvalues=np.arange(39.0).reshape(3, 13),
        scaled=np.ones((3, 13)),
        motion_rank=np.array([13, 10, 13]),
        ranges=np.array([50, 50, 50]),
        rank=np.array([13, 10, 13]),
        noise=np.zeros((3, 13)),
        sigma=np.array([0.2, np.nan, 0.4]),
        worst=1,
        each=("observable", "blind", "observable"),
    )
    summary = summarise_windows(informative)
    assert summary.counts == {"observable": 2, "weak": 0, "too few ranges": 0, "blind": 1, "not judged": 0}
    assert (summary.worst_start, summary.worst_rank, summary.worst_position) == (1.0, 10, None)
    assert summary.median_position == pytest.approx(0.3)


def test_the_source_of_ranges_names_their_noise_or_count_and_their_anchor_and_who_stated_it():
    z = scene("soft", duration=2.0).measurements
    flight = Flight(time=z.time, gyro=z.gyro, accel=z.accel, mag=z.mag, range_time=z.range_time, range=z.range)
    place = (1.0, 0.0, -2.5)
    assert ranges_source(flight, place, synthetic=0.05, anchor_given=True) == (
        "with synthetic ranges of σ 0.05 m to an anchor at (1, 0, -2.5) m, as given"
    )
    assert ranges_source(flight, place, synthetic=None, anchor_given=False) == (
        f"with {len(z.range)} ranges of the file to an anchor at (1, 0, -2.5) m, as the file says"
    )
    bare = replace(flight, range_time=z.range_time[:0], range=z.range[:0])
    assert ranges_source(bare, place, synthetic=None, anchor_given=True) == ""


def test_more_ranges_are_asked_for_only_where_windows_have_too_few():
    assert more_ranges({"blind": 3, "too few ranges": 0}) == ""
    assert more_ranges({"blind": 3, "too few ranges": 2}).startswith(
        "13 ranges or more would determine 2 of the windows"
    )
