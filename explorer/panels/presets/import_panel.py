"""Import: a file is read, the visitor is asked what the file leaves open, and confirms the answers before it is used.

A question shows the answer that the data suggest, with the evidence. A path becomes a preset that is opened and not
saved yet. A recorded flight goes to the panel that judges flights.
"""

import re
from collections.abc import Callable
from functools import partial

import msgspec

from explorer.model.jobs import Jobs
from explorer.panels.presets.repair_text import noise_text
from explorer.panels.world.vehicle import NO_LIMITS
from explorer.storage import import_process
from explorer.storage.catalog import Catalog
from explorer.storage.import_file import ImportFile, Interpretation, guess, is_binary, is_preset_or_zip
from explorer.web.uploads import Uploads
from explorer.widgets.controls import Choice
from explorer.widgets.form import Form
from explorer.widgets.html import NOTE, bullets, folded
from explorer.widgets.page import Page
from explorer.widgets.progress import ProgressPanel
from explorer.widgets.section import Section
from rangenav import formats
from rangenav.formats import ImportResult, Question
from rangenav.number_format import quantity, significant
from rangenav.preset import Preset
from rangenav.vehicle import CATALOGUE, FREE

VEHICLES = {one: NO_LIMITS if one == FREE else one.name for one in CATALOGUE}
VEHICLE_HINT = "The vehicle whose limits the imported path is compared with. It can be changed later, in the World tab."
TABS = (
    "change the anchor in the World tab, δ and the duration in the Motion tab, and the range noise in the Sensors tab"
)
UPLOAD_HINT = "A path (reference, polynomial, TUM, EuRoC csv) or a recorded flight (csv, mat), of at most 20 MB."
FORMAT_HINT = "Guessed from the file's name and first lines when it comes; choose another if that is wrong."
CONFIRM_HINT = "Takes the answers above. Nothing is converted before you have confirmed it."
CONFIRM, OTHERS = "Confirm the answers", "Read it with these answers"
OTHERS_HINT = "Reads the file once more, with the answers chosen above."
FLAG = re.compile(r"--([a-z][a-z-]*?)(?:-unit)? ([^\s,;)]+)")
"""An option of the command line and its value; the menu on the page is named by the question's key."""
BELOW = 0.5
"""viser's order in a folder: between a control and the next one."""
UNANSWERED = ""
CHOOSE = "choose"


def choices() -> dict[str, str]:
    """Label by name of every format that is read."""
    return {row.name: row.read_label for row in formats.readable()}


