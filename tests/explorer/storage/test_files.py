"""A visitor's work on the disk: the last one whole or none, nothing outside the folder, a sentence when it fails."""

import errno
import os
import stat
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from explorer.storage import files
from explorer.storage.files import StorageError, WorkFiles, new_visitor

WRITE_FOREVER = """
import sys
from pathlib import Path
from explorer.storage.files import WorkFiles
kept, letter = WorkFiles(Path(sys.argv[1])), sys.argv[3].encode()
kept.save(sys.argv[2], letter * 100_000)
print("ready", flush=True)
while True:
    kept.save(sys.argv[2], letter * 100_000)
"""


@pytest.fixture
def kept(tmp_path: Path) -> WorkFiles:
    return WorkFiles(tmp_path / "work")


def _age(path: Path, seconds: float) -> None:
    then = time.time() - seconds
    os.utime(path, (then, then))


def test_what_was_saved_last_is_loaded_and_by_another_store_too(kept: WorkFiles):
    visitor = new_visitor()
    assert kept.load(visitor) is None
    kept.save(visitor, b"first")
    kept.save(visitor, b"second \x00\xff")
    assert kept.load(visitor) == b"second \x00\xff"
    assert WorkFiles(kept.folder).load(visitor) == b"second \x00\xff"


def test_visitors_and_the_slots_of_one_are_apart(kept: WorkFiles):
    one, other = new_visitor(), new_visitor()
    for name in (one, f"{one}-1", f"{one}-12", f"{other}-1"):
        kept.save(name, name.encode())
    for name in (one, f"{one}-1", f"{one}-12", f"{other}-1"):
        assert kept.load(name) == name.encode()


@pytest.mark.parametrize(
    "visitor",
    [
        *("", "a" * 31, "a" * 33, "A" * 32, "ａ" * 32, "٣" * 32),
        *("a" * 32 + "-0", "a" * 32 + "-123", "a" * 32 + "\n", "a" * 32 + ".json", "a" * 30 + "\x00a"),
        *("../" + "a" * 32, "a" * 29 + "/..", "a" * 32 + "-1/x"),
    ],
)
def test_an_id_of_another_form_is_refused_before_any_file_is_touched(kept: WorkFiles, visitor: str):
    with pytest.raises(ValueError, match="a visitor's id must be"):
        kept.save(visitor, b"work")
    with pytest.raises(ValueError, match="a visitor's id must be"):
        kept.load(visitor)
    assert not kept.folder.exists()


def test_folder_and_files_are_the_owners_alone(kept: WorkFiles):
    visitor = new_visitor()
    kept.save(visitor, b"work")
    assert stat.S_IMODE(kept.folder.stat().st_mode) == 0o700
    assert stat.S_IMODE((kept.folder / f"{visitor}.json").stat().st_mode) == 0o600


def test_the_state_folder_can_be_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setenv(files.STATE, str(tmp_path / "elsewhere"))
    WorkFiles().save("a" * 32, b"work")
    assert (tmp_path / "elsewhere" / "work" / f"{'a' * 32}.json").read_bytes() == b"work"
    monkeypatch.delenv(files.STATE)
    assert files.state_folder().name == "rangenav"


def test_too_much_is_refused_and_what_was_kept_stays(kept: WorkFiles):
    visitor = new_visitor()
    kept.save(visitor, b"work")
    with pytest.raises(StorageError, match="at most"):
        kept.save(visitor, bytes(files.MAX_BYTES + 1))
    assert kept.load(visitor) == b"work"
    kept.save(visitor, bytes(files.MAX_BYTES))


def test_a_file_that_has_grown_too_large_is_not_read(kept: WorkFiles):
    visitor = new_visitor()
    kept.save(visitor, b"work")
    (kept.folder / f"{visitor}.json").write_bytes(bytes(files.MAX_BYTES + 1))
    with pytest.raises(StorageError, match="more than"):
        kept.load(visitor)


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EACCES, errno.EROFS], ids=["full", "denied", "read-only"])
@pytest.mark.parametrize("where", ["mkstemp", "fsync", "replace"])
def test_a_disk_that_refuses_is_one_sentence_and_leaves_the_old_work_and_no_rubbish(
    kept: WorkFiles, monkeypatch: pytest.MonkeyPatch, where: str, number: int
):
    visitor = new_visitor()
    kept.save(visitor, b"old")

    def refuse(*_: object, **__: object) -> None:
        raise OSError(number, os.strerror(number))

    with monkeypatch.context() as patched:
        patched.setattr(files.tempfile if where == "mkstemp" else files.os, where, refuse)
        with pytest.raises(StorageError) as failed:
            kept.save(visitor, b"new")
    assert "\n" not in str(failed.value)
    assert "your work is not kept" in str(failed.value)
    assert os.strerror(number) in str(failed.value)
    assert kept.load(visitor) == b"old"
    assert [path.name for path in kept.folder.iterdir()] == [f"{visitor}.json"]
    kept.save(visitor, b"new")
    assert kept.load(visitor) == b"new"


