"""The form: sections of controls, each with a complaint below them and a row of buttons that reset changed controls.

viser's threads   a control was moved: wake(); a button was pressed: do(action)       nothing else
session's loop    run_actions(), deliver(), refresh()
"""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any, Protocol

import viser
from viser._messages import HotkeyKey, KeyModifier

from explorer.model import palette
from explorer.model.jobs import Jobs
from explorer.widgets.complaint import Complaint

Wake = Callable[[], None]
"""Called from viser's threads; it may do nothing but set an event."""
Action = Callable[[], None]
"""What a button does; the session's loop runs it."""
MAX_ACTIONS = 64
"""Actions queued while the session is busy; beyond that the oldest are dropped."""
QUIET = palette.rgb(palette.QUIET_BUTTON)
COMPLAINTS, RESETS = 1e6, 2e6
"""viser's order in a folder: below all controls, also below those added later."""
RESET_HINT = (
    "Puts back what was changed (•) to what the preset says. Ctrl+K has “Reset the last control”; Ctrl+Z undoes."
)


def _nothing() -> None:
    """Do nothing: the action of a button that does not exist but that a browser reports as pressed."""


class InvalidInputError(Exception):
    """The chosen values are no valid input. Its cause is the ValueError that says why; `refresh` shows that."""

    def __init__(self, section: "Section | None" = None, text: str = "") -> None:
        """`section` holds the control, if one is the cause; the reason may name a column of the `text`."""
        super().__init__()
        self.section, self.text = section, text


class Resettable(Protocol):
    """The part of a control that a section uses."""

    name: str

    def mark(self) -> bool: ...
    def reset(self) -> None: ...
    def moved(self) -> bool: ...


class Section:
    """A folder of controls; without a label it has no frame. Controls created in its `with` block are in the folder."""

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
        """Register a control of this section; the control calls this in its constructor."""
        self._controls.append(control)

    def caption(self, label: str) -> None:
        """Change the label."""
        if label != self._folder.label:  # so that an unchanged label sends no message
            self._folder.label = label

    @property
    def controls(self) -> tuple[Resettable, ...]:
        """The controls, in the order in which they were created."""
        return tuple(self._controls)

    @property
    def visible(self) -> bool:
        """Whether the section is on the page."""
        return self._folder.visible

    @property
    def label(self) -> str | None:
        """The label of the folder."""
        return self._folder.label

    def show(self, visible: bool) -> None:
        """Show or hide the section."""
        if visible != self._folder.visible:
            self._folder.visible = visible

    def remove(self) -> None:
        """Remove the section and its controls from the page."""
        self.form.sections.remove(self)
        self._folder.remove()
        self.form.forget(self._controls)

    @contextmanager
    def checking(self, text: str = "") -> Iterator[None]:
        """Turn a ValueError into an InvalidInputError that names this section; the page stays as it is."""
        try:
            yield
        except ValueError as error:
            raise InvalidInputError(self, text) from error

    @contextmanager
    def catching(self, text: str = "") -> Iterator[None]:
        """Turn a ValueError into a complaint here, which points into the text, and into an InvalidInputError."""
        with complaining(self), self.checking(text):
            yield

    @contextmanager
    def answering(self) -> Iterator[None]:
        """Like `catching`, for the action of a button: the complaint stays when the controls are read afterwards."""
        self.form.forget_answer()
        try:
            yield
        except ValueError as error:
            self.answer(str(error))
            raise InvalidInputError from error

    def answer(self, sentence: str, *, more: Sequence[str] = ()) -> None:
        """Say here why a button did nothing, until the next answer or the next picture."""
        self.form.forget_answer()
        with self._folder:
            self.form.answer(Complaint(self.gui, order=COMPLAINTS), sentence, more=more)

    def refresh(self) -> Resettable | None:
        """Mark the controls that differ from the preset, and offer to reset them.

        Returns the control that was moved since the last call, if there is one.
        """
        changed = [control for control in self._controls if control.mark()]
        offered = tuple(control.name for control in changed) + (("all",) if len(changed) > 1 else ())
        if offered != self._offered:
            self._offered = offered
            self._row.visible = bool(offered)
            if offered:
                self._row.options = offered
        return next((control for control in self._controls if control.moved()), None)

    def reset_all(self) -> None:
        """Reset every control to the preset."""
        for control in self._controls:
            control.reset()

    def _reset(self, name: str) -> None:
        if self not in self.form.sections:  # it may have been removed since the press
            return
        for control in self._controls:
            if name in (control.name, "all"):
                control.reset()


