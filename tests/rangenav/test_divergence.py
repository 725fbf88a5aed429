"""When an observer has diverged, by figures that do not need the truth."""

from dataclasses import replace

import numpy as np
import pytest
from msgspec.structs import replace as changed

from rangenav import divergence, model, preset, range_fit, record
from rangenav.acquisition import CONSTANT, MATCHED
from rangenav.number_format import quantity
from rangenav.preset import Requirement
from rangenav.signals import Multisine, Tone
from tests.support import records


def diverged_of(distance, *, true_distance: float = 2.0) -> str | None:
    """The rule on a record of constant gains whose estimate is so far (m) from the anchor, from first to last."""
    made = records.scene("paper-slow", duration=2.0)
    estimate = made.observe()
    state = estimate.state.copy()
    state[:, model.POSITION] = 0.0
    state[:, model.POSITION.start] = np.interp(np.linspace(0, 1, len(state)), np.linspace(0, 1, 5), distance)
    time, ranges = made.measurements.range_time, np.full(len(made.measurements.range), true_distance)
    estimate = replace(estimate, state=state)
    return divergence.divergence(estimate, time, ranges, range_fit.of(estimate))


@pytest.mark.parametrize(
    ("distance", "diverged"),
    [
        ([2, 2, 2, 2, 2], False),  # on the sphere that the ranges measure
        ([10000, 8000, 5000, 1000, 0], False),  # far, and coming back
        ([2, 4, 5, 6, 7], False),  # leaving, and not yet three ranges away
        ([2, 20, 50, 90, 200], True),
        ([2, 400, 90, 300, 200], True),  # neither comes nor goes
        ([9000, 20, 20, 200, 400], True),  # had come back
        ([0, 0, 0, 0, 1e200], True),  # its square overflows
    ],
)
def test_an_observer_that_is_far_beyond_its_ranges_and_leaves_them_has_diverged(distance, diverged: bool):
    found = diverged_of(distance)
    assert (found is not None) == diverged
    if found is not None and max(distance) < 1e9:
        assert "the longest range is 2 m" in found
    larger = diverged_of([3 * x for x in distance], true_distance=6.0)
    assert (larger is not None) == diverged  # the rule has no length of its own


def slow_eight():
    """An eight with a yo-yo, 30 m wide and minutes long: constant gains do not hold it."""
    tones = (
        Tone(axis="x", amplitude=30.0, frequency=0.04),
        Tone(axis="y", amplitude=15.0, frequency=0.08),
        Tone(axis="z", amplitude=8.0, frequency=0.05),
    )
    of = preset.load("soft")
    return changed(of, path=Multisine(tones=tones), duration=300.0, requirement=Requirement(window=150.0))


def test_a_run_of_constant_gains_that_ends_far_off_has_diverged_by_the_same_rule_in_every_summary():
    run = record.run(slow_eight())
    assert run.summary.steady_position > 200
    z = run.measurements
    assert run.summary.diverged
    assert run.summary.divergence == divergence.divergence(run.estimate, z.range_time, z.range, run.summary.fit)
    assert run.summary.range_residual > 3 * z.range.max()


@pytest.mark.parametrize("name", ["hover", "wiggle"])
def test_no_run_whose_position_is_far_off_its_ranges_is_said_to_fit_them(name: str):
    """Innovations may be white where the estimate is elsewhere: the state does not only follow them."""
    summary, blind = record.run(preset.load(name)).summary, name == "hover"
    assert summary.range_residual > 1.0
    residual = quantity(summary.range_residual, "m")
    said = f"the innovations are as expected, but its distance from the anchor is wrong by {residual}"
    undetermined = ", and the ranges do not determine the position" if blind else ""
    assert summary.fit.summary(blind=blind) == said + undetermined
    assert range_fit.counted([summary.fit] * 2, blind=False).startswith("2 the innovations are as expected, but ")


@pytest.mark.parametrize(
    ("phase", "own", "distance", "said"),
    [(CONSTANT, 9.0, 3.0, True), (CONSTANT, 9.0, 2.3, False), (MATCHED, 9.0, 3.0, False), (MATCHED, 0.1, 3.0, True)],
)
def test_an_own_deviation_excuses_a_residual_unless_it_is_a_design_quantity(phase, own, distance, said: bool):
    """Ranges of 2 m with a noise of 0.1 m; the own σ of constant gains says nothing."""
    made = records.scene("paper-slow", duration=2.0)
    estimate = made.observe()
    state, covariance = np.zeros_like(estimate.state), np.zeros_like(estimate.covariance)
    state[:, model.POSITION.start] = distance
    covariance[:, 0] = own**2 * np.eye(3)
    phases = np.full(len(estimate.time), phase, dtype=np.int8)
    estimate = replace(estimate, state=state, covariance=covariance, phase=phases)
    time = made.measurements.range_time
    fit = divergence.with_residual(range_fit.of(estimate), estimate, time, np.full(len(time), 2.0), 0.1)
    assert fit.off == (pytest.approx(distance - 2.0) if said else None)


@pytest.mark.parametrize("name", ["paper-slow", "soft", "lissajous"])
def test_no_run_that_is_settling_has_diverged(name: str):
    summary = record.run(preset.load(name)).summary
    assert not summary.diverged
    assert summary.range_residual < 1.0
