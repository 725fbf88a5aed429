"""A folder -> a Lesson: front matter in TOML between two lines `+++`, then sections under `# Heading`.

    +++
    title = "One range, many vehicles"
    ...
    +++
    # Question
    A screen.

    ---

    The next screen of the same section.

check.py is run when the lesson is read, with the rights of whoever started the page.
"""

import importlib.util
import re
from collections.abc import Callable
from pathlib import Path

import msgspec

from explorer.lessons import state
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
        toml_limits.refuse_large(match[1])
        header = msgspec.toml.decode(match[1], type=Header)
    except (msgspec.DecodeError, ValueError) as error:
        raise ValueError(f"lesson.md: {shortened(str(error))}") from None
    return header, _sections(match[2])


def _sections(body: str) -> dict[SectionName, tuple[str, ...]]:
    parts = HEADING.split(body)
    headings = tuple(parts[1::2])
    require(headings == SECTIONS, f"lesson.md: the sections must be {', '.join(SECTIONS)}, got {', '.join(headings)}")
    texts = (tuple(screen.strip() for screen in SCREEN.split(text)) for text in parts[2::2])
    sections = dict(zip(SECTIONS, texts, strict=True))
    for name, screens in sections.items():
        require(all(screens), f"lesson.md: an empty screen in the section {name}")
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
    except Exception as error:  # whatever a teacher's file raises becomes one sentence
        raise ValueError(f"check.py: {type(error).__name__}: {shortened(str(error))}") from None
    found = getattr(module, "check", None)
    require(callable(found), "check.py: must define a function check(state)")
    assert found is not None
    return found
