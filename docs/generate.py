"""Fill the generated parts of the pages: tables of formats, of checks, of the lessons' answers, and the glossary.

    python docs/generate.py
A part stands between `<!-- NAME: begin -->` and `<!-- NAME: end -->` and is replaced as a whole; a test sees that it is
up to date. Nothing outside the marks is touched.
"""

from collections.abc import Callable
from pathlib import Path

from explorer.lessons import teaching
from explorer.lessons.course import OURS, lessons_in
from explorer.model import glossary
from rangenav import formats, record_checks
from rangenav.studies import metrics

HERE = Path(__file__).parent


def table_of_formats() -> str:
    """One row for each exchange format, from the table in `rangenav.formats`."""
    return formats.markdown().rstrip()


def table_of_checks() -> str:
    """One row for each check of a recorded flight, from the table in `rangenav.record_checks`."""
    return record_checks.markdown().rstrip()


def tables_of_terms() -> str:
    """One row for each term of the page, from the table in `explorer.model.glossary`."""
    return glossary.markdown()


def table_of_lessons() -> str:
    """One row for each lesson: what it asks, and the answer."""
    return teaching.markdown(lessons_in(OURS).lessons)


def table_of_metrics() -> str:
    """One row for each metric of a study, from the table in `rangenav.studies.metrics`."""
    return metrics.markdown()


PARTS: dict[str, dict[str, Callable[[], str]]] = {
    "formats.md": {"table of formats": table_of_formats},
    "glossary.md": {"glossary": tables_of_terms},
    "teaching.md": {"lessons": table_of_lessons},
    "how-to/judge-my-flight.md": {"table of checks": table_of_checks},
    "how-to/studies.md": {"table of metrics": table_of_metrics},
}
"""Page → name of the part → what makes it."""


def filled(text: str, name: str, content: str) -> str:
    """The text with one part replaced. Raises ValueError if its marks are not there exactly once."""
    begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    if text.count(begin) != 1 or text.count(end) != 1:
        raise ValueError(f"the marks of {name!r} must stand exactly once")
    before, rest = text.split(begin)
    return f"{before}{begin}\n\n{content}\n\n{end}{rest.split(end)[1]}"


def main() -> None:
    """Fill every part of every page."""
    for page, parts in PARTS.items():
        path = HERE / page
        text = path.read_text(encoding="utf-8")
        for name, make in parts.items():
            text = filled(text, name, make())
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
