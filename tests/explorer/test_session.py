"""A session through viser's messages: the latest change counts, bad input gets a complaint, tabs are independent."""

import math
import threading
import time
from collections.abc import Iterator

import pytest

from explorer.charts import plot_list
from explorer.model.playback import Playback
from explorer.server import SessionServer
from explorer.shared import Compilation
from explorer.web.security import open_server
from rangenav import preset
from tests.support.shared_server import shared
from tests.support.waiting_visitor import drawn, proven
from tests.support.wire import Wire

pytestmark = pytest.mark.slow


NOT_SHOWN = "Not shown"


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    server, compilation = open_server("127.0.0.1", 0), Compilation()
    SessionServer(server, shared(server, compilation))
    compilation.start()
    yield server.get_port()
    server.stop()


@pytest.fixture
def visitor(port: int) -> Iterator[Wire]:
    tab = Wire(port)
    tab.wait_for_text("13 of 13")
    yield tab
    tab.close()


def _threads() -> int:
    return sum(thread.name.startswith("session") for thread in threading.enumerate())


def _wait_for_threads(count: int) -> None:
    deadline = time.monotonic() + 10
    while _threads() != count and time.monotonic() < deadline:
        time.sleep(0.05)
    assert _threads() == count


def _wait_until_blind(tab: Wire) -> None:
    """The sampled verdict is replaced at once by the proven one if that was computed before."""
    tab.wait_for(lambda: "✕ ≈ blind" in tab.text() or "✕ blind" in tab.text(), "a blind motion")


def test_a_gain_changes_the_errors_and_the_label_follows(visitor: Wire):
    before = drawn(visitor)
    visitor.set("range weight q (1/(m⁴ s))", 0.0)
    visitor.wait_for(lambda: drawn(visitor) != before, "another verdict")
    visitor.wait_for(lambda: visitor.value(f"{WEIGHT}: number") == "1", "the number")


WEIGHT = "range weight q (1/(m⁴ s))"


def test_a_sensor_set_is_loaded_and_effects_that_the_paper_does_not_model_are_named(visitor: Wire):
    before = drawn(visitor)
    visitor.set("sensor set", "UWB behind obstacles")
    visitor.wait_for_text("the paper&#x27;s observer has no gate")
    visitor.wait_for(lambda: drawn(visitor) != before, "another verdict")
    assert visitor.value("ranges per second (Hz)") == 100.0
    visitor.set("outliers (%)", 0.0)
    visitor.wait_for(lambda: visitor.value("sensor set") == "as set below", "the set to be no longer that one")
    visitor.wait_for(lambda: "has no gate" not in visitor.text(), "the sentence to go")


def test_a_flight_whose_ranges_are_all_lost_isdrawn(visitor: Wire):
    visitor.set("silent for (s)", 1000.0)
    visitor.wait_for_text("⚠ diverged")
    visitor.set("t (s)", 3.0)
    visitor.wait_until_quiet(0.6)
    assert not visitor.notifications


def test_a_sentence_is_shown_as_text_and_not_as_html(visitor: Wire):
    visitor.set("preset", "<img src=x onerror=alert(1)>")
    visitor.wait_for_text(NOT_SHOWN)
    assert "<img src=x" not in visitor.text()


def test_the_latest_of_many_changes_is_what_remains(visitor: Wire):
    for step in range(60):
        visitor.set("range weight q (1/(m⁴ s))", 1.0 + step / 30)
    visitor.wait_for(lambda: visitor.value(f"{WEIGHT}: number") == "926.1", "the last value")
    visitor.wait_until_quiet(0.6)
    plot_count = sum(len(group.plots) for group in plot_list.GROUPS)
    assert visitor.counts["GuiUplotMessage"] <= plot_count  # plots are created once, however many changes arrive
    assert visitor.value(f"{WEIGHT}: number") == "926.1"


