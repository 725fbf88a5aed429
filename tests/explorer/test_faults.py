"""Faults of the server, of its disk and of its visitors' browsers: the session lives on, nothing is lost, and nobody
else is disturbed."""

import asyncio
import errno
import gc
import itertools
import logging
import math
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from explorer.server import SessionServer
from explorer.storage import autosave, work_files
from explorer.storage.autosave import SavedWork
from explorer.web import limits
from rangenav import preset
from rangenav.progress import Cancelled, Progress
from tests.support.waiting_visitor import Editing, arrived, newest
from tests.support.wire import CAMERA, Storage, Wire

pytestmark = pytest.mark.slow

HOSTILE = (
    math.nan,
    math.inf,
    -1e300,
    "",
    "x" * 5000,
    "<script>",
    None,
    [],
    [math.nan] * 3,
    {},
    True,
    -1,
    2**62,
    "../../x",
)
PER_CONTROL, NODES = 4, 40
BUTTONS = ("GuiButtonMessage", "GuiUploadButtonMessage")
UNITS = "show gains as"
"""The only menu among the settings that an opened preset leaves alone."""
YEAR = 366 * 86400.0
"""s"""
RELOADS, CHANGES = 6, 8
NARROW, FEW = 4096, 120
"""Bytes that the system holds of what was sent, and messages of four pictures; those of eight are twice as many."""


@pytest.fixture(scope="module")
def visitor(sessions: tuple[int, SessionServer]) -> Iterator[Editing]:
    page = arrived(sessions)
    yield page
    page.tab.close()


def _broken(*_: object) -> None:
    raise RuntimeError("a programmer's error")


def _saved(sessions: tuple[int, SessionServer], page: Editing) -> SavedWork:
    (key,) = {value for name, value in page.tab.storage.shared.items() if name == "rangenav-visitor"}
    files = list(sessions[1].shared.work_files.folder.glob(f"{key}*.json"))
    return msgspec.json.decode(files[0].read_bytes(), type=SavedWork)


def _wait_until_saved(sessions: tuple[int, SessionServer], page: Editing, seed: int) -> None:
    def holds() -> bool:
        try:
            return _saved(sessions, page).settings.preset.seed == seed
        except (IndexError, OSError):
            return False

    page.tab.wait_for(holds, f"the seed {seed} in the file")


def test_a_job_that_fails_is_a_sentence_and_a_traceback_and_holds_nothing_up(
    visitor: Editing, caplog: pytest.LogCaptureFixture
) -> None:
    def work(progress: Progress, cancelled: Cancelled) -> None:
        _broken()

    def start() -> None:
        visitor.session.jobs.start("a search", work, _broken, _broken)

    visitor.session.form.do(start)
    visitor.tab.set("noise seed", "11")
    visitor.tab.wait_for(lambda: any("Internal error" in text for text in visitor.tab.notifications), "a sentence")
    visitor.tab.wait_for(lambda: visitor.settings.preset.seed == 11, "the change")
    assert "a programmer's error" in caplog.text
    visitor.tab.notifications.clear()


