"""The work of a tab on the disk: a save is whole or absent, no other folder is touched, a failure is one sentence."""

import errno
import os
import stat
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from explorer.storage import files, work_files
from explorer.storage.work_files import StorageError, WorkFiles, new_browser_id

WRITE_FOREVER = """
import sys
from pathlib import Path
from explorer.storage.work_files import WorkFiles
saved, letter = WorkFiles(Path(sys.argv[1])), sys.argv[3].encode()
saved.save(sys.argv[2], letter * 100_000)
print("ready", flush=True)
while True:
    saved.save(sys.argv[2], letter * 100_000)
"""


@pytest.fixture
def saved(tmp_path: Path) -> WorkFiles:
    return WorkFiles(tmp_path / "work")


def _age(path: Path, seconds: float) -> None:
    then = time.time() - seconds
    os.utime(path, (then, then))


def test_what_was_saved_last_is_loaded_and_by_another_object_of_the_same_folder_too(saved: WorkFiles):
    session_key = new_browser_id()
    assert saved.load(session_key) is None
    saved.save(session_key, b"first")
    saved.save(session_key, b"second \x00\xff")
    assert saved.load(session_key) == b"second \x00\xff"
    assert WorkFiles(saved.folder).load(session_key) == b"second \x00\xff"


def test_browsers_and_the_tabs_of_one_have_files_of_their_own(saved: WorkFiles):
    one, other = new_browser_id(), new_browser_id()
    for name in (one, f"{one}-1", f"{one}-12", f"{other}-1"):
        saved.save(name, name.encode())
    for name in (one, f"{one}-1", f"{one}-12", f"{other}-1"):
        assert saved.load(name) == name.encode()


@pytest.mark.parametrize(
    "session_key",
    [
        *("", "a" * 31, "a" * 33, "A" * 32, "ａ" * 32, "٣" * 32),
        *("a" * 32 + "-0", "a" * 32 + "-123", "a" * 32 + "\n", "a" * 32 + ".json", "a" * 30 + "\x00a"),
        *("../" + "a" * 32, "a" * 29 + "/..", "a" * 32 + "-1/x"),
    ],
)
def test_a_session_key_of_another_form_is_refused_before_any_file_is_touched(saved: WorkFiles, session_key: str):
    with pytest.raises(ValueError, match="a session key must be"):
        saved.save(session_key, b"work")
    with pytest.raises(ValueError, match="a session key must be"):
        saved.load(session_key)
    assert not saved.folder.exists()


def test_folder_and_files_are_the_owners_alone(saved: WorkFiles):
    session_key = new_browser_id()
    saved.save(session_key, b"work")
    assert stat.S_IMODE(saved.folder.stat().st_mode) == 0o700
    assert stat.S_IMODE((saved.folder / f"{session_key}.json").stat().st_mode) == 0o600


def test_the_state_folder_can_be_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setenv(work_files.STATE, str(tmp_path / "elsewhere"))
    WorkFiles().save("a" * 32, b"work")
    assert (tmp_path / "elsewhere" / "work" / f"{'a' * 32}.json").read_bytes() == b"work"
    monkeypatch.delenv(work_files.STATE)
    assert work_files.state_folder().name == "rangenav"


def test_too_much_is_refused_and_what_was_saved_stays(saved: WorkFiles):
    session_key = new_browser_id()
    saved.save(session_key, b"work")
    with pytest.raises(StorageError, match="at most"):
        saved.save(session_key, bytes(work_files.MAX_BYTES + 1))
    assert saved.load(session_key) == b"work"
    saved.save(session_key, bytes(work_files.MAX_BYTES))


def test_a_file_that_has_grown_too_large_is_not_read(saved: WorkFiles):
    session_key = new_browser_id()
    saved.save(session_key, b"work")
    (saved.folder / f"{session_key}.json").write_bytes(bytes(work_files.MAX_BYTES + 1))
    with pytest.raises(StorageError, match="more than"):
        saved.load(session_key)


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EACCES, errno.EROFS], ids=["full", "denied", "read-only"])
@pytest.mark.parametrize("where", ["mkstemp", "fsync", "replace"])
def test_a_disk_that_refuses_is_one_sentence_and_leaves_the_old_work_and_no_unfinished_file(
    saved: WorkFiles, monkeypatch: pytest.MonkeyPatch, where: str, number: int
):
    session_key = new_browser_id()
    saved.save(session_key, b"old")

    def refuse(*_: object, **__: object) -> None:
        raise OSError(number, os.strerror(number))

    with monkeypatch.context() as patched:
        patched.setattr(files.tempfile if where == "mkstemp" else files.os, where, refuse)
        with pytest.raises(StorageError) as failed:
            saved.save(session_key, b"new")
    assert "\n" not in str(failed.value)
    assert "your work is not kept" in str(failed.value)
    assert os.strerror(number) in str(failed.value)
    assert saved.load(session_key) == b"old"
    assert [path.name for path in saved.folder.iterdir()] == [f"{session_key}.json"]
    saved.save(session_key, b"new")
    assert saved.load(session_key) == b"new"


