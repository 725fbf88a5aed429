"""The Class tab, which only the teacher has: how students come in, what all see, who is where, and the end."""

import html
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import viser

from explorer.model.classroom import Classroom
from explorer.panels.classroom.board import BoardPanel
from explorer.storage.bundle import Send
from explorer.web.access.entrance import Entrance
from explorer.web.access.invitation import qr_svg
from explorer.web.access.names import name_of
from explorer.web.access.visitors import Role
from explorer.web.accessibility import spoken
from explorer.widgets.form import Action, Form
from explorer.widgets.html import NOTE
from explorer.widgets.page import Page
from explorer.widgets.section import Section

CODE_HINT = "Replaces the code and the students' link. Who is on the page stays; who comes later needs the new ones."
END_HINT = "Sends every student out, forgets names, predictions and students' presets, and makes a new code and link."
OUT_HINT = "Disconnects this student's tabs. Make a new code, too, or the student can come back with the old one."
PRESENT_HINT = "Every student's page follows yours: settings, time, camera, the control moved last. Their work waits."
FREEZE_HINT = "Nobody can leave your presentation until you release it."
SEND_HINT = "Opens on every student's page what yours shows, as a step that undo takes back."
PRESENT, PRESENTED, FREEZE, RELEASE = "Present my page", "End the presentation", "Eyes on me", "Release all"
INVITATION = (
    '<div style="padding:0 .9em .5em;text-align:center">'
    '<div style="font:700 2.4em/1.3 ui-monospace,monospace;letter-spacing:.08em">{code}</div>'
    "<div>at <b>{page}</b></div>"
    '<button type="button" class="rn-button rn-main" data-rn-flag="invite">Show it large</button>'
    '<div style="margin:.6em auto;max-width:260px" role="img" aria-label="The students’ link as a QR code">{qr}</div>'
    '<details><summary>The link in the picture</summary><code style="overflow-wrap:anywhere">{link}</code></details>'
    "</div>"
)
CARD = (
    '<div class="rn-card rn-invite" role="dialog" aria-label="The way into the class">'
    '<button type="button" class="rn-button" data-rn-flag="invite" aria-label="Close">✕</button>'
    "<p>Open <b>{page}</b> and type</p><b>{code}</b>"
    '<div role="img" aria-label="The students’ link as a QR code">{qr}</div></div>'
)
PRESENTS = (
    '<div class="rn-class" {said}><span><b>You present.</b> {count}</span>'
    '<button type="button" class="rn-button" data-rn-event="class-end">End</button></div>'
)
REALLY = (
    "All students are sent out. Names, predictions and the presets that students have saved are deleted. "
    "*Results as CSV*, above, keeps names and predictions."
)
GUESSED = "The code was guessed at {count} times too often, and was replaced each time. The link is safe from guessing."


@dataclass(frozen=True, kw_only=True)
class ClassActions:
    """What only the session can do."""

    present: Callable[[bool], None]
    """Begins or ends the presentation of this page."""
    notify: Callable[[str, str], None]
    send: Send
    """Downloads a file: its name and its content."""
    forget: Action
    """Deletes the presets that students have saved."""


@dataclass(frozen=True, kw_only=True)
class OverScene:
    """What lies over the scene, outside all tabs."""

    bar: viser.GuiHtmlHandle
    """Says that the page is presented."""
    card: viser.GuiHtmlHandle
    """The code and the QR code for the projector."""
    predictions: viser.GuiHtmlHandle
    """The predictions in the chosen lesson for the projector."""