def test_a_page_that_cannot_be_built_is_a_sentence_and_the_others_live_on(
    sessions: tuple[int, SessionServer],
    visitor: Editing,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr("explorer.session.page.Dock", _broken)
        unlucky = Wire(sessions[0])
        unlucky.wait_for(lambda: any("Internal error" in text for text in unlucky.notifications), "a sentence")
        unlucky.close()
    assert "a programmer's error" in caplog.text
    visitor.set("noise seed", "12")
    assert visitor.settings.preset.seed == 12


@pytest.mark.parametrize("fault", ["full", "read-only"])
def test_a_disk_that_refuses_is_said_and_what_was_done_meanwhile_is_written_once_it_takes_it(
    sessions: tuple[int, SessionServer], visitor: Editing, fault: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    seed, files = {"full": 21, "read-only": 22}[fault], sessions[1].shared.work_files
    monkeypatch.setattr(autosave, "RETRY", 0.3)
    visitor.tab.notifications.clear()
    with monkeypatch.context() as patch:
        if fault == "full":
            patch.setattr(work_files, "write", full)
        else:
            (tmp_path / "home").write_bytes(b"")
            patch.setattr(files, "folder", tmp_path / "home" / "work")
        visitor.set("noise seed", str(seed))
        visitor.tab.wait_for(lambda: any("work is not kept" in text for text in visitor.tab.notifications), "a notice")
        assert visitor.settings.preset.seed == seed
        visitor.settle()
        assert len(visitor.tab.notifications) == 1, "said once, however often it is tried"
    _wait_until_saved(sessions, visitor, seed)


@pytest.mark.parametrize("jump", [YEAR, -YEAR])
def test_a_clock_that_jumps_loses_no_work_and_stops_nothing(
    sessions: tuple[int, SessionServer], visitor: Editing, jump: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    files, seed = sessions[1].shared.work_files, 31 if jump > 0 else 32
    by_age = sorted(files.folder.glob("*.json"), key=lambda file: file.stat().st_mtime)
    before = set(by_age[-work_files.AGELESS // 2 :])  # the suite has many visitors: beyond so many files, age counts
    clock = time.time
    monkeypatch.setattr(time, "time", lambda: clock() + jump)
    visitor.set("noise seed", str(seed))
    _wait_until_saved(sessions, visitor, seed)
    files.prune()
    assert set(files.folder.glob("*.json")) >= before
    moment = visitor.tab.value("t (s)")
    visitor.tab.command("Play or pause")
    visitor.tab.wait_for(lambda: visitor.tab.value("t (s)") != moment, "the run to play")
    visitor.settle()  # which pauses


def test_whatever_is_sent_for_whatever_control_the_session_lives_on(
    sessions: tuple[int, SessionServer],
    visitor: Editing,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    monkeypatch.setattr(limits, "MESSAGES", (1e6, 1e6))
    hostile = arrived(sessions)
    tab, values = hostile.tab, itertools.cycle(HOSTILE)
    units = tab.value(UNITS)
    for uuid, shown in list(tab.elements.items()):
        for value in itertools.islice(values, PER_CONTROL):
            if shown["message"] not in BUTTONS or not shown.get("visible", True) or shown.get("disabled"):
                tab.send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}})
    for updates in ({"visible": False}, {"removed": True}, {"value": 1.0, "update_cb": []}, {"__class__": 1}, {}):
        tab.send({"type": "GuiUpdateMessage", "uuid": tab.find("noise seed"), "updates": updates})
    before = visitor.settings
    visitor.set("noise seed", "41")
    assert visitor.settings.preset.seed == 41
    assert visitor.settings.origin == before.origin
    tab.wait_for_text("Not shown")
    tab.set(UNITS, units)
    tab.set("preset", f"{preset.load('circle').title} (circle)")
    tab.wait_for(lambda: hostile.settings.origin == "circle", "another preset")
    tab.wait_for(lambda: "Not shown" not in tab.text(), "the complaints to go")
    assert not any("Internal error" in text for text in tab.notifications)
    assert not [record for record in caplog.records if record.levelno >= logging.ERROR]
    assert not any(record.exc_info for record in caplog.records)
    tab.close()


def test_whatever_is_sent_of_whatever_node_or_command_the_session_lives_on(
    sessions: tuple[int, SessionServer], visitor: Editing, caplog: pytest.LogCaptureFixture
) -> None:
    tab = visitor.tab
    far, nowhere = (1e11, -1e11, 0.0), {"name": "/nowhere", "owner": ""}
    ray = {"ray_origin": far, "ray_direction": (0.0, 0.0, 0.0), "modifier": "alt"}
    named = [{"name": name, "owner": node["owner"]} for name, node in list(tab.nodes.items())][:NODES]
    for node in (*named, nowhere):
        pose = {"wxyz": (0.0, 0.0, 0.0, 7.0), "position": far}
        drag = {"instance_index": -7, "start_position": far, "start_screen_pos": (9.0, -9.0), "end_position": far}
        drag |= {"end_screen_pos": (9.0, -9.0), "button": "right", "modifier": "alt"}
        for phase in ("end", "update", "start", "start", "update"):
            tab.send({"type": "SceneNodeDragMessage", "phase": phase, **drag, **node})
        tab.send({"type": "SceneNodeClickMessage", "instance_index": 99, "screen_pos": (9.0, 9.0), **ray, **node})
        for name in ("DragEnd", "Update", "DragStart"):
            tab.send({"type": f"TransformControls{name}Message", **(pose if name == "Update" else {}), **node})
    for places in ((), ((9.0, 9.0),), ((0.1, 0.1),) * 7):
        for event in ("click", "rect-select"):
            tab.send({"type": "ScenePointerMessage", "event_type": event, "screen_pos": places, **ray})
    button = next(uuid for uuid, shown in tab.elements.items() if shown["message"] == "GuiButtonMessage")
    for uuid in ("nobody", button, tab.find("noise seed")):
        tab.send({"type": "GuiButtonHoldMessage", "uuid": uuid, "frequency": -1.0})
        tab.send({"type": "CommandTriggerMessage", "uuid": uuid})
        tab.send({"type": "LocalStorageGetItemResponseMessage", "value": "x", "error": None, "request_uuid": uuid})
        tab.send({"type": "GetRenderResponseMessage", "payload": b"no picture", "render_uuid": uuid})
    degenerate = {"position": far, "look_at": far, "near": 0.0, "far": 0.0, "image_height": 0, "image_width": -1}
    for nothing in ({"fov": 0.0}, {"wxyz": (0.0, 0.0, 0.0, 0.0)}, {"up_direction": (0.0, 0.0, 0.0)}, {"fov": 1e-9}):
        tab.send(CAMERA | degenerate | nothing)
    visitor.set("noise seed", "42")
    assert visitor.settings.preset.seed == 42
    tab.send(CAMERA)
    visitor.set("noise seed", "43")
    gc.collect()  # an error in a task is logged when the task goes
    assert not any("Internal error" in text for text in tab.notifications)
    assert not [record for record in caplog.records if record.levelno >= logging.ERROR]


def test_a_browser_that_reads_nothing_takes_bounded_memory_and_holds_nobody_up(
    sessions: tuple[int, SessionServer], visitor: Editing, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = limits.MeteredConnection.connection_made

    def narrow(connection: limits.MeteredConnection, transport: asyncio.BaseTransport) -> None:
        transport.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, NARROW)
        made(connection, transport)

    monkeypatch.setattr(limits.MeteredConnection, "connection_made", narrow)
    tab = Wire(sessions[0], narrow=True)
    sleeping = Editing(tab, newest(sessions[1], tab))
    waiting = sleeping.session.form.gui._websock_interface.get_message_buffer().message_from_id
    sleeping.tab.command("Play or pause")
    sleeping.tab.stall()
    counts: list[int] = []
    for seed in range(61, 61 + 5 * CHANGES):
        sleeping.tab.set("noise seed", str(seed))  # draws every plot of the estimate anew
        visitor.tab.wait_for(lambda seed=seed: sleeping.settings.preset.seed == seed, "the change")
        visitor.set("noise seed", str(seed))
        if counts or waiting:
            counts.append(len(waiting))
        if len(counts) == CHANGES:
            break
    assert len(counts) == CHANGES, "the browser still reads"
    assert counts[-1] <= counts[0] + FEW, counts
    sleeping.tab.close()


def test_a_page_that_is_loaded_again_and_again_keeps_its_work_and_leaves_one_session(
    sessions: tuple[int, SessionServer], caplog: pytest.LogCaptureFixture
) -> None:
    page = arrived(sessions)
    page.set("noise seed", "51")
    page.tab.close()
    storage = page.tab.storage
    others = len(sessions[1].sessions)
    for _ in range(RELOADS):
        Wire(sessions[0], storage=storage).close()
    last = arrived(sessions, Storage(shared=storage.shared, tab=storage.tab))
    assert last.settings.preset.seed == 51

    def sessions_left() -> int:
        return sum(thread.name.startswith("session ") for thread in threading.enumerate())

    last.tab.wait_for(lambda: len(sessions[1].sessions) <= others + 1, "the sessions before it to end")
    last.tab.wait_for(lambda: sessions_left() <= len(sessions[1].sessions), "their threads to end")
    assert not [record for record in caplog.records if record.levelno >= logging.ERROR]
    last.tab.close()