def test_a_folder_that_cannot_be_made_is_a_sentence_when_the_work_is_saved_and_not_before(tmp_path: Path):
    (tmp_path / "file").write_text("here already")
    for folder in (tmp_path / "file", tmp_path / "file" / "work"):
        saved = WorkFiles(folder)
        with pytest.raises(StorageError, match="your work is not kept"):
            saved.save(new_browser_id(), b"work")
    with pytest.raises(StorageError, match="your earlier work cannot be read"):
        WorkFiles(tmp_path / "file" / "work").load(new_browser_id())


def test_pruning_keeps_the_newest_and_touches_only_its_own_files(saved: WorkFiles, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(work_files, "MAX_FILES", 3)
    session_keys = [new_browser_id() for _ in range(6)]
    for age, session_key in reversed(list(enumerate(session_keys))):
        saved.save(session_key, b"work")
        _age(saved.folder / f"{session_key}.json", 100.0 * age)
    foreign = saved.folder / "notes.json"
    foreign.write_text("mine")
    _age(foreign, 1e9)
    saved.prune()
    assert [session_key for session_key in session_keys if saved.load(session_key)] == session_keys[:3]
    assert foreign.exists()


def test_pruning_removes_what_is_too_old_or_too_much_together(saved: WorkFiles, monkeypatch: pytest.MonkeyPatch):
    session_keys = [new_browser_id() for _ in range(4)]
    for age, session_key in reversed(list(enumerate(session_keys))):
        saved.save(session_key, bytes(1000))
        _age(saved.folder / f"{session_key}.json", 10.0 * age)
    _age(saved.folder / f"{session_keys[3]}.json", work_files.MAX_AGE + 60)
    saved.prune()
    assert all(saved.load(session_key) for session_key in session_keys), "of few files age removes none"
    monkeypatch.setattr(work_files, "AGELESS", 2)
    saved.prune()
    assert [saved.load(session_key) is not None for session_key in session_keys] == [True, True, True, False]
    monkeypatch.setattr(work_files, "MAX_TOTAL", 2500)
    WorkFiles(saved.folder)  # the constructor prunes
    assert [saved.load(session_key) is not None for session_key in session_keys] == [True, True, False, False]


def test_the_clock_may_jump_back_and_what_was_saved_last_stays(saved: WorkFiles, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(work_files, "MAX_FILES", 3)
    before, after = [[new_browser_id() for _ in range(3)] for _ in range(2)]
    for session_key in before:
        saved.save(session_key, b"work")
    for session_key in after:
        saved.save(session_key, b"work")
        _age(saved.folder / f"{session_key}.json", 1e9)  # as a clock would have it that was set back
    saved.prune()
    assert [bool(saved.load(session_key)) for session_key in before + after] == [False] * 3 + [True] * 3


def test_saving_prunes_at_regular_counts(saved: WorkFiles, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(work_files, "SAVES_PER_PRUNE", 5)
    monkeypatch.setattr(work_files, "MAX_FILES", 2)
    for _ in range(10):
        saved.save(new_browser_id(), b"work")
    assert len(list(saved.folder.iterdir())) == 2


def test_what_a_crash_left_unfinished_goes_after_a_while_and_not_at_once(saved: WorkFiles):
    session_key = new_browser_id()
    saved.save(session_key, b"work")
    fresh, old = (saved.folder / f"{session_key}.{mark}.part" for mark in ("fresh", "old"))
    for left in (fresh, old):
        left.write_bytes(b"half")
    _age(old, work_files.ABANDONED + 60)
    saved.prune()
    assert fresh.exists()
    assert not old.exists()
    assert saved.load(session_key) == b"work"


def test_many_threads_writing_one_file_never_leave_a_torn_file(saved: WorkFiles):
    session_key = new_browser_id()
    works = [bytes([65 + k]) * 50_000 for k in range(4)]
    saved.save(session_key, works[0])
    stop, torn, failures = threading.Event(), [], []

    def write(work: bytes) -> None:
        try:
            while not stop.is_set():
                WorkFiles(saved.folder).save(session_key, work)
        except Exception as error:
            failures.append(error)

    writers = [threading.Thread(target=write, args=(work,)) for work in works]
    for writer in writers:
        writer.start()
    for _ in range(300):
        if (content := saved.load(session_key)) not in works:
            torn.append(content)
    stop.set()
    for writer in writers:
        writer.join()
    assert not torn
    assert not failures
    assert [path.name for path in saved.folder.iterdir()] == [f"{session_key}.json"]


def test_programs_that_write_one_file_and_are_killed_at_any_moment_never_leave_a_torn_file(saved: WorkFiles):
    session_key, whole = new_browser_id(), {letter.encode() * 100_000 for letter in "ab"}
    command = [sys.executable, "-c", WRITE_FOREVER, str(saved.folder), session_key]
    for _ in range(3):
        writers = [subprocess.Popen([*command, letter], stdout=subprocess.PIPE, text=True) for letter in "ab"]
        for writer in writers:
            assert writer.stdout is not None
            assert writer.stdout.readline() == "ready\n"
        for _ in range(50):
            assert saved.load(session_key) in whole
        for writer in writers:
            writer.kill()
            writer.communicate()
        assert saved.load(session_key) in whole
