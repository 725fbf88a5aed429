"""Work is written when it is due, told about once when it cannot be, and written again as soon as it can."""

import msgspec
import pytest

from explorer.model.settings import Settings
from explorer.storage.autosave import PERIOD, Autosave
from explorer.storage.files import StorageError, WorkFiles, new_visitor
from rangenav import preset

SLOW = Settings(origin="paper-slow", preset=preset.load("paper-slow"))
SEAT = f"{new_visitor()}-1"


def _at(scale: float) -> Settings:
    return msgspec.structs.replace(SLOW, time_scale=scale)


@pytest.fixture
def told() -> list[str]:
    return []


@pytest.fixture
def work_files(tmp_path) -> WorkFiles:
    return WorkFiles(tmp_path / "work")


def _found(work_files: WorkFiles) -> Settings:
    kept = Autosave(work_files, "paper-slow", pytest.fail).find(SEAT)
    assert kept is not None
    return kept.settings


def test_work_is_written_once_a_period_and_the_latest_counts(work_files: WorkFiles, told: list[str]):
    keeping = Autosave(work_files, "paper-slow", told.append)
    assert keeping.find(SEAT) is None
    keeping.remember(_at(2.0))
    assert keeping.wait(0.0) == 0.0
    keeping.write(0.0)
    keeping.remember(_at(3.0))
    assert keeping.wait(0.25 * PERIOD) == pytest.approx(0.75 * PERIOD)
    keeping.write(0.25 * PERIOD)
    assert _found(work_files) == _at(2.0)
    keeping.write(PERIOD)
    assert _found(work_files) == _at(3.0)
    assert keeping.wait(PERIOD) is None
    assert told == []


def test_what_cannot_be_written_is_told_once_and_later_work_is_kept_again(
    work_files: WorkFiles, told: list[str], monkeypatch: pytest.MonkeyPatch
):
    keeping = Autosave(work_files, "paper-slow", told.append)
    keeping.find(SEAT)

    def full(visitor: str, work: bytes) -> None:
        raise StorageError("your work is not kept: the disk is full")

    with monkeypatch.context() as broken:
        broken.setattr(work_files, "save", full)
        for k in range(3):
            keeping.remember(_at(2.0 + k))
            keeping.write(10.0 * k)
    assert told == ["Your work is not kept: the disk is full. The page works on; download what you need."]
    keeping.remember(_at(7.0))
    keeping.write(50.0)
    assert _found(work_files) == _at(7.0)
    assert len(told) == 1


def test_what_is_no_work_of_this_version_is_told_and_no_error(work_files: WorkFiles, told: list[str]):
    work_files.save(SEAT, b'{"opened": "paper", "settings": {"preset": 3}}')
    assert Autosave(work_files, "paper-slow", told.append).find(SEAT) is None
    (sentence,) = told
    assert sentence.startswith("Your earlier work is of no use to this version")


def test_a_browser_that_keeps_nothing_is_told_so_and_nothing_is_written(work_files: WorkFiles, told: list[str]):
    keeping = Autosave(work_files, "paper-slow", told.append)
    assert keeping.find(None) is None
    keeping.remember(SLOW)
    keeping.write(0.0)
    assert not work_files.folder.exists()
    assert len(told) == 1
