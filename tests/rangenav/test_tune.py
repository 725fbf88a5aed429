"""The search never loses on its training seeds, keeps its bounds, and finds gains whose worth is known beforehand."""

import math

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from rangenav import preset, record, tradeoff, tune
from rangenav.attitude import SCHEDULED, AttitudeGains
from rangenav.gains import Gains, Guess
from rangenav.preset import Preset
from rangenav.progress import CancelledError
from rangenav.riccati import Blocks, RiccatiGains
from rangenav.tradeoff import Point
from tests.support.refusals import exactly

pytestmark = pytest.mark.slow


def shortened(name: str, duration: float, gains: Gains | None = None) -> Preset:
    p = preset.load(name)
    window = min(p.requirement.window, duration / 2)
    requirement = replace(p.requirement, window=window)
    return replace(p, duration=duration, requirement=requirement, gains=gains or p.gains)


BAD = Gains(
    riccati=RiccatiGains(q=1.0, v=Blocks(xi=1.0, position=1.0, velocity=1.0, gravity=1.0)),
    attitude=AttitudeGains(k1=0.1),
)
"""Trusts no range and corrects nothing: there is much to win."""
SHORT = shortened("paper", 6.0)


@pytest.mark.parametrize("gains", [Gains(), BAD, Gains(mode="noise-matched", attitude=SCHEDULED)])
def test_the_training_objective_never_rises(gains):
    for weight in (0.0, 0.5, 1.0):
        tuned = tune.tune(shortened("paper", 4.0, gains), runs=2, evaluations=12, steadiness=weight)
        assert tuned.before.gains == gains
        assert tuned.after.objective(weight) <= tuned.before.objective(weight)
        assert tuned.after.objective(weight) == min(point.objective(weight) for point in tuned.points)


def test_from_bad_gains_it_finds_ones_that_are_good_on_seeds_it_has_not_seen():
    tuned = tune.tune(shortened("paper", 6.0, BAD), runs=3, evaluations=150)
    assert tuned.held_out_before.settled == 0
    assert tuned.held_out_after.settled == 1
    assert tuned.held_out_after.steady_position < tuned.held_out_before.steady_position / 3
    assert tuned.starts_after > tuned.starts_before


def test_steadiness_buys_exactness_with_time():
    soon, steady = (tune.tune(SHORT, runs=3, evaluations=120, steadiness=w).after for w in (0.0, 1.0))
    assert soon.settle < steady.settle
    assert steady.steady < soon.steady


def test_two_searches_are_equal():
    first, second = (tune.tune(SHORT, runs=2, evaluations=15) for _ in range(2))
    assert first.points == second.points
    assert first.held_out_after == second.held_out_after


def test_what_a_point_says_is_what_the_runs_say():
    """One seed, the preset's own start and default gains: settling and steady errors of its summary."""
    tuned = tune.tune(SHORT, runs=1, evaluations=1)
    for point, seed in ((tuned.held_out_before, SHORT.seed), (tuned.before, SHORT.seed + tune.TRAINING_OFFSET)):
        summary = record.run_seed(SHORT, seed).summary
        assert point.settle_position == pytest.approx(summary.settle_position_s, rel=1e-12)
        assert point.settle_attitude == pytest.approx(summary.settle_attitude_s, rel=1e-12)
        assert point.steady_position == pytest.approx(summary.steady_position, rel=1e-12)
        assert math.degrees(point.steady_attitude) == pytest.approx(summary.steady_attitude_deg, rel=1e-9)
        assert point.settled == 1.0
    assert tuned.after == tuned.before
    assert tuned.points == (tuned.before,)


def test_all_but_the_first_seed_start_about_an_axis_of_their_own():
    """About the presets' own axis the magnetometer alone is enough, so a blind gravity would look good."""
    deaf = replace(SHORT.gains, attitude=AttitudeGains(k1=4.0, rho2=1e-6))
    tuned = tune.tune(replace(SHORT, gains=deaf), runs=1, evaluations=1).held_out_before
    assert tuned.settled == 1
    assert tune.tune(replace(SHORT, gains=deaf), runs=8, evaluations=1).held_out_before.settled < 0.5


def test_a_run_that_never_settles_counts_as_twice_the_duration_and_numbers_stay_finite():
    tuned = tune.tune(shortened("hover", 4.0), runs=2, evaluations=5)
    assert tuned.before.settle_position == pytest.approx(8.0)
    assert tuned.before.settled == 0
    for point in tuned.points:
        assert math.isfinite(point.objective(0.5))
    known = replace(SHORT, guess=Guess(state="truth"))
    assert tune.tune(known, runs=1, evaluations=1).before.settle_attitude == pytest.approx(tradeoff.SOONEST)


def test_only_gains_that_do_something_are_searched():
    constant = tune.tune(SHORT, runs=1, evaluations=60)
    assert len({point.gains.riccati.q for point in constant.points}) > 5
    assert {point.gains.attitude.rho1 for point in constant.points} == {1.0}
    assert {point.gains.attitude.schedule for point in constant.points} == {None}
    matched = tune.tune(replace(SHORT, gains=Gains(mode="noise-matched", attitude=SCHEDULED)), runs=1, evaluations=60)
    assert {(point.gains.mode, point.gains.riccati.q, point.gains.riccati.v) for point in matched.points} == {
        ("noise-matched", Gains().riccati.q, Gains().riccati.v)
    }
    assert len({point.gains.riccati.p0 for point in matched.points}) > 5
    assert len({point.gains.attitude.schedule for point in matched.points}) > 5


points = st.builds(
    Point,
    gains=st.just(Gains()),
    settled=st.just(1.0),
    **dict.fromkeys(
        ("settle_position", "settle_attitude", "steady_position", "steady_attitude"),
        st.sampled_from([0.1, 0.2, 0.5, 1.0, 2.0, 3.0]),
    ),
)


