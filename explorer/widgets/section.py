"""A section of the form: a folder of controls, below them a complaint and a row of buttons that reset the controls."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any

from explorer.model.glossary import in_labels
from explorer.web.elements import element_id
from explorer.web.in_order import in_order
from explorer.widgets.complaint import Complaint, InvalidInputError, reasons_of
from explorer.widgets.form import Form, Resettable

COMPLAINTS, RESETS = 1e6, 2e6
"""viser's order in a folder: below all controls, also below those added later."""
RESET_HINT = (
    "Puts back what was changed (•) to what the preset says. Ctrl+K has “Reset the last control”; Ctrl+Z undoes."
)


class Section:
    """A folder of controls; without a label it has no frame. Controls created in its `with` block are in the folder."""

    def __init__(
        self, form: Form, label: str | None = None, *, expanded: bool = True, order: float | None = None
    ) -> None:
        """order: viser's, of the folder among its neighbours; the last one by default."""
        self.form, self.gui, self.wake = form, form.gui, form.wake
        self._folder = self.gui.add_folder(label, expand_by_default=expanded, order=order)
        self._controls: list[Resettable] = []
        self._check: Callable[[], object] | None = None
        self._touched, self._said = True, ""
        with self._folder:
            self.complaint = Complaint(self.gui, order=COMPLAINTS)
            self._row = self.gui.add_button_group("reset", ("",), visible=False, order=RESETS, hint=RESET_HINT)
        self._offered: tuple[str, ...] = ()
        self._row.on_click(in_order(lambda event: form.do(partial(self._reset, event.target.value))))
        form.sections.append(self)

    def __enter__(self) -> "Section":
        self._folder.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        self._folder.__exit__(*error)

    def add(self, control: Resettable) -> None:
        """Register a control of this section; the control calls this in its constructor."""
        self._controls.append(control)
        self.touch()

    def touch(self) -> None:
        """Note that a control has changed; called also from viser's threads, after the change and before the wake."""
        self._touched = True
        self.form.touch(self)

    def caption(self, label: str) -> None:
        """Change the label."""
        if label != self._folder.label:  # so that an unchanged label sends no message
            self._folder.label = label

    @property
    def controls(self) -> tuple[Resettable, ...]:
        """The controls, in the order in which they were created."""
        return tuple(self._controls)

    def boxes_named(self, reason: BaseException | None) -> list[str]:
        """The ids of the text boxes of the controls that the reasons begin with, or are compared with."""
        found: list[str] = []
        for sentence in map(in_labels, reasons_of(reason)):
            for one in self._controls:
                name = one.name.partition(" (")[0]
                if sentence.startswith(name) or f"than {name}" in sentence:
                    found += [element_id(box) for box in one.boxes]
        return found

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

    def check(self, read: Callable[[], object]) -> None:
        """Have what the controls hold checked as soon as one is moved, where nothing but a button reads them. `read`
        raises ValueError with the reason, which is shown here."""
        self._check = read

    @contextmanager
    def checking(self, text: str = "") -> Iterator[None]:
        """Turn a ValueError into an InvalidInputError that names this section; the page stays as it is."""
        try:
            yield
        except ValueError as error:
            raise InvalidInputError(self.complaint, text) from error

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
            first, *more = reasons_of(error)
            self.answer(first, more=more)
            raise InvalidInputError from error

    def answer(self, sentence: str, *, more: Sequence[str] = ()) -> None:
        """Say here why a button did nothing, until the next answer or the next picture; what is said already is not
        said twice."""
        self.form.forget_answer()
        if self.complaint.says(sentence):
            return
        with self._folder:
            self.form.answer(Complaint(self.gui, order=COMPLAINTS), sentence, more=more)

    def refresh(self) -> Resettable | None:
        """Mark the controls that differ from the preset, and offer to reset them, after a change of a control or of the
        complaint: a slider follows its box only when nobody complains about the box any more.

        Returns the control that was moved since the last call, if there is one.
        """
        said = self.complaint.content
        if not self._touched and said == self._said:
            return None
        touched, self._touched, self._said = self._touched, False, said  # before reading, so that no change is lost
        if touched and self._check is not None:  # the refusal of a job stays: its section's values are as they were
            with suppress(InvalidInputError), self.catching():
                self._check()
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
    """Show an InvalidInputError in the section whose complaint it names, if that is one of these.

    The sections are given in the order in which they are checked: the complaints of those before it are cleared, and
    without an error those of all.
    """
    complaints = [section.complaint for section in sections]
    try:
        yield
    except InvalidInputError as refusal:
        if refusal.complaint in complaints:
            for complaint in complaints[: complaints.index(refusal.complaint)]:
                complaint.clear()
            section = sections[complaints.index(refusal.complaint)]
            cause = refusal.__cause__
            first, *more = reasons_of(cause)
            refusal.complaint.say(first, text=refusal.text, more=more, boxes=section.boxes_named(cause))
            section.form.forget_repeated(first)
        raise
    for complaint in complaints:
        complaint.clear()