def test_a_folder_that_cannot_be_made_is_a_sentence_and_a_store_is_made_all_the_same(tmp_path: Path):
    (tmp_path / "file").write_text("here already")
    for folder in (tmp_path / "file", tmp_path / "file" / "work"):
        kept = WorkFiles(folder)
        with pytest.raises(StorageError, match="your work is not kept"):
            kept.save(new_visitor(), b"work")
    with pytest.raises(StorageError, match="your earlier work cannot be read"):
        WorkFiles(tmp_path / "file" / "work").load(new_visitor())


def test_pruning_keeps_the_newest_and_touches_only_its_own_files(kept: WorkFiles, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(files, "MAX_FILES", 3)
    visitors = [new_visitor() for _ in range(6)]
    for age, visitor in enumerate(visitors):
        kept.save(visitor, b"work")
        _age(kept.folder / f"{visitor}.json", 100.0 * age)
    foreign = kept.folder / "notes.json"
    foreign.write_text("mine")
    _age(foreign, 1e9)
    kept.prune()
    assert [visitor for visitor in visitors if kept.load(visitor)] == visitors[:3]
    assert foreign.exists()


def test_pruning_forgets_what_is_too_old_or_too_much_together(kept: WorkFiles, monkeypatch: pytest.MonkeyPatch):
    visitors = [new_visitor() for _ in range(4)]
    for age, visitor in enumerate(visitors):
        kept.save(visitor, bytes(1000))
        _age(kept.folder / f"{visitor}.json", 10.0 * age)
    _age(kept.folder / f"{visitors[3]}.json", files.MAX_AGE + 60)
    kept.prune()
    assert [kept.load(visitor) is not None for visitor in visitors] == [True, True, True, False]
    monkeypatch.setattr(files, "MAX_TOTAL", 2500)
    WorkFiles(kept.folder)  # it prunes when it is made
    assert [kept.load(visitor) is not None for visitor in visitors] == [True, True, False, False]


def test_pruning_happens_now_and_then_while_saving(kept: WorkFiles, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(files, "PRUNED_EVERY", 5)
    monkeypatch.setattr(files, "MAX_FILES", 2)
    for _ in range(10):
        kept.save(new_visitor(), b"work")
    assert len(list(kept.folder.iterdir())) == 2


def test_what_a_crash_left_unfinished_goes_after_a_while_and_not_at_once(kept: WorkFiles):
    visitor = new_visitor()
    kept.save(visitor, b"work")
    fresh, old = (kept.folder / f"{visitor}.{mark}.part" for mark in ("fresh", "old"))
    for left in (fresh, old):
        left.write_bytes(b"half")
    _age(old, files.ABANDONED + 60)
    kept.prune()
    assert fresh.exists()
    assert not old.exists()
    assert kept.load(visitor) == b"work"


def test_many_threads_writing_one_visitor_never_leave_a_torn_file(kept: WorkFiles):
    visitor = new_visitor()
    works = [bytes([65 + k]) * 50_000 for k in range(4)]
    kept.save(visitor, works[0])
    stop, torn, failures = threading.Event(), [], []

    def write(work: bytes) -> None:
        try:
            while not stop.is_set():
                WorkFiles(kept.folder).save(visitor, work)
        except Exception as error:
            failures.append(error)

    writers = [threading.Thread(target=write, args=(work,)) for work in works]
    for writer in writers:
        writer.start()
    for _ in range(300):
        if (found := kept.load(visitor)) not in works:
            torn.append(found)
    stop.set()
    for writer in writers:
        writer.join()
    assert not torn
    assert not failures
    assert [path.name for path in kept.folder.iterdir()] == [f"{visitor}.json"]


def test_programs_that_write_one_visitor_and_are_killed_at_any_moment_never_leave_a_torn_file(kept: WorkFiles):
    visitor, whole = new_visitor(), {letter.encode() * 100_000 for letter in "ab"}
    command = [sys.executable, "-c", WRITE_FOREVER, str(kept.folder), visitor]
    for _ in range(3):
        writers = [subprocess.Popen([*command, letter], stdout=subprocess.PIPE, text=True) for letter in "ab"]
        for writer in writers:
            assert writer.stdout is not None
            assert writer.stdout.readline() == "ready\n"
        for _ in range(50):
            assert kept.load(visitor) in whole
        for writer in writers:
            writer.kill()
            writer.communicate()
        assert kept.load(visitor) in whole
