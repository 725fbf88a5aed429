"""What the controls of all panels hold together: one Settings. A drag of a gain reads no dial of a sensor."""

from dataclasses import dataclass

import msgspec

from explorer.model.settings import Settings
from explorer.panels.gains import GainsPanel
from explorer.panels.kept import Kept
from explorer.panels.motion import MotionPanel
from explorer.panels.presets.printed import PrintedPanel
from explorer.panels.sensors import SensorChoice
from explorer.panels.world.twin import TwinPanel
from explorer.widgets.complaint import InvalidInputError, Refusals
from explorer.widgets.form import Form, FormSection
from rangenav.gains import Guess
from rangenav.motion import World
from rangenav.vehicle import Vehicle


@dataclass(frozen=True, kw_only=True)
class Controls:
    """The panels that hold a part of the settings."""

    motion: MotionPanel
    twin: TwinPanel
    printed: PrintedPanel
    gains: GainsPanel
    of_gains: frozenset[FormSection]
    """The sections that hold the controls of the gains alone."""
    sensors: Kept[SensorChoice]
    world: Kept[World]
    vehicle: Kept[Vehicle]
    guess: Kept[Guess]


class Chosen:
    """The settings that the controls hold, kept from one reading to the next."""

    def __init__(self, form: Form, controls: Controls, opened: Settings) -> None:
        """opened: the settings that were shown last; they hold what no control does."""
        self._form, self._controls, self._opened = form, controls, opened
        self._settings: Settings | InvalidInputError | ValueError
        self._without_gains: Settings | None = None
        """What all panels but that of the gains held when they were last read; None if that may have changed."""

    @property
    def opened(self) -> Settings:
        """The settings that were shown last."""
        return self._opened

    def open(self, settings: Settings) -> None:
        """Note other settings that are now shown; every control is read again."""
        self._opened, self._without_gains = settings, None
        self._form.touch()

    def forget(self) -> None:
        """Read every panel that is not kept again: something was moved in the scene."""
        self._without_gains = None

    def forget_world(self) -> None:
        """The same for a move that changes the panel of the world."""
        self._without_gains = None
        self._controls.world.touch(None)

    def refresh(self) -> None:
        """Take over what was touched. Raises InvalidInputError after a complaint below the control, or ValueError if
        the values do not fit together."""
        try:
            self._settings = self._take_over()
        except (InvalidInputError, ValueError) as error:
            self._settings = error
            raise

    def read(self) -> Settings:
        """What `refresh` found last. Raises what `refresh` raised then."""
        if isinstance(self._settings, Settings):
            return self._settings
        raise self._settings

    def _take_over(self) -> Settings:
        controls, touched = self._controls, self._form.take_touched()
        if self._without_gains is None or touched is None or not touched <= controls.of_gains:
            self._without_gains = None  # until all of them are valid
            kept = controls.sensors, controls.world, controls.vehicle, controls.guess
            for panel in kept:
                panel.touch(touched)
            refusals = Refusals()
            for panel in (controls.motion, *kept, controls.twin):
                with refusals.collecting():
                    panel.refresh()
            refusals.raise_first()
            self._without_gains = self._read_without_gains()
        controls.gains.refresh(self._without_gains)
        return controls.gains.read(self._without_gains)

    def _read_without_gains(self) -> Settings:
        opened, controls = self._opened, self._controls
        motion, sensors = controls.motion.read(), controls.sensors.value
        preset = msgspec.structs.replace(
            opened.preset,
            path=motion.path,
            angular_velocity=motion.angular_velocity,
            initial_rotation=motion.initial_rotation,
            duration=motion.duration,
            requirement=msgspec.structs.replace(opened.preset.requirement, window=motion.window),
            world=controls.world.value,
            vehicle=controls.vehicle.value,
            sensors=sensors.sensors,
            seed=sensors.seed,
            guess=controls.guess.value,
        )
        return Settings(
            origin=opened.origin,
            edition=opened.edition,
            preset=preset,
            time_scale=motion.time_scale,
            printed=controls.printed.read(),
            drafts=controls.motion.drafts(),
            twin_turn=controls.twin.read(),
        )
