"""The note that all kernels are compiled holds for one compiler on one machine, and is never needed."""

import subprocess
import sys
from pathlib import Path

import pytest

from rangenav.kernels import cache


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)
    return tmp_path


def test_kernels_are_complete_once_that_was_noted_by_the_same_compiler(folder: Path, monkeypatch: pytest.MonkeyPatch):
    assert not cache.complete()
    cache.note_complete()
    assert cache.complete()
    monkeypatch.setattr(cache.platform, "python_version", lambda: "9.9.9")
    assert not cache.complete()


def test_a_note_that_cannot_be_read_or_written_is_no_note(folder: Path, monkeypatch: pytest.MonkeyPatch):
    (folder / cache.COMPLETE).write_bytes(b"\xff\xfe")
    assert not cache.complete()
    monkeypatch.setattr(cache, "folder", lambda: folder / "absent")
    cache.note_complete()
    assert not cache.complete()


def test_looking_for_the_note_does_not_load_the_compiler():
    program = "import sys; from rangenav.kernels import cache; cache.complete(); sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
