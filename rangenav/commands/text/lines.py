"""Lines of at most 80 columns, broken between words: for a text, and for a command that a shell understands."""

import re
import textwrap

from rangenav.number_format import UNBROKEN

COLUMNS = 80
"""A line is never wider, unless a single word is (the path of a file, which must stay whole to be copied)."""
CONTINUED = "    "
"""Before the second line of a long answer."""
BEFORE_VALUE = re.compile(r" (?!--?[a-z])")
"""A blank in front of an option's value, and not in front of an option."""


def wrapped(text: str, columns: int, continued: str = "") -> list[str]:
    """A text broken at blanks only, and not at UNBROKEN, which becomes a blank; a file's path stays in one piece."""
    lines = textwrap.wrap(text, columns, subsequent_indent=continued, break_long_words=False, break_on_hyphens=False)
    return [line.replace(UNBROKEN, " ") for line in (lines if len(text) > columns else [text])]


def folded_command(text: str, columns: int) -> list[str]:
    """A command that a shell still understands when it is copied: a line that goes on ends in a backslash.

    An option stays on one line with its values: a line breaks before an option, or before the first argument.
    """
    start = text.split(" ", 2)[:2]
    rest = BEFORE_VALUE.sub(UNBROKEN, text.removeprefix(" ".join(start)).strip())
    *first, last = wrapped(" ".join([*start, rest]), columns - 2, "  ")
    return [*(f"{line} \\" for line in first), last]
