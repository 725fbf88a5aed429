"""Every field, family and format of the library has a control: the page would silently lose one without."""

from typing import get_args

import pytest
import viser

from explorer.model.jobs import Jobs
from explorer.model.settings import Printed, Settings
from explorer.panels.dock import Dock
from explorer.panels.motion.families import ANGULAR_VELOCITY_LABELS, BY_NAME, PATH_LABELS, ROWS, family_name
from explorer.panels.presets import bundle, import_panel
from explorer.panels.presets.printed import MISPRINTS
from explorer.storage.catalog import Catalog
from explorer.storage.certifier import Certifier
from explorer.storage.library import Library
from explorer.widgets.form import Form
from rangenav import formats
from rangenav.sensors import MODELLED, Effects
from rangenav.signals import Family, Flown, Sum
from tests.support.page_settings import EVERYTHING, SHIPPED
from tests.support.refreshed import refreshed
from tests.support.signal_examples import EXAMPLES

pytestmark = pytest.mark.slow


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


def test_the_page_writes_and_reads_the_formats_of_the_library(client: viser.ClientHandle, dock: Dock):
    catalog = Catalog(SHIPPED, Library(), Certifier())
    panel = bundle.BundlePanel(Form(client.gui, lambda: None), catalog, dock, Jobs(lambda: None), lambda *_: None)
    written = {row.name for row in formats.writable() if row.certified_as != "preset"}  # the preset is in every zip
    assert set(panel.formats) == written
    assert set(import_panel.choices()) == {row.name for row in formats.readable()}


def test_every_misprint_has_a_switch():
    assert set(MISPRINTS) == set(Printed.__struct_fields__)
