"""A folder -> a Lesson: front matter in TOML between two lines `+++`, then sections under `# Heading`.

    +++
    title = "One range, many vehicles"
    ...
    +++
    # Question
    A screen.

    ---

    The next screen of the same section.

check.py is run when the lesson is read, with the rights of whoever started the page. An error in it becomes a sentence,
then and whenever the function is called.
"""

import importlib.util
import math
import re
from collections.abc import Callable, Mapping
from pathlib import Path

from explorer.lessons import state, text
from explorer.lessons.lesson import SECTIONS, Header, Lesson, SectionName
from explorer.lessons.state import Outcome, State
from rangenav import toml_limits
from rangenav.inputs import require, shortened

NAME = re.compile(r"\d\d-[a-z0-9]+(-[a-z0-9]+)*")
FRONT = re.compile(r"\A\+\+\+\n(.*?)\n\+\+\+\n(.*)\Z", re.DOTALL)
HEADING = re.compile(r"^# (.+)$", re.MULTILINE)
SCREEN = re.compile(r"^---$", re.MULTILINE)


def read(folder: Path) -> Lesson:
    """The lesson in a folder. Raises ValueError with one sentence that names folder and file."""
    try:
        require(bool(NAME.fullmatch(folder.name)), "a lesson's folder is named like 01-one-range")
        header, sections = _text((folder / "lesson.md").read_text(encoding="utf-8"))
        return Lesson(
            name=folder.name,
            folder=folder,
            header=header,
            sections=sections,
            start=state.read(folder / "start.toml"),
            solved=state.read(folder / "solved.toml"),
            cases=tuple(state.read(folder / f"case-{k}.toml") for k in range(1, len(header.cases) + 1)),
            check=_check(folder / "check.py"),
        )
    except OSError as error:
        raise ValueError(f"{folder.name}: {Path(str(error.filename)).name} cannot be read: {error.strerror}") from None
    except ValueError as error:
        sentence = str(error)
        raise ValueError(sentence if sentence.startswith(folder.name) else f"{folder.name}: {sentence}") from None


def _text(content: str) -> tuple[Header, dict[SectionName, tuple[str, ...]]]:
    match = FRONT.match(content)
    require(match is not None, "lesson.md: must begin with front matter in TOML between two lines +++")
    assert match is not None
    try:
        header = toml_limits.decode(match[1], Header)
        sections = _sections(match[2])
        _refuse_unknown_figures(header, sections)
    except ValueError as error:
        raise ValueError(f"lesson.md: {error}") from None
    return header, sections


def _refuse_unknown_figures(header: Header, sections: Mapping[SectionName, tuple[str, ...]]) -> None:
    """Raise ValueError if a text names a figure or a state that does not exist, or has a wrong equation."""
    asked = header.prediction
    figure = (f"{{{asked.figure}}}",) if asked.figure else ()
    states = ("", "start", "solved", "pinned", *(f"case-{k}" for k in range(1, len(header.cases) + 1)))
    screens = (screen for section in sections.values() for screen in section)
    for markdown in (asked.question, asked.because, *figure, *header.hints, *screens):
        text.refuse(markdown, states)


def _sections(body: str) -> dict[SectionName, tuple[str, ...]]:
    parts = HEADING.split(body)
    headings = tuple(parts[1::2])
    require(headings == SECTIONS, f"the sections must be {', '.join(SECTIONS)}, got {', '.join(headings)}")
    texts = (tuple(screen.strip() for screen in SCREEN.split(part)) for part in parts[2::2])
    sections = dict(zip(SECTIONS, texts, strict=True))
    for name, screens in sections.items():
        require(all(screens), f"an empty screen in the section {name}")
    return sections


def _check(path: Path) -> Callable[[State], Outcome]:
    """The function `check` of a file of Python. Raises ValueError if it cannot be run."""
    spec = importlib.util.spec_from_file_location(f"lesson_{path.parent.name.replace('-', '_')}_check", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except OSError:
        raise
    except (Exception, SystemExit) as error:  # whatever a teacher's file raises becomes one sentence
        raise ValueError(_sentence(error)) from None
    found = getattr(module, "check", None)
    require(callable(found), "check.py: must define a function check(state)")
    assert found is not None

    def check(judged: State) -> Outcome:
        try:
            outcome = found(judged)
        except (Exception, SystemExit) as error:
            return Outcome(math.nan, False, _sentence(error))
        if isinstance(outcome, Outcome):
            return outcome
        return Outcome(math.nan, False, f"check.py: must return an Outcome, got {type(outcome).__name__}")

    return check


def _sentence(error: BaseException) -> str:
    return f"check.py: {type(error).__name__}: {shortened(str(error))}"