class ImportPanel:
    """Upload, format, the interpretation of the file, and its open questions."""

    def __init__(
        self,
        form: Form,
        catalog: Catalog,
        page: Page,
        jobs: Jobs,
        uploads: Uploads,
        *,
        judge: Callable[[ImportResult], None],
        close: Callable[[], None],
    ) -> None:
        """`judge` is called with a recorded flight, and judges it; `close` before a file is read, and hides the last
        flight."""
        self._form, self._catalog, self._page = form, catalog, page
        self._judge, self._close = judge, close
        self._section = section = Section(form, "Import a path or a recorded flight", expanded=False)
        self._file: ImportFile | None = None
        self._questions_section: Section | None = None
        self._answers: dict[str, str] = {}
        self._answer_choices: dict[str, Choice[str]] = {}
        self._opened = False
        """Whether the texts are about a preset that was opened."""
        with section:
            self._vehicle = Choice(section, "to be flown by", VEHICLES, hint=VEHICLE_HINT)
            uploads.button("Upload a file", self._receive, section.complaint.say, hint=UPLOAD_HINT)
            self._progress = ProgressPanel(form, jobs)
            self._status = form.gui.add_html("", visible=False)
            self._message = form.gui.add_html("", visible=False)
            self._format = Choice(section, "format", choices(), hint=FORMAT_HINT)
            form.button(
                "Read it as this format", self._read, hint="Reads the file handed over last once more.", quiet=True
            )

    def forget_preset(self) -> None:
        """Remove the texts on an imported path that is not on the page any more. The texts on a recorded flight, and
        open questions, name their file and stay."""
        if self._opened:
            self._opened = self._status.visible = self._message.visible = False
            self._forget_questions()

    def _receive(self, name: str, content: bytes) -> None:
        file = ImportFile(name, content)
        with self._section.catching():
            if is_preset_or_zip(file):
                raise ValueError(f"{name}: presets, and zips with one, are taken by “Upload a preset” further up")
        self._file = file
        self._format.show(guess(self._file))
        self._read()

    def _read(self) -> None:
        self._answers = {}
        self._interpret()

    def _interpret(self) -> None:
        """Interpret the file with the answers given so far."""
        with self._section.catching():
            if self._file is None:
                raise ValueError("no file has been handed over yet")
            format_name = self._format.read()
        self._opened = False
        self._forget_questions()
        self._close()
        self._message.visible = False
        self._show_status(f"{self._file.name}: being read …")
        file, answers = self._file, dict(self._answers)
        self._progress.start(
            f"reading {file.name}",
            lambda progress, cancelled: import_process.read(file, format_name, answers, None, cancelled=cancelled),
            self._take_interpretation,
            partial(self._fail, format_name),
        )

    def _fail(self, format_name: str, reason: str) -> None:
        """Show the error together with the format that was tried, which may have been a wrong guess."""
        if self._file is not None:
            self._show_status(f"{self._file.name}: not read; the reason stands below")
        label = formats.row(format_name).read_label
        advice = "" if is_binary(self._file) else f". It was read as {label}: if it is none, choose another format"
        self._section.complaint.say(f"{in_page(reason)}{advice}{' and read it again' if advice else ''}")

    def _take_interpretation(self, interpretation: Interpretation) -> None:
        result = interpretation.result
        if interpretation.preset is not None and not result.questions:
            self._open(interpretation.preset)
        self._show_message(*report(result), more=every_column(result))
        asked = (*result.questions, *result.applied)
        if asked:
            self._show_questions(asked, open_ones=len(result.questions))
        if result.questions:
            count = "1 question" if len(result.questions) == 1 else f"{len(result.questions)} questions"
            self._show_status(f"{result.source}: {count} below")
        elif interpretation.preset is not None:
            noise = f"the ranges have {noise_text(interpretation.preset)}; set yours before you look for a repair"
            self._show_message(*interpretation.choices, noise, TABS, *report(result))
            self._show_status(f"{result.source}: opened as a preset that is not saved yet; these values were chosen")
        elif result.flight is not None:
            self._judge(result)
            self._show_message(*report(result), "a recorded flight: judge it below", more=every_column(result))
            unasked = sum(question.key not in self._answers for question in result.applied)
            self._show_status(f"{result.source}: a recorded flight{taken(unasked)}; judge it under “Recorded flight”")

    def _open(self, imported: Preset) -> None:
        """Put an imported path on the page."""
        with self._section.catching():
            flown = msgspec.structs.replace(imported, vehicle=self._vehicle.read())
        self._page.write(self._catalog.add_imported(flown))
        self._opened = True

    def _show_questions(self, questions: tuple[Question, ...], *, open_ones: int) -> None:
        """Show each question with its evidence. A suggested answer is chosen in its menu, and has to be confirmed.

        The first `open_ones` are open. The usual answer is applied to the others, and another one may be chosen.
        """
        label, button = (
            ("Questions before it is used", CONFIRM) if open_ones else ("Answers taken without a question", OTHERS)
        )
        with self._section:
            order = self._message.order + BELOW
            self._questions_section = questions_section = Section(self._form, label, order=order)
        with questions_section:
            for k, question in enumerate(questions):
                labels = {option: option for option in question.options}
                if question.suggestion is None:
                    labels = {UNANSWERED: CHOOSE} | labels
                sentences = in_page(f"{question.asks}? {question.evidence}")
                if k >= open_ones:
                    sentences += f"; usually: {question.suggestion}"
                elif question.suggestion is not None:
                    sentences += f"; suggested: {question.suggestion}"
                if question.as_it_is:
                    sentences += f"; {question.as_it_is} takes the record as it is, and it is then not judged"
                self._form.gui.add_html(NOTE.format(bullets((sentences,))))
                choice = self._answer_choices[question.key] = Choice(
                    questions_section, question.key, labels, hint=question.asks
                )
                chosen = self._answers.get(question.key) if k >= open_ones else None
                choice.show(chosen or question.suggestion or UNANSWERED)
            confirm = partial(self._confirm, questions[:open_ones], questions[open_ones:])
            self._form.button(button, confirm, hint=CONFIRM_HINT if open_ones else OTHERS_HINT)

    def _confirm(self, questions: tuple[Question, ...], applied: tuple[Question, ...]) -> None:
        if self._questions_section is None:
            return
        with self._questions_section.catching():
            answers = {key: choice.read() for key, choice in self._answer_choices.items()}
            unanswered = [question.asks for question in questions if answers[question.key] == UNANSWERED]
            if unanswered:
                raise ValueError(f"not answered yet: {'; '.join(unanswered)}")
        usual = {question.key for question in applied if answers[question.key] == question.suggestion}
        self._answers = {key: value for key, value in (self._answers | answers).items() if key not in usual}
        self._interpret()

    def _forget_questions(self) -> None:
        self._answer_choices = {}
        if self._questions_section is not None:
            self._questions_section.remove()
            self._questions_section = None

    def _show_status(self, sentence: str) -> None:
        """Say at the upload button what has become of the file."""
        self._status.content = NOTE.format(bullets((sentence,)))
        self._status.visible = True

    def _show_message(self, *sentences: str, more: str = "") -> None:
        self._message.content = NOTE.format(bullets(sentences) + more)
        self._message.visible = True


def taken(unasked: int) -> str:
    """How many answers were taken without a question, as a clause with its semicolon; empty for none."""
    answers = "1 answer was" if unasked == 1 else f"{unasked} answers were"
    return f"; {answers} taken without a question, see below" if unasked else ""


def every_column(result: ImportResult) -> str:
    """All columns of a table and what they are used for, to be opened by a click; empty without named columns."""
    uses = [f"{name}: {use or 'not used'}" for name, use in result.columns]
    return folded(f"all {len(uses)} columns", uses) if uses else ""


def report(result: ImportResult) -> tuple[str, ...]:
    """Sentences that describe how a file was read: its format, rate, duration, frame and fit."""
    if result.questions and result.flight is None and not result.findings:
        return (f"{result.source}: not read yet; that takes the answers to the questions",)
    rate = "" if result.rate is None else f" at {significant(result.rate, 4)} Hz"
    duration = quantity(result.duration, "s", digits=4)
    sentences = [f"{result.source}: {result.format}, {result.rows} rows{rate}, {duration}, {result.frame}"]
    if result.fit_error is not None:
        sentences.append(f"the path passes the file's positions within {significant(1e3 * result.fit_error)} mm")
    if result.unjudged is not None:
        what = "excitation" if result.flight is None else "the record"
        sentences.append(f"{what} is not judged: {result.unjudged}")
    return tuple(map(in_page, (*sentences, *result.findings)))


def in_page(sentence: str) -> str:
    """A sentence with the name of the page's menu in place of an option of the command line: “range-values: keep”."""
    return FLAG.sub(r"“\1: \2”", sentence)
