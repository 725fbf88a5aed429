"""The folder of a class goes with the class, also after a kill; another program's, and other people's files, stay."""

import tempfile
from pathlib import Path

import pytest

from explorer.storage.class_folder import PREFIX, class_folder


def test_what_a_killed_program_left_of_a_class_is_removed_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    left = tmp_path / f"{PREFIX}left" / "7"
    left.mkdir(parents=True)
    (left / "of-a-student.toml").write_bytes(b"x")
    mine, file, elsewhere = tmp_path / "other", tmp_path / f"{PREFIX}file", tmp_path / "elsewhere"
    for folder in (mine, elsewhere):
        folder.mkdir()
        (folder / "kept").touch()
    file.touch()
    (tmp_path / f"{PREFIX}link").symlink_to(elsewhere)
    with class_folder() as first, class_folder() as second:
        assert first.is_dir()
        assert second.is_dir(), "that of a program that runs is left alone"
        assert not left.parent.exists()
        assert (mine / "kept").exists()
        assert (elsewhere / "kept").exists()
        assert file.exists()
    assert not first.exists()
    assert not second.exists()
