"""The tabs of the right dock: which panels each has, and what they ask of each other and of the session."""

from collections.abc import Callable

from explorer.lessons import course
from explorer.lessons.lesson import Place
from explorer.model.assessment import Cure
from explorer.model.compute import Picture
from explorer.model.glossary import MOTION
from explorer.model.history import History
from explorer.model.jobs import Jobs
from explorer.model.settings import Printed
from explorer.panels import cures, motion, sensors
from explorer.panels.chosen import Controls
from explorer.panels.compare import ComparePanel
from explorer.panels.gains import GainsPanel
from explorer.panels.gains.basin import BasinPanel
from explorer.panels.gains.guess import GuessPanel
from explorer.panels.gains.tuning import TuningPanel
from explorer.panels.kept import kept
from explorer.panels.learn import LearnPanel
from explorer.panels.learn.actions import LearnActions
from explorer.panels.legend import add_legend
from explorer.panels.presets import PresetsPanel
from explorer.panels.presets.bundle import BundlePanel
from explorer.panels.presets.flights import FlightPanel
from explorer.panels.presets.import_panel import ImportPanel
from explorer.panels.presets.printed import PrintedPanel
from explorer.panels.presets.repair import RepairPanel
from explorer.panels.session_actions import SessionActions
from explorer.panels.studies import StudiesPanel
from explorer.panels.studies.picture import PLACE
from explorer.panels.undo import UndoPanel
from explorer.panels.verdict import VerdictPanel
from explorer.panels.welcome import add_welcome
from explorer.panels.world import WorldPanel
from explorer.panels.world.relabel import relabelled
from explorer.panels.world.twin import TwinPanel
from explorer.panels.world.vehicle import VehiclePanel
from explorer.storage.catalog import Catalog
from explorer.web.uploads import Uploads
from explorer.widgets.form import Action, Form
from explorer.widgets.page import Belonging, Page
from rangenav.inputs import Vec3
from rangenav.signals import Signal

WIDTH = 380
"""px; in a narrower dock the labels of the sliders would take two lines."""


class DockTabs(Page):
    """The panels of the dock. They read and write all settings as one value, which the dock itself does."""

    def __init__(
        self, form: Form, catalog: Catalog, name: str, session_actions: SessionActions, jobs: Jobs, history: History
    ) -> None:
        """`name` is the preset that is shown first."""
        self.form, gui = form, form.gui
        self._catalog, self._jobs, self._session = catalog, jobs, session_actions
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
            self.world, world_choice = kept(form, lambda: WorldPanel(form, self.relabel_axes))
            self.twin = TwinPanel(form)
            self.vehicle, vehicle_choice = kept(form, lambda: VehiclePanel(form))
        with tabs.add_tab("Sensors"):
            self.sensors, sensor_choice = kept(form, lambda: sensors.SensorsPanel(form))
        with tabs.add_tab("Gains"):
            others = len(form.sections)
            self.gains = GainsPanel(form)
            of_gains = frozenset(form.sections[others:])
            self.guess, guess_choice = kept(form, lambda: GuessPanel(form))
            self.tuning = TuningPanel(form, self, jobs, pin=lambda: self.compare.pin())
            self.basin = BasinPanel(form, self, jobs)
        with tabs.add_tab("Presets"):
            imports = self._add_presets()
        with tabs.add_tab("Compare"):
            self.compare = ComparePanel(form, jobs, session_actions.show_side_by_side)
        with tabs.add_tab("Studies"):
            first = catalog.presets[name]
            self.studies = StudiesPanel(
                form,
                self,
                jobs,
                catalog,
                session_actions.send,
                first=first,
                show=lambda: session_actions.go_to_place(Place("Studies", (), PLACE)),
            )
        self._controls = Controls(
            motion=self.motion,
            twin=self.twin,
            printed=self.printed,
            gains=self.gains,
            of_gains=of_gains,
            sensors=sensor_choice,
            world=world_choice,
            vehicle=vehicle_choice,
            guess=guess_choice,
        )
        self.belonging: list[Belonging] = [
            self.presets, self.repair, self.bundle, imports, self.tuning, self.basin, self.compare, self.studies
        ]  # fmt: skip
        """The panels that drop what belongs to a preset as soon as another one is on the page."""
        self.following: list[Callable[[Picture], None]] = []
        """What else drops what is not of the picture on the page: panels that the session builds."""

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

    def _edit_path(self, change: Callable[[Signal, Vec3], Signal]) -> None:
        preset = self.read().preset
        self.motion.path.replace(change(preset.path, preset.world.anchor))

    def relabel_axes(self) -> None:
        """Reverse y and z of all axes: z up instead of down, or down instead of up."""
        self.write(relabelled(self.read()))
