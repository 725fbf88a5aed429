"""The timeline below the scene: events of the run, scrub, play, step, speed and loop; each with a command, most with a
key."""

import html
import math
import time
from dataclasses import dataclass
from functools import partial
from typing import Literal

from explorer.model import palette
from explorer.model.compute import Picture
from explorer.model.drawn import Drawn
from explorer.model.playback import STEP, Playback
from explorer.web.elements import element_id, of_kind
from explorer.web.in_order import in_turn
from explorer.widgets import typed_number
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.controls import when_moved
from explorer.widgets.dial_control import BOX_LABEL
from explorer.widgets.form import Action, Form
from explorer.widgets.section import Section
from rangenav import window_text
from rangenav.inputs import require_within
from rangenav.model import STATES
from rangenav.record import SETTLED_POSITION

BUTTONS = {
    "home": ("|◀", "Back to the start (Home)"),
    "back": ("◀", "One step back (←)"),
    "play": ("▶ play", "Play or pause (space)"),
    "forward": ("▶", "One step on (→)"),
    "slower": ("½×", "Play slower"),
    "faster": ("2×", "Play faster"),
    "loop": ("↻", "Loop, or stop at the end"),
}
"""Face and hint of each button."""
BUTTON = '<button type="button" class="rn-button" data-rn-event="{}" title="{}" aria-label="{}">{}</button>'
KEYS: dict[str, tuple[str, Literal["space", "arrowleft", "arrowright", "home"] | None]] = {
    "play": ("Play or pause", "space"),
    "back": ("One step back in time", "arrowleft"),
    "forward": ("One step on in time", "arrowright"),
    "home": ("Back to the start", "home"),
    "slower": ("Play slower", None),
    "faster": ("Play faster", None),
    "loop": ("Loop, or stop at the end", None),
}
STRIP = (
    '<div class="rn-timeline"><div class="rn-strip u-over" role="group" aria-label="Events of the run" '
    'title="Events of the run. A click seeks, a drag sets δ.">'
    '<div class="rn-window" style="left:calc(100% * var(--wfrom, 0));width:calc(100% * var(--wspan, 0))"></div>'
    '{}<div class="rn-cursor" style="left:calc(100% * var(--tcur, 0))"></div></div></div>'
)
"""The variables are those that move the cursor and the window of the plots."""
MARK = (
    '<button type="button" class="rn-mark" data-rn-event="mark-{}" style="left:{:.2f}%;color:{}" title="{}" '
    'aria-label="{}">{}</button>'
)
MOST_MARKS = 12
TIME, TICK = "t (s)", 0.01
"""Label of the slider, and s between two of its positions."""
REDRAW = 0.2
"""s between two updates of the slider while playing; the scene is updated at every frame."""
KEEP_CAMERA_STILL = (
    # viser also turns its camera with the arrow keys; its listener sits one level further out than that of the hotkeys.
    '<img alt="" src="data:," style="display:none" onerror="document.documentElement.addEventListener('
    "'keydown',e=>{if(['ArrowLeft','ArrowRight'].includes(e.key))e.stopPropagation()})"
    '">'
)


