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
def store(tmp_path) -> WorkFiles:
    return WorkFiles(tmp_path / "work")


def _found(store: WorkFiles) -> Settings:
    kept = Autosave(store, "paper-slow", pytest.fail).find(SEAT)
    assert kept is not None
    return kept.settings


def test_work_is_written_once_a_period_and_the_latest_counts(store: WorkFiles, told: list[str]):
    keeping = Autosave(store, "paper-slow", told.append)
    assert keeping.find(SEAT) is None
    keeping.note(_at(2.0))
    assert keeping.wait(0.0) == 0.0
    keeping.write(0.0)
    keeping.note(_at(3.0))
    assert keeping.wait(0.25 * PERIOD) == pytest.approx(0.75 * PERIOD)
    keeping.write(0.25 * PERIOD)
    assert _found(store) == _at(2.0)
    keeping.write(PERIOD)
    assert _found(store) == _at(3.0)
    assert keeping.wait(PERIOD) is None
    assert told == []


def test_what_cannot_be_written_is_told_once_and_later_work_is_kept_again(
    store: WorkFiles, told: list[str], monkeypatch: pytest.MonkeyPatch
):
    keeping = Autosave(store, "paper-slow", told.append)
    keeping.find(SEAT)

    def full(visitor: str, work: bytes) -> None:
        raise StorageError("your work is not kept: the disk is full")

    with monkeypatch.context() as broken:
        broken.setattr(store, "save", full)
        for k in range(3):
            keeping.note(_at(2.0 + k))
            keeping.write(10.0 * k)
    assert told == ["Your work is not kept: the disk is full. The page works on; download what you need."]
    keeping.note(_at(7.0))
    keeping.write(50.0)
    assert _found(store) == _at(7.0)
    assert len(told) == 1


def test_what_is_no_work_of_this_version_is_told_and_no_error(store: WorkFiles, told: list[str]):
    store.save(SEAT, b'{"opened": "paper", "settings": {"preset": 3}}')
    assert Autosave(store, "paper-slow", told.append).find(SEAT) is None
    (sentence,) = told
    assert sentence.startswith("Your earlier work is of no use to this version")


def test_a_browser_that_keeps_nothing_is_told_so_and_nothing_is_written(store: WorkFiles, told: list[str]):
    keeping = Autosave(store, "paper-slow", told.append)
    assert keeping.find(None) is None
    keeping.note(SLOW)
    keeping.write(0.0)
    assert not store.folder.exists()
    assert len(told) == 1
