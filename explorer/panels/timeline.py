"""The timeline: play, scrub, step, speed and loop, with keys for all of them."""

from collections.abc import Callable
from typing import Literal

import viser

from explorer.panels.controls import Clicks, Complaint, Note, when_moved
from explorer.playback import STEP, Playback

BUTTONS = {
    "|◀": "home",
    "◀ step": "back",
    "▶ play / pause": "play",
    "step ▶": "forward",
    "slower": "slower",
    "faster": "faster",
    "↻ loop": "loop",
}
WIDTH, NARROW_WIDTH, GAP = 700, 580, 10
"""px: what two columns of plots, or one, leave between the docks of a usual screen; and the distance to its edges."""
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
"""s: how often the slider follows while playing; the scene moves at every frame."""
KEEP_CAMERA_STILL = (
    # viser also turns its camera with the arrow keys; its listener sits one level further out than that of the hotkeys.
    '<img alt="" src="data:," style="display:none" onerror="document.documentElement.addEventListener('
    "'keydown',e=>{if(['ArrowLeft','ArrowRight'].includes(e.key))e.stopPropagation()})"
    '">'
)


class TimelinePanel:
    """The floating panel at the bottom."""

    def __init__(self, gui: viser.GuiApi, duration: float, note: Note, *, narrow: bool) -> None:
        self._clicks, self._shown, self._written = Clicks(note), 0.0, -REDRAW
        panel = gui.add_panel()
        with panel.add_tab("Timeline", viser.Icon.CLOCK_PLAY):
            hint = "The moment shown in the scene and by the cursors of the plots. Moving it pauses."
            self._scrub = gui.add_slider("t (s)", 0.0, duration, 0.01, 0.0, hint=hint)
            hint = "Keys: space plays and pauses, ← and → step, Home goes to the start. All commands: Ctrl+K."
            self._buttons = gui.add_button_group("", tuple(BUTTONS), hint=hint)
            self._complaint = Complaint(gui)
            gui.add_html(KEEP_CAMERA_STILL)
        panel.float(x=GAP, y=-GAP, width=NARROW_WIDTH if narrow else WIDTH)
        when_moved(self._scrub, lambda: self._clicks.add("scrub"))
        self._buttons.on_click(lambda event: self._clicks.add(BUTTONS.get(event.target.value, "")))
        for name, (label, key) in KEYS.items():
            gui.add_command(label, hotkey=key).on_trigger(self._adding(name))

    def read(self, playback: Playback, now: float) -> None:
        """Carry out what was pressed since the last call. Raises Refused if the slider was sent no number."""
        for name in self._clicks.take():
            with self._complaint.catching():
                self._carry_out(name, playback, now)

    def write(self, playback: Playback, now: float) -> None:
        """Show where the playhead is."""
        if self._scrub.max != playback.duration:
            self._scrub.max = playback.duration
        self._follow(round(playback.time, 2), now, playing=playback.playing)
        state = "▶ playing" if playback.playing else "❚❚ paused"
        label = f"{state} ×{playback.speed:g}{' ↻' if playback.loop else ''}"
        if label != self._buttons.label:
            self._buttons.label = label

    def _follow(self, time: float, now: float, *, playing: bool) -> None:
        """Move the slider, but never over what the visitor has set it to in the meantime."""
        if time == self._shown or self._clicks.waiting or (playing and now - self._written < REDRAW):
            return
        self._scrub.value = self._shown = time
        self._written = now

    def _scrubbed(self, playback: Playback) -> None:
        self._shown = self._scrub.value
        playback.seek(self._shown)

    def _carry_out(self, name: str, playback: Playback, now: float) -> None:
        actions: dict[str, Callable[[], None]] = {
            "scrub": lambda: self._scrubbed(playback),
            "home": lambda: playback.seek(0.0),
            "back": lambda: playback.seek(playback.time - STEP),
            "forward": lambda: playback.seek(playback.time + STEP),
            "play": lambda: playback.toggle(now),
            "slower": lambda: playback.change_speed(-1),
            "faster": lambda: playback.change_speed(+1),
            "loop": playback.toggle_loop,
        }
        if name not in actions:
            raise ValueError("the timeline has no such button")
        actions[name]()

    def _adding(self, name: str) -> Callable[[viser.CommandEvent], None]:
        return lambda _: self._clicks.add(name)
