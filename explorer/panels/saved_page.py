"""What is remembered of a visitor's page when they leave, and shown again when they come back.

The settings are what the dock holds; the view is the rest: the playback, the comparison, the steps of undo and redo.
"""

import time
from collections.abc import Sequence

import msgspec

from explorer.model.comparison import NAMES
from explorer.model.history import History
from explorer.model.playback import Playback
from explorer.model.settings import Settings
from explorer.model.view import MAX_STEPS, View
from explorer.panels.dock import Dock
from explorer.storage.autosave import SavedWork
from explorer.storage.catalog import Catalog


def view_of(dock: Dock, history: History, playback: Playback) -> View:
    """What is remembered of the page besides the settings."""
    compare = dock.compare
    past, future = history.steps(MAX_STEPS)
    return View(
        time=playback.time,
        speed=playback.speed,
        loop=playback.loop,
        estimators=tuple(name for name in NAMES if name in compare.estimators.enabled),
        pinned=compare.pinned_settings,
        keep_pinned=compare.keep_pinned.read(),
        learning=dock.learn.learning,
        map=dock.studies.chosen,
        past=past,
        future=future,
    )


def restore(
    work: SavedWork, dock: Dock, history: History, playback: Playback, catalog: Catalog, *, as_a_step: bool
) -> None:
    """Show the work of an earlier visit; `as_a_step` it is not shown, but the next undo brings it back."""
    dock.gains.use_units(work.language)
    view = work.view
    others = [settings for settings in (view.pinned, view.learning.before) if settings is not None]
    steps = with_presets((*view.past, work.settings, *view.future, *others), catalog)
    done, undone = len(view.past), len(view.past) + 1 + len(view.future)
    settings, others = steps[done], steps[undone:]
    pinned = others[0] if view.pinned is not None else None
    before = others[-1] if view.learning.before is not None else None
    history.restore(steps[:done], steps[done + 1 : undone])
    history.record(settings, time.monotonic(), separate=True)
    playback.restore(view.time, view.speed, loop=view.loop)
    if not as_a_step:
        dock.write(settings)
        dock.compare.restore(view, pinned)
        dock.studies.restore(view.map, settings.preset)
        dock.learn.restore(msgspec.structs.replace(view.learning, before=before))


def with_presets(steps: Sequence[Settings], catalog: Catalog) -> list[Settings]:
    """The same settings, the oldest first, each from a preset in the catalog. A preset that was imported and not
    saved, or was deleted meanwhile, has no file: it is offered as it was in the oldest step."""
    origins: dict[str, str] = {}
    for step in steps:
        if step.origin not in catalog.presets and step.origin not in origins:
            origins[step.origin] = catalog.add_imported(step.preset).origin
    renewed = {origin: {"origin": new, "edition": ""} for origin, new in origins.items()}
    return [msgspec.structs.replace(step, **renewed.get(step.origin, {})) for step in steps]
