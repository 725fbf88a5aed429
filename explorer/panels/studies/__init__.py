"""The Studies tab: a map of one metric over two parameters of the design on the page, filled in from coarse to fine.

    controls ──study_map.study_of──▶ Study ──job──▶ StudyMap, again and again ──picture.markup──▶ the page
A map belongs to the design that it was computed for, except for its two parameters; of another design it is marked so,
and none of its cells can be taken. Autosave and undo do not include it.
"""

import re
import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial

from explorer.model.chosen_map import ChosenMap
from explorer.model.compute import Picture
from explorer.model.jobs import Jobs
from explorer.model.settings import Settings, effective
from explorer.model.study_map import READY, Place, Ready, design, study_of, values_at
from explorer.panels.studies import showing
from explorer.panels.studies.choice import COMPUTE, MapChoice
from explorer.panels.studies.files import MapFiles
from explorer.panels.studies.picture import EVENT, Shown, markup
from explorer.panels.studies.showing import Filling
from explorer.storage import preset_file
from explorer.storage.bundle import Send
from explorer.storage.catalog import Catalog
from explorer.widgets.form import Action, Form
from explorer.widgets.html import NOTE, escaped
from explorer.widgets.page import Page
from explorer.widgets.progress import ProgressPanel
from explorer.widgets.section import Section
from rangenav.inputs import require
from rangenav.preset import Preset
from rangenav.progress import Cancelled, Progress
from rangenav.studies import maps
from rangenav.studies.maps import StudyMap
from rangenav.studies.study import Study

PERIOD = 0.5
"""s between two pictures of a map that fills."""
INTRODUCTION = (
    "A map shows one number over two parameters, with everything else as it is on the page. "
    "Start one of these three, or choose axes of your own below."
)
OTHER_DESIGN = "the design has changed: this map is of the earlier one, so compute it again"
OTHER_CHOICE = "the axes, the metric or the seeds have changed: this map is of the earlier ones, so compute it again"
FOLLOWS = "this page follows a presentation: make a copy first"
AGAIN = (
    "The axes, the points and the metric of your map are as you left them; its values are not kept. "
    f"“{COMPUTE}” computes them again."
)
NO_MAP = "there is no map yet: start one first"
CELL = re.compile(rf"{EVENT}-(\d{{1,4}})-(\d{{1,4}})", re.ASCII)


