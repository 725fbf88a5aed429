"""The page asks what the command line asks about a recorded flight, and judges nothing against the evidence."""

from dataclasses import replace
from pathlib import Path

import pytest

from explorer.panels.presets import flights, import_panel
from explorer.storage import flight_report, import_file
from explorer.storage.flight_report import FlightOptions
from explorer.storage.import_file import ImportFile
from rangenav import formats, preset
from rangenav.number_format import UNBROKEN

pytestmark = pytest.mark.slow

ORIGIN = (0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def halved(tmp_path_factory: pytest.TempPathFactory) -> ImportFile:
    """A log of our own whose accelerometer has half its scale."""
    file: Path = tmp_path_factory.mktemp("log") / "flight.csv"
    formats.export(preset.load("barrel"), "log", file)
    lines = file.read_text().splitlines()
    head = next(k for k, line in enumerate(lines) if line.startswith("t [s]"))
    rows = [line.split(",") for line in lines[head + 1 :]]
    halves = [[*row[:4], *(repr(float(cell) / 2) if cell else "" for cell in row[4:7]), *row[7:]] for row in rows]
    return ImportFile("flight.csv", "\n".join([*lines[: head + 1], *map(",".join, halves)]).encode())


def test_the_page_asks_with_the_evidence_and_uses_the_corrected_record(halved: ImportFile):
    asked = import_file.interpret(halved, "log", {}, ORIGIN).result
    (question,) = asked.questions
    assert (question.key, question.suggestion) == ("accel-scale", "2")
    result = import_file.interpret(halved, "log", {"accel-scale": "2"}, ORIGIN).result
    assert (result.questions, result.unjudged) == ((), None)
    assert result.flight is not None
    report = flight_report.judge(result.flight, FlightOptions(anchor=result.flight.anchor or ORIGIN))
    assert report.whole.verdict == "observable"
    assert "observable: the whole record determines the position" in flights.report("flight.csv", report)


def test_the_page_does_not_judge_a_record_that_is_taken_against_the_evidence(halved: ImportFile):
    result = import_file.interpret(halved, "log", {"accel-scale": "1"}, ORIGIN).result
    assert result.flight is not None
    assert any("the record is not judged: the mean specific force" in one for one in import_panel.report(result))
    report = flight_report.judge(result.flight, FlightOptions(anchor=result.flight.anchor or ORIGIN))
    assert report.whole.verdict == "not judged"
    assert report.windows.counts["not judged"] == sum(report.windows.counts.values())
    assert "not judged: the mean specific force" in flights.report("flight.csv", report)


def test_the_head_of_a_result_says_that_the_observer_diverged_and_the_table_whether_requirements_are_met(
    halved: ImportFile,
):
    result = import_file.interpret(halved, "log", {"accel-scale": "2"}, ORIGIN).result
    assert result.flight is not None
    report = flight_report.judge(result.flight, FlightOptions(anchor=result.flight.anchor, position_sigma=1e-3))
    shown = flights.report("flight.csv", report).replace(UNBROKEN, " ")
    head, table = shown.split("</div>", 1)
    assert "flight.csv: ▲ weak" in head
    assert "required ±0.001 m: ✗ not met" in table
    assert ("blind if they begin at" in table) == ("blind where" in report.summary)
    diverged = replace(report, failure="the observer has diverged")
    assert "but the observer has diverged" in flights.report("flight.csv", diverged).split("</div>", 1)[0]


def test_the_page_names_its_own_menus_and_no_option_of_the_command_line():
    said = import_panel.in_page("10 ranges are no distances: not used (--range-values keep uses them)")
    assert said == "10 ranges are no distances: not used (“range-values: keep” uses them)"
    assert import_panel.in_page("too rare; --time-unit ms, if so") == "too rare; “time: ms”, if so"


def test_an_anchor_that_does_not_fit_the_ranges_is_named_when_the_flight_is_judged(halved: ImportFile):
    result = import_file.interpret(halved, "log", {"accel-scale": "2"}, ORIGIN).result
    assert result.flight is not None
    report = flight_report.judge(result.flight, FlightOptions(anchor=(5.0, 5.0, 5.0)))
    assert report.whole.verdict == "not judged"
    assert "for the anchor at (5, 5, 5)" in (report.whole.restriction or "")


def test_an_anchor_that_neither_file_nor_person_says_is_asked_and_none_is_used_without_ranges(halved: ImportFile):
    result = import_file.interpret(halved, "log", {"accel-scale": "2"}, ORIGIN).result
    assert result.flight is not None
    unknown = replace(result.flight, anchor=None)
    with pytest.raises(ValueError, match="where does the anchor stand"):
        flight_report.judge(unknown, FlightOptions())
    bare = replace(unknown, range_time=unknown.range_time[:0], range=unknown.range[:0], range_lines=None)
    report = flight_report.judge(bare, FlightOptions())
    assert (report.ranges_source, report.whole.ranges) == ("", 0)
    assert "13 ranges or more would determine" in flights.report("flight.csv", report)
    with pytest.raises(ValueError, match="where does the anchor stand"):
        flight_report.judge(bare, FlightOptions(ranges="synthetic"))


def test_gravity_and_field_that_nothing_tells_are_asked_for_and_no_usual_ones_are_used(halved: ImportFile):
    result = import_file.interpret(halved, "log", {"accel-scale": "2"}, ORIGIN).result
    assert result.flight is not None
    unknown = replace(result.flight, gravity=None, magnetic=None)
    source, evidence = flight_report.world_evidence(unknown)
    assert (source, "does not start still" in evidence) == ("", True)
    with pytest.raises(ValueError, match="where do gravity and the magnetic field point"):
        flight_report.judge(unknown, FlightOptions(source=source))
