"""Undo and redo: a row of buttons, their keys, and the history of settings that they walk through."""

from collections.abc import Callable

from explorer.model.history import History
from explorer.model.settings import Settings
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.form import Form
from explorer.widgets.page import Page

HINT = "Ctrl+Z and Ctrl+Shift+Z, outside a text box. “reset all” puts every control back to the preset."


class UndoPanel:
    """The buttons; “reset all” stands in the same row."""

    def __init__(self, form: Form, history: History, page: Page, notify: Callable[[str, str], None]) -> None:
        """`notify` shows a title and a sentence for a few seconds."""
        self._history, self._page, self._notify = history, page, notify
        form.buttons("", {"↶ undo": self._undo, "↷ redo": self._redo, "reset all": form.reset_all}, hint=HINT)
        form.command("Undo", self._undo, key="Z", modifier="cmd/ctrl")
        form.command("Redo", self._redo, key="Z", modifier="cmd/ctrl+shift")
        form.command("Reset the last control", form.reset_last)
        form.command("Reset all controls", form.reset_all)

    def _undo(self) -> None:
        """One step back. Settings that are not in the history yet, because they are invalid or were chosen a moment
        ago, count as a step."""
        shown = self._history.now
        before = self._history.undo() if self._chosen() == shown else shown
        if before is not None:
            self._page.write(before)
        else:
            self._notify("Nothing to undo", "Steps are counted from when this page was opened or reloaded.")

    def _redo(self) -> None:
        after = self._history.redo()
        if after is not None:
            self._page.write(after)
        else:
            self._notify("Nothing to redo", "Nothing has been undone since the last change.")

    def _chosen(self) -> Settings | None:
        """What the controls say now, None if that is no valid input."""
        try:
            return self._page.read()
        except (InvalidInputError, ValueError):
            return None
