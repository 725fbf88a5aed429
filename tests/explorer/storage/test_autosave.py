"""Work is written when it is due; a failure is notified once, and writing is tried again at every change."""

import msgspec
import pytest

from explorer.model.settings import Settings
from explorer.storage.autosave import PERIOD, Autosave
from explorer.storage.work_files import StorageError, WorkFiles, new_browser_id
from rangenav import preset

SLOW = Settings(origin="paper-slow", preset=preset.load("paper-slow"))
SESSION_KEY = f"{new_browser_id()}-1"


def _at(scale: float) -> Settings:
    return msgspec.structs.replace(SLOW, time_scale=scale)


@pytest.fixture
def notices() -> list[str]:
    return []


@pytest.fixture
def work_files(tmp_path) -> WorkFiles:
    return WorkFiles(tmp_path / "work")


def _restored(work_files: WorkFiles) -> Settings:
    work = Autosave(work_files, "paper-slow", pytest.fail).restore(SESSION_KEY)
    assert work is not None
    return work.settings


def test_work_is_written_once_a_period_and_the_latest_counts(work_files: WorkFiles, notices: list[str]):
    autosave = Autosave(work_files, "paper-slow", notices.append)
    assert autosave.restore(SESSION_KEY) is None
    autosave.remember(_at(2.0))
    assert autosave.wait(0.0) == 0.0
    autosave.write(0.0)
    autosave.remember(_at(3.0))
    assert autosave.wait(0.25 * PERIOD) == pytest.approx(0.75 * PERIOD)
    autosave.write(0.25 * PERIOD)
    assert _restored(work_files) == _at(2.0)
    autosave.write(PERIOD)
    assert _restored(work_files) == _at(3.0)
    assert autosave.wait(PERIOD) is None
    assert notices == []


def test_a_failing_write_is_notified_once_and_later_work_is_saved_again(
    work_files: WorkFiles, notices: list[str], monkeypatch: pytest.MonkeyPatch
):
    autosave = Autosave(work_files, "paper-slow", notices.append)
    autosave.restore(SESSION_KEY)

    def full(visitor: str, work: bytes) -> None:
        raise StorageError("your work is not kept: the disk is full")

    with monkeypatch.context() as broken:
        broken.setattr(work_files, "save", full)
        for k in range(3):
            autosave.remember(_at(2.0 + k))
            autosave.write(10.0 * k)
    assert notices == ["Your work is not kept: the disk is full. The page works on; download what you need."]
    autosave.remember(_at(7.0))
    autosave.write(50.0)
    assert _restored(work_files) == _at(7.0)
    assert len(notices) == 1


def test_a_file_that_this_version_cannot_read_is_notified_and_is_no_error(work_files: WorkFiles, notices: list[str]):
    work_files.save(SESSION_KEY, b'{"opened": "paper", "settings": {"preset": 3}}')
    assert Autosave(work_files, "paper-slow", notices.append).restore(SESSION_KEY) is None
    (sentence,) = notices
    assert sentence.startswith("Your earlier work is of no use to this version")


def test_a_browser_without_storage_is_notified_and_nothing_is_written(work_files: WorkFiles, notices: list[str]):
    autosave = Autosave(work_files, "paper-slow", notices.append)
    assert autosave.restore(None) is None
    autosave.remember(SLOW)
    autosave.write(0.0)
    assert not work_files.folder.exists()
    assert len(notices) == 1
