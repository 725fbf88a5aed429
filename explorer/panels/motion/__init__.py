"""The Motion tab: duration, window and time scale; the path; the angular velocity and where the attitude starts."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

from explorer.model.glossary import MOTION
from explorer.model.settings import MAX_TIME_SCALE, MIN_TIME_SCALE, Drafts, Settings
from explorer.panels.motion.families import ANGULAR_VELOCITY_LABELS, description
from explorer.panels.motion.families.editor import SignalSlot
from explorer.panels.motion.path import PathPanel, PathTransforms
from explorer.panels.motion.signal import SignalEditor
from explorer.widgets.complaint import Refusals
from explorer.widgets.controls import Number
from explorer.widgets.dials import Dial, InverseDial
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from explorer.widgets.vector import Vector
from rangenav.inputs import Vec3, require_within
from rangenav.number_format import significant
from rangenav.preset import MAX_DURATION, MIN_DURATION
from rangenav.signals import AngularVelocity, Flown, Signal

ANGULAR_VELOCITY = SignalSlot(
    menu=MOTION["turning family"].label, unit="rad/s", amplitude=(-3.0, 3.0), frequency=(0.05, 10.0), open_tones=0
)
SPEEDS = 1 / MAX_TIME_SCALE, 1 / MIN_TIME_SCALE
"""The slowest and the fastest."""
FAMILY_HINT = (
    "ω(t) of the body, rad/s in body axes. keyframes: a smooth curve through timed values; flown: thrust along the "
    "specific force, so the path decides the attitude and only the yaw is chosen. What is entered in one is kept."
)
TURNING = "Angular velocity ω(t), body axes"
NO_EFFECT = (
    "Turning the body changes neither the Gramian's eigenvalues nor the derived PE: they depend on path and gravity "
    "alone. It does change the **printed** φ (Presets, *As printed in the paper*)."
)


@dataclass(frozen=True, kw_only=True)
class MotionChoice:
    """The part of some settings that this tab sets."""

    path: Signal
    angular_velocity: AngularVelocity
    initial_rotation: Vec3
    time_scale: float
    duration: float
    window: float

    @staticmethod
    def of(settings: Settings) -> "MotionChoice":
        """The part of some settings that this tab shows."""
        p = settings.preset
        return MotionChoice(
            path=p.path,
            angular_velocity=p.angular_velocity,
            initial_rotation=p.initial_rotation,
            time_scale=settings.time_scale,
            duration=p.duration,
            window=p.requirement.window,
        )


class MotionPanel:
    """All controls of the motion."""

    def __init__(self, form: Form, edit: Callable[[Callable[[Signal, Vec3], Signal]], None]) -> None:
        self.timing = _Timing(form)
        self.path = PathPanel(form)
        with self.path.section:
            self._transforms = PathTransforms(form, edit)
        self.angular_velocity = _AngularVelocity(form)
        self._duration = MIN_DURATION
        """s: of the flight, the last one that was valid."""

    def refresh(self) -> None:
        """Show what follows from the motion chosen. Raises InvalidInputError after showing the reason."""
        refusals = Refusals()
        with refusals.collecting():
            self.timing.refresh()
            _, self._duration, _ = self.timing.read()
            self._transforms.set_duration(self._duration)
        for part in (self.path, self.angular_velocity):
            with refusals.collecting():
                part.refresh(self._duration)
        refusals.raise_first()

    def read(self) -> MotionChoice:
        """The motion chosen. Raises InvalidInputError."""
        scale, duration, window = self.timing.read()
        path = self.path.read()
        angular_velocity, start = self.angular_velocity.read()
        return MotionChoice(
            path=path,
            angular_velocity=angular_velocity,
            initial_rotation=start,
            time_scale=scale,
            duration=duration,
            window=window,
        )

    def drafts(self) -> Drafts:
        """The signals entered in families that are not in use."""
        path, wiggle = self.path.drafts()
        return Drafts(path=path, wiggle=wiggle, angular_velocity=self.angular_velocity.drafts())

    def write(self, choice: MotionChoice, base: MotionChoice, drafts: Drafts) -> None:
        """Show a motion."""
        self.timing.write(choice, base)
        self.path.write(choice.path, base.path, drafts)
        self.angular_velocity.write(choice, base, drafts)

    def draw(self, time_scale: float) -> None:
        """Show the effect of the time scale on μ."""
        self.timing.draw(time_scale)

    def set_window(self, length: float) -> None:
        """Set the window δ (s), as a drag across a plot does."""
        self.timing.set_window(length)

    def complain(self, sentence: str) -> None:
        """Show an error of the whole motion in the section that causes it."""
        if sentence.startswith("path:"):
            section = self.path.section
        elif sentence.startswith(("angular_velocity:", "flown:", "initial_rotation")):
            section = self.angular_velocity.section
        else:
            section = self.timing.section
        section.complaint.say(sentence)

    def clear(self) -> None:
        """Hide the errors of the whole motion."""
        for section in (self.timing.section, self.path.section, self.angular_velocity.section):
            section.complaint.clear()


class _Timing:
    """Duration, window and time scale."""

    def __init__(self, form: Form) -> None:
        self.section = section = Section(form)
        with section:
            speed, window, duration = (MOTION[name] for name in ("speed", "window", "duration"))
            self.time_scale = InverseDial(section, speed.caption, SPEEDS, hint=speed.hint)
            self._line = form.gui.add_markdown("")
            self._window = Dial(section, window.caption, (0.5, 15.0), step=0.1, hint=window.hint)
            self._duration = Number(section, duration.caption, hint=duration.hint)

    def refresh(self) -> None:
        with self.section.catching():
            _, duration, _ = self.read()
            self._window.reach(duration / 2)  # a slow motion over minutes needs windows of minutes

    def read(self) -> tuple[float, float, float]:
        """Time scale, duration (s) and window (s)."""
        with self.section.checking():
            scale, duration, window = self.time_scale.read(), self._duration.read(), self._window.read()
            require_within(MOTION["speed"].label, 1 / scale if scale else math.inf, *SPEEDS)
            require_within(MOTION["duration"].label, duration, MIN_DURATION, MAX_DURATION, "s")
            return scale, duration, window

    def write(self, choice: MotionChoice, base: MotionChoice) -> None:
        self.time_scale.write(choice.time_scale, base.time_scale)
        self._window.write(choice.window, base.window)
        self._duration.write(choice.duration, base.duration)

    def set_window(self, length: float) -> None:
        self._window.show(length)

    def draw(self, time_scale: float) -> None:
        line = speed_sentence(1 / time_scale)
        if line != self._line.content:
            self._line.content = line


def speed_sentence(speed: float) -> str:
    """What a speed other than 1 does to the excitation."""
    if speed == 1.0:
        return "Speed 1 is the speed of the preset."
    more, times = ("less", 1 / speed) if speed < 1 else ("more", speed)
    pace = f"{significant(times)} times as {'slow' if speed < 1 else 'fast'}"
    period, window = significant(times**7), significant(times**8)
    return f"{pace}: {period} times {more} excitation in a period, {window} times in a window."


class _AngularVelocity:
    """The angular velocity ω(t), and the initial attitude R(0)."""

    def __init__(self, form: Form) -> None:
        self.section = section = Section(form, TURNING, expanded=False)
        with section:
            form.gui.add_markdown(NO_EFFECT)
            self.signal_editor = SignalEditor(form, ANGULAR_VELOCITY, ANGULAR_VELOCITY_LABELS, hint=FAMILY_HINT)
            self._start_section = start = Section(form, "Initial attitude R(0)", expanded=True)
            with start:
                term = MOTION["initial attitude"]
                self._rotation = Vector(start, term.caption, hint=term.hint, scale=math.degrees(1.0))

    def refresh(self, duration: float) -> None:
        self.signal_editor.refresh(duration)
        self._describe(self.signal_editor.signal)
        self._start_section.show(not isinstance(self.signal_editor.signal, Flown))
        with self._start_section.catching():
            self._rotation.read()

    def read(self) -> tuple[AngularVelocity, Vec3]:
        angular_velocity = self.signal_editor.read()
        with self._start_section.checking():
            return angular_velocity, self._rotation.read()

    def write(self, choice: MotionChoice, base: MotionChoice, drafts: Drafts) -> None:
        self.signal_editor.write(choice.angular_velocity, base.angular_velocity, drafts.angular_velocity)
        self._describe(choice.angular_velocity)
        self._rotation.write(choice.initial_rotation, base.initial_rotation)
        self._start_section.show(not isinstance(choice.angular_velocity, Flown))

    def _describe(self, signal: AngularVelocity) -> None:
        """Say in the folded heading what is inside."""
        self.section.caption(f"{TURNING}: {description(signal)}")

    def drafts(self) -> tuple[AngularVelocity, ...]:
        return cast(tuple[AngularVelocity, ...], self.signal_editor.drafts())
