"""Undo, reset, complaints at the box that causes them, and work that comes back after a reload."""

import time

import msgspec
import pytest

from explorer.model.settings import Settings
from explorer.server import SessionServer
from explorer.shared import Compilation
from explorer.web.security import open_server
from explorer.widgets.form import Action
from rangenav import preset
from tests.support.shared_server import shared
from tests.support.waiting_visitor import Editing, arrived, newest
from tests.support.wire import Storage, Wire

pytestmark = pytest.mark.slow


NOT_SHOWN = "Not shown"


def test_undo_and_redo_go_over_everything_and_a_drag_is_one_step(editing: Editing):
    states = [editing.settings]
    for step in range(6):  # as while a slider is dragged
        editing.tab.set("amplitude x (m)", 1.0 + 0.01 * (step + 1))
        time.sleep(0.05)
    editing.settle()
    states.append(editing.settings)
    for label, value in (
        ("range weight q (1/(m⁴ s))", 2.0),
        ("ranges per second (Hz)", 20.0),
        ("vehicle", "hand-held"),
        ("flight duration (s)", 15.0),
    ):
        time.sleep(0.8)  # longer than a moment
        editing.set(label, value)
        states.append(editing.settings)
    for state in states[-2::-1]:
        editing.command("Undo")
        assert editing.settings == state
    editing.command("Undo")
    assert editing.settings == states[0]
    editing.tab.wait_for(
        lambda: any("Nothing to undo" in complaint for complaint in editing.tab.notifications), "a word"
    )
    for state in states[1:]:
        editing.command("Redo")
        assert editing.settings == state
    editing.command("Redo")
    editing.tab.wait_for(
        lambda: any("Nothing to redo" in complaint for complaint in editing.tab.notifications), "a word"
    )


def test_another_preset_is_a_step_that_can_be_undone(editing: Editing):
    editing.set("amplitude x (m)", 1.5)
    before = editing.settings
    editing.set("preset", f"{preset.load('hover').title} (hover)")
    assert editing.settings.origin == "hover"
    editing.command("Undo")
    assert editing.settings == before
    assert editing.tab.value("preset") == f"{preset.load('paper-slow').title} (paper-slow)"


def test_what_differs_from_the_preset_is_marked_and_can_be_reset(editing: Editing):
    editing.set("amplitude x (m)", 1.5)
    editing.set("frequency ω (rad/s)", 3.0)
    assert editing.tab.elements[editing.tab.find("amplitude x (m)")]["label"] == "amplitude x (m) •"
    editing.press("reset", "amplitude x (m)")
    assert editing.tab.elements[editing.tab.find("amplitude x (m)")]["label"] == "amplitude x (m)"
    assert editing.settings.preset.path.tones[0].frequency == 3.0  # type: ignore[union-attr]
    editing.command("Reset the last control")
    assert editing.settings.preset == preset.load("paper-slow")
    editing.set("range weight q (1/(m⁴ s))", 1.0)
    editing.set("noise seed", 5.0)
    editing.command("Reset all controls")
    assert editing.settings.preset == preset.load("paper-slow")


@pytest.mark.parametrize(
    ("seconds", "sentence"), [(0.0, "between 0.5 and 3600"), (1e6, "between 0.5 and 3600"), (3.0, "")]
)
def test_durations_beyond_reason_get_a_sentence(editing: Editing, seconds: float, sentence: str):
    editing.set("flight duration (s)", seconds)
    complaint = " ".join(editing.refusals())
    assert sentence in complaint if sentence else "time window judged δ must be shorter than the duration" in complaint


def test_a_long_flight_has_windows_of_minutes_and_pings_every_ten_seconds(editing: Editing):
    editing.set("speed (slower ⟷ faster)", -1.0)
    editing.set("flight duration (s)", 1200.0)
    editing.set("time window judged δ (s)", 200.0)
    editing.set("ranges per second (Hz)", 0.1)
    chosen = editing.settings.preset
    assert (chosen.duration, chosen.requirement.window, chosen.sensors.range_rate) == (1200.0, 200.0, 0.1)
    assert editing.tab.elements[editing.tab.find("time window judged δ (s)")]["max"] >= 600.0


def _complaints_below_controls(editing: Editing, sentence: str) -> list[str]:
    """The complaints with a sentence that are below controls, not in the verdict."""
    return [complaint for complaint in editing.refusals() if sentence in complaint and NOT_SHOWN not in complaint]


@pytest.mark.parametrize(
    ("label", "value", "sentence"),
    [
        ("flight duration (s)", 0.0, "flight duration must lie between"),
        ("noise seed", 1.5, "seed must be a whole number"),
        ("flight duration (s)", 3.0, "time window judged δ must be shorter"),
    ],
)
def test_a_refused_number_is_reported_at_its_box_and_no_longer_once_it_is_good(
    editing: Editing, label: str, value: float, sentence: str
):
    good = editing.tab.value(label)
    editing.set(label, value)
    assert _complaints_below_controls(editing, sentence)
    editing.settle()
    assert _complaints_below_controls(editing, sentence)
    editing.set(label, good)
    editing.wait_until_accepted()


def test_a_sentence_about_the_whole_goes_when_another_takes_its_place(editing: Editing):
    editing.set("frequency ω (rad/s)", 1e4)
    assert _complaints_below_controls(editing, "faster than the IMU")
    editing.set("ranges per second (Hz)", 2000.0)
    editing.set("IMU rate (Hz)", 0.0)
    assert not _complaints_below_controls(editing, "faster than the IMU")
    assert _complaints_below_controls(editing, "IMU rate must lie")


