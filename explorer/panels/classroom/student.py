"""What a student sees of the class: a bar over the scene while the teacher presents, and the own name."""

from contextlib import suppress

import viser

from explorer.model.classroom import chosen_name
from explorer.web.accessibility import spoken
from explorer.web.connection import run_script
from explorer.web.elements import of_kind
from explorer.widgets.controls import Text
from explorer.widgets.form import Form
from explorer.widgets.section import Section

NAME = "your name"
NAME_HINT = "Only your teacher sees it, with where you are in the lessons and what you predicted, until the class ends."
BUTTON = '<button type="button" class="rn-button {}" data-rn-event="class-{}">{}</button>'
BAR = '<div class="rn-class" {}><span>{}</span>{}</div>'
FROZEN = BAR.format(
    spoken("class", "Eyes on the teacher. Your page follows."),
    "<b>Eyes on the teacher.</b> Your page follows; your own work comes back afterwards.",
    "",
)
FOLLOWING = BAR.format(
    spoken("class", "You follow the teacher."),
    "You follow the teacher.",
    BUTTON.format("", "copy", "Work on a copy") + BUTTON.format("", "back", "Back to my work"),
)
COPIED = BAR.format(
    spoken("class", "You work on a copy."),
    "You work on a copy.",
    BUTTON.format("rn-main", "follow", "Follow") + BUTTON.format("", "back", "Back to my work"),
)
PRESENTED = BAR.format(
    spoken("class", "The teacher presents."), "The teacher presents.", BUTTON.format("rn-main", "follow", "Follow")
)
MAX_TYPED = 80


class StudentPanel:
    """The bar, and the box for the name."""

    def __init__(self, form: Form, client: viser.ClientHandle, bar: viser.GuiHtmlHandle, name: str) -> None:
        """bar lies outside all tabs. name: what the student is called before choosing a name."""
        self._client, self._bar, self._given = client, bar, name
        self._held = False
        section = Section(form, "You in this class")
        with section:
            with of_kind("rn-free-"):
                self._name = Text(section, NAME, hint=NAME_HINT, longest=MAX_TYPED)
            self._name.show(name)
            section.check(self._chosen)

    @property
    def name(self) -> str:
        """The chosen name; an empty or a wrong one leaves the one that was given."""
        with suppress(ValueError):
            return self._chosen()
        return self._given

    def draw(self, *, presented: bool, following: bool, frozen: bool, copied: bool) -> None:
        """Show whether the page follows, and what the student can do about it. copied: whether a copy of what the
        teacher showed lies over the student's own work."""
        leave = COPIED if copied else PRESENTED
        content = FROZEN if frozen else FOLLOWING if following else leave if presented else ""
        if content != self._bar.content:
            self._bar.content = content
        if following != self._held:
            self._held = following
            run_script(self._client, f"document.documentElement.classList.toggle('rn-held', {str(following).lower()})")

    def _chosen(self) -> str:
        return chosen_name(self._name.read()) or self._given