def test_a_preset_replaces_every_control_and_its_tones(visitor: Wire):
    visitor.set("preset", f"{preset.load('hover').title} (hover)")
    _wait_until_blind(visitor)
    visitor.wait_until_quiet(0.6)
    assert not any(p.get("label") == "amplitude x (m)" for p in visitor.elements.values())
    visitor.set("preset", f"{preset.load('wiggle').title} (wiggle)")
    visitor.wait_for(
        lambda: any((p.get("label") or "").startswith("x: 0.02") for p in visitor.elements.values()), "tones"
    )
    visitor.wait_for_text("13 of 13")


def test_a_written_preset_is_drawn_once_not_once_for_every_control(visitor: Wire):
    visitor.wait_until_quiet(0.6)
    before = visitor.counts["GuiUpdateMessage"]
    visitor.set("preset", f"{preset.load('lissajous').title} (lissajous)")
    visitor.wait_until_quiet(0.6)
    assert visitor.counts["GuiUpdateMessage"] - before < 250


def test_an_idle_session_sends_nothing(visitor: Wire):
    visitor.wait_until_quiet(3.0)


def test_two_tabs_do_not_disturb_each_other(port: int, visitor: Wire):
    other = Wire(port)
    other.wait_for_text("13 of 13")
    before, label = proven(other), visitor.value("amplitude x (m)")
    visitor.set("amplitude x (m)", 2.0)
    visitor.set("preset", f"{preset.load('circle').title} (circle)")
    _wait_until_blind(visitor)
    assert drawn(other) == before
    assert other.value("amplitude x (m)") == label
    other.close()


def test_a_tab_that_leaves_takes_its_thread_with_it(port: int):
    _wait_for_threads(0)
    tabs = [Wire(port) for _ in range(3)]
    for tab in tabs:
        tab.wait_for_text("13 of 13")
    assert _threads() == 3
    for tab in tabs:
        tab.close()
    _wait_for_threads(0)


def test_a_tab_that_leaves_in_the_middle_of_a_mistake_is_no_error(port: int, caplog: pytest.LogCaptureFixture):
    """Pytest turns an exception in the session's thread, and a message to a closed connection, into a failure."""
    tab = Wire(port)
    tab.wait_for_text("13 of 13")
    tab.set("flight duration (s)", 2.0)
    tab.wait_for_text("time window judged δ must be shorter than the duration")
    tab.close()
    _wait_for_threads(0)
    assert "session" not in caplog.text


def test_a_tab_may_leave_while_its_picture_is_drawn_and_what_it_changed_last_is_saved(
    port: int, caplog: pytest.LogCaptureFixture
):
    tab = Wire(port)
    tab.wait_for_text("13 of 13")
    tab.set("flight duration (s)", 25.0)
    tab.close()
    _wait_for_threads(0)
    assert "session" not in caplog.text
    again = Wire(port, storage=tab.storage)
    again.wait_for_text("13 of 13")
    assert again.value("flight duration (s)") == "25"
    again.close()


def test_an_unforeseen_error_after_the_tab_has_left_is_only_logged(
    port: int, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
):
    def broken(*_: object) -> None:
        raise RuntimeError("a programmer's error")

    tab = Wire(port)
    tab.wait_for_text("13 of 13")
    with monkeypatch.context() as patch:
        patch.setattr("explorer.storage.autosave.Autosave.remember", broken)
        tab.close()
        _wait_for_threads(0)
    assert "a programmer's error" in caplog.text


def test_an_unforeseen_error_is_notified_and_the_session_goes_on(
    visitor: Wire, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
):
    def broken(_: object) -> None:
        raise RuntimeError("a programmer's error")

    with monkeypatch.context() as patch:
        patch.setattr("explorer.model.compute.compute", broken)
        visitor.set("range weight q (1/(m⁴ s))", 0.5)
        visitor.wait_for(lambda: any("Internal error" in text for text in visitor.notifications), "a notification")
    assert "a programmer's error" in caplog.text
    caplog.clear()
    before = drawn(visitor)
    visitor.set("range weight q (1/(m⁴ s))", 0.0)
    visitor.wait_for(lambda: drawn(visitor) != before, "the session to go on")


