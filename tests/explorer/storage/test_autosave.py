"""Work is written when it is due; a failure is notified once, and writing is tried again at every change."""

import math
import stat
import threading

import msgspec
import pytest

from explorer.model.settings import Settings
from explorer.model.view import View
from explorer.storage.autosave import PERIOD, Autosave, SavedWork
from explorer.storage.work_files import StorageError, WorkFiles, new_browser_id
from rangenav import preset
from rangenav.signals import MinimumSnap, Waypoint

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


def test_what_is_written_aside_waits_for_a_slow_disk_and_the_latest_counts(
    work_files: WorkFiles, notices: list[str], monkeypatch: pytest.MonkeyPatch
):
    autosave, disk, save = Autosave(work_files, "paper-slow", notices.append), threading.Event(), work_files.save
    autosave.restore(SESSION_KEY)
    monkeypatch.setattr(work_files, "save", lambda key, work: (disk.wait(10), save(key, work)))
    autosave.remember(_at(2.0))
    autosave.write_aside(0.0)
    autosave.remember(_at(3.0))
    autosave.write_aside(PERIOD)  # the first write still waits: no second one beside it
    assert autosave.wait(PERIOD) == PERIOD
    disk.set()
    autosave.finish()
    assert _restored(work_files) == _at(2.0)
    autosave.remember(_at(4.0))
    autosave.write(1.5 * PERIOD, at_once=True)
    assert _restored(work_files) == _at(4.0)
    assert autosave.wait(2 * PERIOD) is None


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


NEWER = b'{"version": 2, "opened": "paper", "settings": {"of": "another form"}}'
UNREADABLE = {
    ".newer": (NEWER, "Your earlier work was saved by a newer version of the program."),
    ".broken": (b'{"opened": "paper", "settings": {"preset": 3}}', "Your earlier work is of no use to this version: "),
}


@pytest.mark.parametrize("ending", UNREADABLE)
def test_a_file_that_this_version_cannot_read_is_kept_and_not_written_over_by_opening_the_page(
    work_files: WorkFiles, notices: list[str], ending: str
):
    content, sentence = UNREADABLE[ending]
    work_files.save(SESSION_KEY, content)
    autosave = Autosave(work_files, "paper-slow", notices.append)
    for _ in range(2):  # a second visit finds the same file, and no second copy is made
        autosave = Autosave(work_files, "paper-slow", notices.append)
        assert autosave.restore(SESSION_KEY) is None
        autosave.remember(SLOW)  # what the page shows when it opens
        autosave.write(0.0, at_once=True)
        assert work_files.load(SESSION_KEY) == content
    assert len(notices) == 2
    assert notices[0] == notices[1]
    assert notices[0].startswith(sentence)
    assert f"kept as {SESSION_KEY}.json{ending} in {work_files.folder}" in notices[0]
    autosave.remember(_at(2.0))
    autosave.write(0.0, at_once=True)
    assert _restored(work_files) == _at(2.0)
    assert (work_files.folder / f"{SESSION_KEY}.json{ending}").read_bytes() == content
    assert len(list(work_files.folder.iterdir())) == 2


def test_every_file_of_a_newer_version_is_kept_under_a_number_of_its_own(work_files: WorkFiles, notices: list[str]):
    for k in range(3):
        work_files.save(SESSION_KEY, NEWER + b" " * k)
        Autosave(work_files, "paper-slow", notices.append).restore(SESSION_KEY)
    work_files.prune()
    for k, name in enumerate(("newer", "newer-2", "newer-3")):
        kept = work_files.folder / f"{SESSION_KEY}.json.{name}"
        assert kept.read_bytes() == NEWER + b" " * k
        assert stat.S_IMODE(kept.stat().st_mode) == 0o600


def test_where_a_file_cannot_be_kept_nothing_is_saved_over_it(
    work_files: WorkFiles, notices: list[str], monkeypatch: pytest.MonkeyPatch
):
    work_files.save(SESSION_KEY, NEWER)

    def full(session_key: str, ending: str) -> str:
        raise StorageError("it cannot be copied (no space left)")

    monkeypatch.setattr(work_files, "keep", full)
    autosave = Autosave(work_files, "paper-slow", notices.append)
    autosave.restore(SESSION_KEY)
    for scale in (1.0, 2.0):
        autosave.remember(_at(scale))
        autosave.write(0.0, at_once=True)
    assert work_files.load(SESSION_KEY) == NEWER
    (sentence,) = notices
    assert "It stays as it is, and nothing is saved: it cannot be copied (no space left)." in sentence


def test_a_browser_without_storage_is_notified_and_nothing_is_written(work_files: WorkFiles, notices: list[str]):
    autosave = Autosave(work_files, "paper-slow", notices.append)
    assert autosave.restore(None) is None
    autosave.remember(SLOW)
    autosave.write(0.0)
    assert not work_files.folder.exists()
    assert len(notices) == 1


def test_the_view_is_saved_with_the_settings(work_files: WorkFiles):
    view = View(time=3.2, speed=2.0, loop=False, estimators=("EKF",), pinned=_at(2.0), past=(SLOW,), future=(_at(4.0),))
    autosave = Autosave(work_files, "paper-slow", pytest.fail)
    autosave.restore(SESSION_KEY)
    autosave.remember(_at(3.0), view=view)
    autosave.write(0.0)
    work = Autosave(work_files, "paper-slow", pytest.fail).restore(SESSION_KEY)
    assert work is not None
    assert (work.settings, work.view) == (_at(3.0), view)


def test_work_without_a_view_has_the_usual_one(work_files: WorkFiles):
    autosave = Autosave(work_files, "paper-slow", pytest.fail)
    autosave.restore(SESSION_KEY)
    autosave.remember(_at(3.0))
    autosave.write(0.0)
    content = work_files.load(SESSION_KEY)
    assert content is not None
    fields = msgspec.json.decode(content)
    del fields["view"]  # as version 0.1.0 wrote it
    work_files.save(SESSION_KEY, msgspec.json.encode(fields))
    work = Autosave(work_files, "paper-slow", pytest.fail).restore(SESSION_KEY)
    assert work is not None
    assert (work.settings, work.view) == (_at(3.0), View())


def test_of_large_settings_fewer_steps_are_saved_and_the_file_stays_small(work_files: WorkFiles):
    points = tuple(Waypoint(time=float(k), value=(math.sin(k), math.cos(k), 0.1 * k)) for k in range(1000))
    large = msgspec.structs.replace(SLOW.preset, path=MinimumSnap(points=points))
    steps = tuple(Settings(origin="paper-slow", preset=large, time_scale=1.0 + 0.01 * k) for k in range(50))
    autosave = Autosave(work_files, "paper-slow", pytest.fail)
    autosave.restore(SESSION_KEY)
    autosave.remember(steps[-1], view=View(past=steps, future=steps))
    autosave.write(0.0)
    content = work_files.load(SESSION_KEY)
    assert content is not None
    assert len(content) < 1e6
    past = msgspec.json.decode(content, type=SavedWork).view.past
    assert 0 < len(past) < 10
    assert past == steps[-len(past) :]
