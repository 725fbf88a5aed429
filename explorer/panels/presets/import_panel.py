"""Import: a file is read, its open questions are put with what the data suggest and why, and only then is it used.

A path becomes a preset that is opened (and not saved yet); a recorded flight goes to the panel that judges flights.
"""

from collections.abc import Callable
from functools import partial

from explorer.model.jobs import Jobs
from explorer.storage.catalog import Catalog
from explorer.storage.import_file import ImportFile, Interpretation, guess, interpret, looks_like_a_preset
from explorer.web.uploads import Uploads
from explorer.widgets.controls import Choice
from explorer.widgets.form import Form, Section
from explorer.widgets.html import NOTE, bullets
from explorer.widgets.page import Page
from rangenav import formats
from rangenav.formats import ImportResult, Question

ANCHOR = (0.0, 0.0, 0.0)
"""m; no path says where the anchor stands, and the World tab moves it."""
UPLOAD = "A path (reference, polynomial, TUM, EuRoC csv) or a recorded flight (csv, mat), of at most 20 MB."
FORMAT = "Guessed from the file's name and first lines when it comes; choose another if that is wrong."
CONFIRM = "Takes the answers above. Nothing is converted before you have confirmed it."
UNANSWERED = ""
CHOOSE = "choose"


def choices() -> dict[str, str]:
    """Label by name of every format that is read."""
    return {row.name: row.read_label for row in formats.readable()}


class ImportPanel:
    """Upload, format, what was understood, and the questions that are open."""

    def __init__(
        self,
        form: Form,
        catalog: Catalog,
        page: Page,
        jobs: Jobs,
        uploads: Uploads,
        *,
        judge: Callable[[ImportResult], None],
    ) -> None:
        """`judge` takes a recorded flight."""
        self._form, self._catalog, self._page, self._jobs, self._judge = form, catalog, page, jobs, judge
        self._section = section = Section(form, "Import a path or a recorded flight", expanded=False)
        self._file: ImportFile | None = None
        self._asking: Section | None = None
        self._answers: dict[str, str] = {}
        self._asked: dict[str, Choice[str]] = {}
        with section:
            uploads.button("Upload a file", self._receive, section.complaint.say, hint=UPLOAD)
            self._format = Choice(section, "format", choices(), hint=FORMAT)
            form.button(
                "Read it as this format", self._read, hint="Reads the file handed over last once more.", quiet=True
            )
            self._said = form.gui.add_html("", visible=False)

    def _receive(self, name: str, content: bytes) -> None:
        file = ImportFile(name, content)
        with self._section.catching():
            if looks_like_a_preset(file):
                raise ValueError(f"{name}: presets, and zips with one, are taken by “Upload a preset” further up")
        self._file = file
        self._format.show(guess(self._file))
        self._read()

    def _read(self) -> None:
        self._answers = {}
        self._begin()

    def _begin(self) -> None:
        """Read with the answers there are."""
        with self._section.catching():
            if self._file is None:
                raise ValueError("no file has been handed over yet")
            format_name = self._format.read()
        self._forget_questions()
        self._said.visible = False
        file, answers = self._file, dict(self._answers)
        self._jobs.start(
            f"reading {file.name}",
            lambda progress, cancelled: interpret(file, format_name, answers, ANCHOR),
            self._understood,
            partial(self._fail, format_name),
        )

    def _fail(self, format_name: str, reason: str) -> None:
        """Say as what it could not be read, since that was a guess."""
        label = formats.row(format_name).read_label
        advice = f"It was read as {label}: if it is none, choose another format and read it again"
        self._section.complaint.say(f"{reason}. {advice}")

    def _understood(self, understood: Interpretation) -> None:
        found = understood.found
        self._say(*report(found))
        if found.questions:
            self._ask(found.questions)
        elif understood.preset is not None:
            self._page.write(self._catalog.add_imported(understood.preset))
            self._say(*report(found), "opened as a preset that is not saved yet (anchor at 0, 0, 0: see World)")
        elif found.flight is not None:
            self._judge(found)
            self._say(*report(found), "a recorded flight: judge it below")

    def _ask(self, questions: tuple[Question, ...]) -> None:
        """Put each question with its evidence; what is suggested is chosen already, and waits to be confirmed."""
        with self._section:
            self._asking = asking = Section(self._form, "Questions before it is used")
        with asking:
            for question in questions:
                words = {option: option for option in question.options}
                if question.suggestion is None:
                    words = {UNANSWERED: CHOOSE} | words
                said = f"{question.asks}? {question.evidence}"
                if question.suggestion is not None:
                    said += f"; suggested: {question.suggestion}"
                self._form.gui.add_html(NOTE.format(bullets((said,))))
                choice = self._asked[question.key] = Choice(asking, question.key, words, hint=question.asks)
                choice.show(question.suggestion or UNANSWERED)
            self._form.button("Confirm the answers", partial(self._confirm, questions), hint=CONFIRM)

    def _confirm(self, questions: tuple[Question, ...]) -> None:
        if self._asking is None:
            return
        with self._asking.catching():
            answers = {question.key: self._asked[question.key].read() for question in questions}
            open_ones = [question.asks for question in questions if answers[question.key] == UNANSWERED]
            if open_ones:
                raise ValueError(f"not answered yet: {'; '.join(open_ones)}")
        self._answers |= answers
        self._begin()

    def _forget_questions(self) -> None:
        self._asked = {}
        if self._asking is not None:
            self._asking.remove()
            self._asking = None

    def _say(self, *sentences: str) -> None:
        self._said.content = NOTE.format(bullets(sentences))
        self._said.visible = True


def report(found: ImportResult) -> tuple[str, ...]:
    """What a file was understood to be, one sentence each."""
    rate = "" if found.rate is None else f" at {found.rate:.4g} Hz"
    said = [f"{found.source}: {found.format}, {found.rows} rows{rate}, {found.duration:.4g} s, {found.frame}"]
    if found.fit_error is not None:
        said.append(f"the path passes the file's positions within {1e3 * found.fit_error:.3g} mm")
    if found.unjudged is not None:
        said.append(f"excitation is not judged: {found.unjudged}")
    return (*said, *found.findings)