class StudiesPanel:
    """Buttons of ready maps, the map with its progress and its files, and the axes."""

    def __init__(
        self, form: Form, page: Page, jobs: Jobs, catalog: Catalog, send: Send, *, first: Preset, show: Action
    ) -> None:
        """`send` downloads a file, and `show` brings the map into sight. first: a preset whose parameters are offered
        until there is a picture."""
        self._form, self._page, self._catalog, self._show = form, page, catalog, show
        self.filling: Filling | None = None
        """The map on the page; None before the first one."""
        self.follows: Callable[[], bool] = lambda: False
        """Whether the page follows a presentation; the session knows."""
        self._settings: Settings | None = None
        self._chosen: ChosenMap | None = None
        """What could be used last."""
        self._computed_before = False
        """Whether there was a map before a reload that was not computed again."""
        self._open, self._drawn_at = True, float("-inf")
        self._drawn: tuple[StudyMap | None, object] = None, None
        """The map that was drawn last, and everything else that decided the picture."""
        self._ready = Section(form)
        with self._ready:
            form.gui.add_html(NOTE.format(escaped(INTRODUCTION)))
            for ready in READY:
                form.button(ready.question, partial(self.start_ready, ready), hint=ready.hint)
        for ready in READY:
            form.command(f"Map: {ready.question}", partial(self.start_ready, ready), step=False)
        self.progress = ProgressPanel(form, jobs)
        self.block = form.gui.add_html("", visible=False)
        self._files = MapFiles(form, self._on_page, self._design_file, send)
        self.choice = MapChoice(form, first, self.start)
        form.command("Put the last control on the map's axis across", self._put_last_across, step=False)

    def start_ready(self, ready: Ready) -> None:
        """Start one of the ready maps."""
        with self._ready.answering():
            self._refuse_following()
            self.choice.write_ready(ready, self._page.read().preset)
        self.start()

    def start(self) -> None:
        """Compute the map of the axes that are chosen."""
        with self.choice.section.answering():
            self._refuse_following()
            settings, (axes, metric, runs) = self._page.read(), self.choice.read()
            base = design(settings, (axes[0].path, axes[1].path))
            of = study_of(settings, axes, metric, runs, file=self._file_name(settings.origin, base))
            filling = self._stopped(settings) or Filling(of, Place(settings, of), metric)
            of, begun = filling.study, filling.map

        def work(progress: Progress, cancelled: Cancelled) -> StudyMap:
            for newest in maps.coarse_to_fine(of, begun=begun, progress=progress, cancelled=cancelled):
                filling.map = newest
            assert filling.map is not None, "a map has a point at least"
            return filling.map

        self.filling, self._settings, self._computed_before = filling, settings, False
        self.progress.start(f"map of {of.count} points", work, lambda _: None, self.choice.section.complaint.say)
        self._show()

    def take(self, i: int, j: int) -> None:
        """Make a cell of the map the design on the page."""
        with self.choice.section.answering():
            self._refuse_following()
            filling, of = self._filled()
            n, m = of.computed.shape
            require(i < n and j < m, f"the map has {n} × {m} cells, got {i}, {j}")
            settings = self._page.read()
            require(filling.place.values(settings) is not None, OTHER_DESIGN)
            reason = str(of.reason[i, j])
            require(not reason, f"this point cannot be computed: {reason}")
            after = filling.place.take(settings, values_at(filling.study, (i, j)))
        self._page.write(after)

    def action(self, event: str) -> Action | None:
        """What an event of the map does; None for the event of something else."""
        cell = CELL.fullmatch(event)
        return None if cell is None else partial(self.take, int(cell[1]), int(cell[2]))

    def follow(self, picture: Picture) -> None:
        """Take the settings on the page; a map of another design is not computed any further."""
        self._settings = picture.settings
        if self._open:
            self.choice.offer(picture.settings.preset)
        if self.filling is not None and self.filling.place.values(picture.settings) is None:
            self.progress.stop()
        self.refresh()

    def see(self, tabs: frozenset[str] | None) -> None:
        """Draw only while the tab is open; None if the browser has not said."""
        opened = tabs is None or "studies" in tabs
        if opened and not self._open and self._settings is not None:
            self.choice.offer(self._settings.preset)
        self._open = opened
        self.refresh()

    def refresh(self) -> None:
        """Draw the map if it has changed, at most a few times a second while it fills."""
        filling = self.filling
        if not self._open or filling is None or filling.map is None or self._settings is None:
            return
        running = self.progress.running is not None
        others = self._metric_shown(filling), self._outdated(filling), self._settings, running
        soon = time.monotonic() - self._drawn_at < PERIOD
        drawn, drawn_with = self._drawn
        if others == drawn_with and (soon or filling.map is drawn):
            return
        self._drawn, self._drawn_at = (filling.map, others), time.monotonic()
        content = markup(self._shown(filling, filling.map))
        if content != self.block.content:
            self.block.content = content
        self.block.visible = True
        self._files.show(True)

    def forget_preset(self) -> None:
        """Stop and drop the map: it belongs to a preset that is not on the page any more."""
        self.progress.stop()
        self.filling, self._drawn, self._computed_before = None, (None, None), False
        self.block.visible = False
        self._files.show(False)

    @property
    def chosen(self) -> ChosenMap | None:
        """What is remembered of the tab; while a box holds nothing that can be used, what was chosen before."""
        with suppress(ValueError):
            (across, upwards), metric, runs = self.choice.read()
            drawn = self._computed_before or (self.filling is not None and self.filling.map is not None)
            self._chosen = ChosenMap(across=across, upwards=upwards, metric=metric, runs=runs, drawn=drawn)
        return self._chosen

    def restore(self, chosen: ChosenMap | None, design: Preset) -> None:
        """Show what was chosen in an earlier visit, and say that a map must be computed again."""
        if chosen is None:
            return
        self.choice.restore(chosen, design)
        self._computed_before = chosen.drawn
        if chosen.drawn:
            self.block.content, self.block.visible = NOTE.format(escaped(AGAIN)), True

    def _filled(self) -> tuple[Filling, StudyMap]:
        """The map on the page. Raises ValueError if there is none."""
        filling = self.filling
        if filling is None or filling.map is None:
            raise ValueError(NO_MAP)
        return filling, filling.map

    def _stopped(self, settings: Settings) -> Filling | None:
        """The map on the page if it was stopped and is of what is chosen, so that it goes on; None otherwise."""
        filling = self.filling
        if filling is None or filling.map is None or filling.map.share == 1 or filling.place.values(settings) is None:
            return None
        return None if self._outdated(filling) else filling

    def _on_page(self) -> tuple[Study, Shown]:
        filling, of = self._filled()
        return filling.study, self._shown(filling, of)

    def _design_file(self) -> tuple[str, bytes]:
        settings = self._page.read()
        original = self._catalog.presets[settings.origin]
        return preset_file.file_name(settings.origin, effective(settings), original), preset_file.document(settings)

    def _shown(self, filling: Filling, of: StudyMap) -> Shown:
        running = self.progress.running is not None
        metric, outdated = self._metric_shown(filling), self._outdated(filling)
        return showing.shown(filling, of, self._settings, metric, outdated=outdated, running=running)

    def _metric_shown(self, filling: Filling) -> str:
        """The metric that is chosen, if the map has it."""
        try:
            chosen = self.choice.metric.read()
        except ValueError:
            return filling.metric
        return chosen if chosen in filling.study.file.metrics else filling.metric

    def _outdated(self, filling: Filling) -> str:
        """Why the map is not of what is chosen now; empty if it is."""
        if self._settings is not None and filling.place.values(self._settings) is None:
            return OTHER_DESIGN
        file = filling.study.file
        try:
            axes, metric, runs = self.choice.read()
        except ValueError:
            return OTHER_CHOICE
        other_runs = runs != file.runs and bool(file.run_metrics)
        return OTHER_CHOICE if axes != file.parameters or metric not in file.metrics or other_runs else ""

    def _refuse_following(self) -> None:
        require(not self.follows(), FOLLOWS)

    def _put_last_across(self) -> None:
        with self.choice.section.answering():
            moved = self._form.last_moved.partition(" (")[0]
            self.choice.put_across(moved, self._page.read().preset)

    def _file_name(self, origin: str, base: Preset) -> str:
        """How the study's file names its preset: by its name as it is shipped, else by a file to be put beside it."""
        shipped = ":" not in origin and self._catalog.presets.get(origin) == base
        return origin if shipped else f"{origin.rpartition(':')[2] or 'design'}-map.toml"
