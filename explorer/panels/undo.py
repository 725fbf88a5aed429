"""Undo and redo, always in sight above the controls: buttons, their keys, and the history that they walk through."""

from collections.abc import Callable

from explorer.model.history import History
from explorer.model.settings import Settings
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.form import Action, Form
from explorer.widgets.page import Page

BUTTON = '<button type="button" class="rn-button {}" {} title="{}" aria-label="{}">{}</button>'
TOOLS = (
    ("", 'data-rn-event="undo"', "Undo (Ctrl+Z, outside a text box)", "Undo", "↶"),
    ("", 'data-rn-event="redo"', "Redo (Ctrl+Shift+Z)", "Redo", "↷"),
    ("", 'data-rn-event="link"', "Copies a link that opens what you see now", "Copy a link", "link"),
    ("", 'data-rn-event="reset"', "Puts every control back to the preset", "Reset all controls", "reset"),
    ("rn-switch", 'data-rn-flag="theme"', "Dark or light; at first as the system is", "Dark or light", "◐"),
    ("rn-switch", 'data-rn-flag="type"', "Big type, for a projector", "Big type", "A"),
    ("", 'data-rn-flag="sheet"', "More room for the controls, or for the scene", "Taller controls", "⌃"),
    ("", 'data-rn-flag="welcomed"', "What this page is, and what the picture shows", "Help", "?"),
)
"""Class, what it does, hint, name and face of each button."""


class UndoPanel:
    """The buttons; those for the look of the page and for help are in the same row."""

    def __init__(self, form: Form, history: History, page: Page, notify: Callable[[str, str], None]) -> None:
        """`notify` shows a title and a sentence for a few seconds."""
        self._history, self._page, self._notify = history, page, notify
        self.actions: dict[str, Action] = {"undo": self._undo, "redo": self._redo, "reset": form.reset_all}
        """What the buttons do, by the names that they send."""
        form.gui.add_html(f'<div class="rn-tools">{"".join(BUTTON.format(*tool) for tool in TOOLS)}</div>')
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
