"""The Presets tab through viser's messages: keeping, changing, deleting, importing, exporting, repairing, judging."""

import errno
import io
import os
import zipfile
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from explorer import store, uploads
from explorer.access import open_server
from explorer.library import Library
from explorer.session import Sessions
from explorer.shelf import MINE
from explorer.warming import Warming
from rangenav import certificate, formats, preset
from tests.house import house
from tests.test_editor import Editing
from tests.wire import Wire

SHIPPED = preset.shipped()
SAVE, TIDY = "keep", "tidy"


@pytest.fixture(scope="module")
def sessions() -> Iterator[tuple[int, Sessions]]:
    server, warming = open_server("127.0.0.1", 0), Warming()
    made = Sessions(server, house(server, warming))
    warming.start()
    yield server.get_port(), made
    server.stop()


@pytest.fixture
def data(tmp_path: Path, sessions: tuple[int, Sessions]) -> Library:
    """An empty library for this test's visitors."""
    kept = Library(tmp_path / "presets")
    object.__setattr__(sessions[1]._house, "library", kept)
    return kept


def _visitor(sessions: tuple[int, Sessions]) -> Editing:
    port, made = sessions
    tab = Wire(port)
    tab.wait_for(lambda: tab.counts.get("GuiSetPanelWidthMessage"), "the docks")
    session = list(made._of.values())[-1]
    tab.wait_for(lambda: session._picture is not None and "t (s)" in str(tab.elements), "the first picture")
    return Editing(tab, session)


@pytest.fixture
def page(sessions: tuple[int, Sessions], data: Library) -> Iterator[Editing]:
    visitor = _visitor(sessions)
    yield visitor
    visitor.tab.close()


def _save_as(page: Editing, title: str) -> None:
    page.set("title", title)
    page.press(SAVE, "save as")
    page.tab.wait_for_text("saved as")


def test_what_is_kept_is_offered_to_every_tab_with_a_drawing_and_a_badge(
    page: Editing, data: Library, sessions: tuple[int, Sessions]
):
    page.set("q", 1.25)
    shown = page.settings.preset
    _save_as(page, "Mein <b>Flug</b> / über ../ alles")
    (name,) = data.stamps()
    assert name == "mein-b-flug-b-uber-alles"
    kept = preset.loads(data.read(name).decode(), source=name)
    assert kept == msgspec.structs.replace(shown, title="Mein <b>Flug</b> / über ../ alles")
    assert page.settings.origin == MINE + name
    page.tab.wait_for_text("● CERTIFIED OBSERVABLE")
    assert "<svg" in page.tab.text()
    assert "<b>Flug" not in page.tab.text()
    page.tab.wait_for(lambda: data.beside(name), "the certificate beside it")
    beside = data.beside(name)
    assert beside is not None
    assert certificate.verify(data.read(name), certificate.loads(beside, source="x"), source=name) == ()
    other = _visitor(sessions)
    other.set("preset", f"★ {kept.title} ({name})")
    assert other.settings.preset == kept
    other.tab.close()


def test_a_shipped_preset_is_not_written_over(page: Editing, data: Library):
    page.press(SAVE, "save")
    assert any("use “save as”" in text for text in page.refusals())
    assert data.stamps() == {}


def test_a_save_over_what_another_page_has_changed_is_refused_and_both_are_kept(page: Editing, data: Library):
    _save_as(page, "mine")
    theirs = preset.dumps(SHIPPED["soft"]).encode()
    data.save("mine", theirs, known={page.settings.edition})
    page.set("q", 2.0)
    mine = page.settings
    page.press(SAVE, "save")
    assert any("changed elsewhere since you opened it" in text for text in page.refusals())
    assert data.read("mine") == theirs
    assert page.settings == mine
    page.press(SAVE, "save as")
    assert data.read("mine") == theirs
    assert preset.loads(data.read("mine-2").decode(), source="x").gains == mine.preset.gains


def test_saving_again_and_again_is_no_conflict_with_oneself_and_undo_still_goes_back(page: Editing, data: Library):
    _save_as(page, "mine")
    before = page.settings
    page.set("q", 2.0)
    page.press(SAVE, "save")
    assert "saved as mine.toml" in page.tab.text()
    saved = data.read("mine")
    page.command("Undo")
    page.command("Undo")
    assert page.settings.preset == before.preset
    page.press(SAVE, "save")
    assert page.refusals() == []
    assert data.read("mine") != saved


def test_what_is_deleted_stays_on_the_page_and_comes_back(page: Editing, data: Library):
    _save_as(page, "mine")
    content, shown = data.read("mine"), page.settings
    page.press(TIDY, "delete")
    assert data.stamps() == {}
    assert page.settings == shown
    assert "deleted" in page.tab.value("preset")
    page.press(TIDY, "undo delete")
    assert data.read("mine") == content
    assert page.tab.value("preset") == "★ mine (mine)"
    page.press(TIDY, "undo delete")
    assert any("nothing was deleted" in text for text in page.refusals())


