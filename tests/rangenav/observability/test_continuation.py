"""A rank that is low because of rounding is no deficit: 60 digits, or a longer window of the same piece, tell."""

import json
import math

import pytest
from msgspec.structs import replace

from rangenav import analysis, certificate, explanation, preset, report, twin
from rangenav import preset as presets
from rangenav.observability import functions
from rangenav.observability.worst_rank import worst_rank
from rangenav.preset import Requirement
from rangenav.signals import Multisine, Waypoint, Waypoints
from tests.support import precise_rank
from tests.support.precise_rank import tones

SOFT = preset.load("soft")
SHORT = replace(SOFT, requirement=Requirement(window=0.5, mu=1e-12, position_sigma=0.5))
PLANAR = Multisine(tones=tones(("x", 1.0, 1.5, 0.0), ("y", 0.4, 2.25, 0.3)))


@pytest.fixture(scope="module")
def issued() -> certificate.Certificate:
    return certificate.certify(presets.dumps(SHORT).encode(), source="preset")


def test_a_window_that_60_digits_give_rank_13_is_weak_and_not_blind():
    analysed = analysis.analyse(SHORT)
    assert isinstance(SHORT.path, Multisine)
    assert precise_rank.rank(SHORT.path, SHORT.world.gravity, analysed.gramian_at, 0.5) == 13
    assert analysed.rank < 13
    assert analysed.rounded
    assert not analysed.directions
    for one in (analysed, analysis.sampled(SHORT)):
        assert one.verdict.word == "weak"
        assert one.verdict.reason.startswith(f"rank at least {one.rank} of 13, ")
    assert analysed.proof is not None
    assert not analysed.proof.rank_proven


def test_certificate_json_and_explanation_say_the_same_of_it(issued: certificate.Certificate):
    reason, stated = (
        analysis.analyse(SHORT).verdict.reason,
        report.analysis_report(SHORT, analysis.analyse(SHORT), name="short"),
    )
    check = {one.name: one for one in issued.checks}
    assert issued.verdict == stated["verdict"] == "weak"
    assert issued.verdict_reason == reason
    assert reason in check["rank"].words
    assert reason in stated["verdict_reason"]
    assert not check["rank"].met
    assert not check["rank"].proven
    assert not check["accuracy"].proven
    assert issued.rank.scope
    assert issued.rank.scope.basis == "sampled"
    assert not issued.rank.blind
    assert stated["gramian"]["rounded"]
    assert reason in stated["gramian"]["reason"]
    explained = explanation.explanation(SHORT, twin.twin(SHORT), name="short")
    assert explained["functions"]["relations"] == []
    assert "the rank is 13 of 13" in explained["printed"]["words"]
    assert "blind" not in json.dumps(stated["accuracy"])


def test_rounding_is_no_proof_that_a_motion_is_unobservable():
    wrong = replace(SHORT, expect="unobservable")
    assert not certificate.certify(presets.dumps(wrong).encode(), source="preset").certified


@pytest.mark.parametrize("window", [0.3, 3.0])
def test_a_deficit_of_the_motion_remains_one_on_windows_of_every_length(window: float):
    worst = worst_rank(PLANAR, SOFT.world, 20.0, window)
    assert (worst.rank, worst.rounded) == (11, False)
    assert {d.summary for d in worst.directions} == {
        "nothing excites z: the path has no snap along it; position and velocity along z cannot be told"
    }
    seen = functions.functions(PLANAR, SOFT.world.gravity, worst.at, window, until=20.0)
    assert [one.split()[0] for one in seen.unseen] == ["p_z", "v_z"]


@pytest.mark.parametrize("name", ["hover", "circle", "minimum-snap"])
def test_shipped_blind_motions_stay_blind(name: str):
    """Of minimum-snap, because a polynomial of degree 7 and its products with τ and τ² span 10 powers of τ."""
    p = preset.load(name)
    worst = worst_rank(p.path, p.world, p.duration, p.requirement.window)
    assert worst.rank < 13
    assert not worst.rounded


def test_a_deficit_on_a_window_of_several_pieces_is_blind_but_not_proven():
    """In a plane it is true; of what a computer adds up over knots it cannot be told from rounding."""
    points = tuple(Waypoint(time=float(k), value=(math.sin(k), math.cos(2.3 * k), 0.0)) for k in range(11))
    planar = replace(
        SOFT, path=Waypoints(points=points), duration=10.0, requirement=replace(SHORT.requirement, window=4)
    )
    stated = certificate.certify(presets.dumps(planar).encode(), source="preset")
    check = {one.name: one for one in stated.checks}
    assert (stated.verdict, stated.rank.rank) == ("blind", 11)
    assert not check["rank"].proven
    assert not check["accuracy"].proven
    assert "(proven)" not in check["rank"].words
    whole = worst_rank(preset.load("minimum-snap").path, SOFT.world, 24.0, 6.0)  # in one piece
    assert whole.resolved
