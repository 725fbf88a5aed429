"""The right dock: undo and redo, and the tabs of controls, which show one Settings; and the verdict over the scene."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace

from explorer.lessons import course
from explorer.model.assessment import Cure
from explorer.model.comparison import Comparison
from explorer.model.compute import Picture
from explorer.model.glossary import MOTION, in_labels
from explorer.model.history import History
from explorer.model.jobs import Jobs
from explorer.model.settings import Printed, Settings, is_another
from explorer.panels import cures, motion, sensors
from explorer.panels.chosen import Chosen, Controls
from explorer.panels.compare import ComparePanel
from explorer.panels.gains import GainsPanel
from explorer.panels.gains.basin import BasinPanel
from explorer.panels.gains.guess import GuessPanel
from explorer.panels.gains.tuning import TuningPanel
from explorer.panels.kept import kept
from explorer.panels.learn import LearnPanel
from explorer.panels.learn.actions import LearnActions
from explorer.panels.legend import add_legend
from explorer.panels.open_tabs import OpenTabs
from explorer.panels.presets import PresetsPanel
from explorer.panels.presets.bundle import BundlePanel
from explorer.panels.presets.flights import FlightPanel
from explorer.panels.presets.import_panel import ImportPanel
from explorer.panels.presets.printed import PrintedPanel
from explorer.panels.presets.repair import RepairPanel
from explorer.panels.session_actions import SessionActions
from explorer.panels.studies import StudiesPanel
from explorer.panels.undo import UndoPanel
from explorer.panels.verdict import VerdictPanel
from explorer.panels.welcome import add_welcome
from explorer.panels.world import WorldPanel
from explorer.panels.world.relabel import in_axes_of, relabelled
from explorer.panels.world.twin import TwinPanel
from explorer.panels.world.vehicle import VehiclePanel
from explorer.storage.catalog import Catalog
from explorer.web.uploads import Uploads
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.form import Action, Form
from explorer.widgets.html import upper_first
from explorer.widgets.page import Belonging
from rangenav.inputs import Vec3
from rangenav.preset import Preset
from rangenav.signals import Signal

WIDTH = 380
"""px; in a narrower dock the labels of the sliders would take two lines."""
SENSORS_SENTENCES = ("seed", "duration × rate", "requirement.window must be at least")
"""Beginnings of the errors of a whole preset that are shown in the Sensors tab; others are shown in the Motion tab."""


class Dock:
    """All controls of one visitor but the timeline's."""

    def __init__(
        self, form: Form, catalog: Catalog, name: str, session_actions: SessionActions, jobs: Jobs, history: History
    ) -> None:
        """`name` is the preset that is shown first."""
        self.form, gui = form, form.gui
        self._catalog, self._jobs, self._session = catalog, jobs, session_actions
        self._proofs = form.new_jobs()
        gui.main_panel.dock_right()
        gui.main_panel.set_width(WIDTH)
        self._undo = UndoPanel(form, history, self, session_actions.notify)
        add_legend(gui)
        add_welcome(gui)
        self.verdict = VerdictPanel(gui, self._cures())
        self.tabs = tabs = gui.add_tab_group()
        strip = gui.add_html("")
        with tabs.add_tab("Learn"):
            self.learn = LearnPanel(form, course(), self, self._learn_actions(), strip)
        with tabs.add_tab("Motion"):
            self.motion = motion.MotionPanel(form, self._edit_path)
        with tabs.add_tab("World"):
            self.world, world = kept(form, lambda: WorldPanel(form, self.relabel_axes))
            self.twin = TwinPanel(form)
            self.vehicle, vehicle = kept(form, lambda: VehiclePanel(form))
        with tabs.add_tab("Sensors"):
            self.sensors, sensor_choice = kept(form, lambda: sensors.SensorsPanel(form))
        with tabs.add_tab("Gains"):
            others = len(form.sections)
            self.gains = GainsPanel(form)
            of_gains = frozenset(form.sections[others:])
            self.guess, guess = kept(form, lambda: GuessPanel(form))
            self.tuning = TuningPanel(form, self, jobs, pin=lambda: self.compare.pin())
            self.basin = BasinPanel(form, self, jobs)
        with tabs.add_tab("Presets"):
            imports = self._add_presets()
        with tabs.add_tab("Compare"):
            self.compare = ComparePanel(form, jobs, session_actions.show_side_by_side)
        with tabs.add_tab("Studies"):
            first = catalog.presets[name]
            self.studies = StudiesPanel(form, self, jobs, catalog, session_actions.send, first=first)
        self.belonging: list[Belonging] = [
            self.presets, self.repair, self.bundle, imports, self.tuning, self.basin, self.compare, self.studies
        ]  # fmt: skip
        """The panels that drop what belongs to a preset as soon as another one is on the page."""
        self.following: list[Callable[[Picture], None]] = []
        """What else drops what is not of the picture on the page: panels that the session builds."""
        controls = Controls(
            motion=self.motion,
            twin=self.twin,
            printed=self.printed,
            gains=self.gains,
            of_gains=of_gains,
            sensors=sensor_choice,
            world=world,
            vehicle=vehicle,
            guess=guess,
        )
        opened = catalog.open(name)
        self._chosen = Chosen(form, controls, opened)
        self._tabs_in_sight = OpenTabs(
            {
                "world": (self.vehicle.draw,),
                "gains": (self.gains.draw, self.guess.draw),
                "presets": (self.printed.draw,),
            }
        )
        self.write(opened)

    def _cures(self) -> dict[Cure, Action]:
        """What the buttons do that the verdict offers; their panels are built after the verdict."""
        return {
            "repair": lambda: self.repair.start(),
            "tune": lambda: self.tuning.start(),
            "slow down": lambda: cures.slow_down(self, self._session.notify),
            "model": lambda: self.printed.write(Printed()),
            "effects": lambda: cures.switch_effects_off(self),
            "vehicle": lambda: self._session.go_to(MOTION["vehicle"].caption),
        }

    def _learn_actions(self) -> LearnActions:
        """What a lesson does with the other panels, which are built after it."""
        return LearnActions(
            pin=lambda settings: self.compare.pin_next(settings),
            pinned=lambda: self.compare.pinned_settings,
            download=self._session.send,
            exported=lambda: self.bundle.exported,
            rewind=self._session.rewind,
            go_to=self._session.go_to_place,
        )

    def _add_presets(self) -> ImportPanel:
        """Add the panels of the Presets tab; the one that imports is returned."""
        form, catalog, jobs = self.form, self._catalog, self._jobs
        uploads = Uploads(form.gui, form.do, form.visitor)
        self.presets = PresetsPanel(form, catalog, self, uploads, self._session)
        self.repair = RepairPanel(
            form,
            self,
            jobs,
            pin=lambda: self.compare.pin(),
            target=lambda preset: self.bundle.target(preset),
            choose=lambda format_name: self.bundle.choose(format_name),
        )
        self.bundle = BundlePanel(form, catalog, self, jobs, self._session.send, repair=self.repair.start)
        take_flight, close_flight = lambda flight: flights.offer(flight), lambda: flights.close()
        imports = ImportPanel(form, catalog, self, jobs, uploads, judge=take_flight, close=close_flight)
        flights = FlightPanel(form, jobs)
        self.printed = PrintedPanel(
            form,
            catalog,
            self,
            pin=lambda settings: self.compare.pin_next(settings),
            show_side_by_side=self._session.show_side_by_side,
        )
        return imports

    def refresh(self) -> None:
        """Take over what the visitor has moved, and write what follows from it on the page: the editor of another
        family, gains in other units, the values of a set of sensors, a label with its number.

        Raises InvalidInputError after a complaint below the control, or ValueError if the values do not fit together.
        """
        self._chosen.refresh()

    def read(self) -> Settings:
        """What was chosen when `refresh` or `write` was called last; the page stays as it is.

        Raises what `refresh` raised then.
        """
        return self._chosen.read()

    @contextmanager
    def catching(self) -> Iterator[None]:
        """Show below its cause, and in the verdict, why no picture can be made; raise InvalidInputError."""
        self.motion.clear()  # first: the complaint about a control may appear in the same places
        self.sensors.clear()
        try:
            yield
        except InvalidInputError as refusal:
            self._say_not_shown(str(refusal.__cause__), *refusal.others)
            raise
        except ValueError as error:
            in_sensors = str(error).startswith(SENSORS_SENTENCES)
            (self.sensors if in_sensors else self.motion).complain(str(error))
            self._say_not_shown(str(error))
            raise InvalidInputError from error
        self.verdict.complaint.clear()

    def write(self, settings: Settings) -> None:
        """Show settings, and mark the controls that differ from the preset that the settings came from.

        What belongs to the preset that was on the page before is dropped, however the other one came."""
        if is_another(self._chosen.opened, settings):
            for panel in self.belonging:
                panel.forget_preset()
        self._chosen.open(settings)
        p, base = settings.preset, self._base(settings)
        original = Settings(preset=base)
        self.motion.write(motion.MotionChoice.of(settings), motion.MotionChoice.of(original), settings.drafts)
        self.world.write(p.world, base.world)
        self.vehicle.write(p.vehicle, base.vehicle)
        self.sensors.write(sensors.SensorChoice.of(p), sensors.SensorChoice.of(base))
        self.gains.write(settings, base.gains)
        self.guess.write(p.guess, base.guess)
        self.twin.write(settings.twin_turn)
        self.printed.write(settings.printed)
        self.presets.write(settings)
        with suppress(InvalidInputError, ValueError):  # `read` raises it
            self.refresh()

    def prove(self, picture: Picture) -> None:
        """Show the verdict on every window as soon as it is computed, in place of that on the sampled windows."""
        self._proofs.start(
            "the worst of all windows",
            lambda _progress, cancelled: picture.proven(cancelled),
            self.verdict.draw,
            self.verdict.complaint.say,
        )

    def draw(self, picture: Picture) -> None:
        """Show the verdict, and what follows from the picture in each panel."""
        self._proofs.cancel()
        self.verdict.draw(picture)
        self.motion.draw(picture.settings.time_scale)
        self._tabs_in_sight.draw(picture)
        self.tuning.draw(picture)
        self.basin.draw(picture)
        self.presets.draw(picture)
        self.repair.draw(picture)
        self.bundle.draw(picture)
        self.learn.draw(picture)
        self.studies.follow(picture)
        for draw in self.following:
            draw(picture)

    def see(self, tabs: frozenset[str] | None) -> None:
        """Draw what takes a while in these tabs alone from now on; None for all tabs. An opened tab is drawn at
        once."""
        self._tabs_in_sight.see(tabs)
        self.studies.see(tabs)

    @property
    def actions(self) -> dict[str, Action]:
        """What the buttons do that lie outside the tabs, by the names that they send."""
        own: dict[str, Action] = {"again": self._session.restart_preset, "stop": self.form.stop_progress}
        return (
            self.verdict.actions
            | self.repair.actions
            | self.tuning.actions
            | self._undo.actions
            | self.learn.actions
            | own
        )

    def draw_progress(self) -> None:
        """Show the progress and the outcome of a search beside its button; below the verdict, if the verdict or the
        palette began it."""
        job = self.form.draw_progress()
        self.studies.refresh()
        searches = [one for one in (self.repair, self.tuning) if one.progress.away and one.outcome]
        outcome, answers = (searches[0].outcome, searches[0].answers) if searches else ("", ())
        self.verdict.draw_progress(job, outcome, answers)

    @property
    def changed(self) -> bool:
        """Whether the comparison has changed since it was drawn last."""
        return self.compare.changed or self.basin.changed or self.repair.changed

    def comparison(self, picture: Picture) -> Comparison:
        """What to draw in comparison with a picture."""
        compared = self.compare.comparison(picture)
        return replace(compared, basin=self.basin.globe(picture), proposed=self.repair.proposed(picture))

    @property
    def chosen_preset(self) -> str:
        """The name chosen in the menu of presets. Raises InvalidInputError for a name that is not offered."""
        return self.presets.read()

    @property
    def origin(self) -> str:
        """The name of the preset that the settings came from."""
        return self._chosen.opened.origin

    @property
    def points(self) -> tuple[Vec3, ...]:
        """Positions (m) of the waypoints that can be dragged."""
        return self.motion.path.points

    def move_waypoint(self, index: int, position: Vec3) -> None:
        """Move a waypoint, as a drag does."""
        self._chosen.forget()
        self.motion.path.move(index, position)

    def move_anchor(self, position: Vec3) -> None:
        """Move the anchor, as a drag does."""
        self._chosen.forget_world()
        self.world.move_anchor(position)

    def _base(self, settings: Settings) -> Preset:
        """The preset that the settings came from, in the axes that are in use."""
        return in_axes_of(self._catalog.presets[settings.origin], settings.preset)

    def _edit_path(self, change: Callable[[Signal, Vec3], Signal]) -> None:
        preset = self.read().preset
        self.motion.path.replace(change(preset.path, preset.world.anchor))

    def relabel_axes(self) -> None:
        """Reverse y and z of all axes: z up instead of down, or down instead of up."""
        self.write(relabelled(self.read()))

    def _say_not_shown(self, *reasons: str) -> None:
        """Name every control that holds no valid input."""
        wrong = ". ".join(upper_first(in_labels(reason)) for reason in dict.fromkeys(reasons))
        self.verdict.complaint.say(f"Not shown: {wrong}. The picture belongs to the last values that could be used.")
