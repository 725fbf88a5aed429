"""A sheet of controls in sections, each with a place for one complaint and a row that resets what was changed.

viser calls back from threads of its own: all that a callback does is to note that something moved, or to leave an
action that the session's loop carries out.
"""

import html
import re
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any, Protocol

import viser
from viser._messages import HotkeyKey, KeyModifier

from explorer.model import palette
from explorer.model.jobs import Jobs

Wake = Callable[[], None]
"""Called from viser's threads: it may set an event and nothing else."""
Action = Callable[[], None]
"""What a button asks for, carried out by the session's loop."""
MAX_ACTIONS = 64
"""Presses remembered while the session is busy; of more, the oldest are dropped."""
ALERT = f"color:{palette.ERROR};font-weight:600;font-size:0.85em;line-height:1.4;padding:0.2em 0.8em 0.6em"
ALERT += ";overflow-wrap:anywhere"
QUIET = palette.rgb(palette.QUIET_BUTTON)
COMPLAINTS, RESETS = 1e6, 2e6
"""viser's order of things in a folder: below all controls, whenever these were added."""
COLUMN = re.compile(r"\(column (\d+)\)$")
POINTED = 48
"""Characters of a long text shown around the place that is pointed at."""
RESET_HINT = (
    "Puts back what was changed (•) to what the preset says. Ctrl+K has “Reset the last control”; Ctrl+Z undoes."
)


def _nothing() -> None:
    """No action: for a button that the browser made up."""


class InvalidInputError(Exception):
    """What is chosen is no valid input, and a sentence beside the control says why."""


class Complaint:
    """A place for one sentence under the controls that caused it."""

    def __init__(self, gui: viser.GuiApi, *, order: float | None = None) -> None:
        self._line = gui.add_html("", visible=False, order=order)

    def say(self, sentence: str, *, text: str = "", more: Sequence[str] = ()) -> None:
        """Show the sentence, marked by a sign as well as a colour; with a text, point at the column it names. What is
        `more` stands below it, a line each."""
        lines = "".join(f'<div style="font-weight:400;padding-left:1em">• {html.escape(line)}</div>' for line in more)
        said = f"⚠ {html.escape(sentence)}{pointer(text, sentence)}{lines}"
        shown = f'<div role="alert" style="{ALERT}">{said}</div>'
        if shown != self._line.content:
            self._line.content = shown
        self._line.visible = True

    def clear(self) -> None:
        """Nothing to complain about."""
        self._line.visible = False

    def remove(self) -> None:
        """Take the place itself off the page."""
        self._line.remove()


class Resettable(Protocol):
    """What a section needs of a control."""

    name: str

    def mark(self) -> bool: ...
    def reset(self) -> None: ...
    def moved(self) -> bool: ...


class Section:
    """A folder of controls; without a label it has no frame. Use it as a context to add to it."""

    def __init__(self, form: "Form", label: str | None = None, *, expanded: bool = True) -> None:
        self.form, self.gui, self.wake = form, form.gui, form.wake
        self._folder = self.gui.add_folder(label, expand_by_default=expanded)
        self._controls: list[Resettable] = []
        with self._folder:
            self.complaint = Complaint(self.gui, order=COMPLAINTS)
            self._row = self.gui.add_button_group("reset", ("",), visible=False, order=RESETS, hint=RESET_HINT)
        self._offered: tuple[str, ...] = ()
        self._row.on_click(lambda event: form.do(partial(self._reset, event.target.value)))
        form.sections.append(self)

    def __enter__(self) -> "Section":
        self._folder.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        self._folder.__exit__(*error)

    def add(self, control: Resettable) -> None:
        """Called by a control when it is made."""
        self._controls.append(control)

    def caption(self, label: str) -> None:
        """Another label."""
        if label != self._folder.label:  # a message to the browser only if there is news
            self._folder.label = label

    def show(self, visible: bool) -> None:
        """Whether it is on the page."""
        if visible != self._folder.visible:
            self._folder.visible = visible

    def remove(self) -> None:
        """Take it off the page with all that is in it."""
        self.form.sections.remove(self)
        self._folder.remove()
        self.form.forget(self._controls)

    @contextmanager
    def catching(self, text: str = "") -> Iterator[None]:
        """Turn a ValueError into a sentence here, pointing into the text, and into Refused for the caller."""
        try:
            yield
        except ValueError as error:
            self.complaint.say(str(error), text=text)
            raise InvalidInputError from error
        self.complaint.clear()

    @contextmanager
    def answering(self) -> Iterator[None]:
        """As `catching`, for what a button asks: reading the controls, which follows at once, leaves the sentence."""
        self.form.forget_answer()
        try:
            yield
        except ValueError as error:
            self.answer(str(error))
            raise InvalidInputError from error

    def answer(self, sentence: str, *, more: Sequence[str] = ()) -> None:
        """Say here why a button did nothing, until something else is done or shown."""
        self.form.forget_answer()
        with self._folder:
            self.form.answer(Complaint(self.gui, order=COMPLAINTS), sentence, more=more)

    def refresh(self) -> Resettable | None:
        """Mark what differs from the preset, offer to reset it; the control that was moved since, if any."""
        changed = [control for control in self._controls if control.mark()]
        offered = tuple(control.name for control in changed) + (("all",) if len(changed) > 1 else ())
        if offered != self._offered:
            self._offered = offered
            self._row.visible = bool(offered)
            if offered:
                self._row.options = offered
        return next((control for control in self._controls if control.moved()), None)

    def reset_all(self) -> None:
        """Put every control back."""
        for control in self._controls:
            control.reset()

    def _reset(self, name: str) -> None:
        for control in self._controls if self in self.form.sections else ():  # it may have gone since the press
            if name in (control.name, "all"):
                control.reset()