@settings(max_examples=200)
@given(st.lists(points, min_size=1, max_size=20).map(tuple))
def test_the_front_is_what_no_other_point_beats_in_both(seen):
    kept = tradeoff.front(seen, "settle_position", "steady_position")

    def pair(point):
        return point.settle_position, point.steady_position

    def beats(one, other):
        return pair(one) != pair(other) and all(a <= b for a, b in zip(pair(one), pair(other), strict=True))

    assert {pair(p) for p in kept} == {pair(p) for p in seen if not any(beats(other, p) for other in seen)}
    assert [p.settle_position for p in kept] == sorted({p.settle_position for p in kept})


def test_the_chosen_gains_are_on_the_front_of_what_was_weighed():
    tuned = tune.tune(SHORT, runs=2, evaluations=40)
    on_front = tradeoff.front(tuned.points, "settle", "steady")
    assert tuned.after.objective(0.5) == min(point.objective(0.5) for point in on_front)


def test_evaluations_are_counted_and_progress_ends_at_one():
    for count in (1, 2, 7, 33):
        seen = []
        tuned = tune.tune(shortened("paper", 1.0), runs=1, evaluations=count, progress=seen.append)
        assert len(tuned.points) == count
        np.testing.assert_allclose(seen, np.arange(1, count + 1) / count)


def test_a_cancelled_search_stops():
    seen = []
    with pytest.raises(CancelledError):
        tune.tune(SHORT, runs=2, evaluations=500, progress=seen.append, cancelled=lambda: len(seen) >= 3)
    assert len(seen) == 3


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"steadiness": 1.5}, "steadiness must lie between 0 and 1, got 1.5"),
        ({"evaluations": 0}, "the number of evaluations must lie between 1 and 10000, got 0"),
        (
            {"runs": 9000, "evaluations": 1},
            "runs × duration × IMU rate must not exceed 10000000 samples kept, got 10800000",
        ),
        ({"runs": 0}, "the number of runs must lie between 1 and 10000, got 0"),
        (
            {"runs": 100, "evaluations": 10_000},
            "runs × duration × IMU rate must not exceed 200000000 samples, got 1200000000",
        ),
    ],
)
def test_too_much_or_no_work_is_refused_in_one_sentence(arguments, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        tune.tune(SHORT, **arguments)


def test_the_command_writes_a_preset_with_the_gains_it_reports(answer, tmp_path):
    preset.save(shortened("paper", 4.0), tmp_path / "short.toml")
    out = tmp_path / "tuned.toml"
    said = answer("tune", tmp_path / "short.toml", "--runs", 2, "--evaluations", 10, "-o", out)
    assert said["saved"] == str(out)
    assert (said["runs"], said["evaluations"], said["steadiness"]) == (2, 10, 0.5)
    written = preset.load(out)
    assert msgspec.to_builtins(written.gains) == said["gains"]["after"]
    assert replace(written, gains=Gains()) == replace(shortened("paper", 4.0), gains=Gains())
    assert said["objective"]["after"] <= said["objective"]["before"]
    assert said["held_out"]["seeds"] == [1, 2]
    keys = {"settled", "settle_position_s", "settle_attitude_s", "steady_position", "steady_attitude_deg"}
    for group in ("training", "held_out"):
        for side in ("before", "after"):
            assert set(said[group][side]) == keys
    for part in ("position", "attitude"):
        curve = said["curve"][part]
        assert [point["settle_s"] for point in curve] == sorted(point["settle_s"] for point in curve)
        for point in curve:
            assert msgspec.convert(point["gains"], Gains)
            assert "settles at" in point["words"]


def test_the_command_shows_before_beside_after(run, tmp_path):
    preset.save(shortened("paper", 4.0), tmp_path / "short.toml")
    code, out, err = run("tune", tmp_path / "short.toml", "--runs", 1, "--evaluations", 5)
    assert (code, err) == (0, "")
    for text in ("before → after", "held-out seeds", "steady position error", "random starts", "gains changed"):
        assert text in out


def test_the_command_replaces_no_file_unasked_and_says_so_before_it_works(run, tmp_path):
    there = tmp_path / "there.toml"
    there.write_text("mine")
    code, _, err = run("tune", "paper", "--runs", 1000, "-o", there)  # a minute, if it began
    assert (code, err) == (2, f"--output {there}: exists already; --overwrite replaces it\n")
    assert there.read_text() == "mine"
    preset.save(shortened("paper", 1.0), tmp_path / "short.toml")
    code, _, err = run("tune", tmp_path / "short.toml", "--runs", 1, "--evaluations", 2, "-o", there, "--overwrite")
    assert (code, err) == (0, "")
    assert preset.load(there).duration == 1.0


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("nowhere",), "nowhere: no such preset"),
        (("paper", "--runs", "0"), "the number of runs must lie between 1 and 10000, got 0"),
        (("paper", "--runs", "many"), "--runs"),
        (("paper", "--steadiness", "nan"), "--steadiness: must be a finite number, got 'nan'"),
        (("paper", "--evaluations", "100000"), "the number of evaluations must lie between 1 and 10000, got 100000"),
        (("paper", "-o", "tuned.json"), "--output must name a file that ends in .toml, got tuned.json"),
        (("paper", "-o", "/nowhere/tuned.toml"), "--output /nowhere/tuned.toml: no such folder"),
    ],
)
def test_bad_arguments_are_answered_in_one_line(run, arguments, sentence):
    code, out, err = run("tune", *arguments)
    assert (code, out) == (2, "")
    assert sentence in err
    assert err.count("\n") == 1
