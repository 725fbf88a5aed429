"""The Presets tab through viser's messages: saving, changing, deleting and uploading presets."""

import errno
import io
import os
import time
import zipfile
from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest

from explorer.server import SessionServer
from explorer.storage import files
from explorer.storage.catalog import MINE, REFRESH_PERIOD
from explorer.storage.library import Library
from explorer.web import uploads
from rangenav import certificate, formats, preset
from tests.support.waiting_visitor import Editing, arrived, save_as

pytestmark = pytest.mark.slow


SHIPPED = preset.shipped()
SAVE, TIDY = "keep", "tidy"


def test_what_is_kept_is_offered_to_every_tab_with_a_drawing_and_a_badge(
    page: Editing, data: Library, sessions: tuple[int, SessionServer]
):
    page.set("range weight q (1/(m⁴ s))", 1.25)
    shown = page.settings.preset
    save_as(page, "Mein <b>Flug</b> / über ../ alles")
    (name,) = data.stamps()
    assert name == "mein-b-flug-b-uber-alles"
    saved = preset.loads(data.read(name).decode(), source=name)
    assert saved == msgspec.structs.replace(shown, title="Mein <b>Flug</b> / über ../ alles")
    assert page.settings.origin == MINE + name
    page.tab.wait_for_text("● CERTIFIED OBSERVABLE")
    assert "<svg" in page.tab.text()
    assert "<b>Flug" not in page.tab.text()
    page.tab.wait_for(lambda: data.read_certificate(name), "the certificate beside it")
    stored = data.read_certificate(name)
    assert stored is not None
    assert certificate.verify(data.read(name), certificate.loads(stored, source="x"), source=name) == ()
    other = arrived(sessions)
    other.set("preset", f"★ {saved.title} ({name})")
    assert other.settings.preset == saved
    other.tab.close()


def test_a_shipped_preset_is_not_written_over(page: Editing, data: Library):
    page.press(SAVE, "save")
    assert any("use “save as”" in text for text in page.refusals())
    assert data.stamps() == {}


def test_a_save_over_what_another_page_has_changed_is_refused_and_both_are_kept(page: Editing, data: Library):
    save_as(page, "mine")
    theirs = preset.dumps(SHIPPED["soft"]).encode()
    data.save("mine", theirs, known={page.settings.edition})
    page.set("range weight q (1/(m⁴ s))", 2.0)
    mine = page.settings
    page.press(SAVE, "save")
    assert any("changed elsewhere since you opened it" in text for text in page.refusals())
    assert data.read("mine") == theirs
    assert page.settings == mine
    page.press(SAVE, "save as")
    assert data.read("mine") == theirs
    assert preset.loads(data.read("mine-2").decode(), source="x").gains == mine.preset.gains


def test_saving_again_and_again_is_no_conflict_with_oneself_and_undo_still_goes_back(page: Editing, data: Library):
    save_as(page, "mine")
    before = page.settings
    page.set("range weight q (1/(m⁴ s))", 2.0)
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
    save_as(page, "mine")
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


def test_what_was_deleted_comes_back_after_a_reload_too(
    page: Editing, data: Library, sessions: tuple[int, SessionServer], reloaded: Callable[[], Editing]
):
    save_as(page, "mine")
    content, shown = data.read("mine"), page.settings.preset
    page.press(TIDY, "delete")
    later = reloaded()
    assert later.settings.preset == shown
    later.tab.wait_for(lambda: later.tab.value("preset") == "◌ mine, not saved (mine)", "the title")
    later.press(TIDY, "undo delete")
    assert data.read("mine") == content


def test_what_was_imported_and_not_saved_keeps_its_title_over_a_reload(
    page: Editing, reloaded: Callable[[], Editing], tmp_path: Path
):
    formats.export(SHIPPED["paper-slow"], "reference", tmp_path / "tour.csv")
    page.tab.upload("Upload a file", "my_tour.csv", (tmp_path / "tour.csv").read_bytes())
    page.tab.wait_for_text("opened as a preset")
    page.settle()
    shown = page.settings.preset
    later = reloaded()
    assert later.settings.preset == shown
    later.tab.wait_for(lambda: later.tab.value("preset") == "◌ my_tour, not saved (my-tour)", "the title")
    later.tab.wait_for(lambda: later.tab.value("title") == "my_tour", "the title to save under")


def test_a_save_writes_the_title_that_was_typed_and_a_title_that_is_taken_is_reported(
    page: Editing, data: Library, sessions: tuple[int, SessionServer]
):
    save_as(page, "mine")
    other = arrived(sessions)
    save_as(other, "Mine!")
    assert "saved as mine-2.toml, beside mine.toml, which is left as it was" in other.tab.text()
    other.tab.close()
    page.set("title", "mine, better")
    page.press(SAVE, "save")
    assert preset.loads(data.read("mine").decode(), source="x").title == "mine, better"
    assert page.tab.value("preset") == "★ mine, better (mine)"
    page.set("title", "")
    page.press(SAVE, "save")
    assert any("printable characters" in text for text in page.refusals())
    assert "saved as" not in page.tab.text()  # the message of an earlier success is gone