def test_scrubbing_pauses_and_stays_inside_the_run(visitor: Wire):
    visitor.set("t (s)", 7.5)
    visitor.set("t (s)", 1e9)
    visitor.wait_for(lambda: visitor.value("t (s)") == preset.load("paper-slow").duration, "the end of the run")
    visitor.set("t (s)", math.nan)
    visitor.wait_for_text("time must be a finite number")
    visitor.set("t (s)", 3.0)
    visitor.wait_for(lambda: "time must be" not in visitor.text(), "the complaint to go")


@pytest.mark.parametrize("nonsense", ["abc", "-1", "1e99", ""])
def test_a_moment_that_is_none_gets_a_sentence_and_stays_as_it_was_typed(visitor: Wire, nonsense: str):
    sent = visitor.value("t (s): number")
    visitor.set("t (s): number", "7.5")
    visitor.wait_for(lambda: visitor.value("t (s)") == 7.5, "the moment")
    visitor.set("t (s): number", nonsense)
    visitor.wait_for_text("⚠")
    assert visitor.value("t (s): number") == sent  # nothing was put in place of what was typed
    assert visitor.value("t (s)") == 7.5
    visitor.set("t (s)", 3.0)
    visitor.wait_for(lambda: visitor.value("t (s): number") == "3", "the box to follow the slider")
    visitor.wait_for(lambda: "⚠" not in visitor.text(), "the complaint to go")


def test_the_clock_plays_loops_and_stops():
    clock = Playback(10.0)
    clock.toggle(100.0)
    clock.advance(101.0)
    assert clock.time == 1.0
    clock.change_speed(+1)
    clock.advance(106.0)
    assert clock.time == 1.0  # 1 + 5 · 2 = 11 s of a 10 s run that loops
    clock.toggle_loop()
    clock.advance(200.0)
    assert (clock.time, clock.playing) == (10.0, False)
    clock.toggle(300.0)
    assert (clock.time, clock.playing) == (0.0, True)
    clock.seek(99.0)
    assert (clock.time, clock.playing) == (10.0, False)
    clock.fit(4.0)
    assert clock.time == 4.0
    with pytest.raises(ValueError, match="finite"):
        clock.seek(math.nan)


def test_speed_stays_within_its_list():
    clock = Playback(1.0)
    for _ in range(20):
        clock.change_speed(-1)
    assert clock.speed == 0.1
    for _ in range(20):
        clock.change_speed(+1)
    assert clock.speed == 8.0


NUMERALS = "9" * 400
"""A browser sends the text of a number box where JavaScript cannot hold it as a number."""


def test_a_number_of_hundreds_of_digits_in_any_box_is_no_internal_error(visitor: Wire):
    boxes = {
        uuid: p for uuid, p in visitor.elements.items() if _is_number(p.get("value")) or _is_vector(p.get("value"))
    }
    assert len(boxes) > 40
    for uuid, properties in boxes.items():
        value = properties["value"]
        assert not isinstance(value, int), f"{properties['label']}: viser would cut off decimals, and keep every digit"
        entered = NUMERALS if _is_number(value) else [NUMERALS] * len(value)
        visitor.send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": entered}})
    for uuid, properties in list(visitor.elements.items()):
        if str(properties.get("value")).replace(".", "").isdigit():  # what is typed is a text
            visitor.send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": str(NUMERALS)}})
    visitor.press("Run the noise seeds")
    visitor.wait_for(lambda: "runs: “" in visitor.text(), "a complaint", timeout=30)
    assert not any("Internal error" in text for text in visitor.notifications)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_vector(value: object) -> bool:
    return isinstance(value, list | tuple) and len(value) == 3 and all(map(_is_number, value))
