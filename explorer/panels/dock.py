"""The right dock: the tabs of controls and, below them, the verdict. Together they read and show one Settings."""

from collections.abc import Iterator
from contextlib import contextmanager

import msgspec
import viser

from explorer.compute import Picture
from explorer.panels import motion, sensors
from explorer.panels.controls import Note, Refused
from explorer.panels.gains import GainsPanel
from explorer.panels.guess import GuessPanel
from explorer.panels.presets import PresetsPanel
from explorer.panels.printed import PrintedPanel
from explorer.panels.verdict import VerdictPanel
from explorer.settings import Settings
from rangenav.preset import Preset

WIDTH = 380
"""px; narrower, the labels of the sliders break."""
SENSORS_RULES = ("seed", "duration")
"""How sentences begin that tell of choices in the Sensors tab; all others about a whole preset tell of the motion."""


class Dock:
    """All controls of one visitor but the timeline's."""

    def __init__(self, gui: viser.GuiApi, presets: dict[str, Preset], name: str, note: Note) -> None:
        shown = Settings(preset=presets[name])
        self._base = shown.preset
        gui.main_panel.dock_right()
        gui.main_panel.set_width(WIDTH)
        tabs = gui.add_tab_group()
        with tabs.add_tab("Motion", viser.Icon.ROUTE):
            self.motion = motion.MotionPanel(gui, motion.Chosen.of(shown), note)
        with tabs.add_tab("Sensors", viser.Icon.RULER_MEASURE):
            self.sensors = sensors.SensorsPanel(gui, sensors.Chosen.of(shown.preset), note)
        with tabs.add_tab("Gains", viser.Icon.ADJUSTMENTS):
            self.gains = GainsPanel(gui, shown.preset.gains, note)
            self.guess = GuessPanel(gui, shown.preset.guess, note)
        with tabs.add_tab("Presets", viser.Icon.FOLDER):
            self.presets = PresetsPanel(gui, presets, name, note)
            self.printed = PrintedPanel(gui, shown.printed, note)
        panel = gui.add_panel()
        with panel.add_tab("Verdict", viser.Icon.EYE_CHECK):
            self.verdict = VerdictPanel(gui)
        panel.dock_below(gui.main_panel)

    def read(self) -> Settings:
        """What the visitor has chosen. Raises Refused after saying why beside the control, or ValueError if it does not
        fit together."""
        moved, sensed = self.motion.read(), self.sensors.read()
        preset = msgspec.structs.replace(
            self._base,
            path=moved.path,
            angular_velocity=moved.angular_velocity,
            requirement=msgspec.structs.replace(self._base.requirement, window=moved.window),
            sensors=sensed.sensors,
            seed=sensed.seed,
            gains=self.gains.read(),
            guess=self.guess.read(),
        )
        return Settings(preset=preset, time_scale=moved.time_scale, printed=self.printed.read())

    @contextmanager
    def catching(self) -> Iterator[None]:
        """Say beside its cause, and in the verdict, why no picture can be made; raise Refused."""
        try:
            yield
        except Refused as refusal:
            self._refuse(refusal.__cause__)
            raise
        except ValueError as error:
            place = self.sensors if str(error).startswith(SENSORS_RULES) else self.motion
            place.complaint.say(str(error))
            self._refuse(error)
            raise Refused from error
        self.verdict.complaint.clear()

    def write(self, name: str, settings: Settings) -> None:
        """Show settings, and the preset they came from."""
        self._base = settings.preset
        self.motion.write(motion.Chosen.of(settings))
        self.sensors.write(sensors.Chosen.of(settings.preset))
        self.gains.write(settings.preset.gains)
        self.guess.write(settings.preset.guess)
        self.printed.write(settings.printed)
        self.presets.write(name, settings.preset)

    def draw(self, picture: Picture) -> None:
        """Show the verdict and what stands beside the controls."""
        self.verdict.draw(picture)
        self.motion.draw(picture.settings.time_scale)
        self.gains.draw(picture)
        self.printed.draw(picture)

    def _refuse(self, reason: BaseException | None) -> None:
        self.verdict.complaint.say(f"Not shown: {reason}. What you see is the last picture that could be made.")
