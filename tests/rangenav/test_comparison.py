"""Estimators side by side: same record, same definitions, and words that tell a wrong place from a right one."""

from dataclasses import replace as changed

import numpy as np
import pytest
from msgspec.structs import replace

from rangenav import comparison, preset, record, refine


def contenders(name: str, **changes) -> dict[str, comparison.Candidate]:
    return {c.name: c for c in comparison.compare(record.run(replace(preset.load(name), **changes)))}


def test_the_refinement_is_best_and_all_judge_the_same_record():
    of = record.run(preset.load("paper"))
    found = {c.name: c for c in comparison.compare(of)}
    assert list(found) == [comparison.CASCADE, comparison.REFINEMENT, comparison.EKF, comparison.EKF_TRUTH]
    assert found[comparison.CASCADE].estimate is of.estimate
    steady = {name: c.summary.steady_position for name, c in found.items()}
    assert steady[comparison.REFINEMENT] < min(steady[comparison.CASCADE], steady[comparison.EKF_TRUTH])
    assert found[comparison.REFINEMENT].words.startswith("converged after")
    for c in found.values():
        assert c.estimate.state.shape == of.truth.state.shape
        assert c.estimate.innovation.shape == of.estimate.innovation.shape
        assert c.summary.microseconds_per_step > 0


def test_words_tell_a_wrong_place():
    found = contenders("soft")
    assert found[comparison.EKF].words.startswith("in a wrong place: ")
    assert found[comparison.CASCADE].words.startswith("within 0.3 m from t = ")


def test_a_refinement_that_converged_to_the_mirror_image_says_so():
    of = record.run(preset.load("soft"))
    track = refine.refine(of.measurements, of.estimate, comparison._setting(of)).track
    away = changed(track, position=track.position + 3.0)
    assert comparison._contender("refined", away, of, 0.1, words="converged after 9 passes").words.startswith(
        "converged after 9 passes; in a wrong place: "
    )
    assert comparison._contender("refined", track, of, 0.1, words="converged").words == "converged"


def test_words_tell_what_is_not_a_number():
    of = record.run(replace(preset.load("paper"), duration=7.0))
    lost = of.errors.position.copy()
    lost[200:] = np.nan
    words = comparison._words(of.estimate, changed(of.errors, position=lost), of.summary)
    assert words == "not a number from t = 1 s on"


@pytest.mark.parametrize("name", ["hover", "line"])
def test_blind_motions_are_compared_as_well(name: str):
    assert len(contenders(name, duration=10.0)) == 4
