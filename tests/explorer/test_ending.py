"""The program ends when it is told to, and what was changed a moment before is saved."""

import signal
import time
from pathlib import Path

import pytest

from explorer.server import SessionServer
from tests.support.server_process import ServerProcess
from tests.support.waiting_visitor import arrived
from tests.support.wire import Storage

pytestmark = pytest.mark.slow
MOMENT = 0.1
"""s between a change and the signal."""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP])
def test_what_was_changed_a_moment_before_a_signal_is_saved(tmp_path: Path, number: signal.Signals):
    server = ServerProcess(tmp_path)
    tab = server.connect(Storage())
    for seed in (3.0, 7.0):  # the first is saved at once, the second would be due a second later
        tab.set("noise seed", seed)
        time.sleep(MOMENT)
    assert server.end(number) == 0
    assert server.saved().settings.preset.seed == 7
    tab.close()


def test_after_a_kill_every_session_comes_back_and_a_full_disk_is_said_and_loses_nothing(tmp_path: Path):
    killed, seeds = ServerProcess(tmp_path), (31.0, 32.0)
    tabs = [killed.connect(Storage()) for _ in seeds]
    for tab, seed in zip(tabs, seeds, strict=True):
        tab.set("noise seed", seed)
    tabs[0].wait_for(lambda: sorted(one.settings.preset.seed for one in killed.all_saved()) == [*seeds], "the files")
    assert killed.end(signal.SIGKILL) == -signal.SIGKILL
    server = ServerProcess(tmp_path)
    back = [server.connect(tab.storage) for tab in tabs]
    assert [tab.value("noise seed") for tab in back] == ["31", "32"]
    server.fill_disk(full=True)
    back[0].set("noise seed", 33.0)
    back[0].wait_for(lambda: any("work is not kept" in text for text in back[0].notifications), "a notice")
    server.fill_disk(full=False)
    assert server.end(signal.SIGTERM) == 0
    assert sorted(one.settings.preset.seed for one in server.all_saved()) == [32, 33]
    assert "Traceback" not in server.errors
    for tab in (*tabs, *back):
        tab.close()


def test_the_work_of_a_newer_version_outlives_a_visit_and_the_page_says_where_it_is(
    sessions: tuple[int, SessionServer],
):
    folder = sessions[1].shared.work_files.folder
    others = set(folder.glob("*.json"))
    before = arrived(sessions)
    before.set("noise seed", 3.0)
    before.tab.close()
    before.session.thread.join()
    (file,) = set(folder.glob("*.json")) - others
    newer = file.read_bytes().replace(b'"version":1', b'"version":2', 1).replace(b'"settings":', b'"chosen":', 1)
    file.write_bytes(newer)
    after = arrived(sessions, before.tab.storage)
    words = ("newer version of the program", f"{file.name}.newer")
    after.tab.wait_for(lambda: any(all(word in text for word in words) for text in after.tab.notifications), "a notice")
    after.tab.close()
    after.session.thread.join()
    assert file.read_bytes() == newer
    assert file.with_name(f"{file.name}.newer").read_bytes() == newer
