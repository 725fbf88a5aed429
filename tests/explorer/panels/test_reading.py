"""Reading the dock or a panel changes nothing on the page, whatever the visitor has just moved; `refresh` does."""

from collections.abc import Callable
from typing import Any, cast

import pytest
import viser

from explorer.model.settings import Settings
from explorer.panels.dock import Dock
from explorer.panels.motion import MotionChoice
from explorer.panels.sensors import SensorChoice
from explorer.widgets.complaint import InvalidInputError
from tests.support.page_settings import SHIPPED
from tests.support.refreshed import refreshed
from tests.support.sent_messages import Page

pytestmark = pytest.mark.slow


MOVES: dict[str, Callable[[Dock], None]] = {
    "nothing": lambda dock: None,
    "another family of the path": lambda dock: dock.motion.path.base_editor.family_menu.show("waypoints"),
    "another family of ω": lambda dock: dock.motion.angular_velocity.signal_editor.family_menu.show("flown"),
    "a tone": lambda dock: _move(dock, "amplitude x (m)", 0.7),
    "a curve that closes": lambda dock: _close(dock),
    "a wiggle": lambda dock: _move(dock, "add a second motion", True),
    "the time scale": lambda dock: dock.motion.timing.time_scale.show(1.5),
    "gravity": lambda dock: _move(dock, "gravity g (m/s²)", (0.0, 0.0, -9.81)),
    "a sensor set": lambda dock: dock.sensors.sensor_set.show("paper"),
    "a rate": lambda dock: dock.sensors.range_rate.show(17.0),
    "noise as a density": lambda dock: dock.sensors.noise.as_density.show(True),
    "an effect": lambda dock: dock.sensors.effects.fields.controls["gyro_bias"].show((0.01, 0.0, 0.0)),
    "the mode of the gains": lambda dock: dock.gains.mode.show("noise-matched"),
    "gains in physical units": lambda dock: dock.gains.units_choice.show("physical"),
    "a gain in physical units": lambda dock: _move_physical(dock, 0.9),
    "a schedule of k1": lambda dock: dock.gains.schedule_dials.enabled.show(True),
}
INVALID: dict[str, tuple[str, Any]] = {
    "a seed that is no whole number": ("noise seed", 1.5),
    "a duration that is too short": ("flight duration (s)", 0.0),
    "a magnetic direction along gravity": ("magnetic direction m", (0.0, 0.0, 1.0)),
    "a frequency beyond what the IMU can sample": ("frequency ω (rad/s)", 1e4),
    "an axis without a length": ("axis of the attitude error", (0.0, 0.0, 0.0)),
}


def _move(dock: Dock, name: str, value: Any) -> None:
    """Move the first control of a name."""
    controls: list[Any] = [control for section in dock.form.sections for control in section.controls]
    next(control for control in controls if control.name == name).show(value)


def _close(dock: Dock) -> None:
    """Close a curve through points whose period is too short for it."""
    dock.motion.path.base_editor.family_menu.show("waypoints")
    refreshed(dock)
    _move(dock, "ends of the curve", "rest")
    refreshed(dock)
    _move(dock, "period (s)", 0.1)
    _move(dock, "ends of the curve", "closed")


def _move_physical(dock: Dock, factor: float) -> None:
    """Move a gain in physical units."""
    dock.gains.units_choice.show("physical")
    refreshed(dock)
    dial = dock.gains.physical_dials.dials["range_sigma"]
    dial.show(factor * dial.read())


def _controls(dock: Dock) -> list[tuple[Any, ...]]:
    """Label, value and visibility of every control on the page, and whether its section can be seen."""
    handles = [(cast(Any, c).handle, s) for s in dock.form.sections for c in s.controls]
    return [(handle.label, handle.value, handle.visible, s.label, s.visible) for handle, s in handles]


def _all_read(dock: Dock) -> list[Any]:
    """What every panel and the dock say, or the kind and the cause of the error that they raise."""
    without_gains = Settings(preset=SHIPPED["circle"])
    reads: tuple[Callable[[], Any], ...] = (
        dock.motion.read,
        dock.world.read,
        dock.twin.read,
        dock.vehicle.read,
        dock.sensors.read,
        lambda: dock.gains.read(without_gains),
        dock.guess.read,
        dock.printed.read,
        dock.presets.read,
        dock.read,
    )
    said: list[Any] = []
    for read in reads:
        try:
            said.append(read())
        except (InvalidInputError, ValueError) as error:
            said.append((type(error), str(error), str(error.__cause__)))
    return said


def _assert_reading_changes_nothing(dock: Dock, page: Page) -> None:
    before = _controls(dock)
    page.messages.clear()
    assert _all_read(dock) == _all_read(dock)
    assert page.messages == []
    assert _controls(dock) == before


@pytest.fixture(scope="module")
def recorded(client: viser.ClientHandle) -> Page:
    """Remembers every message that is sent to the client of the module."""
    return Page(cast(viser.ViserServer, client))


@pytest.mark.parametrize("move", MOVES.values(), ids=MOVES.keys())
@pytest.mark.parametrize("name", ["circle", "paper"])
def test_reading_any_panel_or_the_dock_twice_gives_equal_values_and_sends_no_message(
    dock: Dock, recorded: Page, name: str, move: Callable[[Dock], None]
):
    dock.gains.use_units("paper")
    dock.write(Settings(origin=name, preset=SHIPPED[name]))
    move(dock)
    _assert_reading_changes_nothing(dock, recorded)
    settings = refreshed(dock)
    _assert_reading_changes_nothing(dock, recorded)
    p = settings.preset
    assert MotionChoice.of(settings) == dock.motion.read()
    assert (p.world, p.vehicle, p.guess) == (dock.world.read(), dock.vehicle.read(), dock.guess.read())
    assert SensorChoice.of(p) == dock.sensors.read()
    assert dock.gains.read(settings) == settings


@pytest.mark.parametrize(("control", "value"), INVALID.values(), ids=INVALID.keys())
def test_what_is_invalid_is_said_on_the_page_by_refresh_and_not_by_reading(
    dock: Dock, recorded: Page, control: str, value: Any
):
    dock.gains.use_units("paper")
    dock.write(Settings(origin="circle", preset=SHIPPED["circle"]))
    _move(dock, control, value)
    _assert_reading_changes_nothing(dock, recorded)
    with pytest.raises(InvalidInputError), dock.catching():
        dock.refresh()
    assert [section.complaint.content for section in dock.form.sections if section.complaint.content]
    with pytest.raises((InvalidInputError, ValueError)):
        dock.read()
    _assert_reading_changes_nothing(dock, recorded)
