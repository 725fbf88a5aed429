"""A person's own presets on the disk: no name is a path, nothing is torn, nothing is written over unseen."""

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
kept = Library(Path(sys.argv[1]))
for k in range(20):
    kept.add("The same", f"{sys.argv[2]} {k}".encode())
"""
HOSTILE = [
    *("../../etc/passwd", "a/b\\c", "..", ".", ".hidden", "C:\\x", "con", "NUL", "x\0y", "a\nb"),
    *("Überflug", "飛行", "🚁", "é" * 80, "name.with.dots", "   ", "~", "$HOME", "-rf", "a" * 300),
]


@pytest.fixture
def kept(tmp_path: Path) -> Library:
    return Library(tmp_path / "presets")


def _files(kept: Library) -> set[str]:
    return {path.name for path in kept.folder.iterdir() if not path.name.startswith(".")}


def _trash(kept: Library) -> list[bytes]:
    return sorted(path.read_bytes() for path in (kept.folder / library.TRASH).glob("*"))


def test_what_was_added_is_listed_and_read_by_another_library_too(kept: Library):
    assert kept.stamps() == {}
    name = kept.add("Soft three-tone path", b"one")
    assert name == "soft-three-tone-path"
    assert list(Library(kept.folder).stamps()) == [name]
    assert Library(kept.folder).read(name) == b"one"


@pytest.mark.parametrize("title", HOSTILE)
def test_any_title_makes_a_file_in_the_folder_and_nowhere_else(kept: Library, tmp_path: Path, title: str):
    name = kept.add(title, b"work")
    assert kept.read(name) == b"work"
    assert _files(kept) == {name + ".toml"}
    assert [path.name for path in tmp_path.iterdir()] == ["presets"]


@given(st.text(max_size=200))
def test_a_slug_is_a_short_plain_name_whatever_the_title(title: str):
    name = slug(title)
    assert name.isascii()
    assert 0 < len(name) <= library.MAX_NAME + len("preset-")
    assert set(name) <= set("abcdefghijklmnopqrstuvwxyz0123456789-")
    assert not library.RESERVED.fullmatch(name)


@pytest.mark.parametrize("name", ["../x", "a/b", "..", ".x", "", "a\\b", "c:x", "x\0", "x\n", "a" * 200])
def test_a_name_that_could_be_a_path_is_refused_before_any_file_is_touched(kept: Library, name: str):
    for touch in (
        lambda: kept.read(name),
        lambda: kept.save(name, b"x", known={""}),
        lambda: kept.delete(name, known={""}),
        lambda: kept.restore(name),
    ):
        with pytest.raises(LibraryError):
            touch()
    assert not kept.folder.exists() or not _files(kept)


def test_titles_that_make_the_same_name_get_a_number(kept: Library):
    assert [kept.add(title, title.encode()) for title in ("Eight", "eight!", "飛", "行")] == [
        *("eight", "eight-2", "preset", "preset-2")
    ]
    assert kept.read("eight-2") == b"eight!"


def test_a_file_that_somebody_copied_into_the_folder_is_listed_and_never_written_over(kept: Library):
    kept.add("first", b"x")
    (kept.folder / "Mein Flug.v2.toml").write_bytes(b"theirs")
    (kept.folder / "second.toml").write_bytes(b"theirs too")
    assert kept.read("Mein Flug.v2") == b"theirs"
    assert kept.add("Second", b"mine") == "second-2"
    assert kept.read("second") == b"theirs too"


def test_a_save_over_an_edition_nobody_has_seen_is_refused_and_changes_nothing(kept: Library):
    name = kept.add("path", b"first")
    Library(kept.folder).save(name, b"by another page", known={edition(b"first")})
    with pytest.raises(LibraryError, match="changed elsewhere since you opened it"):
        kept.save(name, b"mine", known={edition(b"first")})
    assert kept.read(name) == b"by another page"
    kept.save(name, b"mine", known={edition(b"first"), edition(b"by another page")})
    assert kept.read(name) == b"mine"
    assert _trash(kept) == [b"by another page", b"first"]  # what was written over is there still


def test_a_save_over_a_file_that_was_deleted_elsewhere_is_a_sentence(kept: Library):
    name = kept.add("path", b"first")
    kept.delete(name, known={edition(b"first")})
    with pytest.raises(LibraryError, match="not in your library any more"):
        kept.save(name, b"mine", known={edition(b"first")})


def test_deleting_is_undone_and_a_name_taken_meanwhile_is_left_alone(kept: Library):
    name = kept.add("path", b"first")
    mark = kept.delete(name, known={edition(b"first")})
    assert kept.stamps() == {}
    assert kept.add("path", b"second") == "path"
    assert kept.restore(mark) == "path-2"
    assert (kept.read("path"), kept.read("path-2")) == (b"second", b"first")
    with pytest.raises(LibraryError, match="not in the trash any more"):
        kept.restore(mark)


def test_what_can_be_restored_is_known_to_whoever_comes_later_the_newest_first(kept: Library):
    for name in ("first.v2", "second"):
        kept.add(name, name.encode())
    kept.save("second", b"again", known={edition(b"second")})
    kept.rename("second", "third", b"again", known={edition(b"again")})
    marks = [
        kept.delete(name, known={edition(content)})
        for name, content in (("first-v2", b"first.v2"), ("third", b"again"))
    ]
    later = Library(kept.folder)
    assert later.deleted() == marks[::-1]  # and nothing of what was written over, or is called otherwise now
    assert [later.restore(mark) for mark in later.deleted()] == ["third", "first-v2"]
    assert later.deleted() == []


def test_renaming_moves_the_content_and_keeps_what_was(kept: Library):
    name = kept.add("old", b"first")
    assert kept.rename(name, "New name", b"second", known={edition(b"first")}) == "new-name"
    assert _files(kept) == {"new-name.toml"}
    assert kept.rename("new-name", "new NAME!", b"third", known={edition(b"second")}) == "new-name"
    assert kept.read("new-name") == b"third"
    assert _trash(kept) == [b"first", b"second"]


def test_a_rename_of_a_changed_file_leaves_no_second_one_behind(kept: Library):
    name = kept.add("old", b"first")
    with pytest.raises(LibraryError, match="changed elsewhere"):
        kept.rename(name, "new", b"x", known={edition(b"never seen")})
    assert _files(kept) == {"old.toml"}


def test_a_certificate_lies_beside_its_preset_and_goes_when_that_changes(kept: Library):
    name = kept.add("path", b"first")
    kept.write_certificate(name, b"{}")
    assert kept.read_certificate(name) == b"{}"
    assert list(kept.stamps()) == [name]
    kept.save(name, b"second", known={edition(b"first")})
    assert kept.read_certificate(name) is None


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EACCES, errno.EROFS], ids=["full", "denied", "read-only"])
@pytest.mark.parametrize("where", ["mkstemp", "fsync", "replace"])
def test_a_disk_that_refuses_is_one_sentence_and_nothing_is_lost_or_left(
    kept: Library, monkeypatch: pytest.MonkeyPatch, where: str, number: int
):
    name = kept.add("path", b"old")

    def refuse(*_: object, **__: object) -> None:
        raise OSError(number, os.strerror(number))

    with monkeypatch.context() as patched:
        patched.setattr(files.tempfile if where == "mkstemp" else files.os, where, refuse)
        for change in (
            lambda: kept.save(name, b"new", known={edition(b"old")}),
            lambda: kept.add("another", b"new"),
            lambda: kept.rename(name, "renamed", b"new", known={edition(b"old")}),
        ):
            with pytest.raises(LibraryError, match=os.strerror(number)) as failed:
                change()
            assert "\n" not in str(failed.value)
    assert kept.read(name) == b"old"
    assert _files(kept) == {"path.toml"}


def test_a_folder_that_cannot_be_made_is_a_sentence(tmp_path: Path):
    (tmp_path / "file").write_text("here already")
    for folder in (tmp_path / "file", tmp_path / "file" / "presets"):
        kept = Library(folder)
        with pytest.raises(LibraryError, match="cannot be written"):
            kept.add("path", b"work")
        with pytest.raises(LibraryError, match="cannot be listed"):
            kept.stamps()


def test_too_much_is_refused(kept: Library, monkeypatch: pytest.MonkeyPatch):
    with pytest.raises(LibraryError, match="at most"):
        kept.add("path", bytes(library.MAX_BYTES + 1))
    monkeypatch.setattr(library, "MAX_PRESETS", 2)
    kept.add("a", b"x")
    kept.add("b", b"x")
    with pytest.raises(LibraryError, match="holds 2 presets"):
        kept.add("c", b"x")


def test_the_trash_forgets_the_oldest(kept: Library, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(trash, "MAX_FILES", 3)
    name = kept.add("path", b"0")
    for k in range(1, 6):
        kept.save(name, str(k).encode(), known={edition(str(k - 1).encode())})
    assert _trash(kept) == [b"2", b"3", b"4"]


def test_the_data_folder_can_be_told_and_is_the_owners_alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setenv(library.DATA, str(tmp_path / "elsewhere"))
    Library().add("path", b"work")
    folder = tmp_path / "elsewhere" / "presets"
    assert (folder / "path.toml").read_bytes() == b"work"
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    monkeypatch.delenv(library.DATA)
    assert library.data_folder().name == "rangenav"


def test_programs_that_save_under_one_title_at_once_lose_nothing(kept: Library):
    writers = [subprocess.Popen([sys.executable, "-c", ADD_MANY, str(kept.folder), who]) for who in "ab"]
    assert [writer.wait(60) for writer in writers] == [0, 0]
    assert {kept.read(name) for name in kept.stamps()} == {f"{who} {k}".encode() for who in "ab" for k in range(20)}


def test_of_many_that_write_over_one_edition_at_once_one_wins_and_the_others_are_told(kept: Library):
    name = kept.add("path", b"first")
    outcomes: list[str] = []
    ready = threading.Barrier(6)

    def save(who: str) -> None:
        ready.wait()
        try:
            Library(kept.folder).save(name, who.encode(), known={edition(b"first")})
            outcomes.append(who)
        except LibraryError:
            outcomes.append("")

    savers = [threading.Thread(target=save, args=(who,)) for who in "abcdef"]
    for saver in savers:
        saver.start()
    for saver in savers:
        saver.join()
    (winner,) = filter(None, outcomes)
    assert kept.read(name) == winner.encode()
    assert _trash(kept) == [b"first"]


def test_a_file_of_a_long_name_is_brought_back_too(kept: Library):
    name = "a" * 2 * library.MAX_NAME
    kept.folder.mkdir(parents=True)
    (kept.folder / f"{name}.toml").write_bytes(b"work")  # put there by hand
    assert kept.restore(kept.delete(name, known={edition(b"work")})) == name
    assert kept.read(name) == b"work"


def test_the_badge_is_of_what_is_shown_and_not_of_what_another_page_made_of_its_file(tmp_path: Path):
    shipped = preset.shipped()
    opened, other = shipped["soft"], msgspec.structs.replace(shipped["hover"], title=shipped["soft"].title)
    certifier = Certifier()
    here, there = (Catalog(shipped, Library(tmp_path), certifier) for _ in range(2))
    mine = here.add(opened)
    there.refresh()
    there.save(mine.origin, other, edition=there.open(mine.origin).edition)
    here.refresh()
    assert here.presets[mine.origin] == opened  # what was opened is still what the page is held against
    for shown in (opened, other):
        news = threading.Event()
        found = here.badge(mine.origin, shown, news.set)
        if found is None:
            assert news.wait(30)
            found = here.badge(mine.origin, shown, news.set)
        assert isinstance(found, Certificate)
        assert found.artifact.sha256 == edition(preset.dumps(shown).encode())
        assert found.expect == shown.expect


def test_a_folder_that_another_program_holds_locked_is_a_sentence_and_free_again_afterwards(
    kept: Library, monkeypatch: pytest.MonkeyPatch
):
    """The lock of version 0.1.0, an flock of the same file, is the other program."""
    kept.add("first", b"one")
    monkeypatch.setattr(library, "LOCK_TIMEOUT", 0.1)
    with (kept.folder / library.LOCK).open("a") as held:
        fcntl.flock(held.fileno(), fcntl.LOCK_EX)
        with pytest.raises(LibraryError, match="another program is changing your library just now"):
            kept.add("second", b"two")
    kept.add("second", b"two")
    assert list(kept.stamps()) == ["first", "second"]
