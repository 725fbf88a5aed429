"""Every field, family and format of the library has a control: the page would silently lose one without."""

from typing import Annotated, Any, get_args

import msgspec
import pytest
import viser

from explorer.model.jobs import Jobs
from explorer.model.settings import Printed, Settings
from explorer.panels.dock import Dock
from explorer.panels.motion.families import (
    ANGULAR_VELOCITY_LABELS,
    BY_NAME,
    PATH_LABELS,
    ROWS,
    family_name,
    family_of_numbers,
)
from explorer.panels.motion.families.numbers import NumbersEditor
from explorer.panels.motion.path import PATH
from explorer.panels.presets import bundle, import_panel
from explorer.panels.presets.printed import MISPRINTS
from explorer.storage.catalog import Catalog
from explorer.storage.certifier import Certifier
from explorer.storage.library import Library
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.form import Form
from rangenav import formats
from rangenav.fields import SIGNAL_UNIT, NumberField
from rangenav.inputs import Vec3
from rangenav.sensors import MODELLED, Effects
from rangenav.signals import Family, Flown, Sum
from rangenav.signals.base import SignalBase
from tests.support.page_settings import EVERYTHING, SHIPPED
from tests.support.refreshed import refreshed
from tests.support.signal_examples import EXAMPLES

pytestmark = pytest.mark.slow
RADIUS = NumberField(label="radius", unit=SIGNAL_UNIT, limits=(0.0, 100.0), step=0.01, dial=(0.0, 5.0), hint="r.")
CLIMB = NumberField(label="climb", unit=f"{SIGNAL_UNIT}/s", limits=(0.0, 100.0), step=0.01, hint="c.")


class Helix(SignalBase, frozen=True, kw_only=True, tag="helix", tag_field="kind"):
    """A family of numbers, which the library does not have."""

    radius: Annotated[float, RADIUS] = 1.0
    climb: Annotated[Vec3, CLIMB] = (0.0, 0.0, 0.0)


def helix(**values: Any) -> Any:
    """A signal of a family that is not in the union."""
    return Helix(**values)


def test_the_preset_with_every_effect_has_no_field_at_its_default():
    assert [name for name in Effects.__struct_fields__ if getattr(EVERYTHING, name) == getattr(MODELLED, name)] == []


def test_every_effect_has_a_control_and_no_control_is_without_an_effect(dock: Dock):
    assert tuple(dock.sensors.effects.fields.controls) == Effects.__struct_fields__


def test_each_effect_alone_is_read_back_from_its_control(dock: Dock):
    for name in Effects.__struct_fields__:
        dock.write(Settings(origin="soft", preset=SHIPPED["soft"]))
        dock.sensors.effects.fields.controls[name].show(getattr(EVERYTHING, name))
        effects = refreshed(dock).preset.sensors.unmodelled
        changed = [field for field in Effects.__struct_fields__ if getattr(effects, field) != getattr(MODELLED, field)]
        assert changed == [name]
        assert getattr(effects, name) == getattr(EVERYTHING, name)


def test_every_family_of_paths_is_in_the_menu_of_paths_under_the_name_that_files_give_it():
    assert {BY_NAME[name].type for name in PATH_LABELS} == set(get_args(Family))
    for row in ROWS:
        if row.name != "constant":  # a Multisine
            assert row.type.__struct_config__.tag == row.name


def test_every_menu_entry_has_a_hint_and_every_name_one_row():
    assert all(row.path_hint for row in ROWS if row.path_label)
    assert len(BY_NAME) == len(ROWS)
    assert all(row.path_label or row.angular_velocity_label for row in ROWS)


def test_every_example_of_a_signal_has_a_family_and_only_sums_come_from_a_file_alone():
    for signal in (*EXAMPLES.values(), Flown()):
        assert (family_name(signal) in BY_NAME) == (not isinstance(signal, Sum))


def test_a_flown_body_and_every_label_of_an_angular_velocity_have_a_row():
    assert set(ANGULAR_VELOCITY_LABELS) <= set(BY_NAME)
    assert "flown" in ANGULAR_VELOCITY_LABELS


def test_a_family_of_numbers_gets_a_control_for_each_field_that_reads_its_value_back(client: viser.ClientHandle):
    row = family_of_numbers(helix(), description="a helix", path_label="helix", path_hint="a circle that climbs")
    editor = row.editor(Form(client.gui, lambda: None), PATH)
    assert isinstance(editor, NumbersEditor)
    assert [control.handle.label for control in editor.fields.controls.values()] == ["radius (m)", "climb (m/s)"]
    shown = helix(radius=2.5, climb=(0.1, 0.0, -0.3))
    editor.write(shown, helix())
    assert refreshed(editor) == shown
    for name, value in (("radius", 4.0), ("climb", (0.0, 0.0, 1.0))):
        editor.write(shown, helix())
        editor.fields.controls[name].show(value)
        assert refreshed(editor) == msgspec.structs.replace(shown, **{name: value})
    editor.fields.controls["radius"].show(-1.0)
    with pytest.raises(InvalidInputError) as refusal:
        refreshed(editor)
    assert str(refusal.value.__cause__) == "radius must lie between 0 and 100, got -1"


def test_a_visitor_who_chooses_a_family_of_numbers_starts_from_the_signal_of_its_row():
    first = helix(radius=3.0)
    row = family_of_numbers(first, description="a helix", path_label="helix", path_hint="a circle that climbs")
    assert row.name == "helix"
    assert row.convert(EXAMPLES["waypoints"], 10.0) == first
    assert row.convert(helix(radius=7.0), 10.0) == helix(radius=7.0)


def test_the_page_writes_and_reads_the_formats_of_the_library(client: viser.ClientHandle, dock: Dock):
    catalog = Catalog(SHIPPED, Library(), Certifier())
    panel = bundle.BundlePanel(Form(client.gui, lambda: None), catalog, dock, Jobs(lambda: None), lambda *_: None)
    written = {row.name for row in formats.writable() if row.certified_as != "preset"}  # the preset is in every zip
    assert set(panel.formats) == written
    assert set(import_panel.choices()) == {row.name for row in formats.readable()}


def test_every_misprint_has_a_switch():
    assert set(MISPRINTS) == set(Printed.__struct_fields__)
