"""The Presets tab through viser's messages: exporting, importing, judging a recorded flight, repairing."""

import io
import re
import zipfile
from collections.abc import Mapping
from pathlib import Path

import pytest

from explorer.storage import import_file
from explorer.storage.import_file import ImportFile
from rangenav import certificate, formats, preset
from rangenav.certificate import exports
from rangenav.inputs import Vec3
from tests.support.waiting_visitor import Editing, save_as

pytestmark = pytest.mark.slow


SHIPPED = preset.shipped()
WORST = re.compile(r"from ([\d.]+) s: rank")
"""The beginning of the worst window of a recorded flight (s)."""


@pytest.fixture(autouse=True)
def _read_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Files are read in this process. The browser's tests read them in a process of their own, as the page does; what
    that adds is tested in tests/explorer/storage/test_import_process.py."""

    def read(file: ImportFile, format_name: str, confirm: Mapping[str, str], anchor: Vec3 | None, *, cancelled: object):
        return import_file.interpret(file, format_name, confirm, anchor)

    monkeypatch.setattr("explorer.storage.import_process.read", read)


def _zip(page: Editing, name: str) -> zipfile.ZipFile:
    page.tab.wait_for(lambda: name in dict(page.tab.downloads), name)
    return zipfile.ZipFile(io.BytesIO(dict(page.tab.downloads)[name]))


def test_an_export_is_one_zip_whose_certificate_is_of_its_very_bytes(page: Editing, tmp_path: Path):
    page.press("formats", "all")
    page.press("Export as a zip")
    packed = _zip(page, "paper-slow.zip")
    packed.extractall(tmp_path)
    assert certificate.verify_file(tmp_path / "paper-slow.toml") == ()
    assert certificate.verify_file(tmp_path / "paper-slow.mat", readers=exports.readers()) == ()
    assert certificate.verify_file(tmp_path / "paper-slow.euroc", readers=exports.readers()) == ()
    assert preset.load(tmp_path / "paper-slow.toml") == page.settings.preset
    names = set(packed.namelist())
    for name in ("paper-slow.mat", "paper-slow.tum.txt", "paper-slow.mcap", "paper-slow.reference.csv", "README.txt"):
        assert name in names
    read_back = formats.read(tmp_path / "paper-slow.reference.csv", "reference")
    assert read_back.path is not None


def test_an_export_that_misses_its_requirement_is_refused_or_marked(page: Editing):
    page.set("preset", f"{SHIPPED['circle'].title} (circle)")
    page.set("polynomials", True)  # what is to be flown must be observable; a circle may be studied
    page.press("Export as a zip")
    page.tab.wait_for(lambda: any("refused" in text for text in page.refusals()), "the refusal")
    assert page.tab.downloads == []
    assert "• the rank is 11 of 13" in page.tab.text()
    assert "it would do to add for example a tone" in page.tab.text()
    page.set("preset", f"{SHIPPED['figure-eight'].title} (figure-eight)")
    page.wait_until_accepted()  # the complaint was about another motion
    page.set("preset", f"{SHIPPED['circle'].title} (circle)")
    page.set("write files that miss the requirement, too", True)
    page.press("Export as a zip")
    packed = _zip(page, "circle.uncertified.zip")
    assert "circle.polynomial.uncertified.csv" in packed.namelist()
    assert "circle.polynomial.csv.certificate.json" not in packed.namelist()
    assert b"UNCERTIFIED" in packed.read("README.txt")


def test_a_path_is_imported_after_its_questions_are_answered(page: Editing, tmp_path: Path):
    formats.export(SHIPPED["paper-slow"], "tum", tmp_path / "tour.txt")
    lines = (tmp_path / "tour.txt").read_text().splitlines()
    before = page.settings
    page.tab.upload("Upload a file", "Tour 1.txt", "\n".join(lines[1:]).encode())
    page.tab.wait_for_text("Tour 1.txt: 1 question below")  # written last, when the button is on the page
    assert "which way does z point" in page.tab.text()
    assert page.settings == before
    assert page.tab.value("format") == "TUM trajectory"
    page.press("Confirm the answers")
    if any("not answered yet" in text for text in page.refusals()):
        page.set("frame", "z-up")
        page.press("Confirm the answers")
    page.tab.wait_for_text("opened as a preset that is not saved yet")
    page.settle()
    assert page.settings.preset.title == "Tour 1"
    assert "not judged</b>" in page.tab.text()
    assert "the path&#x27;s snap was not in Tour 1.txt" in page.tab.text()
    assert page.settings.preset.world.gravity[2] < 0
    save_as(page, "Tour kept")
    page.set("speed (slower ⟷ faster)", -0.05)  # another path: a design of the visitor's
    assert "not judged</b>" not in page.tab.text()


def test_a_file_that_cannot_be_read_is_a_sentence_with_its_line(page: Editing):
    before = page.settings
    page.tab.upload("Upload a file", "bad.csv", b"t,p_x,p_y,p_z\n0,1,2,3\n1,2,three,4\n2,2,four,4\n")
    page.tab.wait_for(lambda: any("line 3" in text for text in page.refusals()), "the line")
    page.press("Read it as this format")
    assert page.settings == before


def test_a_guess_is_reported_with_the_name_the_person_knows_and_a_preset_is_sent_to_its_button(page: Editing):
    page.tab.upload("Upload a file", "Non_sense 1.csv", b"lorem, ipsum\n" * 60_000)
    page.tab.wait_for(lambda: any("Non_sense 1.csv: " in text for text in page.refusals()), "the file's own name")
    assert any("read as flight log CSV: if it is none, choose another" in text for text in page.refusals())
    page.tab.upload("Upload a file", "mine.toml", preset.dumps(SHIPPED["soft"]).encode())
    page.tab.wait_for(lambda: any("taken by “Upload a preset”" in text for text in page.refusals()), "the way")


def test_a_recorded_flight_is_judged_with_errors_against_its_truth(page: Editing, tmp_path: Path):
    formats.export(SHIPPED["paper-slow"], "log", tmp_path / "flight.csv")
    page.tab.upload("Upload a file", "flight.csv", (tmp_path / "flight.csv").read_bytes())
    page.tab.wait_for_text("a recorded flight: judge it below")
    before = page.settings
    page.set("flight's range noise σ (m)", 0.05)
    page.press("Was it informative?")
    page.tab.wait_for_text("rms by quarters")
    assert "windows" in page.tab.text()
    assert "as the file says" in page.tab.text()
    assert "on its ranges: " in page.tab.text()
    page.set("begin at (s)", 12.0)
    page.press("Was it informative?")
    page.tab.wait_for(lambda: any(float(at) >= 12 for at in WORST.findall(page.tab.text())), "a later worst window")
    page.set("end at (s)", 12.0)
    page.press("Was it informative?")
    page.tab.wait_for(lambda: any("must begin before it ends" in text for text in page.refusals()), "a sentence")
    page.set("end at (s)", 20.0)
    page.set("flight's window δ (s)", 1e9)
    page.press("Was it informative?")
    page.tab.wait_for(lambda: any("the window must lie" in text for text in page.refusals()), "a sentence")
    assert page.settings == before


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[bytes, bytes]:
    """A short flight with a truth: without ranges and anchor, and with ranges of which ten are zeros."""
    file = tmp_path_factory.mktemp("log") / "flight.csv"
    formats.export(SHIPPED["paper-slow"], "log", file)
    lines = file.read_text().splitlines()
    head = next(k for k, line in enumerate(lines) if line.startswith("t [s]"))
    at = lines[head].split(",").index("range [m]")
    rows = [line.split(",") for line in [lines[head], *lines[head + 1 : head + 1601 : 4]]]  # those with a range
    bare = [",".join(row[:at] + row[at + 1 :]) for row in rows]
    zeros = [",".join([*row[:at], "0.0" if k % 40 == 9 else row[at], *row[at + 1 :]]) for k, row in enumerate(rows)]
    world = lines[:3]
    assert "anchor" in lines[3]
    return "\n".join([*world, *bare]).encode(), "\n".join([*lines[:4], *zeros]).encode()


def _visible(page: Editing, label: str) -> bool:
    return page.tab.elements[page.tab.find(label)]["visible"]


def test_a_flight_is_judged_with_nothing_that_is_not_chosen_and_its_result_names_file_ranges_and_anchor(
    page: Editing, recorded: tuple[bytes, bytes]
):
    page.tab.upload("Upload a file", "bare.csv", recorded[0])
    page.tab.wait_for_text("bare.csv: a recorded flight; judge it under “Recorded flight”")
    assert page.tab.value("synthetic ranges") is False
    boxes = ("flight's gravity (m/s²)", "flight's magnetic direction", "flight's anchor (m)")
    assert [_visible(page, box) for box in boxes] == [False] * 3
    page.press("Was it informative?")
    page.tab.wait_for_text("no ranges, so the observers were not run")
    assert re.search(r"<div>• bare\.csv: \S \w", page.tab.text())
    assert "an anchor at" not in page.tab.text()
    page.set("synthetic ranges", True)
    page.press("Was it informative?")
    page.tab.wait_for(lambda: any("where does the anchor stand" in text for text in page.refusals()), "the question")
    page.set("anchor from", "as given below")
    page.set("gravity and field from", "as given below")
    page.tab.wait_for(lambda: all(_visible(page, box) for box in boxes), "the boxes")
    page.set("gravity and field from", "as the file says")
    page.tab.wait_for(lambda: not any(_visible(page, box) for box in boxes[:2]), "boxes that are not used to hide")
    page.set("flight's anchor (m)", (0.0, 0.0, 1.0))
    page.press("Was it informative?")
    page.tab.wait_for_text("with synthetic ranges of σ 0.1 m to an anchor at (0, 0, 1) m, as given")


def test_another_file_takes_the_last_flight_from_the_page_and_a_usual_answer_may_be_overruled(
    page: Editing, recorded: tuple[bytes, bytes]
):
    page.tab.upload("Upload a file", "zeros.csv", recorded[1])
    page.tab.wait_for_text("zeros.csv: a recorded flight; 1 answer was taken without a question, see below")
    assert page.tab.value("range-values") == "drop"
    page.press("Was it informative?")
    page.tab.wait_for_text("390 ranges of the file to an anchor at (0, 0, 0) m, as the file says")
    page.set("range-values", "keep")
    page.press("Read it with these answers")
    page.tab.wait_for_text("the record is not judged: 10 of 400 ranges are no distances")
    page.tab.wait_for_text("zeros.csv: a recorded flight; judge it")
    assert page.tab.value("range-values") == "keep"
    assert "390 ranges of the file" not in page.tab.text()
    page.press("Was it informative?")
    page.tab.wait_for_text("zeros.csv: ? not judged: 10 of 400 ranges")
    page.tab.upload("Upload a file", "none.csv", b"no,flight\n1,2\n")
    page.tab.wait_for_text("none.csv: not read")
    assert not _visible(page, "Recorded flight")
    assert "zeros.csv: ? not judged" not in page.tab.text()


def test_a_blind_motion_is_repaired_shown_accepted_and_undone(page: Editing):
    page.set("preset", f"{SHIPPED['circle'].title} (circle)")
    circle = page.settings
    page.press("Make it observable")
    page.tab.wait_for_text("Searched with ranges of 0.1")
    assert page.settings == circle
    assert page.session.picture is not None
    proposed = page.session.dock.comparison(page.session.picture).proposed
    assert proposed is not None
    assert proposed.path != circle.preset.path
    page.press("Discard the motion")
    assert page.session.dock.comparison(page.session.picture).proposed is None
    assert "Searched with ranges of 0.1" not in page.tab.text()
    page.press("Make it observable")
    page.tab.wait_for_text("Searched with ranges of 0.1")
    page.press("Accept the motion")
    after = page.settings.preset
    assert certificate.certify(preset.dumps(after).encode(), source="x").certified
    assert after.path != circle.preset.path
    assert page.session.dock.compare.pinned is not None
    assert page.session.dock.compare.pinned.settings == circle
    assert page.tab.value("title") == after.title
    page.tab.wait_for_text("As opened: ✕ certified unobservable")
    assert "✕ CERTIFIED UNOBSERVABLE" not in page.tab.text()
    page.command("Undo")
    assert page.settings == circle


def test_what_was_chosen_while_a_repair_was_looked_for_stays_and_another_motion_is_not_replaced(page: Editing):
    page.set("preset", f"{SHIPPED['circle'].title} (circle)")
    page.press("Make it observable")
    page.tab.wait_for_text("Searched with ranges of 0.1")
    page.set("range weight q (1/(m⁴ s))", 2.0)
    gains = page.settings.preset.gains
    page.press("Accept the motion")
    assert page.settings.preset.path != SHIPPED["circle"].path
    assert page.settings.preset.gains == gains
    page.tab.wait_for_text("on the page now, and not saved yet")
    page.command("Undo")
    page.tab.wait_for(lambda: "on the page now, and not saved yet" not in page.tab.text(), "the sentence to go")
    page.set("preset", f"{SHIPPED['figure-eight'].title} (figure-eight)")
    page.press("Make it observable")
    page.tab.wait_for_text("Searched with ranges of 0.1")
    page.press("add a tone along", "+ z")
    page.tab.wait_for(lambda: "Searched with ranges of 0.1" not in page.tab.text(), "the change to go with its motion")
    page.set("preset", f"{SHIPPED['hover'].title} (hover)")
    assert page.settings.preset == SHIPPED["hover"]
    assert "Searched with ranges of 0.1" not in page.tab.text()


def test_a_repair_that_this_kind_of_change_cannot_do_says_why(page: Editing):
    page.set("preset", f"{SHIPPED['hover'].title} (hover)")
    page.set("repair by", "changing its size")
    page.press("Make it observable")
    page.tab.wait_for(lambda: any("stays straight at any size" in text for text in page.refusals()), "the reason")
