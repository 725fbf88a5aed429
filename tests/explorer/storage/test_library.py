"""A person's own presets on the disk: no title is a path, no file is half written, no unseen edition is overwritten."""

import errno
import fcntl
import os
import stat
import subprocess
import sys
import threading
from pathlib import Path

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from explorer.storage import files, library, trash
from explorer.storage.catalog import Catalog
from explorer.storage.certifier import Certifier
from explorer.storage.library import Library, LibraryError, edition, slug
from rangenav import preset
from rangenav.certificate import Certificate

ADD_MANY = """
import sys
from pathlib import Path
from explorer.storage.library import Library
own_presets = Library(Path(sys.argv[1]))
for k in range(20):
    own_presets.add("The same", f"{sys.argv[2]} {k}".encode())
"""
HOSTILE = [
    *("../../etc/passwd", "a/b\\c", "..", ".", ".hidden", "C:\\x", "con", "NUL", "x\0y", "a\nb"),
    *("Überflug", "飛行", "🚁", "é" * 80, "name.with.dots", "   ", "~", "$HOME", "-rf", "a" * 300),
]


@pytest.fixture
def own_presets(tmp_path: Path) -> Library:
    return Library(tmp_path / "presets")


def _files(own_presets: Library) -> set[str]:
    return {path.name for path in own_presets.folder.iterdir() if not path.name.startswith(".")}


def _trash(own_presets: Library) -> list[bytes]:
    return sorted(path.read_bytes() for path in (own_presets.folder / library.TRASH).glob("*"))


def test_what_was_added_is_listed_and_read_by_another_library_too(own_presets: Library):
    assert own_presets.stamps() == {}
    name = own_presets.add("Soft three-tone path", b"one")
    assert name == "soft-three-tone-path"
    assert list(Library(own_presets.folder).stamps()) == [name]
    assert Library(own_presets.folder).read(name) == b"one"


@pytest.mark.parametrize("title", HOSTILE)
def test_any_title_makes_a_file_in_the_folder_and_nowhere_else(own_presets: Library, tmp_path: Path, title: str):
    name = own_presets.add(title, b"work")
    assert own_presets.read(name) == b"work"
    assert _files(own_presets) == {name + ".toml"}
    assert [path.name for path in tmp_path.iterdir()] == ["presets"]


@given(st.text(max_size=200))
def test_a_slug_is_a_short_file_name_whatever_the_title(title: str):
    name = slug(title)
    assert name.isascii()
    assert 0 < len(name) <= library.MAX_NAME + len("preset-")
    assert set(name) <= set("abcdefghijklmnopqrstuvwxyz0123456789-")
    assert not library.RESERVED.fullmatch(name)


@pytest.mark.parametrize("name", ["../x", "a/b", "..", ".x", "", "a\\b", "c:x", "x\0", "x\n", "a" * 200])
def test_a_name_that_could_be_a_path_is_refused_before_any_file_is_touched(own_presets: Library, name: str):
    for touch in (
        lambda: own_presets.read(name),
        lambda: own_presets.save(name, b"x", known={""}),
        lambda: own_presets.delete(name, known={""}),
        lambda: own_presets.restore(name),
    ):
        with pytest.raises(LibraryError):
            touch()
    assert not own_presets.folder.exists() or not _files(own_presets)


def test_titles_that_make_the_same_name_get_a_number(own_presets: Library):
    assert [own_presets.add(title, title.encode()) for title in ("Eight", "eight!", "飛", "行")] == [
        *("eight", "eight-2", "preset", "preset-2")
    ]
    assert own_presets.read("eight-2") == b"eight!"


def test_a_file_that_somebody_copied_into_the_folder_is_listed_and_never_overwritten(own_presets: Library):
    own_presets.add("first", b"x")
    (own_presets.folder / "Mein Flug.v2.toml").write_bytes(b"theirs")
    (own_presets.folder / "second.toml").write_bytes(b"theirs too")
    assert own_presets.read("Mein Flug.v2") == b"theirs"
    assert own_presets.add("Second", b"mine") == "second-2"
    assert own_presets.read("second") == b"theirs too"


def test_a_save_over_an_edition_nobody_has_seen_is_refused_and_changes_nothing(own_presets: Library):
    name = own_presets.add("path", b"first")
    Library(own_presets.folder).save(name, b"by another page", known={edition(b"first")})
    with pytest.raises(LibraryError, match="changed elsewhere since you opened it"):
        own_presets.save(name, b"mine", known={edition(b"first")})
    assert own_presets.read(name) == b"by another page"
    own_presets.save(name, b"mine", known={edition(b"first"), edition(b"by another page")})
    assert own_presets.read(name) == b"mine"
    assert _trash(own_presets) == [b"by another page", b"first"]  # the overwritten contents are in the trash


def test_a_save_over_a_file_that_was_deleted_elsewhere_is_a_sentence(own_presets: Library):
    name = own_presets.add("path", b"first")
    own_presets.delete(name, known={edition(b"first")})
    with pytest.raises(LibraryError, match="not in your library any more"):
        own_presets.save(name, b"mine", known={edition(b"first")})