def test_renaming_keeps_what_was_changed_and_not_saved(page: Editing, data: Library):
    _save_as(page, "old")
    page.set("q", 2.0)
    changed = page.settings.preset
    page.set("title", "飛行 two")
    page.press(TIDY, "rename")
    assert list(data.stamps()) == ["two"]
    assert page.settings.preset == msgspec.structs.replace(changed, title="飛行 two")
    page.press(SAVE, "save")
    assert preset.loads(data.read("two").decode(), source="x") == page.settings.preset


def test_a_duplicate_is_a_file_of_its_own(page: Editing, data: Library):
    page.press(SAVE, "duplicate")
    (name,) = data.stamps()
    assert page.settings.origin == MINE + name
    assert page.settings.preset.title == f"{SHIPPED['paper-slow'].title}, copy"


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS], ids=["full", "read-only"])
def test_a_disk_that_refuses_is_a_sentence_and_the_work_stays_on_the_page(
    page: Editing, data: Library, monkeypatch: pytest.MonkeyPatch, number: int
):
    def refuse(*_: object, **__: object) -> None:
        raise OSError(number, os.strerror(number))

    page.set("q", 2.0)
    mine = page.settings
    page.set("title", "mine")
    with monkeypatch.context() as patched:
        patched.setattr(store.os, "replace", refuse)
        page.press(SAVE, "save as")
        assert any(os.strerror(number) in text for text in page.refusals())
    assert page.settings == mine
    assert data.stamps() == {}
    page.press(SAVE, "save as")
    assert list(data.stamps()) == ["mine"]


@pytest.mark.parametrize("title", ["", "   ", "x" * 81, "a\x00b", "\u202edesrever"])
def test_a_title_that_is_none_is_told(page: Editing, data: Library, title: str):
    page.set("title", title)
    page.press(SAVE, "save as")
    assert any("printable characters" in text for text in page.refusals())
    assert data.stamps() == {}


def test_a_file_that_is_no_preset_is_named_beside_the_others(page: Editing, data: Library):
    _save_as(page, "mine")
    (data.folder / "broken.toml").write_bytes(b"\xff\x00")
    (data.folder / "wrong.toml").write_text('title = "x"')
    page.press(SAVE, "save")
    page.tab.wait_for_text("broken.toml: not UTF-8 text")
    assert "wrong.toml: Object missing required field" in page.tab.text()


def test_an_uploaded_preset_joins_the_library_and_is_opened(page: Editing, data: Library):
    content = preset.dumps(SHIPPED["soft"]).encode()
    page.tab.upload("Upload a preset", "../../../soft one.toml", content)
    page.tab.wait_for_text("soft one.toml joined your library")
    page.settle()
    assert page.settings.preset == SHIPPED["soft"]
    assert list(data.stamps()) == ["soft-three-tone-path"]


@pytest.mark.parametrize(
    ("content", "said", "sentence"),
    [
        (b"not = a preset", {}, "x.toml: "),
        (b"\xff\xfe", {}, "not UTF-8 text"),
        (b"", {}, "the file is empty"),
        (b"abc", {"size_bytes": 600_000_000}, "600 MB, more than the 20 MB"),
        (b"abc", {"size_bytes": 2}, "did not arrive as sent"),
        (b"abc", {"part_count": 10_000_000}, "are no file"),
        (b"abc", {"size_bytes": 4}, "3 bytes came of 4"),
    ],
)
def test_an_upload_that_will_not_do_is_a_sentence_and_the_next_one_is_taken(
    page: Editing, data: Library, content: bytes, said: dict[str, object], sentence: str
):
    page.tab.upload("Upload a preset", "x.toml", content, **said)
    page.tab.wait_for(lambda: any(sentence in text for text in page.refusals()), sentence)
    page.tab.upload("Upload a preset", "soft.toml", preset.dumps(SHIPPED["soft"]).encode())
    page.tab.wait_for_text("soft.toml joined your library")


def test_a_second_file_waits_for_the_first_and_a_stalled_one_gives_way(
    page: Editing, data: Library, monkeypatch: pytest.MonkeyPatch
):
    page.tab.upload("Upload a preset", "slow.toml", b"abc", size_bytes=10, part_count=2)
    page.tab.upload("Upload a preset", "hasty.toml", b"abc")
    page.tab.wait_for(lambda: any("another file is on its way" in text for text in page.refusals()), "a word")
    monkeypatch.setattr(uploads, "STALLED", 0.0)
    page.tab.upload("Upload a preset", "soft.toml", preset.dumps(SHIPPED["soft"]).encode())
    page.tab.wait_for_text("soft.toml joined your library")


def test_names_are_for_reading_only():
    assert uploads.readable("../../etc/pass\x00wd\u202e") == "passwd"
    assert uploads.readable("C:\\folder\\a.csv") == "a.csv"
    assert uploads.readable(7) == "file"
    assert len(uploads.readable("x" * 10**6)) <= uploads.LONGEST_NAME


