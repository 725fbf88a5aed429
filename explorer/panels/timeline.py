"""The timeline: play, scrub, step, speed and loop, each with a command and most with a key."""

import time
from typing import Literal

import viser

from explorer.model.playback import STEP, Playback
from explorer.widgets.controls import when_moved
from explorer.widgets.form import Form
from explorer.widgets.section import Section

BUTTONS = {
    "|◀": "home",
    "◀ step": "back",
    "▶ play / pause": "play",
    "step ▶": "forward",
    "slower": "slower",
    "faster": "faster",
    "↻ loop": "loop",
}
MAX_WIDTH, MIN_WIDTH, GAP = 700, 480, 10
"""px: limits of the width of the panel, and its distance to the docks."""
KEYS: dict[str, tuple[str, Literal["space", "arrowleft", "arrowright", "home"] | None]] = {
    "play": ("Play or pause", "space"),
    "back": ("One step back in time", "arrowleft"),
    "forward": ("One step on in time", "arrowright"),
    "home": ("Back to the start", "home"),
    "slower": ("Play slower", None),
    "faster": ("Play faster", None),
    "loop": ("Loop, or stop at the end", None),
}
REDRAW = 0.1
"""s between two updates of the slider while playing; the scene is updated at every frame."""
KEEP_CAMERA_STILL = (
    # viser also turns its camera with the arrow keys; its listener sits one level further out than that of the hotkeys.
    '<img alt="" src="data:," style="display:none" onerror="document.documentElement.addEventListener('
    "'keydown',e=>{if(['ArrowLeft','ArrowRight'].includes(e.key))e.stopPropagation()})"
    '">'
)


class TimelinePanel:
    """The floating panel at the bottom."""

    def __init__(self, form: Form, playback: Playback, *, room: float) -> None:
        """`room` (px) is the space between the docks."""
        self._form, self._playback = form, playback
        self._shown_time, self._moved_at = 0.0, -REDRAW
        actions = {
            "home": lambda: playback.seek(0.0),
            "back": lambda: playback.seek(playback.time - STEP),
            "forward": lambda: playback.seek(playback.time + STEP),
            "play": lambda: playback.toggle(time.monotonic()),
            "slower": lambda: playback.change_speed(-1),
            "faster": lambda: playback.change_speed(+1),
            "loop": playback.toggle_loop,
        }
        panel = form.gui.add_panel()
        with panel.add_tab("Timeline", viser.Icon.CLOCK_PLAY):
            self._section = Section(form)
            with self._section:
                hint = "The moment shown in the scene and by the cursors of the plots. Moving it pauses."
                self._slider = form.gui.add_slider("t (s)", 0.0, playback.duration, 0.01, 0.0, hint=hint)
                hint = "Keys: space plays and pauses, ← and → step, Home goes to the start. All commands: Ctrl+K."
                actions_by_label = {label: actions[name] for label, name in BUTTONS.items()}
                self._buttons = form.buttons("", actions_by_label, hint=hint)
                form.gui.add_html(KEEP_CAMERA_STILL)
        panel.float(x=GAP, y=-GAP, width=round(min(max(room - 2 * GAP, MIN_WIDTH), MAX_WIDTH)))
        when_moved(self._slider, lambda: form.do(self._seek, step=False))
        for name, (label, key) in KEYS.items():
            form.command(label, actions[name], key=key)

    def write(self, now: float) -> None:
        """Show the time of the playback."""
        playback = self._playback
        if self._slider.max != playback.duration:
            self._slider.max = playback.duration
        self._move_slider(round(playback.time, 2), now, playing=playback.playing)
        state = "▶ playing" if playback.playing else "❚❚ paused"
        label = f"{state} ×{playback.speed:g}{' ↻' if playback.loop else ''}"
        if label != self._buttons.label:
            self._buttons.label = label

    def _move_slider(self, moment: float, now: float, *, playing: bool) -> None:
        """Move the slider, unless the visitor has moved it meanwhile."""
        if moment == self._shown_time or self._form.waiting or (playing and now - self._moved_at < REDRAW):
            return
        self._slider.value = self._shown_time = moment
        self._moved_at = now

    def _seek(self) -> None:
        with self._section.catching():
            self._shown_time = self._slider.value
            self._playback.seek(self._shown_time)
