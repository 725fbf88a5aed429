"""What the browser has of the Learn tab: its text, the strip over the scene, and the box for a predicted number."""

from collections.abc import Callable, Sequence

import viser

from explorer.panels.learn import markup
from explorer.panels.learn.judge import Judge
from explorer.panels.learn.open_lesson import OpenLesson
from explorer.panels.learn.screen_figures import ScreenFigures
from explorer.widgets.form import Form

NUMBER_HINT = "A number, such as 0.5. It is committed by the button below, and stays."
COMMIT_HINT = "A committed prediction stays."


class Elements:
    """The elements of the page that the player of a lesson writes; each is sent only when it changes."""

    def __init__(self, form: Form, strip: viser.GuiHtmlHandle, commit: Callable[[str], None]) -> None:
        """`strip` lies over the scene. `commit` is called with the text of the box when its button is pressed."""
        self._block, self._strip = form.gui.add_html(""), strip
        self._number = form.gui.add_text("your prediction", "", visible=False, hint=NUMBER_HINT)
        self._commit = form.button("Commit", lambda: commit(self._number.value), hint=COMMIT_HINT)
        self._commit.visible = False

    @property
    def content(self) -> str:
        """The text of the tab, as HTML."""
        return self._block.content

    def show(
        self,
        where: OpenLesson,
        judge: Judge,
        figures: ScreenFigures,
        *,
        said: str,
        guide: Sequence[Sequence[str]] | None,
    ) -> None:
        """Show the list of lessons or the open screen, with the figures that are known.

        said: what "show me" is doing, or why a prediction was not taken. guide: for the teacher; None for a student of
        a class."""
        figures.begin()
        lesson, strip = where.lesson, ""
        if lesson is None:
            content = markup.course_list(where.course, where.learning, guide)
        else:
            shown = markup.Shown(
                learning=where.learning,
                states=judge.states(lesson, where.answers),
                read=figures.read,
                outcome=judge.outcome,
                said=said,
                waits=where.answer_waits,
                last=where.following is None,
            )
            content = markup.screen(lesson, shown)
            strip = markup.strip(lesson, judge.outcome) if where.kind in ("task", "outcome") else ""
        self._write(content, strip, asks_number=where.asks_number)

    def _write(self, content: str, strip: str, *, asks_number: bool) -> None:
        """Write the texts of tab and strip (HTML), and show the box if a number is asked for."""
        if asks_number and not self._number.visible:
            self._number.value = ""  # what was typed in another lesson is no answer here
        for handle in (self._number, self._commit):
            if handle.visible != asks_number:
                handle.visible = asks_number
        for handle, text in ((self._strip, strip), (self._block, content)):
            if text != handle.content:
                handle.content = text
