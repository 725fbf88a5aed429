"""Estimators compared: the same record, the same definitions, and a text that tells a wrong place from a right one."""

from dataclasses import replace as changed

import numpy as np
import pytest
from msgspec.structs import replace

from rangenav import comparison, preset, record, refine

pytestmark = pytest.mark.slow


def candidates(name: str, **changes) -> dict[str, comparison.Candidate]:
    return {c.name: c for c in comparison.compare(record.run(replace(preset.load(name), **changes)))}


def test_the_refinement_is_best_and_all_judge_the_same_record():
    of = record.run(preset.load("paper"))
    candidates_by_name = {c.name: c for c in comparison.compare(of)}
    assert list(candidates_by_name) == [comparison.CASCADE, comparison.REFINEMENT, comparison.EKF, comparison.EKF_TRUTH]
    assert candidates_by_name[comparison.CASCADE].estimate is of.estimate
    steady = {name: c.summary.steady_position for name, c in candidates_by_name.items()}
    assert steady[comparison.REFINEMENT] < min(steady[comparison.CASCADE], steady[comparison.EKF_TRUTH])
    assert candidates_by_name[comparison.REFINEMENT].outcome.startswith("converged after")
    assert candidates_by_name[comparison.CASCADE].outcome.startswith("within 0.3 m from t = ")
    for c in candidates_by_name.values():
        assert c.estimate.state.shape == of.truth.state.shape
        assert c.estimate.innovation.shape == of.estimate.innovation.shape
        assert c.summary.microseconds_per_step > 0


def test_the_text_names_a_wrong_place():
    candidates_by_name = candidates("soft")
    assert candidates_by_name[comparison.EKF].outcome.startswith("in a wrong place: ")
    assert candidates_by_name[comparison.CASCADE].outcome.startswith("not settled: ")  # below 0.3 m for 0.26 s at most


def test_a_refinement_that_converged_to_the_mirror_image_says_so():
    of = record.run(preset.load("soft"))
    track = refine.refine(of.measurements, of.estimate, comparison.config_of(of)).track
    away = changed(track, position=track.position + 3.0)
    assert comparison.candidate("refined", away, of, 0.1, outcome="converged after 9 passes").outcome.startswith(
        "converged after 9 passes; in a wrong place: "
    )
    assert comparison.candidate("refined", track, of, 0.1, outcome="converged").outcome == "converged"


def test_the_text_names_what_is_not_a_number():
    of = record.run(replace(preset.load("paper"), duration=7.0))
    lost = of.errors.position.copy()
    lost[200:] = np.nan
    text = comparison.outcome_text(of.estimate, changed(of.errors, position=lost), of.summary)
    assert text == "not a number from t = 1 s on"


@pytest.mark.parametrize("name", ["hover", "line"])
def test_blind_motions_are_compared_as_well(name: str):
    assert len(candidates(name, duration=10.0)) == 4