@contextmanager
def complaining(*sections: Section) -> Iterator[None]:
    """Show an InvalidInputError in the section that it names, if that is one of these.

    The sections are given in the order in which they are checked: the complaints of those before it are cleared, and
    without an error those of all.
    """
    try:
        yield
    except InvalidInputError as refusal:
        if refusal.section in sections:
            for section in sections[: sections.index(refusal.section)]:
                section.complaint.clear()
            refusal.section.complaint.say(str(refusal.__cause__), text=refusal.text)
        raise
    for section in sections:
        section.complaint.clear()


class Form:
    """All sections of one visitor's docks, the queued actions, and the jobs."""

    def __init__(self, gui: viser.GuiApi, wake: Wake) -> None:
        self.gui, self.wake = gui, wake
        self.sections: list[Section] = []
        self._actions: deque[tuple[Action, bool]] = deque(maxlen=MAX_ACTIONS)
        self._last: Resettable | None = None
        self.actions_run = 0
        """How many actions have been run."""
        self._answer: Complaint | None = None
        self._jobs: list[Jobs] = []

    def new_jobs(self) -> Jobs:
        """A queue of jobs for one panel; `deliver` hands over its results together with those of the other queues."""
        jobs = Jobs(self.wake)
        self._jobs.append(jobs)
        return jobs

    def deliver(self) -> None:
        """Hand over the results of all finished jobs. Raises the error of a job, except an InvalidInputError."""
        for jobs in self._jobs:
            with suppress(InvalidInputError):
                jobs.deliver()

    def cancel_jobs(self) -> None:
        """Cancel all jobs, because the visitor has left."""
        for jobs in self._jobs:
            jobs.cancel()

    def do(self, action: Action, *, step: bool = True) -> None:
        """Queue an action for the session's loop; called from viser's threads. With `step` it can be undone."""
        self._actions.append((action, step))
        self.wake()

    def run_actions(self, before: Action = _nothing) -> bool:
        """Run the actions queued since the last call, the oldest first, and `before` before each of them.

        Returns whether one of them is a step to undo. An action that raises InvalidInputError has shown its complaint.
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
        """Update the marks and the reset rows of all sections."""
        for section in tuple(self.sections):
            self._last = section.refresh() or self._last

    def answer(self, place: Complaint, sentence: str, *, more: Sequence[str] = ()) -> None:
        """Show why a button did nothing, until `forget_answer`."""
        self._answer = place
        place.say(sentence, more=more)

    def forget_answer(self) -> None:
        """Remove the sentence that says why a button did nothing."""
        if self._answer is not None:
            self._answer.remove()
            self._answer = None

    def forget(self, controls: Sequence[Resettable]) -> None:
        """Forget controls that are no longer on the page."""
        if self._last in controls:
            self._last = None

    def reset_last(self) -> None:
        """Reset the control that was moved last."""
        if self._last is not None:
            self._last.reset()

    def reset_all(self) -> None:
        """Reset every control to the preset."""
        for section in tuple(self.sections):
            section.reset_all()

    def button(self, label: str, action: Action, *, hint: str, quiet: bool = False) -> viser.GuiButtonHandle:
        """A button whose action the session's loop runs; a `quiet` one is grey, for an action that is rarely wanted."""
        button = self.gui.add_button(label, hint=hint, color=QUIET if quiet else None)
        button.on_click(lambda _: self.do(action))
        return button

    def command(
        self,
        label: str,
        action: Action,
        *,
        key: HotkeyKey | None = None,
        modifier: KeyModifier | None = None,
    ) -> None:
        """A command of the Ctrl+K palette, with an optional hotkey."""
        self.gui.add_command(label, hotkey=key, modifier=modifier).on_trigger(lambda _: self.do(action))

    @property
    def waiting(self) -> bool:
        """Whether actions are queued."""
        return bool(self._actions)

    def buttons(self, label: str, actions: dict[str, Action], *, hint: str) -> viser.GuiButtonGroupHandle:
        """A row of small buttons, each with an action."""
        row = self.gui.add_button_group(label, tuple(actions), hint=hint)
        row.on_click(lambda event: self.do(actions.get(event.target.value, _nothing)))
        return row
