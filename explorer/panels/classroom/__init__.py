"""The Class tab, which only the teacher has: how students come in, who is in, and how the class ends."""

import html
from functools import partial

from explorer.panels.session_actions import SessionActions
from explorer.web.access.entrance import Entrance
from explorer.web.access.invitation import qr_svg
from explorer.web.access.names import name_of
from explorer.web.access.visitors import Role
from explorer.widgets.form import Form
from explorer.widgets.html import NOTE, table
from explorer.widgets.section import Section

CODE_HINT = "Replaces the code and the students' link. Who is on the page stays; who comes later needs the new ones."
END_HINT = "Sends every student out and replaces the code and the link. What students saved in their browsers stays."
OUT_HINT = "Disconnects this student's tabs. Give a new code, too, or the student can come back with the old one."
INVITATION = (
    '<div style="padding:0 .9em .5em;text-align:center">'
    '<div style="font:700 2.4em/1.3 ui-monospace,monospace;letter-spacing:.08em">{code}</div>'
    "<div>at <b>{page}</b></div>"
    '<div style="margin:.6em auto;max-width:260px" role="img" aria-label="The students’ link as a QR code">{qr}</div>'
    '<details><summary>The link in the picture</summary><code style="overflow-wrap:anywhere">{link}</code></details>'
    "</div>"
)
GUESSED = "The code was guessed at {count} times too often, and was replaced each time. The link is safe from guessing."
NOBODY = "No student is on the page yet."


class ClassPanel:
    """The invitation, the list of students, and what the teacher can do."""

    def __init__(self, form: Form, entrance: Entrance, page: str, session_actions: SessionActions) -> None:
        """page: the page's address, as students type it."""
        self._form, self._entrance, self._page = form, entrance, page
        self._notify = session_actions.notify
        self._shown: object = None
        with Section(form, "Students come in"):
            self._invitation = form.gui.add_html("")
            form.button("New code and link", self._renew, hint=CODE_HINT, quiet=True)
        self._section = Section(form, "On the page")
        with self._section:
            self._list = form.gui.add_html("")
            self._out = Section(form)
        with Section(form):
            form.button("End the class", self._end, hint=END_HINT, quiet=True)

    def refresh(self) -> None:
        """Show who is in now, and the code that is valid now."""
        entrance = self._entrance
        students = {number: tabs for number, tabs in entrance.inside.items() if entrance.is_student(number)}
        shown = entrance.code, entrance.code_was_guessed_at, tuple(sorted(students.items()))
        if shown == self._shown:
            return
        self._shown = shown
        self._show_invitation()
        self._show_students(students)

    def _show_invitation(self) -> None:
        entrance = self._entrance
        link = entrance.link(Role.STUDENT, self._page)
        text = INVITATION.format(
            code=entrance.code, page=html.escape(self._page), qr=qr_svg(link), link=html.escape(link)
        )
        guessed = entrance.code_was_guessed_at
        self._invitation.content = text + (NOTE.format(GUESSED.format(count=guessed)) if guessed else "")

    def _show_students(self, students: dict[int, int]) -> None:
        self._section.caption(f"On the page: {len(students)} of {self._entrance.places} places")
        rows = [(name_of(number), f"{tabs} tabs" if tabs > 1 else "") for number, tabs in sorted(students.items())]
        self._list.content = NOTE.format(table((), rows) if rows else NOBODY)
        self._out.remove()
        with self._section:
            self._out = Section(self._form)
        with self._out:
            for number in sorted(students):
                label = f"Send {name_of(number)} out"
                self._form.button(label, partial(self._send_out, number), hint=OUT_HINT, quiet=True)

    def _renew(self) -> None:
        self._entrance.renew()
        self.refresh()

    def _send_out(self, number: int) -> None:
        self._entrance.remove(number)
        self._notify("Sent out", f"{name_of(number)} is no longer on the page.")
        self.refresh()

    def _end(self) -> None:
        self._entrance.end_class()
        self._notify("The class is over", "All students are out; a new code and a new link are ready.")
        self.refresh()
