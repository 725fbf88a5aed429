"""The dock reads back the settings that were written to it: undo, redo and autosave depend on it."""

from typing import Any

import msgspec
import pytest
from hypothesis import assume, given
from hypothesis import settings as tried
from hypothesis import strategies as st

from explorer.model.settings import Settings
from explorer.panels.dock import Dock
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.controls import Choice, Number, Switch, Text
from explorer.widgets.dial_control import DialControl
from explorer.widgets.dials import Dial, InverseDial, LogDial
from explorer.widgets.vector import AXES, Vector
from rangenav import axes
from rangenav.signals import Flown, Multisine
from rangenav.vehicle import CATALOGUE
from tests.support.page_settings import SHIPPED, SLOW_DRAWS, page_settings
from tests.support.refreshed import refreshed
from tests.support.signal_examples import keeps_its_family

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore:Do not use the `random` module")]
"""The threads of the websocket use `random` while hypothesis draws."""
FEW = tried(max_examples=30, deadline=None, suppress_health_check=SLOW_DRAWS)


@FEW
@given(page_settings(), page_settings())
def test_settings_are_read_back_as_they_were_written_whatever_was_there_before(
    dock: Dock, before: Settings, settings: Settings
):
    dock.write(before)
    assert refreshed(dock) == before
    dock.write(settings)
    assert refreshed(dock) == settings
    assert refreshed(dock) == settings  # reading changes nothing
    dock.write(before)
    assert refreshed(dock) == before


@FEW
@given(page_settings())
def test_settings_survive_the_file_they_are_kept_in(settings: Settings):
    assert msgspec.json.decode(msgspec.json.encode(settings), type=Settings) == settings


@FEW
@given(page_settings())
def test_axes_relabelled_twice_are_the_original_ones(dock: Dock, settings: Settings):
    signals = (settings.preset.path, settings.preset.angular_velocity)
    assume(all(keeps_its_family(signal) for signal in signals if not isinstance(signal, Flown)))
    assert axes.flipped(axes.flipped(settings.preset)) == settings.preset
    dock.write(settings)
    dock.relabel_axes()
    assert refreshed(dock).preset == axes.flipped(settings.preset)
    dock.relabel_axes()
    assert refreshed(dock) == settings


def test_a_constant_is_kept_while_another_family_is_in_use(dock: Dock):
    dock.write(Settings(origin="hover", preset=SHIPPED["hover"]))
    turning = dock.motion.angular_velocity.signal_editor
    turning.family_menu.show("constant")
    refreshed(dock)
    next(iter(turning.editors["constant"].fields.controls.values())).show((1.0, 2.0, 3.0))  # type: ignore[attr-defined]
    refreshed(dock)
    turning.family_menu.show("formula")
    refreshed(dock)
    turning.editors["formula"].texts["x"].show("7")  # type: ignore[attr-defined]
    settings = refreshed(dock)
    dock.write(Settings(origin="paper", preset=SHIPPED["paper"]))
    dock.write(settings)
    assert refreshed(dock) == settings
    turning.family_menu.show("constant")
    assert refreshed(dock).preset.angular_velocity == Multisine(offset=(1.0, 2.0, 3.0))


def test_vehicles_of_one_name_are_told_apart(dock: Dock):
    own = [msgspec.structs.replace(CATALOGUE[0], speed=float(k)) for k in (1, 2)]
    for chosen, base in (own, own[::-1]):
        dock.vehicle.write(chosen, base)
        assert dock.vehicle.read() == chosen


TYPED = st.sampled_from(("5000", "5e3", "5 000", "-0.2", "0", "1e-3", "", "1e", "1e9", "five", "nan", "12,5"))
"""What a visitor types into the box of a number."""
VALUES: dict[type, st.SearchStrategy[Any]] = {
    Choice: st.integers(0, 99),
    Dial: st.one_of(st.floats(-3, 90), TYPED),
    LogDial: st.one_of(st.floats(-6, 5), TYPED),
    InverseDial: st.one_of(st.floats(-1, 1), TYPED),
    Number: TYPED,
    Vector: st.tuples(*[st.one_of(st.floats(-2, 2).map(str), TYPED)] * 3),
    Switch: st.booleans(),
    Text: st.sampled_from(("sin(t)", "2*cos(3*t)", "t t", "", "0 0 0 0\n9 1 0 2\n20 0 0 1", "0 0 0 0\n0 1 1 1")),
}
DEEDS = st.tuples(st.integers(0, 999), st.tuples(*VALUES.values()))
"""The number of a visible control, and a value for each kind of control."""


def _do(dock: Dock, which: int, values: tuple[Any, ...]) -> None:
    """One action of a visitor: half of them choose another family, which might lose the most."""
    form = dock.form
    controls = [c for section in form.sections if section.visible for c in section.controls]
    families = [dock.motion.path.base_editor.family_menu, dock.motion.angular_velocity.signal_editor.family_menu]
    control: Any = families[which % 4] if which % 4 < 2 else controls[which % len(controls)]
    value = dict(zip(VALUES, values, strict=True))[type(control)]
    if isinstance(control, Choice):
        value = control.handle.options[value % len(control.handle.options)]
    if isinstance(control, DialControl) and isinstance(value, str):
        control.type(value)
    elif isinstance(control, Vector):
        for axis, text in zip(AXES, value, strict=True):
            control.type(axis, text)
    else:
        control.handle.value = value


def _read(dock: Dock) -> Settings | None:
    try:
        return refreshed(dock)
    except (InvalidInputError, ValueError):
        return None


@FEW
@given(st.lists(DEEDS, min_size=1, max_size=12))
def test_whatever_a_visitor_does_is_shown_again_as_they_left_it(dock: Dock, deeds: list[tuple[int, tuple[Any, ...]]]):
    dock.write(Settings(origin="circle", preset=SHIPPED["circle"]))
    good = refreshed(dock)
    for which, values in deeds:
        _do(dock, which, values)
        now = _read(dock)
        if now is not None:
            good = now
            assert _read(dock) == good  # looking again changes nothing
    dock.write(Settings(origin="paper", preset=SHIPPED["paper"]))
    dock.write(good)
    assert refreshed(dock) == good
