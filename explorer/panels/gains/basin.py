"""Basin of attraction: settling times of the attitude filter for starts about axes in all directions, on a globe.

The convergence is almost global (paper, theorem), but starts near the undesired equilibria converge slowly: the globe
shows which starts do, and how long they take.

A globe belongs to the settings that it was computed for, except for their initial attitude error. It disappears when
these settings change. Autosave and undo do not include it.
"""

import html
import math

import msgspec
import numpy as np

from explorer.model import basin, palette
from explorer.model.basin import Setup
from explorer.model.compute import Picture
from explorer.model.jobs import Jobs
from explorer.model.settings import effective
from explorer.panels.presets import Page
from explorer.widgets.controls import Number
from explorer.widgets.dials import Dial
from explorer.widgets.form import Form
from explorer.widgets.html import NOTE
from explorer.widgets.progress import ProgressPanel
from explorer.widgets.section import Section
from rangenav import ensemble
from rangenav.ensemble import Basin
from rangenav.ensemble.basin import MAX_AXES
from rangenav.inputs import require
from rangenav.number_format import fixed, significant
from rangenav.progress import Cancelled, Progress

ANGLE, AXES = math.radians(179.0), 300
ANGLES = 0.0, 180.0
"""Degrees."""
ANGLE_HINT = "How far (degrees) each start is from the true attitude; near 180° the filter may linger (paper, U_π)."
AXES_HINT = f"How many axes to start about, evenly all around, 1 to {MAX_AXES}."
COMPUTE_HINT = "Starts the attitude filter about every axis, on the record of these settings. Takes about a second."
HIDE_HINT = "Takes the globe off the picture, or brings it back."
SLOWEST_HINT = "Makes the slowest start the initial attitude error of the run; Ctrl+Z takes it back."
OUTDATED = "The settings have changed: the globe belonged to others and is gone."
STOPPED = "The settings changed while the starts ran, so these were stopped."
COMPUTE_LABEL, HIDE_LABEL, SHOW_LABEL = "Start from all around", "Hide the globe", "Show the globe"
COLOUR_SCALE = (
    '<div style="display:flex;align-items:center;gap:0.5em;padding:0.3em 0">{first}'
    '<span role="img" aria-label="light is soon, dark is late" style="flex:1;height:0.8em;border-radius:3px;'
    'background:linear-gradient(to right,{stops})"></span>{last}</div>'
)
NEVER_SIGN = '<b style="color:{0}">◆</b>'


class BasinPanel:
    """An angle, a number of axes, buttons, and the settling times."""

    def __init__(self, form: Form, page: Page, jobs: Jobs) -> None:
        self._page, self._jobs = page, jobs
        self.computed: tuple[Setup, Basin] | None = None
        self._running: tuple[Setup, object] | None = None
        self._hidden, self._changed, self._message = False, False, ""
        self._section = section = Section(form, "Basin of attraction", expanded=False)
        with section:
            scale = math.degrees(1.0)
            self._angle = Dial(
                section,
                "attitude error of all starts (°)",
                ANGLES,
                step=0.1,
                hint=ANGLE_HINT,
                scale=scale,
                allowed=ANGLES,
            )
            self._axes = Number(section, "number of axes", hint=AXES_HINT)
            self._angle.write(ANGLE, None)
            self._axes.write(AXES, None)
            form.button(COMPUTE_LABEL, self._compute, hint=COMPUTE_HINT)
            self._progress = ProgressPanel(form, jobs)
            self._result = form.gui.add_html("", visible=False)
            self._slowest = form.button("Start from the slowest", self._start_from_slowest, hint=SLOWEST_HINT)
            self._hide = form.button(HIDE_LABEL, self._toggle, hint=HIDE_HINT)
        self._slowest.visible = self._hide.visible = False
        section.check(self._options)
        form.command("Basin of attraction", self._compute)

    @property
    def changed(self) -> bool:
        """Whether the globe has changed since it was drawn last."""
        return self._changed

    def globe(self, picture: Picture) -> Basin | None:
        """The globe to draw with a picture; None if there is none for its settings, or if it is hidden."""
        self._changed = False
        if self.computed is None and self._running is None:
            return None
        setup = basin.setup_of(picture.preset)
        if self._running is not None and self._running[0] != setup:
            if self._jobs.running is self._running[1]:
                self._jobs.cancel()
                self._message = STOPPED
            self._running = None
        if self.computed is not None and self.computed[0] != setup:
            self.computed, self._message = None, self._message or OUTDATED
        return None if self.computed is None or self._hidden else self.computed[1]

    def draw(self, picture: Picture) -> None:
        """Describe the globe, or say why it has disappeared."""
        result = None if self.computed is None else self.computed[1]
        text = NOTE.format(html.escape(self._message)) if result is None else basin_text(picture, result)
        if text != self._result.content:
            self._result.content = text
        self._result.visible = result is not None or bool(self._message)
        self._slowest.visible = self._hide.visible = result is not None
        label = SHOW_LABEL if self._hidden else HIDE_LABEL
        if label != self._hide.label:
            self._hide.label = label

    def _compute(self) -> None:
        with self._section.catching():
            chosen, (angle, count) = effective(self._page.read()), self._options()
        setup = basin.setup_of(chosen)

        def work(progress: Progress, cancelled: Cancelled) -> Basin:
            return ensemble.basin(chosen, angle, count, progress=progress, cancelled=cancelled)

        def done(result: Basin) -> None:
            self.computed, self._running, self._hidden, self._changed = (setup, result), None, False, True

        def failed(sentence: str) -> None:
            self._running = None
            self._section.complaint.say(sentence)

        self._progress.start(f"{count} starts at {significant(math.degrees(angle), 4)}°", work, done, failed)
        self._running, self._message = (setup, self._jobs.running), ""

    def _options(self) -> tuple[float, int]:
        """Angle (rad) and number of axes. Raises ValueError with the reason."""
        angle, axes = self._angle.read(), self._axes.read()
        whole = math.isfinite(axes) and axes == int(axes) and 1 <= axes <= MAX_AXES
        require(whole, f"number of axes must be a whole number between 1 and {MAX_AXES}, got {axes:g}")
        return angle, int(axes)

    def forget_preset(self) -> None:
        """Forget the globe without a word: it belongs to a run that is not on the page any more."""
        if self._running is not None and self._jobs.running is self._running[1]:
            self._jobs.cancel()
        self._changed |= self.computed is not None
        self.computed, self._running, self._message = None, None, ""

    def _start_from_slowest(self) -> None:
        if self.computed is None:
            return
        result, settings = self.computed[1], self._page.read()
        x, y, z = (float(entry) for entry in result.axis[basin.slowest(result)])
        guess = msgspec.structs.replace(settings.preset.guess, attitude_axis=(x, y, z), attitude_angle=result.angle)
        preset = msgspec.structs.replace(settings.preset, guess=guess)
        self._page.write(msgspec.structs.replace(settings, preset=preset))

    def _toggle(self) -> None:
        self._hidden, self._changed = not self._hidden, True