def test_deleting_is_undone_and_a_name_taken_meanwhile_is_left_alone(own_presets: Library):
    name = own_presets.add("path", b"first")
    mark = own_presets.delete(name, known={edition(b"first")})
    assert own_presets.stamps() == {}
    assert own_presets.add("path", b"second") == "path"
    assert own_presets.restore(mark) == "path-2"
    assert (own_presets.read("path"), own_presets.read("path-2")) == (b"second", b"first")
    with pytest.raises(LibraryError, match="not in the trash any more"):
        own_presets.restore(mark)


def test_a_later_visit_lists_the_deleted_presets_the_newest_first(own_presets: Library):
    for name in ("first.v2", "second"):
        own_presets.add(name, name.encode())
    own_presets.save("second", b"again", known={edition(b"second")})
    own_presets.rename("second", "third", b"again", known={edition(b"again")})
    marks = [
        own_presets.delete(name, known={edition(content)})
        for name, content in (("first-v2", b"first.v2"), ("third", b"again"))
    ]
    later = Library(own_presets.folder)
    assert later.deleted() == marks[::-1]  # and nothing of what was written over, or is called otherwise now
    assert [later.restore(mark) for mark in later.deleted()] == ["third", "first-v2"]
    assert later.deleted() == []


def test_renaming_moves_the_content_and_saves_the_old_one_in_the_trash(own_presets: Library):
    name = own_presets.add("old", b"first")
    assert own_presets.rename(name, "New name", b"second", known={edition(b"first")}) == "new-name"
    assert _files(own_presets) == {"new-name.toml"}
    assert own_presets.rename("new-name", "new NAME!", b"third", known={edition(b"second")}) == "new-name"
    assert own_presets.read("new-name") == b"third"
    assert _trash(own_presets) == [b"first", b"second"]


def test_a_rename_of_a_changed_file_leaves_no_second_one_behind(own_presets: Library):
    name = own_presets.add("old", b"first")
    with pytest.raises(LibraryError, match="changed elsewhere"):
        own_presets.rename(name, "new", b"x", known={edition(b"never seen")})
    assert _files(own_presets) == {"old.toml"}


def test_the_stored_certificate_of_a_preset_is_removed_when_the_preset_changes(own_presets: Library):
    name = own_presets.add("path", b"first")
    own_presets.write_certificate(name, b"{}")
    assert own_presets.read_certificate(name) == b"{}"
    assert list(own_presets.stamps()) == [name]
    own_presets.save(name, b"second", known={edition(b"first")})
    assert own_presets.read_certificate(name) is None


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EACCES, errno.EROFS], ids=["full", "denied", "read-only"])
@pytest.mark.parametrize("where", ["mkstemp", "fsync", "replace"])
def test_a_disk_that_refuses_is_one_sentence_and_nothing_is_lost_or_left(
    own_presets: Library, monkeypatch: pytest.MonkeyPatch, where: str, number: int
):
    name = own_presets.add("path", b"old")

    def refuse(*_: object, **__: object) -> None:
        raise OSError(number, os.strerror(number))

    with monkeypatch.context() as patched:
        patched.setattr(files.tempfile if where == "mkstemp" else files.os, where, refuse)
        for change in (
            lambda: own_presets.save(name, b"new", known={edition(b"old")}),
            lambda: own_presets.add("another", b"new"),
            lambda: own_presets.rename(name, "renamed", b"new", known={edition(b"old")}),
        ):
            with pytest.raises(LibraryError, match=os.strerror(number)) as failed:
                change()
            assert "\n" not in str(failed.value)
    assert own_presets.read(name) == b"old"
    assert _files(own_presets) == {"path.toml"}


def test_a_folder_that_cannot_be_made_is_a_sentence(tmp_path: Path):
    (tmp_path / "file").write_text("here already")
    for folder in (tmp_path / "file", tmp_path / "file" / "presets"):
        own_presets = Library(folder)
        with pytest.raises(LibraryError, match="cannot be written"):
            own_presets.add("path", b"work")
        with pytest.raises(LibraryError, match="cannot be listed"):
            own_presets.stamps()


def test_too_large_a_preset_and_too_many_presets_are_refused(own_presets: Library, monkeypatch: pytest.MonkeyPatch):
    with pytest.raises(LibraryError, match="at most"):
        own_presets.add("path", bytes(library.MAX_BYTES + 1))
    monkeypatch.setattr(library, "MAX_PRESETS", 2)
    own_presets.add("a", b"x")
    own_presets.add("b", b"x")
    with pytest.raises(LibraryError, match="holds 2 presets"):
        own_presets.add("c", b"x")


