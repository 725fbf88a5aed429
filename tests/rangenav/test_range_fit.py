"""What a run's innovations say of it: consistent, overconfident by a factor, correlated or lost."""

from dataclasses import replace

import numpy as np
import pytest

from rangenav import range_fit
from rangenav.acquisition import COLLECTING, CONSTANT, LOST, MATCHED
from rangenav.cascade import Estimate
from tests.support import records

RANGES = 2000


def estimate(innovation: np.ndarray, phase: int) -> Estimate:
    """A record of two samples whose ranges have these innovations, in units of σ."""
    blank = records.scene("paper-slow", duration=1.0).observe()
    pairs = np.column_stack([innovation, np.ones(len(innovation))])
    return replace(blank, innovation=pairs, phase=np.full(len(blank.time), phase, dtype=np.int8))


def noise(seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal(RANGES)


@pytest.mark.parametrize("phase", [CONSTANT, MATCHED])
def test_white_innovations_of_the_stated_size_are_consistent_in_every_run(phase: int):
    assert {range_fit.of(estimate(noise(seed), phase)).word for seed in range(40)} == {"consistent"}


@pytest.mark.parametrize("factor", [1.5, 3.0])
def test_innovations_that_are_too_large_name_their_factor(factor: float):
    fit = range_fit.of(estimate(factor * noise(), MATCHED))
    assert fit.word == "overconfident"
    assert fit.factor == pytest.approx(factor, rel=0.1)
    assert fit.summary(blind=True) == fit.summary(blind=False) == f"overconfident ×{fit.factor:.2g}"
    assert range_fit.of(estimate(factor * noise(), CONSTANT)).word == "consistent"  # their σ is a design quantity


def test_a_few_outliers_are_no_overconfidence_but_many_are():
    few, many = noise(), noise()
    few[::50], many[::2] = 100.0, 100.0
    assert range_fit.of(estimate(few, MATCHED)).word == "consistent"
    assert range_fit.of(estimate(many, MATCHED)).word == "overconfident"


@pytest.mark.parametrize(
    "innovation", [noise() + 0.5, np.convolve(noise(), np.ones(3), "same")], ids=["mean", "correlated"]
)
def test_constant_gains_are_judged_by_mean_and_whiteness(innovation: np.ndarray):
    assert range_fit.of(estimate(innovation, CONSTANT)).word == "correlated"


def test_an_estimator_without_phases_is_judged_by_the_size_of_its_innovations():
    """The extended Kalman filter's gains follow the noise, as noise-matched ones do."""
    ekf = replace(estimate(2.0 * noise(), CONSTANT), phase=None)
    assert range_fit.of(ekf).word == "overconfident"


def test_many_runs_are_counted_by_word_with_the_span_of_their_factors():
    fits = [range_fit.of(estimate(factor * noise(seed), MATCHED)) for seed, factor in enumerate([1.0, 1.0, 1.5, 3.0])]
    over = f"2 overconfident ×{fits[2].factor:.2g} to ×{fits[3].factor:.2g}"
    fits += [range_fit.of(estimate(noise(), LOST))]
    assert range_fit.counted(fits, blind=False) == f"2 consistent, {over}, 1 lost"
    assert range_fit.counted(fits, blind=True) == f"2 {range_fit.BLIND}, {over}, 1 lost"


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("phase", [CONSTANT, COLLECTING, MATCHED])
def test_innovations_of_any_size_are_judged_without_overflow(phase: int):
    """An estimate that runs away has innovations of 1e200 σ, and one without noise of 0."""
    huge = range_fit.of(estimate(1e200 * np.abs(noise()), phase))
    assert huge.word == ("correlated" if phase == CONSTANT else "overconfident")
    assert huge.factor is None or np.isfinite(huge.factor)
    assert range_fit.of(estimate(0.0 * noise(), phase)).word == "consistent"
    gone = estimate(noise(), phase)
    assert range_fit.of(replace(gone, state=np.full_like(gone.state, np.inf))).word == "lost"


def test_lost_few_ranges_and_blind_motions_say_so():
    assert range_fit.of(estimate(noise(), LOST)).word == "lost"
    assert range_fit.of(estimate(noise()[:40], MATCHED)).word == "not judged"
    assert range_fit.of(estimate(noise(), CONSTANT)).summary(blind=True) == range_fit.BLIND
    assert range_fit.of(estimate(noise(), COLLECTING)).summary(blind=False) == range_fit.COLLECTED


@pytest.mark.parametrize(
    ("phase", "gains"),
    [
        ([CONSTANT] * 4, "constant gains"),
        ([MATCHED] * 4, "noise-matched gains"),
        ([MATCHED, COLLECTING, MATCHED, MATCHED], "noise-matched gains, the initial guess given up once"),
        (
            [MATCHED, COLLECTING, MATCHED, COLLECTING],
            "noise-matched gains, the initial guess given up 2 times, constant gains at the end",
        ),
    ],
)
def test_a_fit_names_the_gains_and_how_often_they_gave_up_their_guess(phase: list[int], gains: str):
    run = estimate(noise(), phase[-1])
    phases = np.repeat(np.array(phase, dtype=np.int8), -(-len(run.time) // 4))[: len(run.time)]
    fit = range_fit.of(replace(run, phase=phases))
    assert fit.gains == gains
    assert fit.report(blind=False)["given_up"] == phase.count(COLLECTING)


def test_what_is_said_of_a_run_has_its_gains_and_the_predicted_error_unless_the_motion_is_blind():
    fit = range_fit.of(estimate(noise(), MATCHED))
    assert fit.statement(blind=False, predicted=1.812) == "consistent (noise-matched gains); predicted position ±1.81 m"
    assert fit.statement(blind=False, predicted=np.inf).endswith("predicted position not determined")
    assert fit.statement(blind=True, predicted=None) == f"{range_fit.BLIND} (noise-matched gains)"


def test_of_constant_gains_consistent_says_that_their_covariance_was_not_judged():
    """Whatever its size: innovations a tenth of their stated σ are as white as others."""
    fit = range_fit.of(estimate(0.1 * noise(), CONSTANT))
    words = "consistent by mean and whiteness of the innovations"
    assert fit.statement(blind=False, predicted=1.812) == f"{words} (constant gains); predicted position ±1.81 m"
    assert range_fit.counted([fit, fit], blind=False) == f"2 {words}"
    assert (fit.report(blind=False)["word"], fit.report(blind=False)["words"]) == ("consistent", words)