class TimelinePanel:
    """The strip of events, the slider and the buttons, below the scene."""

    def __init__(self, form: Form, playback: Playback) -> None:
        self._form, self._playback = form, playback
        self._shown_time, self._shown_text = 0.0, "0"
        """What slider and box held when they were last written or read: if they hold something else, the visitor has
        changed it since, and `_seek` or `_seek_typed` is on its way."""
        self._moved_at, self._state_drawn = -REDRAW, Drawn()
        self.actions: dict[str, Action] = {
            "home": lambda: playback.seek(0.0),
            "back": lambda: playback.seek(playback.time - STEP),
            "forward": lambda: playback.seek(playback.time + STEP),
            "play": lambda: playback.toggle(time.monotonic()),
            "slower": lambda: playback.change_speed(-1),
            "faster": lambda: playback.change_speed(+1),
            "loop": playback.toggle_loop,
        }
        """What the buttons do, by the names that they send."""
        self._events: tuple[Event, ...] = ()
        self.actions |= {f"mark-{k}": partial(self._go_to_event, k) for k in range(MOST_MARKS)}
        with form.gui.add_folder("Timeline"):
            self._strip = form.gui.add_html(STRIP.format(""))
            self._section = Section(form)
            with self._section:
                hint = "The moment shown in the scene and by the cursors of the plots. Moving it pauses."
                with of_kind("rn-slider-"):
                    self._slider = form.gui.add_slider(TIME, 0.0, _end(playback.duration), TICK, 0.0, hint=hint)
                with of_kind("rn-box-number-"):
                    self._box = form.gui.add_text(f"{TIME}: {BOX_LABEL}", "0")
            self._buttons = form.gui.add_html("")
            form.gui.add_html(KEEP_CAMERA_STILL)
        when_moved(self._slider, lambda: form.do(self._seek, step=False))
        when_moved(self._box, lambda: form.do(self._seek_typed, step=False))
        for name, (label, key) in KEYS.items():
            form.command(label, self.actions[name], key=key)

    def draw(self, picture: Picture) -> None:
        """Mark the events of a run above the slider."""
        self._events = events(picture)[:MOST_MARKS]
        marks = (_mark(k, event, picture.preset.duration) for k, event in enumerate(self._events))
        content = STRIP.format("".join(marks))
        if content != self._strip.content:
            self._strip.content = content

    def write(self, now: float) -> None:
        """Show the time of the playback."""
        playback = self._playback
        end = _end(playback.duration)
        if self._slider.max != end:
            self._slider.max = end
        self._follow(now)
        if not self._state_drawn.changed(playback.playing, playback.speed, playback.loop):
            return
        state = "playing" if playback.playing else "paused"
        faces = {name: face for name, (face, _) in BUTTONS.items()} | ({"play": "❚❚ pause"} if playback.playing else {})
        buttons = (BUTTON.format(name, hint, hint, faces[name]) for name, (_, hint) in BUTTONS.items())
        label = f"{state} ×{playback.speed:g}{' ↻' if playback.loop else ''}"
        self._buttons.content = (
            f'<div class="rn-transport">{"".join(buttons)}<span class="rn-state">{label}</span></div>'
        )

    def _follow(self, now: float) -> None:
        """Have slider and box show the time of the playback."""
        playback = self._playback
        due = not playback.playing or now - self._moved_at >= REDRAW
        if due and not self._form.waiting and round(playback.time, 2) != self._shown_time:
            self._moved_at = now
            in_turn(self._form.gui, self._write_time)

    def _write_time(self) -> None:
        moment = round(self._playback.time, 2)
        if self._write_slider(moment):
            self._write_box(moment)

    def _write_slider(self, moment: float) -> bool:
        """Show a moment, unless the visitor has moved the slider meanwhile. Returns whether it is another one."""
        shown = self._shown_time
        if moment == shown or (self._slider.value != shown and not math.isnan(shown)):  # NaN was refused
            return False
        self._slider.value = self._shown_time = moment
        return True

    def _write_box(self, moment: float) -> None:
        """Show a moment, unless the visitor has typed another one meanwhile; a text that was refused goes with its
        complaint."""
        if self._box.value != self._shown_text:
            return
        self._box.value = self._shown_text = typed_number.text(moment)
        if self._section.complaint.is_about(element_id(self._box)):
            self._section.complaint.clear()

    def _go_to_event(self, k: int) -> None:
        """Go to the moment of a mark; one that is no longer there does nothing."""
        if k < len(self._events):
            self._playback.seek(self._events[k].time)

    def _seek(self) -> None:
        with self._section.catching():
            self._shown_time = self._slider.value
            self._playback.seek(self._shown_time)
        in_turn(self._form.gui, partial(self._write_box, round(self._playback.time, 2)))

    def _seek_typed(self) -> None:
        """Go to the moment in the box. What is none stays there, with a sentence."""
        self._shown_text = self._box.value
        try:
            moment = typed_number.parse(self._shown_text)
            require_within("t", moment, 0.0, self._playback.duration, "s")
        except ValueError as error:
            self._section.complaint.say(str(error), boxes=(element_id(self._box),))
            raise InvalidInputError from error
        self._section.complaint.clear()
        self._playback.seek(moment)
        in_turn(self._form.gui, partial(self._write_slider, round(self._playback.time, 2)))


def _end(duration: float) -> float:
    """The end of the slider (s): the duration in ticks, rounded up, so that its number can be read."""
    return round(math.ceil(round(duration / TICK, 6)) * TICK, 2)


@dataclass(frozen=True)
class Event:
    """Something that happened in a run."""

    time: float
    """s"""
    sign: str
    color: palette.Color
    text: str


def events(picture: Picture) -> tuple[Event, ...]:
    """The start of the worst window, when limits are exceeded most, and when the estimate has settled."""
    analysis, summary = picture.analysis, picture.summary
    later = window_text.later_round(analysis.gramian_at, picture.preset.requirement.window, picture.preset.duration)
    found = [] if later else [Event(analysis.gramian_at, "▼", palette.WARNING, "the worst window starts")]
    found += [Event(one.at, "✕", palette.ERROR, one.summary) for one in picture.breaks]
    if summary.settle_position_s is not None and analysis.rank == STATES and not summary.diverged:
        text = f"the position stays within {SETTLED_POSITION:g} m from here on"
        found.append(Event(summary.settle_position_s, "✓", palette.GOOD, text))
    return tuple(found)


def _mark(number: int, event: Event, duration: float) -> str:
    share, text = 100 * min(event.time / duration, 1.0), html.escape(f"{event.time:.1f} s: {event.text}")
    return MARK.format(number, share, event.color, text, text, event.sign)