def test_presets_are_browsed_one_after_the_other_and_all_at_a_glance(page: Editing, data: Library):
    save_as(page, 'a "quoted" <b>')
    (data.folder / 'mean"><img src=x>.toml').write_bytes(data.read("a-quoted-b"))
    assert 'class="tile"' not in page.tab.text()  # nothing is sent before it is asked for
    page.press("browse", "see all")
    time.sleep(REFRESH_PERIOD)
    page.settle()  # the library is read again at the first change a second later
    page.tab.wait_for_text("★ mean&quot;&gt;&lt;img src=x&gt;")
    assert "<img src=x>" not in page.tab.text()
    assert page.tab.text().count('class="tile"') == len(SHIPPED) + 2
    page.press("open", "circle")
    assert page.settings.preset == SHIPPED["circle"]
    names = list(SHIPPED)
    page.press("browse", "next ›")
    assert page.settings.origin == names[names.index("circle") + 1]
    page.press("browse", "‹ previous")
    page.press("browse", "‹ previous")
    assert page.settings.origin == names[names.index("circle") - 1]
    page.press("browse", "see all")
    assert 'class="tile"' not in page.tab.text()


def test_renaming_keeps_what_was_changed_and_not_saved(page: Editing, data: Library):
    save_as(page, "old")
    page.set("range weight q (1/(m⁴ s))", 2.0)
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

    page.set("range weight q (1/(m⁴ s))", 2.0)
    mine = page.settings
    page.set("title", "mine")
    with monkeypatch.context() as patched:
        patched.setattr(files.os, "replace", refuse)
        page.press(SAVE, "save as")
        assert any(os.strerror(number) in text for text in page.refusals())
    assert page.settings == mine
    assert data.stamps() == {}
    page.press(SAVE, "save as")
    assert list(data.stamps()) == ["mine"]


@pytest.mark.parametrize("title", ["", "   ", "x" * 81, "a\x00b", "\u202edesrever"])
def test_an_invalid_title_is_reported(page: Editing, data: Library, title: str):
    page.set("title", title)
    page.press(SAVE, "save as")
    assert any("printable characters" in text for text in page.refusals())
    assert data.stamps() == {}


def test_a_file_that_is_no_preset_is_named_beside_the_others(page: Editing, data: Library):
    save_as(page, "mine")
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
    ("content", "header", "sentence"),
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
    page: Editing, data: Library, content: bytes, header: dict[str, int], sentence: str
):
    page.tab.upload("Upload a preset", "x.toml", content, **header)
    page.tab.wait_for(lambda: any(sentence in text for text in page.refusals()), sentence)
    page.tab.upload("Upload a preset", "soft.toml", preset.dumps(SHIPPED["soft"]).encode())
    page.tab.wait_for_text("soft.toml joined your library")


def _packed(*files: tuple[str, bytes]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files:
            archive.writestr(name, content)
    return packed.getvalue()


def test_a_zip_is_taken_for_the_preset_in_it(page: Editing, data: Library):
    soft = preset.dumps(SHIPPED["soft"]).encode()
    for members, sentence in (
        ([("x.csv", b"")], "0 presets (.toml) in it"),
        ([("a.toml", soft), ("b.toml", soft)], "2 presets (.toml) in it"),
        ([("bomb.toml", bytes(10**8))], "bomb.toml unpacks to more than 1000000 bytes"),
        ([("../../a.toml", b"\xff")], "a.toml in x.zip: not UTF-8"),
    ):
        page.tab.upload("Upload a preset", "x.zip", _packed(*members))
        page.tab.wait_for(lambda said=sentence: any(said in text for text in page.refusals()), sentence)
    for broken in (_packed(("a.toml", soft))[:-30], b"PK\x03\x04" + bytes(90)):
        page.tab.upload("Upload a preset", "broken.zip", broken)
        page.tab.wait_for(lambda: any("zip cannot be read" in text for text in page.refusals()), "a sentence")
        page.tab.upload("Upload a preset", "empty.zip", b"")
        page.tab.wait_for(lambda: any("the file is empty" in text for text in page.refusals()), "a sentence")
    assert data.stamps() == {}
    page.tab.upload("Upload a preset", "x.zip", _packed(("s.toml", soft), ("s.certificate.json", b"{}")))
    page.tab.wait_for_text("x.zip joined your library")
    page.settle()
    assert page.settings.preset == SHIPPED["soft"]


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