def test_why_a_button_did_nothing_is_said_until_something_else_is_shown(editing: Editing):
    editing.set("path made of", "waypoints")
    editing.set("ends of the curve", "open: at rest at both ends")
    editing.set("points, a line t x y z each", "0 0 0 0\n20 1 1 1")
    before = editing.settings
    editing.press("", "− delete it")
    assert _complaints_below_controls(editing, "2 to 2000 waypoints")
    assert editing.settings == before
    editing.set("range weight q (1/(m⁴ s))", 1.0)
    editing.tab.wait_for(lambda: not _complaints_below_controls(editing, "2 to 2000 waypoints"), "no complaint")


def test_the_control_of_a_tone_that_was_removed_is_not_reset(editing: Editing):
    editing.set("amplitude x (m)", 1.5)
    editing.press("", "− remove this tone")
    before = editing.settings
    editing.command("Reset the last control")
    assert editing.settings == before
    assert not [complaint for complaint in editing.tab.notifications if "Internal error" in complaint]


def test_undo_of_a_change_that_has_not_been_shown_yet_takes_back_that_change_alone(editing: Editing):
    editing.set("range weight q (1/(m⁴ s))", 1.0)
    before = editing.settings
    time.sleep(0.8)  # longer than a moment
    form, uuid = editing.session.form, editing.tab.find("ranges per second (Hz)")
    run_actions, dial = form.run_actions, editing.session.dock.sensors.range_rate

    def busy(before: Action) -> bool:
        """A change and its undo arrive while the session is busy, so that it reads both at once."""
        form.run_actions = run_actions  # type: ignore[method-assign]
        stepped = run_actions(before)
        editing.tab.send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": 33.0}})
        editing.tab.wait_for(lambda: dial.read() == 33.0, "the change")
        editing.tab.command("Undo")
        editing.tab.wait_for(lambda: form.waiting, "the undo")
        return run_actions(before) or stepped

    form.run_actions = busy  # type: ignore[method-assign]
    editing.settle()
    assert dial.read() == before.preset.sensors.range_rate
    assert editing.settings == before


def test_the_download_of_an_edited_path_is_read_back_exactly(editing: Editing):
    editing.set("path made of", "waypoints")
    editing.set("add a second motion", True)
    shown = editing.settings.preset
    text = preset.dumps(shown)
    assert preset.loads(text, source="test") == shown
    assert msgspec.json.decode(msgspec.json.encode(editing.settings), type=Settings) == editing.settings


def _until_shown(editing: Editing, expected: Settings) -> None:
    editing.tab.wait_for(lambda: editing.settings == expected, "the work")


def test_work_comes_back_after_a_reload_and_after_the_server_was_restarted(sessions: tuple[int, SessionServer]):
    storage = Storage()
    port, server = sessions
    editing = Editing(tab := Wire(port, storage=storage), newest(server, tab))
    editing.set("path made of", "formulas")
    editing.set("x(t) =", "cos(3*t)")
    editing.set("range weight q (1/(m⁴ s))", 2.0)
    expected = editing.settings
    tab.close()
    back = Wire(port, storage=storage)
    _until_shown(Editing(back, newest(server, back)), expected)
    back.close()
    server, compilation = open_server("127.0.0.1", 0), Compilation()
    again = SessionServer(server, shared(server, compilation))
    compilation.start()
    later = Wire(server.get_port(), storage=storage)
    _until_shown(Editing(later, newest(again, later)), expected)
    assert later.value("x(t) =") == "cos(3*t)"
    later.close()
    server.stop()


def test_estimators_time_pin_and_undo_survive_a_reload(sessions: tuple[int, SessionServer]):
    before = arrived(sessions)
    before.press("Pin this run as A")
    before.set("extended Kalman filter (EKF)", True)
    weight = before.settings.preset.gains.riccati.q
    before.set("range weight q (1/(m⁴ s))", 2.0)
    before.command("Play slower")
    before.tab.set("t (s)", 7.5)
    before.tab.wait_for_text("<b>7.50 s</b>")
    left = before.settings
    before.tab.close()
    after = arrived(sessions, before.tab.storage)
    compare = after.session.dock.compare
    after.tab.wait_for(lambda: compare.pinned is not None, "the pinned run")
    assert compare.pinned is not None
    assert compare.pinned.preset.gains.riccati.q == weight
    assert compare.estimators.enabled == {"EKF"}
    assert after.settings == left
    after.tab.wait_for(lambda: after.tab.value("t (s)") == 7.5, "the moment")
    after.tab.wait_for_text("paused ×0.5")
    after.command("Undo")
    assert after.settings.preset.gains.riccati.q == weight
    after.tab.close()


def test_two_tabs_of_one_browser_keep_their_own_work(sessions: tuple[int, SessionServer]):
    port, server = sessions
    browser = Storage()
    first = Editing(one := Wire(port, storage=browser), newest(server, one))
    second = Editing(two := Wire(port, storage=Storage(shared=browser.shared)), newest(server, two))
    first.set("range weight q (1/(m⁴ s))", 1.0)
    second.set("range weight q (1/(m⁴ s))", 3.0)
    one.close()
    two.close()
    back = Wire(port, storage=browser)
    assert Editing(back, newest(server, back)).settings.preset.gains.riccati.q == 10.0
    back.close()