def _zip(page: Editing, name: str) -> zipfile.ZipFile:
    page.tab.wait_for(lambda: name in dict(page.tab.downloads), name)
    return zipfile.ZipFile(io.BytesIO(dict(page.tab.downloads)[name]))


def test_an_export_is_one_zip_whose_certificate_is_of_its_very_bytes(page: Editing, tmp_path: Path):
    page.press("formats", "all")
    page.press("Export as a zip")
    packed = _zip(page, "paper-slow.zip")
    packed.extractall(tmp_path)
    assert certificate.verify_file(tmp_path / "paper-slow.toml") == ()
    assert preset.load(tmp_path / "paper-slow.toml") == page.settings.preset
    names = set(packed.namelist())
    for name in ("paper-slow.mat", "paper-slow.tum.txt", "paper-slow.mcap", "paper-slow.reference.csv", "README.txt"):
        assert name in names
    read_back = formats.read(tmp_path / "paper-slow.reference.csv", "reference")
    assert read_back.path is not None


def test_an_export_that_misses_its_requirement_is_refused_or_marked(page: Editing):
    page.set("preset", f"{SHIPPED['circle'].title} (circle)")
    page.press("Export as a zip")
    page.tab.wait_for(lambda: any("refused" in text for text in page.refusals()), "the refusal")
    assert page.tab.downloads == []
    page.set("even if uncertified", True)
    page.set("TUM", True)
    page.press("Export as a zip")
    packed = _zip(page, "circle.uncertified.zip")
    assert all("uncertified" in name for name in packed.namelist() if name != "README.txt")
    assert b"UNCERTIFIED" in packed.read("README.txt")


def test_a_path_is_imported_after_its_questions_are_answered(page: Editing, tmp_path: Path):
    formats.export(SHIPPED["paper-slow"], "tum", tmp_path / "tour.txt")
    lines = (tmp_path / "tour.txt").read_text().splitlines()
    before = page.settings
    page.tab.upload("Upload a file", "Tour 1.txt", "\n".join(lines[1:]).encode())
    page.tab.wait_for_text("which way")
    assert page.settings == before
    assert page.tab.value("format") == "TUM trajectory"
    page.press("Confirm the answers")
    if any("not answered yet" in text for text in page.refusals()):
        page.set("frame", "z-up")
        page.press("Confirm the answers")
    page.tab.wait_for_text("opened as a preset that is not saved yet")
    page.settle()
    assert page.settings.preset.title == "Tour 1"
    assert page.settings.preset.world.gravity[2] < 0
    _save_as(page, "Tour kept")


def test_a_file_that_cannot_be_read_is_a_sentence_with_its_line(page: Editing):
    before = page.settings
    page.tab.upload("Upload a file", "bad.csv", b"t,p_x,p_y,p_z\n0,1,2,three\n")
    page.tab.wait_for(lambda: any("line 2" in text for text in page.refusals()), "the line")
    page.press("Read it as this format")
    assert page.settings == before


def test_a_recorded_flight_is_judged_with_errors_against_its_truth(page: Editing, tmp_path: Path):
    formats.export(SHIPPED["paper-slow"], "log", tmp_path / "flight.csv")
    page.tab.upload("Upload a file", "flight.csv", (tmp_path / "flight.csv").read_bytes())
    page.tab.wait_for_text("a recorded flight: judge it below")
    before = page.settings
    page.set("ranges ± (m)", 0.05)
    page.press("Was it informative?")
    page.tab.wait_for_text("rms by quarters")
    assert "windows" in page.tab.text()
    assert "as the file says" in page.tab.text()
    page.set("windows of (s)", 1e9)
    page.press("Was it informative?")
    page.tab.wait_for(lambda: any("the window must lie" in text for text in page.refusals()), "a sentence")
    assert page.settings == before


def test_a_blind_motion_is_repaired_shown_accepted_and_undone(page: Editing):
    page.set("preset", f"{SHIPPED['circle'].title} (circle)")
    circle = page.settings
    page.press("Make it observable")
    page.tab.wait_for_text("before (A)")
    assert page.settings == circle
    page.press("Discard")
    assert "before (A)" not in page.tab.text()
    page.press("Make it observable")
    page.tab.wait_for_text("before (A)")
    page.press("Accept")
    after = page.settings.preset
    assert certificate.certify(preset.dumps(after).encode(), source="x").certified
    assert after.path != circle.preset.path
    page.command("Undo")
    assert page.settings == circle


def test_a_repair_that_this_kind_of_change_cannot_do_says_why(page: Editing):
    page.set("preset", f"{SHIPPED['hover'].title} (hover)")
    page.set("by changing", "its size")
    page.press("Make it observable")
    page.tab.wait_for(lambda: any("stays straight at any size" in text for text in page.refusals()), "the reason")
