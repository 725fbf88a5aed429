"""The form: all sections of controls on one visitor's page, the queue of what buttons do, and the jobs.

viser's threads      a control was moved: wake()                  nothing else
viser's event loop   a button was pressed: do(action)             nothing else, in the order of the presses
session's loop       run_actions(), deliver(), refresh()
"""

from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Protocol

import viser
from viser._messages import HotkeyKey, KeyModifier

from explorer.model import palette
from explorer.model.jobs import Job, Jobs
from explorer.model.turns import Places, Share
from explorer.web.in_order import in_order
from explorer.widgets.complaint import Complaint, InvalidInputError

Wake = Callable[[], None]
"""Called from viser's threads; it may do nothing but set an event."""
Action = Callable[[], None]
"""What a button does; the session's loop runs it."""
MAX_ACTIONS = 64
"""Actions queued while the session is busy; beyond that the oldest are dropped."""
QUIET = palette.rgb(palette.QUIET_BUTTON)


def _nothing() -> None:
    """Do nothing: the action of a button that does not exist but that a browser reports as pressed."""


class Resettable(Protocol):
    """The part of a control that a section uses."""

    name: str

    @property
    def boxes(self) -> tuple[viser.GuiTextHandle, ...]: ...
    def mark(self) -> bool: ...
    def reset(self) -> None: ...
    def moved(self) -> bool: ...


class FormSection(Protocol):
    """What the form knows of its sections, which are made after it: see `explorer.widgets.section`."""

    complaint: Complaint

    @property
    def controls(self) -> tuple[Resettable, ...]: ...
    @property
    def visible(self) -> bool: ...
    @property
    def label(self) -> str | None: ...
    def refresh(self) -> Resettable | None: ...
    def reset_all(self) -> None: ...


class Progress(Protocol):
    """The part that the form uses of the progress of a panel's work: see `explorer.widgets.progress`."""

    away: bool

    @property
    def running(self) -> Job | None: ...
    def draw(self) -> None: ...
    def stop(self) -> None: ...


