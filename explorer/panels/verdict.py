"""The verdict as one line over the scene: sign, word, the number that decides, what is wanted, and one action.

The line unfolds to the five answers of `explorer.model.assessment`, and these to all figures. While it is folded and
something moves, the line alone is written. Its buttons are the page's own HTML: the session hands the names that they
send to `act`.
"""

import html
from collections.abc import Sequence

import viser

from explorer.model import assessment, glossary, palette
from explorer.model.assessment import Answer, Cure
from explorer.model.compute import Picture
from explorer.model.jobs import Job
from explorer.panels import figures
from explorer.widgets.answer import AnswerButton
from explorer.widgets.complaint import Complaint
from explorer.widgets.form import Action
from explorer.widgets.html import escaped
from explorer.widgets.progress import STOP_HINT

CURES: dict[Cure, tuple[str, str]] = {
    "repair": ("make it observable", "Looks for a small change of the motion that meets the requirement."),
    "tune": ("tune the observer", "Looks for gains with which the estimate settles sooner and errs less."),
    "slow down": ("fly it slower", "Flies the same path slower, so that it keeps the limits of the vehicle."),
    "model": ("use the derived model", "Switches off the paper's misprinted model."),
    "effects": ("switch them off", "Switches off the biases, outliers and drop-outs that the observer does not model."),
    "vehicle": ("choose a vehicle", "Opens the list of vehicles."),
}
"""Label and hint of the button that cures what is wrong."""
UNFOLD = '<button type="button" class="rn-button rn-unfold" data-rn-flag="unfolded" aria-label="All answers"></button>'
BUTTON = '<button type="button" class="rn-button {}" data-rn-event="{}" title="{}">{}</button>'
DIMMED = f"color:{palette.SECONDARY_TEXT}"
WAIT = f'<span style="{DIMMED}">Follows in a moment.</span>'
"""In place of the answers, in a browser that does not show them."""


STOP = AnswerButton(event="stop", label="Stop", hint=STOP_HINT)


class VerdictPanel:
    """The line; below it what is running, or why nothing is shown; and the answers."""

    def __init__(self, gui: viser.GuiApi, cures: dict[Cure, Action]) -> None:
        """`cures` are the actions that are offered."""
        self._cures = cures
        self._folded = False
        self._shown: Picture | None = None
        self._block = gui.add_html("")
        self._progress = gui.add_html("", visible=False)
        self._buttons = gui.add_html("", visible=False)
        gui.add_html('<span class="rn-complaint"></span>')
        self.complaint = Complaint(gui)

    @property
    def actions(self) -> dict[str, Action]:
        """What the buttons do, by the name that they send."""
        return {_event(cure): action for cure, action in self._cures.items()}

    def progress(self, fraction: float, stage: str) -> None:
        """Show the progress of compilation; at 1 it is hidden."""
        name = f"Compiling the observers (once per machine): {stage}"
        self._show_progress(_progress_bar(name, fraction) if fraction < 1 else "", ())

    def draw_progress(self, job: Job | None, outcome: str, answers: Sequence[AnswerButton]) -> None:
        """Show the progress of work that was begun here or by the palette, or the outcome of the last search with its
        buttons."""
        if job is not None:
            self._show_progress(_progress_bar(f"Working: {job.name}", job.fraction), (STOP,))
        elif outcome:
            text = f'<div class="rn-progress rn-outcome" role="status">{escaped(outcome)}</div>'
            self._show_progress(text, answers)
        else:
            self._show_progress("", ())

    def draw(self, picture: Picture) -> None:
        """Show the verdict on a picture; ≈ marks a number of the sampled windows, until that of all windows is
        known."""
        self._shown, given = picture, assessment.answers(picture)
        moving = picture.analysis.proof is None
        rows = f'<div class="rn-rows">{WAIT if self._folded and moving else self._rows(picture, given)}</div>'
        content = f'<div class="rn-verdict">{self._line(picture, given)}{rows}</div>'
        if content != self._block.content:
            self._block.content = content

    def fold(self, folded: bool) -> None:
        """Note whether the browser shows the line alone; the answers are written once it shows them, too."""
        opened, self._folded = self._folded and not folded, folded
        if opened and self._shown is not None:
            self.draw(self._shown)

    def _line(self, picture: Picture, given: tuple[Answer, ...]) -> str:
        sign, color = assessment.SIGNS[assessment.level(given)]
        deciding = assessment.decisive(given)
        head = f'<b style="color:{color}">{sign} {figures.about(picture)}{picture.analysis.verdict.word}</b>'
        cure = self._button(picture, deciding.cure)
        summary = escaped(deciding.summary)
        text = f'<span class="rn-deciding" title="{summary}">{summary}{figures.chips(picture)}</span>'
        return f'<div class="rn-line" role="group" aria-label="Verdict">{head}{text}{cure}{UNFOLD}</div>'

    def _button(self, picture: Picture, cure: Cure | None) -> str:
        """The button of a cure as HTML; empty where there is none."""
        if cure not in self._cures:
            return ""
        assert cure is not None
        label, hint = CURES[cure]
        if cure == "slow down" and picture.slower:
            label = f"fly it {picture.slower:g}× slower"
        return BUTTON.format("rn-main", _event(cure), html.escape(hint), label)

    def _rows(self, picture: Picture, given: tuple[Answer, ...]) -> str:
        """The answers, each cure once, and folded below them all figures."""
        lines, offered = [], set[Cure | None]()
        for answer in given:
            sign, color = assessment.SIGNS[answer.level]
            hint = html.escape(glossary.hint(answer.term)) if answer.term in glossary.TERMS else ""
            mark = f'<b style="color:{color}">{sign}</b>'
            question = f'<span title="{hint}">{mark} {assessment.QUESTIONS[answer.question]}</span>'
            text = "<br>".join(escaped(part) for part in (answer.summary, *answer.remarks))
            button = "" if answer.cure in offered else self._button(picture, answer.cure)
            offered.add(answer.cure)
            lines.append(f"<tr><td>{question}</td><td>{text} {button}</td></tr>")
        subject = f'<div style="{DIMMED}">{html.escape(assessment.subject_of(picture))}</div>'
        folded = f"<details><summary>all figures</summary>{figures.table(picture)}</details>"
        return f"{subject}<table>{''.join(lines)}</table>{folded}"

    def _show_progress(self, content: str, answers: Sequence[AnswerButton]) -> None:
        """Show a strip below the line. Its buttons are an element of their own, which stays while the bar moves: a
        button that is replaced under the mouse cannot be pressed."""
        buttons = f'<div class="rn-answers">{"".join(_answer(one) for one in answers)}</div>' if answers else ""
        for handle, text in ((self._progress, content), (self._buttons, buttons)):
            if text != (handle.content if handle.visible else ""):
                handle.visible = bool(text)
                if text:
                    handle.content = text


def _event(cure: Cure) -> str:
    return f"cure-{cure.replace(' ', '-')}"


def _answer(one: AnswerButton) -> str:
    return BUTTON.format("rn-main" if one.main else "", one.event, html.escape(one.hint), html.escape(one.label))


def _progress_bar(name: str, fraction: float) -> str:
    bar = f'<progress max="1" value="{fraction:.3f}"></progress>'
    return f'<div class="rn-progress" role="status">{html.escape(name)}, {100 * fraction:.0f} % {bar}</div>'