class ClassPanel:
    """The invitation, the presentation, the board, and the end of the class."""

    def __init__(
        self,
        form: Form,
        page: Page,
        entrance: Entrance,
        classroom: Classroom,
        actions: ClassActions,
        over_scene: OverScene,
        *,
        address: str,
        lessons: Mapping[int, str],
    ) -> None:
        """address: the page's, as students type it. lessons: titles by numbers."""
        self._form, self._page, self._entrance, self._classroom = form, page, entrance, classroom
        self._actions, self._address, self._over = actions, address, over_scene
        self._invited: object = None
        self._students: tuple[int, ...] | None = None
        with Section(form, "Students come in"):
            self._invitation = form.gui.add_html("")
            form.button("New code and link", self._renew, hint=CODE_HINT, quiet=True)
        with Section(form, "All see"):
            self._present = form.button(PRESENT, self._toggle_presentation, hint=PRESENT_HINT)
            self._freeze = form.button(FREEZE, self._toggle_freeze, hint=FREEZE_HINT, quiet=True)
            form.button("Send what I see to all", self._send_state, hint=SEND_HINT, quiet=True)
        self._board = BoardPanel(form, classroom, lessons, self._open_lesson, actions.send, over_scene.predictions)
        with self._board.students:
            self._removal = Section(form, "Send out", expanded=False)
        with self._removal:
            self._out = Section(form)
        with Section(form):
            self._to_end = form.button("End the class", self._ask_to_end, hint=END_HINT, quiet=True)
            self._asked = (
                form.gui.add_markdown(REALLY, visible=False),
                form.button("End it now", self._end, hint=END_HINT),
                form.button("Go on with the class", self._keep, hint="Nothing happens.", quiet=True),
            )
        self._keep()

    def refresh(self) -> None:
        """Show what is true now: the code, who is in, whether all follow."""
        entrance = self._entrance
        inside = {number: tabs for number, tabs in entrance.inside.items() if entrance.is_student(number)}
        self._show_invitation()
        self._show_state(len(inside))
        self._board.draw(inside, entrance.places)
        self._show_removal(tuple(sorted(inside)))

    @property
    def actions(self) -> dict[str, Action]:
        """What the button of the bar does, by the name that it sends."""
        return {"class-end": lambda: self._actions.present(False)}

    def _show_state(self, students: int) -> None:
        state = self._classroom.state
        bar = "" if state.shown is None else self._presents(students)
        if bar != self._over.bar.content:
            self._over.bar.content = bar
        for button, label in (
            (self._present, PRESENTED if state.shown is not None else PRESENT),
            (self._freeze, RELEASE if state.frozen else FREEZE),
        ):
            if button.label != label:
                button.label = label

    def _presents(self, students: int) -> str:
        if self._classroom.state.frozen:
            count = "Eyes on you: nobody can leave."
            return PRESENTS.format(said=spoken("class", f"You present. {count}"), count=count)
        following = sum(member.following for member in self._classroom.members.values())
        count = "Nobody is on the page yet." if students == 0 else f"{following} of {students} follow."
        return PRESENTS.format(said=spoken("class", f"You present. {count}"), count=count)

    def _show_invitation(self) -> None:
        entrance = self._entrance
        link, guessed = entrance.link(Role.STUDENT, self._address), entrance.code_was_guessed_at
        if (link, entrance.code, guessed) == self._invited:
            return
        self._invited = link, entrance.code, guessed
        text = INVITATION.format(
            code=entrance.code, page=html.escape(self._address), qr=qr_svg(link), link=html.escape(link)
        )
        large = qr_svg(link, scale=None)
        self._over.card.content = CARD.format(code=entrance.code, page=html.escape(self._address), qr=large)
        self._invitation.content = text + (NOTE.format(GUESSED.format(count=guessed)) if guessed else "")

    def _show_removal(self, students: tuple[int, ...]) -> None:
        if students == self._students:
            return
        self._students = students
        self._out.remove()
        with self._removal:
            self._out = Section(self._form)
        with self._out:
            for number in students:
                send_out: Action = partial(self._send_out, number)
                self._form.button(f"Send {self._name(number)} out", send_out, hint=OUT_HINT, quiet=True)

    def _name(self, number: int) -> str:
        member = self._classroom.members.get(number)
        return name_of(number) if member is None else member.name

    def _toggle_presentation(self) -> None:
        self._actions.present(self._classroom.state.shown is None)

    def _toggle_freeze(self) -> None:
        state = self._classroom.state
        if state.shown is None:
            self._actions.present(True)
        self._classroom.freeze(not state.frozen)

    def _send_state(self) -> None:
        self._classroom.send(settings=self._page.read())
        self._actions.notify("Sent to all", "Every student's page opens what yours shows, as a step of its own.")

    def _open_lesson(self, number: int) -> None:
        """Open a lesson on every student's page, and end the presentation: a page that follows cannot work on a
        lesson."""
        self._actions.present(False)
        self._classroom.send(lesson=number)

    def _renew(self) -> None:
        self._entrance.renew()
        self._actions.notify("A new code and a new link", "Nobody comes in with the old ones. Who is in stays in.")

    def _send_out(self, number: int) -> None:
        name = self._name(number)
        self._entrance.remove(number)
        self._classroom.forget(number)
        self._actions.notify("Sent out", f"{name} is no longer on the page.")

    def _ask_to_end(self) -> None:
        self._show_question(asked=True)

    def _keep(self) -> None:
        self._show_question(asked=False)

    def _show_question(self, *, asked: bool) -> None:
        self._to_end.visible = not asked
        for part in self._asked:
            part.visible = asked

    def _end(self) -> None:
        self._keep()
        self._actions.present(False)
        self._entrance.end_class()
        self._classroom.clear()
        self._actions.forget()
        self._actions.notify("The class is over", "All students are out; a new code and a new link are ready.")
