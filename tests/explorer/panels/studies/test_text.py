"""The sentence of a map, on maps whose values are known."""

import numpy as np

from explorer.model.study_axes import Candidate
from explorer.model.study_judgement import judged
from explorer.panels.studies.text import BLIND, MATCHED, sentence
from rangenav.studies.maps import StudyMap
from rangenav.studies.requirements import NO_LIMITS, Bound

NAMES = Candidate("gains.riccati.q", "range weight q"), Candidate("gains.attitude.k1", "attitude gain k1", "1/s")
WANTED = Bound(0.5, True, "position error wanted")


def said(values: list[list[float]], metric: str, bound: Bound | None = WANTED, *, matched: bool = False) -> str:
    array = np.array(values)
    of = StudyMap(
        first=np.arange(float(array.shape[0])),
        second=np.arange(float(array.shape[1])),
        values={metric: array},
        computed=np.ones(array.shape, dtype=bool),
        reason=np.full(array.shape, "", dtype=object),
        step=1,
    )
    return sentence(of, NAMES, metric, bound, judged(of, metric, bound), None, inside=True, matched=matched)


def test_a_parameter_that_changes_nothing_is_named_with_its_reason():
    both = said([[0.1, 0.1], [0.1, 0.1]], "steady_position", matched=True)
    assert "Neither range weight q nor attitude gain k1 changes" in both
    assert MATCHED in both
    one = said([[0.1, 0.1], [0.2, 0.2]], "steady_position", matched=True)
    assert "Attitude gain k1 does not change" in one
    assert MATCHED not in one  # k1 acts with noise-matched gains, too
    assert "change" not in said([[0.1, 0.2], [0.2, 0.3]], "steady_position")


def test_without_a_vehicle_nothing_meets_its_limits():
    assert said([[1.0, 1.0], [1.0, 1.0]], "flyable", Bound(0.5, False, NO_LIMITS)).startswith(
        "No vehicle is chosen, so no limit applies."
    )
    assert "meet" not in said([[1.0, 1.0]], "flyable", Bound(0.5, False, NO_LIMITS))


def test_a_map_without_any_finite_value_says_that_the_motion_is_blind():
    endless = said([[np.inf, np.inf]], "sigma_lifted")
    assert BLIND in endless
    assert BLIND in said([[np.nan, np.nan]], "sigma_lifted")  # no such number
    assert "%" not in endless
    assert BLIND not in said([[np.inf, np.inf]], "settle_position")