class Form:
    """All sections of one visitor's docks, and what was asked of them."""

    def __init__(self, gui: viser.GuiApi, wake: Wake) -> None:
        self.gui, self.wake = gui, wake
        self.sections: list[Section] = []
        self._actions: deque[tuple[Action, bool]] = deque(maxlen=MAX_ACTIONS)
        self._last: Resettable | None = None
        self.actions_run = 0
        """Actions carried out so far."""
        self._answer: Complaint | None = None
        self._jobs: list[Jobs] = []

    def new_jobs(self) -> Jobs:
        """Jobs of a panel's own, whose results `deliver` hands over with all others."""
        jobs = Jobs(self.wake)
        self._jobs.append(jobs)
        return jobs

    def deliver(self) -> None:
        """Hand over the results of all finished jobs. Raises what a job raised, unless a complaint says it already."""
        for jobs in self._jobs:
            with suppress(InvalidInputError):
                jobs.deliver()

    def cancel_jobs(self) -> None:
        """The visitor has left."""
        for jobs in self._jobs:
            jobs.cancel()

    def do(self, action: Action, *, step: bool = True) -> None:
        """Leave an action for the session's loop; called from viser's threads. Moving in time is no step to undo."""
        self._actions.append((action, step))
        self.wake()

    def run_actions(self, before: Action = _nothing) -> bool:
        """Run the actions left since the last call, the oldest first, and `before` before each of them.

        Returns whether a step to undo was among them. A complaint already says where an action was refused.
        """
        count, stepped = len(self._actions), False
        for _ in range(count):
            action, step = self._actions.popleft()
            stepped = stepped or step
            with suppress(InvalidInputError):
                before()
            with suppress(InvalidInputError):
                action()
        self.actions_run += count
        return stepped

    def refresh(self) -> None:
        """Bring marks and reset rows up to date."""
        for section in tuple(self.sections):
            self._last = section.refresh() or self._last

    def answer(self, place: Complaint, sentence: str, *, more: Sequence[str] = ()) -> None:
        """Say why a button did nothing, until it is forgotten."""
        self._answer = place
        place.say(sentence, more=more)

    def forget_answer(self) -> None:
        """Something else was done, or shown."""
        if self._answer is not None:
            self._answer.remove()
            self._answer = None

    def forget(self, controls: Sequence[Resettable]) -> None:
        """Controls that are no longer on the page."""
        if self._last in controls:
            self._last = None

    def reset_last(self) -> None:
        """Put back the control that was moved last."""
        if self._last is not None:
            self._last.reset()

    def reset_all(self) -> None:
        """Put every control back."""
        for section in tuple(self.sections):
            section.reset_all()

    def button(self, label: str, action: Action, *, hint: str, quiet: bool = False) -> viser.GuiButtonHandle:
        """A button whose action the session's loop carries out; a quiet one is not what people mostly come for."""
        made = self.gui.add_button(label, hint=hint, color=QUIET if quiet else None)
        made.on_click(lambda _: self.do(action))
        return made

    def command(
        self,
        label: str,
        action: Action,
        *,
        key: HotkeyKey | None = None,
        modifier: KeyModifier | None = None,
    ) -> None:
        """A command of the Ctrl+K palette, with a key if there is one for it."""
        self.gui.add_command(label, hotkey=key, modifier=modifier).on_trigger(lambda _: self.do(action))

    @property
    def waiting(self) -> bool:
        """Whether there is something to carry out."""
        return bool(self._actions)

    def buttons(self, label: str, actions: dict[str, Action], *, hint: str) -> viser.GuiButtonGroupHandle:
        """A row of small buttons, each with its action."""
        made = self.gui.add_button_group(label, tuple(actions), hint=hint)
        made.on_click(lambda event: self.do(actions.get(event.target.value, _nothing)))
        return made


def pointer(text: str, sentence: str) -> str:
    """The text with a caret under the column that the sentence names, as HTML; empty if it names none."""
    found = COLUMN.search(sentence)
    if found is None or not text:
        return ""
    column = min(int(found[1]), len(text) + 1)
    first = max(0, column - 1 - POINTED // 2)
    line = "".join(c if c.isprintable() else "·" for c in text[first : first + POINTED])
    style = "margin:0.3em 0 0;font-weight:400;overflow-x:auto"
    return f'<pre style="{style}">{html.escape(line)}\n{" " * (column - 1 - first)}^</pre>'
