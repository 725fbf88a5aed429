"""The right dock: its controls show one Settings, read and written as a whole; each picture is drawn in its panels."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace

from explorer.model.comparison import Comparison
from explorer.model.compute import Picture
from explorer.model.glossary import in_labels
from explorer.model.history import History
from explorer.model.jobs import Jobs
from explorer.model.settings import Settings, is_another
from explorer.panels import motion, sensors
from explorer.panels.chosen import Chosen
from explorer.panels.dock_tabs import DockTabs
from explorer.panels.open_tabs import OpenTabs
from explorer.panels.session_actions import SessionActions
from explorer.panels.world.relabel import in_axes_of
from explorer.storage.catalog import Catalog
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.form import Action, Form
from explorer.widgets.html import upper_first
from rangenav.inputs import Vec3
from rangenav.preset import Preset

SENSORS_SENTENCES = ("seed", "duration × rate", "requirement.window must be at least")
"""Beginnings of the errors of a whole preset that are shown in the Sensors tab; others are shown in the Motion tab."""


class Dock(DockTabs):
    """All controls of one visitor but the timeline's."""

    def __init__(
        self, form: Form, catalog: Catalog, name: str, session_actions: SessionActions, jobs: Jobs, history: History
    ) -> None:
        """`name` is the preset that is shown first."""
        super().__init__(form, catalog, name, session_actions, jobs, history)
        self._proofs = form.new_jobs()
        opened = catalog.open(name)
        self._chosen = Chosen(form, self._controls, opened)
        self._tabs_in_sight = OpenTabs(
            {
                "world": (self.vehicle.draw,),
                "gains": (self.gains.draw, self.guess.draw),
                "presets": (self.printed.draw,),
            }
        )
        self.write(opened)

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

    def _say_not_shown(self, *reasons: str) -> None:
        """Name every control that holds no valid input."""
        wrong = ". ".join(upper_first(in_labels(reason)) for reason in dict.fromkeys(reasons))
        self.verdict.complaint.say(f"Not shown: {wrong}. The picture belongs to the last values that could be used.")