class Form:
    """All sections of one visitor's docks, the queued actions, and the queues of jobs."""

    def __init__(self, gui: viser.GuiApi, wake: Wake, share: Share | None = None, visitor: int = 0) -> None:
        """share: the visitor's share of the server's places for long work; None for places of the form's own.
        visitor: the number of the visitor in a class; 0 at this machine's own page."""
        self.visitor = visitor
        self.gui, self.wake, self._share = gui, wake, share or Places().share()
        self.sections: list[FormSection] = []
        self.progress: list[Progress] = []
        """The progress of the work of each panel."""
        self.hints: dict[str, str] = {}
        """The hints of all buttons, by their labels."""
        self.away = False
        """Whether the action that runs comes from a button that is not in its panel, or from the palette."""
        self._actions: deque[tuple[Action, bool, bool]] = deque(maxlen=MAX_ACTIONS)
        self._last: Resettable | None = None
        self._touched: deque[FormSection] = deque()
        self._all_touched = True
        self.actions_run = 0
        """How many actions have been run."""
        self._answer: Complaint | None = None
        self._jobs: list[Jobs] = []

    def new_jobs(self) -> Jobs:
        """A queue of jobs for one panel; `deliver` hands over its results together with those of the other queues."""
        jobs = Jobs(self.wake, self._share)
        self._jobs.append(jobs)
        return jobs

    def deliver(self) -> None:
        """Hand over the results of all finished jobs. Raises the error of a job, except an InvalidInputError."""
        for jobs in self._jobs:
            if jobs.running is not None:
                self.touch()
            with suppress(InvalidInputError):
                jobs.deliver()

    @property
    def works(self) -> bool:
        """Whether a job with a progress bar runs."""
        return any(panel.running is not None for panel in self.progress)

    def cancel_jobs(self) -> None:
        """Cancel all jobs, because the visitor has left."""
        for jobs in self._jobs:
            jobs.cancel()

    def touch(self, section: FormSection | None = None) -> None:
        """Note that a control of a section has changed; without a section, that anything may have changed."""
        if section is None:
            self._all_touched = True
        else:
            self._touched.append(section)

    def take_touched(self) -> frozenset[FormSection] | None:
        """The sections whose controls have changed since the last call; None if anything may have changed."""
        everything, self._all_touched = self._all_touched, False
        sections = frozenset(self._touched.popleft() for _ in range(len(self._touched)))
        return None if everything else sections

    def do(self, action: Action, *, step: bool = True, away: bool = False) -> None:
        """Queue an action for the session's loop; called from viser's threads. step: whether undo takes the action
        back. away: whether its button is in another panel than the one that acts."""
        self._actions.append((action, step, away))
        self.wake()

    def run_actions(self, before: Action = _nothing) -> bool:
        """Run the actions queued since the last call, the oldest first, and `before` before each of them.

        Returns whether one of them is a step to undo. An action that raises InvalidInputError has shown its complaint.
        """
        count, stepped = len(self._actions), False
        for _ in range(count):
            action, step, self.away = self._actions.popleft()
            self.touch()
            stepped = stepped or step
            with suppress(InvalidInputError):
                before()
            with suppress(InvalidInputError):
                action()
            self.touch()
        self.away = False
        self.actions_run += count
        return stepped

    def draw_progress(self) -> Job | None:
        """Show the progress of all panels' work. Returns the job that was begun by a button elsewhere, if one runs."""
        for panel in self.progress:
            panel.draw()
        return next((panel.running for panel in self.progress if panel.away and panel.running is not None), None)

    def stop_progress(self) -> None:
        """Stop the work that was begun by a button elsewhere."""
        for panel in self.progress:
            if panel.away:
                panel.stop()

    def refresh(self) -> None:
        """Update the marks and the reset rows of all sections."""
        for section in tuple(self.sections):
            self._last = section.refresh() or self._last

    def answer(self, place: Complaint, sentence: str, *, more: Sequence[str] = ()) -> None:
        """Show why a button did nothing, until `forget_answer`."""
        self._answer = place
        place.say(sentence, more=more)

    def forget_repeated(self, sentence: str) -> None:
        """Remove the answer if it is a sentence that is shown below controls by now."""
        if self._answer is not None and self._answer.says(sentence):
            self.forget_answer()

    def forget_answer(self) -> None:
        """Remove the sentence that says why a button did nothing."""
        if self._answer is not None:
            self._answer.remove()
            self._answer = None

    def forget(self, controls: Sequence[Resettable]) -> None:
        """Forget controls that are no longer on the page."""
        if self._last in controls:
            self._last = None

    @property
    def last_moved(self) -> str:
        """The label of the control that was moved last; empty if none was."""
        return "" if self._last is None else self._last.name

    def reset_last(self) -> None:
        """Reset the control that was moved last."""
        if self._last is not None:
            self._last.reset()

    def reset_all(self) -> None:
        """Reset every control to the preset."""
        for section in tuple(self.sections):
            section.reset_all()

    def button(
        self, label: str, action: Action, *, hint: str, quiet: bool = False, away: bool = False
    ) -> viser.GuiButtonHandle:
        """A button whose action the session's loop runs; a `quiet` one is grey, for an action that is rarely wanted.

        `away`: whether another panel acts."""
        self.hints[label] = hint
        button = self.gui.add_button(label, hint=hint, color=QUIET if quiet else None)
        button.on_click(in_order(lambda _: self.do(action, away=away)))
        return button

    def when_moved(self, handle: viser.GuiInputHandle, action: Action) -> None:
        """Queue an action whenever the visitor moves a control, before that of a button that is pressed next."""
        moved = in_order(lambda event: self.do(action, step=False) if event.client_id is not None else None)
        handle.on_update(moved)

    def command(
        self,
        label: str,
        action: Action,
        *,
        key: HotkeyKey | None = None,
        modifier: KeyModifier | None = None,
        step: bool = True,
    ) -> None:
        """A command of the Ctrl+K palette, with an optional hotkey. step: whether undo takes it back."""
        command = self.gui.add_command(label, hotkey=key, modifier=modifier)
        command.on_trigger(in_order(lambda _: self.do(action, step=step, away=True)))

    @property
    def waiting(self) -> bool:
        """Whether actions are queued."""
        return bool(self._actions)

    def buttons(self, label: str, actions: dict[str, Action], *, hint: str) -> viser.GuiButtonGroupHandle:
        """A row of small buttons, each with an action."""
        self.hints[label] = hint
        row = self.gui.add_button_group(label, tuple(actions), hint=hint)
        row.on_click(in_order(lambda event: self.do(actions.get(event.target.value, _nothing))))
        return row
