"""Ranges that leave the position undetermined: counted, aliased, or below rounding, which 60 digits tell apart."""

import math

import pytest
from msgspec.structs import replace

from explorer.model import assessment
from explorer.model.compute import compute
from explorer.model.settings import Settings
from explorer.panels import figures
from rangenav import analysis, certificate, preset, report
from rangenav import preset as presets
from rangenav.analysis import Analysis
from rangenav.commands.text import analyze as text
from rangenav.motion import World
from rangenav.observability import undetermined
from rangenav.preset import Preset, Requirement
from rangenav.signals import Multisine, Waypoint, Waypoints
from tests.support import precise_rank
from tests.support.precise_rank import tones

SOFT = preset.load("soft")
SHORT = replace(SOFT, requirement=Requirement(window=1.2, mu=1e-6, position_sigma=0.5))
"""Its 13 functions have rank 13 as computed; its ranges do not, as computed."""
REASON = "ranges in the 1.2 s from t = "
AT_THIS = "do not determine the position at this precision"
HIDDEN = Multisine(tones=tones(("x", 1.0, 1.5, 0.0), ("y", 0.4, 2.25, 0.3), ("z", 0.5, 20 * math.pi, 0.7)))
"""Each range at 10 Hz finds the tone along z in the same phase."""


@pytest.fixture(scope="module")
def analysed() -> Analysis:
    return analysis.analyse(SHORT)


@pytest.fixture(scope="module")
def issued() -> certificate.Certificate:
    return certificate.certify(presets.dumps(SHORT).encode(), source="preset")


def test_ranges_that_60_digits_give_rank_13_are_weak_and_not_blind(analysed: Analysis):
    assert analysed.proof is not None
    held = analysed.proof.accuracy.windows
    assert isinstance(SHORT.path, Multisine)
    rate = SHORT.sensors.range_rate
    assert precise_rank.rank_of_ranges(SHORT.path, SHORT.world.gravity, held.first, held.last, rate) == 13
    assert (analysed.rank, analysed.rounded, analysed.ranges_rounded) == (13, False, True)
    assert not math.isfinite(held.bound)
    assert analysed.verdict.word == "weak"
    assert REASON in analysed.verdict.reason
    assert analysed.verdict.reason.endswith(AT_THIS)
    assert not analysed.proof.accuracy_proven


def test_report_and_json_call_nothing_of_it_blind_or_proven(analysed: Analysis):
    said = text.report(SHORT, analysed, name="short")
    stated = report.analysis_report(SHORT, analysed, name="short")
    assert said.sign == "!"
    assert said.answer.startswith("weak: rank 13 in ")
    assert AT_THIS in said.answer
    assert (stated["verdict"], stated["accuracy"]["rounded"], stated["accuracy"]["proven"]) == ("weak", True, False)
    assert "at this precision" in stated["accuracy"]["reason"]
    assert "blind" not in str(stated["accuracy"])


def test_the_certificate_calls_nothing_of_it_blind_or_proven(issued: certificate.Certificate):
    check = {one.name: one for one in issued.checks}
    assert (issued.verdict, issued.meets, issued.accuracy.rounded) == ("weak", False, True)
    assert (check["accuracy"].met, check["accuracy"].proven) == (False, False)
    assert "is not determined at this precision" in check["accuracy"].words
    assert issued.accuracy.scope
    assert issued.accuracy.scope.basis == "sampled"
    expected_blind = replace(SHORT, expect="unobservable", requirement=replace(SHORT.requirement, mu=1e-12))
    assert not certificate.certify(presets.dumps(expected_blind).encode(), source="preset").certified


@pytest.mark.parametrize("window", [0.5, 0.9])
def test_the_page_says_it_in_amber_and_with_the_reason(window: float):
    """At 0.5 s the rank itself is below rounding, too; it is that of sampled windows here. At 0.9 s the ranges of four
    in ten windows do not determine the position; at 1.2 s those of five in a thousand, which some windows may miss."""
    picture = compute(Settings(preset=replace(SHORT, requirement=replace(SHORT.requirement, window=window))))
    given, rows = {one.question: one for one in assessment.answers(picture)}, dict(figures.rows(picture))
    assert given["seen"].level == given["accuracy"].level == "mind"
    assert given["seen"].summary == picture.analysis.verdict.reason
    assert "at this precision" in given["seen"].summary
    assert "at this precision" in given["accuracy"].summary
    assert rows["σ lifted"] == "position not determined at this precision"
    assert "blind" not in rows
    assert ("at least" in rows["rank"]) == picture.analysis.rounded


def aliased(path: Multisine, rate: float, window: float) -> Preset:
    sensors = replace(SOFT.sensors, range_rate=rate)
    needed = Requirement(window=window, mu=1e-9, position_sigma=1.0)
    return replace(SOFT, path=path, duration=40.0, sensors=sensors, requirement=needed)


def test_ranges_that_hide_a_frequency_leave_the_position_open_on_windows_of_every_length():
    seen = analysis.analyse(aliased(HIDDEN, 10.0, 8.0))
    proof = seen.proof
    assert proof is not None
    assert (seen.rank, proof.undetermined, seen.verdict.word) == (13, "alias", "blind")
    assert "nor do those of longer windows" in seen.verdict.reason
    assert not proof.accuracy_proven
    denser = analysis.analyse(aliased(HIDDEN, 11.0, 8.0))
    assert math.isfinite(denser.lifted_end.position)


def test_too_few_ranges_and_too_few_places_are_counted_and_so_proven():
    loop = Multisine(tones=tones(("x", 1.0, 2.0, 0.0), ("y", 0.8, 4.0, 1.0), ("z", 0.7, 6.0, 2.0)))
    rates = {"too few": 1.0, "same places": 3 / math.pi}
    for cause, rate in rates.items():
        proof = analysis.analyse(aliased(loop, rate, 12.0 if cause == "too few" else 20.0)).proof
        assert proof is not None
        assert proof.undetermined == cause
        assert proof.accuracy_proven


def test_places_are_told_apart_as_finely_as_time_is_rounded():
    assert undetermined.places(60, 1.0, 1.0) == 1
    assert undetermined.places(60, 1.0, 1.0 + 1e-9) == 60
    assert undetermined.places(60, 10.0, 0.7) == 7
    assert undetermined.places(60, 10.0, None) == 60


def test_of_pieces_longer_windows_show_nothing():
    points = tuple(Waypoint(time=float(k), value=(math.sin(k), math.cos(2 * k), math.sin(3 * k))) for k in range(9))
    of = undetermined.cause(Waypoints(points=points), World(), window=2.0, first=0, last=40, rate=20.0)
    assert of == "rounding"
