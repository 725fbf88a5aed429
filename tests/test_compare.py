"""Estimators side by side: same record, same definitions, and words that tell a wrong place from a right one."""

from dataclasses import replace as changed

import numpy as np
import pytest
from msgspec.structs import replace

from rangenav import compare, preset, record, refine


def contenders(name: str, **changes) -> dict[str, compare.Contender]:
    return {c.name: c for c in compare.compare(record.run(replace(preset.load(name), **changes)))}


def test_the_refinement_is_best_and_all_judge_the_same_record():
    of = record.run(preset.load("paper"))
    found = {c.name: c for c in compare.compare(of)}
    assert list(found) == [compare.CASCADE, compare.REFINEMENT, compare.EKF, compare.EKF_TRUTH]
    assert found[compare.CASCADE].estimate is of.estimate
    steady = {name: c.summary.steady_position for name, c in found.items()}
    assert steady[compare.REFINEMENT] < min(steady[compare.CASCADE], steady[compare.EKF_TRUTH])
    assert found[compare.REFINEMENT].words.startswith("converged after")
    for c in found.values():
        assert c.estimate.state.shape == of.truth.state.shape
        assert c.estimate.innovation.shape == of.estimate.innovation.shape
        assert c.summary.microseconds_per_step > 0


def test_words_tell_a_wrong_place():
    found = contenders("soft")
    assert found[compare.EKF].words.startswith("in a wrong place: ")
    assert found[compare.CASCADE].words.startswith("within 0.3 m from t = ")


def test_a_refinement_that_converged_to_the_mirror_image_says_so():
    of = record.run(preset.load("soft"))
    track = refine.refine(of.measurements, of.estimate, compare._setting(of)).track
    away = changed(track, position=track.position + 3.0)
    assert compare._contender("refined", away, of, 0.1, words="converged after 9 passes").words.startswith(
        "converged after 9 passes; in a wrong place: "
    )
    assert compare._contender("refined", track, of, 0.1, words="converged").words == "converged"


def test_words_tell_what_is_not_a_number():
    of = record.run(replace(preset.load("paper"), duration=7.0))
    lost = of.errors.position.copy()
    lost[200:] = np.nan
    words = compare._words(of.estimate, changed(of.errors, position=lost), of.summary)
    assert words == "not a number from t = 1 s on"


@pytest.mark.parametrize("name", ["hover", "line"])
def test_blind_motions_are_compared_as_well(name: str):
    assert len(contenders(name, duration=10.0)) == 4
