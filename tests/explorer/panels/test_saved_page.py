"""What a visitor left is shown again when they come back; what has no file any more is offered as it was."""

import msgspec
import pytest

from explorer.model.history import History
from explorer.model.playback import Playback
from explorer.model.settings import Settings
from explorer.panels import saved_page
from explorer.panels.dock import Dock
from explorer.storage.autosave import SavedWork
from explorer.storage.catalog import NEW, Catalog
from explorer.storage.certifier import Certifier
from explorer.storage.library import Library
from tests.support.page_settings import SHIPPED

CIRCLE, HOVER = (Settings(origin=name, preset=SHIPPED[name]) for name in ("circle", "hover"))
DURATION = SHIPPED["circle"].duration


@pytest.fixture
def catalog() -> Catalog:
    return Catalog(SHIPPED, Library(), Certifier())


def left(dock: Dock) -> SavedWork:
    """The work of a visitor who has undone the step from the circle to the hover, halfway through the circle."""
    history, playback = History(), Playback(DURATION)
    history.restore((), ())
    for k, settings in enumerate((Settings(origin="soft", preset=SHIPPED["soft"]), CIRCLE, HOVER)):
        history.record(settings, float(k), separate=True)
    assert history.undo() == CIRCLE
    playback.restore(0.5 * DURATION, 2.0, loop=False)
    dock.write(CIRCLE)
    view = saved_page.view_of(dock, history, playback)
    return SavedWork(opened="soft", settings=dock.read(), view=view)


def test_who_comes_back_sees_what_they_left_and_can_undo_and_redo_it(dock: Dock, catalog: Catalog):
    work, history, playback = left(dock), History(), Playback(DURATION)
    dock.write(HOVER)
    saved_page.restore(work, dock, history, playback, catalog, as_a_step=False)
    assert dock.read() == CIRCLE
    assert saved_page.view_of(dock, history, playback) == work.view
    assert history.redo() == HOVER


def test_work_that_gives_way_to_a_requested_preset_is_one_undo_away(dock: Dock, catalog: Catalog):
    work, history, playback = left(dock), History(), Playback(DURATION)
    dock.write(HOVER)
    saved_page.restore(work, dock, history, playback, catalog, as_a_step=True)
    assert dock.read() == HOVER
    history.record(HOVER, 0.0, separate=True)
    assert history.undo() == CIRCLE


def test_a_preset_without_a_file_is_offered_once_as_it_was_in_the_oldest_step(catalog: Catalog):
    lost = msgspec.structs.replace(CIRCLE, origin=f"{NEW}gone", edition="abc")
    later = msgspec.structs.replace(lost, preset=msgspec.structs.replace(lost.preset, seed=99))
    before = set(catalog.presets)
    steps = saved_page.with_presets((HOVER, lost, later), catalog)
    (offered,) = set(catalog.presets) - before
    assert catalog.presets[offered] == lost.preset
    assert [(step.origin, step.edition) for step in steps] == [("hover", ""), (offered, ""), (offered, "")]
    assert [step.preset for step in steps] == [HOVER.preset, lost.preset, later.preset]