def basin_text(picture: Picture, result: Basin) -> str:
    """How many starts settle and when, the meaning of the colours, and where the undesired equilibria are."""
    settles, degrees = np.isfinite(result.settle), math.degrees(result.angle)
    count, last = len(settles), basin.slowest(result)
    middle = float(np.median(result.settle))
    lines = [f"<b>{settles.sum()} of {count}</b> starts at {significant(degrees, 4)}° settle (below 5° from then on)."]
    lines.append(
        f"Median <b>{significant(middle)} s</b>." if math.isfinite(middle) else "Half of them or more never do."
    )
    about = f"about ({', '.join(fixed(entry) for entry in result.axis[last].tolist())})"
    if settles[last]:
        lines.append(f"The slowest, {about}, takes <b>{significant(result.settle[last])} s</b>.")
    else:
        lines.append(f"The worst, {about}, ends at <b>{significant(math.degrees(result.final[last]))}°</b>.")
    text = f"{' '.join(lines)}{legend(result)}{_equilibria(picture)}"
    if picture.settings.printed.model:
        text += "<div>⚠ Computed with the derived model: the printed one is followed by the run alone.</div>"
    return NOTE.format(text)


def legend(result: Basin) -> str:
    """The colour scale with its ends in seconds, and the sign of a start that never settles."""
    limits, text = basin.settling_span(result), ""
    if limits is not None:
        stops = ",".join(palette.SETTLING_SCALE)
        text = COLOUR_SCALE.format(first=f"{significant(limits[0])} s", last=f"{significant(limits[1])} s", stops=stops)
    if not np.isfinite(result.settle).all():
        text += f"<div>{NEVER_SIGN.format(palette.NEVER_SETTLES)} not settled in {significant(result.time[-1])} s</div>"
    return text


def _equilibria(picture: Picture) -> str:
    """The marked axes, and the angles from each to gravity and to the magnetic vector."""
    world = picture.preset.world

    def angle_to(axis: np.ndarray, vector: tuple[float, ...]) -> str:
        cosine = abs(float(axis @ vector)) / math.hypot(*vector)
        return f"{math.degrees(math.acos(min(cosine, 1.0))):.0f}°"

    named = (
        f"<b>±u{'₁₂₃'[k]}</b> ({angle_to(axis, world.magnetic)} from m, {angle_to(axis, world.gravity)} from g)"
        for k, axis in enumerate(basin.equilibria(picture))
    )
    return f"<div>Sticks: the undesired equilibria, half turns about {', '.join(named)}.</div>"
