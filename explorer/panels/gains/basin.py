"""Basin of attraction: how long the attitude takes from starts all around, as a globe in 3-D, and the slowest of them.

"Almost global" (paper, theorem) hides that starts near the undesired equilibria linger; here one sees where and how
long. A globe belongs to the settings it was computed for, whatever the attitude error they start with: when they
change it is taken off. Like everything that stands beside the run, it is no part of what is kept and undone.
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
from explorer.widgets.controls import Dial, Number
from explorer.widgets.form import Form, Section
from explorer.widgets.html import NOTE
from rangenav import ensemble
from rangenav.ensemble import Basin
from rangenav.ensemble.basin import MAX_AXES
from rangenav.inputs import require
from rangenav.progress import Cancelled, Progress

ANGLE, AXES = math.radians(179.0), 300
ANGLE_HINT = "How far (degrees) each start is from the true attitude; near 180° the filter may linger (paper, U_π)."
AXES_HINT = f"How many axes to start about, evenly all around, 1 to {MAX_AXES}."
COMPUTE = "Starts the attitude filter about every axis, on the record of these settings. Takes about a second."
HIDE = "Takes the globe off the picture, or brings it back."
SLOWEST = "Makes the slowest start the initial attitude error of the run; Ctrl+Z takes it back."
GONE = "The settings have changed: the globe belonged to others and is gone."
OVERTAKEN = "The settings changed while the starts ran, so these were stopped."
COMPUTE_LABEL, HIDE_LABEL, SHOW_LABEL = "Start from all around", "Hide the globe", "Show the globe"
SCALE = (
    '<div style="display:flex;align-items:center;gap:0.5em;padding:0.3em 0">{first}'
    '<span role="img" aria-label="light is soon, dark is late" style="flex:1;height:0.8em;border-radius:3px;'
    'background:linear-gradient(to right,{stops})"></span>{last}</div>'
)
DIAMOND = '<b style="color:{0}">◆</b>'


class BasinPanel:
    """An angle, a number of axes, buttons, and what was found."""

    def __init__(self, form: Form, page: Page, jobs: Jobs) -> None:
        self._page, self._jobs = page, jobs
        self._found: tuple[Setup, Basin] | None = None
        self._running: tuple[Setup, object] | None = None
        self._hidden, self._changed, self._note = False, False, ""
        self._section = section = Section(form, "Basin of attraction", expanded=False)
        with section:
            scale = math.degrees(1.0)
            self._angle = Dial(section, "start angle (°)", (0.0, 180.0), step=0.1, hint=ANGLE_HINT, scale=scale)
            self._axes = Number(section, "axes", step=1, hint=AXES_HINT)
            self._angle.write(ANGLE, None)
            self._axes.write(AXES, None)
            form.button(COMPUTE_LABEL, self._compute, hint=COMPUTE)
            self._said = form.gui.add_html("", visible=False)
            self._slowest = form.button("Start from the slowest", self._start_from_slowest, hint=SLOWEST)
            self._hide = form.button(HIDE_LABEL, self._toggle, hint=HIDE)
        self._slowest.visible = self._hide.visible = False
        form.command("Basin of attraction", self._compute)

    @property
    def changed(self) -> bool:
        """Whether there is something else to draw than was drawn last."""
        return self._changed

    def shown(self, picture: Picture) -> Basin | None:
        """What to draw beside a picture, if there is something that belongs to it."""
        self._changed = False
        if self._found is None and self._running is None:
            return None
        setup = basin.setup_of(picture.preset)
        if self._running is not None and self._running[0] != setup:
            if self._jobs.running is self._running[1]:
                self._jobs.cancel()
                self._note = OVERTAKEN
            self._running = None
        if self._found is not None and self._found[0] != setup:
            self._found, self._note = None, self._note or GONE
        return None if self._found is None or self._hidden else self._found[1]

    def draw(self, picture: Picture) -> None:
        """Say what is drawn, or why it is gone."""
        found = None if self._found is None else self._found[1]
        said = NOTE.format(html.escape(self._note)) if found is None else words(picture, found)
        if said != self._said.content:
            self._said.content = said
        self._said.visible = found is not None or bool(self._note)
        self._slowest.visible = self._hide.visible = found is not None
        label = SHOW_LABEL if self._hidden else HIDE_LABEL
        if label != self._hide.label:
            self._hide.label = label

    def _compute(self) -> None:
        with self._section.catching():
            angle, axes = self._angle.read(), self._axes.read()
            whole = math.isfinite(axes) and axes == int(axes) and 1 <= axes <= MAX_AXES
            require(whole, f"axes must be a whole number between 1 and {MAX_AXES}, got {axes:g}")
            chosen, count = effective(self._page.read()), int(axes)
        setup = basin.setup_of(chosen)

        def work(progress: Progress, cancelled: Cancelled) -> Basin:
            return ensemble.basin(chosen, angle, count, progress=progress, cancelled=cancelled)

        def done(found: Basin) -> None:
            self._found, self._running, self._hidden, self._changed = (setup, found), None, False, True

        def failed(sentence: str) -> None:
            self._running = None
            self._section.complaint.say(sentence)

        self._jobs.start(f"{count} starts at {math.degrees(angle):.4g}°", work, done, failed)
        self._running, self._note = (setup, self._jobs.running), ""

    def _start_from_slowest(self) -> None:
        if self._found is None:
            return
        found, settings = self._found[1], self._page.read()
        x, y, z = (float(entry) for entry in found.axis[basin.slowest(found)])
        guess = msgspec.structs.replace(settings.preset.guess, attitude_axis=(x, y, z), attitude_angle=found.angle)
        preset = msgspec.structs.replace(settings.preset, guess=guess)
        self._page.write(msgspec.structs.replace(settings, preset=preset))

    def _toggle(self) -> None:
        self._hidden, self._changed = not self._hidden, True


def words(picture: Picture, found: Basin) -> str:
    """How many settle and when, what the colours mean, and where the undesired equilibria are."""
    settles, degrees = np.isfinite(found.settle), math.degrees(found.angle)
    count, last = len(settles), basin.slowest(found)
    middle = float(np.median(found.settle))
    lines = [f"<b>{settles.sum()} of {count}</b> starts at {degrees:.4g}° settle (below 5° from then on)."]
    lines.append(f"Median <b>{middle:.3g} s</b>." if math.isfinite(middle) else "Half of them or more never do.")
    about = f"about ({', '.join(f'{entry:.2f}' for entry in found.axis[last])})"
    if settles[last]:
        lines.append(f"The slowest, {about}, takes <b>{found.settle[last]:.3g} s</b>.")
    else:
        lines.append(f"The worst, {about}, ends at <b>{math.degrees(found.final[last]):.3g}°</b>.")
    said = f"{' '.join(lines)}{legend(found)}{_equilibria(picture)}"
    if picture.settings.printed.model:
        said += "<div>⚠ Computed with the derived model: the printed one is followed by the run alone.</div>"
    return NOTE.format(said)


def legend(found: Basin) -> str:
    """The scale with its ends in seconds, and the sign of what never settles."""
    span, said = basin.ends(found), ""
    if span is not None:
        stops = ",".join(palette.SETTLING_SCALE)
        said = SCALE.format(first=f"{span[0]:.3g} s", last=f"{span[1]:.3g} s", stops=stops)
    if not np.isfinite(found.settle).all():
        said += f"<div>{DIAMOND.format(palette.NEVER_SETTLES)} not settled in {found.time[-1]:.3g} s</div>"
    return said


def _equilibria(picture: Picture) -> str:
    """Which axes are marked, and where gravity and the magnetic vector are from them."""
    world = picture.preset.world

    def off(axis: np.ndarray, vector: tuple[float, ...]) -> str:
        cosine = abs(float(axis @ vector)) / math.hypot(*vector)
        return f"{math.degrees(math.acos(min(cosine, 1.0))):.0f}°"

    named = (
        f"<b>±u{'₁₂₃'[k]}</b> ({off(axis, world.magnetic)} from m, {off(axis, world.gravity)} from g)"
        for k, axis in enumerate(basin.equilibria(picture))
    )
    return f"<div>Sticks: the undesired equilibria, half turns about {', '.join(named)}.</div>"