def test_neither_a_student_nor_a_class_fills_the_disk_and_what_was_saved_stays(tmp_path: Path):
    def library(number: int) -> Library:
        folder = tmp_path / str(number)
        return Library(folder, rooms=((folder, 2500), (tmp_path, 4000)))

    first, second = library(1), library(2)
    names = [first.add(f"preset {k}", bytes(1000)) for k in range(2)]
    with pytest.raises(LibraryError, match=r"not saved: your library has no room for more than 0\.0025 MB"):
        first.add("one too many", bytes(1000))
    second.add("mine", bytes(1000))
    with pytest.raises(LibraryError, match=r"not saved: the class has no room for more than 0\.004 MB"):
        second.add("one too many", bytes(1001))
    assert list(first.stamps()) == names
    first.delete(names[0], known=[edition(bytes(1000))])
    assert first.add("again", bytes(100)) == "again", "who deletes a preset has room again"


def test_the_trash_removes_the_oldest(own_presets: Library, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(trash, "MAX_FILES", 3)
    name = own_presets.add("path", b"0")
    for k in range(1, 6):
        own_presets.save(name, str(k).encode(), known={edition(str(k - 1).encode())})
    assert _trash(own_presets) == [b"2", b"3", b"4"]


def test_the_data_folder_can_be_named_and_is_the_owners_alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setenv(library.DATA, str(tmp_path / "elsewhere"))
    Library().add("path", b"work")
    folder = tmp_path / "elsewhere" / "presets"
    assert (folder / "path.toml").read_bytes() == b"work"
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    monkeypatch.delenv(library.DATA)
    assert library.data_folder().name == "rangenav"


def test_programs_that_save_under_one_title_at_once_lose_nothing(own_presets: Library):
    writers = [subprocess.Popen([sys.executable, "-c", ADD_MANY, str(own_presets.folder), who]) for who in "ab"]
    assert [writer.wait(60) for writer in writers] == [0, 0]
    assert {own_presets.read(name) for name in own_presets.stamps()} == {
        f"{who} {k}".encode() for who in "ab" for k in range(20)
    }


def test_of_many_saves_over_one_edition_at_once_one_wins_and_the_others_are_refused(own_presets: Library):
    name = own_presets.add("path", b"first")
    outcomes: list[str] = []
    ready = threading.Barrier(6)

    def save(who: str) -> None:
        ready.wait()
        try:
            Library(own_presets.folder).save(name, who.encode(), known={edition(b"first")})
            outcomes.append(who)
        except LibraryError:
            outcomes.append("")

    savers = [threading.Thread(target=save, args=(who,)) for who in "abcdef"]
    for saver in savers:
        saver.start()
    for saver in savers:
        saver.join()
    (winner,) = filter(None, outcomes)
    assert own_presets.read(name) == winner.encode()
    assert _trash(own_presets) == [b"first"]


def test_a_file_of_a_long_name_is_restored_too(own_presets: Library):
    name = "a" * 2 * library.MAX_NAME
    own_presets.folder.mkdir(parents=True)
    (own_presets.folder / f"{name}.toml").write_bytes(b"work")  # put there by hand
    assert own_presets.restore(own_presets.delete(name, known={edition(b"work")})) == name
    assert own_presets.read(name) == b"work"


def test_the_badge_is_of_what_is_shown_and_not_of_what_another_page_made_of_its_file(tmp_path: Path):
    shipped = preset.shipped()
    opened, other = shipped["soft"], msgspec.structs.replace(shipped["hover"], title=shipped["soft"].title)
    certifier = Certifier()
    here, there = (Catalog(shipped, Library(tmp_path), certifier) for _ in range(2))
    mine = here.add(opened)
    there.refresh()
    there.save(mine.origin, other, edition=there.open(mine.origin).edition)
    here.refresh()
    assert here.presets[mine.origin] == opened  # the page is compared with what was opened
    for shown in (opened, other):
        news = threading.Event()
        badge = here.badge(mine.origin, shown, news.set)
        if badge is None:
            assert news.wait(30)
            badge = here.badge(mine.origin, shown, news.set)
        assert isinstance(badge, Certificate)
        assert badge.artifact.sha256 == edition(preset.dumps(shown).encode())
        assert badge.expect == shown.expect


def test_a_folder_that_another_program_holds_locked_is_a_sentence_and_free_again_afterwards(
    own_presets: Library, monkeypatch: pytest.MonkeyPatch
):
    """The other program holds the lock as version 0.1.0 does, by an flock of the same file."""
    own_presets.add("first", b"one")
    monkeypatch.setattr(library, "LOCK_TIMEOUT", 0.1)
    with (own_presets.folder / library.LOCK).open("a") as held:
        fcntl.flock(held.fileno(), fcntl.LOCK_EX)
        with pytest.raises(LibraryError, match="another program is changing your library just now"):
            own_presets.add("second", b"two")
    own_presets.add("second", b"two")
    assert list(own_presets.stamps()) == ["first", "second"]


def test_an_observable_motion_that_was_drawn_from_a_blind_preset_is_saved_as_observable(tmp_path: Path):
    blind, observable = preset.load("figure-eight"), preset.load("soft")
    drawn = msgspec.structs.replace(observable, expect=blind.expect, story=blind.story)
    catalog = Catalog(preset.shipped(), Library(tmp_path), Certifier())
    saved, kept = catalog.add(drawn).preset, catalog.add(blind).preset
    assert (saved.expect, saved.story, saved.path) == ("observable", "", observable.path)
    assert kept == blind
