"""The verdict as one line over the scene: sign, word, the number that decides, what is wanted, and one action.

The line unfolds to the five answers of `explorer.model.assessment`, and these to all figures. Its buttons are the
page's own HTML: the session hands the names that they send to `act`.
"""

import html

import viser

from explorer.model import assessment, glossary, palette
from explorer.model.assessment import Answer, Cure, Level
from explorer.model.compute import Picture
from explorer.model.jobs import Job
from explorer.panels import figures
from explorer.widgets.complaint import Complaint
from explorer.widgets.form import Action

SIGNS: dict[Level, tuple[str, palette.Color]] = {
    "good": ("●", palette.GOOD),
    "unjudged": ("○", palette.NEUTRAL),
    "mind": ("▲", palette.WARNING),
    "bad": ("✕", palette.ERROR),
}
"""Shape and colour (Okabe–Ito hues, dark enough to read on white, and light enough on black) of a level."""
CURES: dict[Cure, tuple[str, str]] = {
    "repair": ("make it observable", "Looks for a small change of the motion that meets the requirement."),
    "tune": ("tune the observer", "Looks for gains with which the estimate settles sooner and errs less."),
    "slow down": ("fly it slower", "Flies the same path slower, so that it keeps the limits of the vehicle."),
    "model": ("use the derived model", "Switches off the paper's misprinted model."),
    "vehicle": ("choose a vehicle", "Opens the list of vehicles."),
}
"""Label and hint of the button that cures what is wrong."""
ANSWERS: dict[str, tuple[str, str]] = {
    "stop": ("Stop", "Ends the work at once; what was there before stays."),
    "accept": ("Accept the motion", "Puts B on the page and pins the motion before as A. Ctrl+Z takes it back."),
    "discard": ("Discard", "What is on the page stays as it is."),
}
"""Label and hint of the buttons beside the progress and the outcome of a search."""
UNFOLD = '<button type="button" class="rn-button rn-unfold" data-rn-flag="unfolded" aria-label="All answers"></button>'
BUTTON = '<button type="button" class="rn-button {}" data-rn-event="{}" title="{}">{}</button>'
DIMMED = f"color:{palette.SECONDARY_TEXT}"


class VerdictPanel:
    """The line, below it what is running or why nothing was shown, and the answers."""

    def __init__(self, gui: viser.GuiApi, cures: dict[Cure, Action], answers: dict[str, Action]) -> None:
        """`cures` are the actions that are offered; `answers` are those to a running job and to its outcome."""
        self._cures, self._answers = cures, answers
        self._block = gui.add_html("")
        self._progress = gui.add_html("", visible=False)
        self._buttons = gui.add_html("", visible=False)
        gui.add_html('<span class="rn-complaint"></span>')
        self.complaint = Complaint(gui)

    @property
    def actions(self) -> dict[str, Action]:
        """What the buttons do, by the name that they send."""
        return {_event(cure): action for cure, action in self._cures.items()} | self._answers

    def progress(self, fraction: float, stage: str) -> None:
        """Show the progress of compilation; at 1 it is hidden."""
        name = f"Compiling the observers (once per machine): {stage}"
        self._show_progress(_progress_bar(name, fraction) if fraction < 1 else "")

    def draw_progress(self, job: Job | None, outcome: str, *, found: bool) -> None:
        """Show the progress of the running job, or the outcome of the last search and, if it has `found` a motion, a
        button to accept it."""
        if job is not None:
            self._show_progress(_progress_bar(f"Working: {job.name}", job.fraction), "stop")
        elif outcome:
            answers = ("accept", "discard") if found else ("discard",)
            self._show_progress(f'<div class="rn-progress" role="status">{html.escape(outcome)}</div>', *answers)
        else:
            self._show_progress("")

    def draw(self, picture: Picture) -> None:
        """Show the verdict on a picture; ≈ marks what is that of sampled windows, and not yet of all."""
        given = assessment.answers(picture)
        rows = f'<div class="rn-rows">{_rows(picture, given)}</div>'
        content = f'<div class="rn-verdict">{self._line(picture, given)}{rows}</div>'
        if content != self._block.content:
            self._block.content = content

    def _line(self, picture: Picture, given: tuple[Answer, ...]) -> str:
        sign, color = SIGNS[assessment.level(given)]
        deciding = assessment.decisive(given)
        head = f'<b style="color:{color}">{sign} {figures.about(picture)}{picture.analysis.verdict.word}</b>'
        cure = _button(deciding.cure) if deciding.cure in self._cures else ""
        summary = html.escape(deciding.summary)
        text = f'<span class="rn-deciding" title="{summary}">{summary}{figures.chips(picture)}</span>'
        return f'<div class="rn-line" role="status">{head}{text}{cure}{UNFOLD}</div>'

    def _show_progress(self, content: str, *answers: str) -> None:
        """Show a strip below the line. Its buttons are an element of their own, which stays while the bar moves: a
        button that is replaced under the mouse cannot be pressed."""
        buttons = f'<div class="rn-answers">{"".join(_answer(name) for name in answers)}</div>' if answers else ""
        for handle, text in ((self._progress, content), (self._buttons, buttons)):
            if text != (handle.content if handle.visible else ""):
                handle.visible = bool(text)
                if text:
                    handle.content = text


def _rows(picture: Picture, given: tuple[Answer, ...]) -> str:
    """The answers, and folded below them all figures."""
    lines = []
    for answer in given:
        sign, color = SIGNS[answer.level]
        hint = html.escape(glossary.hint(answer.term)) if answer.term in glossary.TERMS else ""
        question = (
            f'<span title="{hint}"><b style="color:{color}">{sign}</b> {assessment.QUESTIONS[answer.question]}</span>'
        )
        text = "<br>".join(html.escape(part) for part in (answer.summary, *answer.remarks))
        lines.append(f"<tr><td>{question}</td><td>{text}</td></tr>")
    subject = f'<div style="{DIMMED}">{html.escape(subject_of(picture))}</div>'
    folded = f"<details><summary>all figures</summary>{figures.table(picture)}</details>"
    return f"{subject}<table>{''.join(lines)}</table>{folded}"


def subject_of(picture: Picture) -> str:
    """What the verdict is on: the motion that the page shows, and no recorded flight."""
    return f"The motion “{picture.preset.title or picture.settings.origin}”, as on the page."


def _event(cure: Cure) -> str:
    return f"cure-{cure.replace(' ', '-')}"


def _button(cure: Cure | None) -> str:
    assert cure is not None
    label, hint = CURES[cure]
    return BUTTON.format("rn-main", _event(cure), html.escape(hint), label)


def _answer(name: str) -> str:
    label, hint = ANSWERS[name]
    return BUTTON.format("rn-main" if name == "accept" else "", name, html.escape(hint), label)


def _progress_bar(name: str, fraction: float) -> str:
    bar = f'<progress max="1" value="{fraction:.3f}"></progress>'
    return f'<div class="rn-progress" role="status">{html.escape(name)}, {100 * fraction:.0f} % {bar}</div>'
