"""Docstrings of this project as RST: paragraphs stay paragraphs, indented formulas stay as they are typed.

A docstring here is plain text: lines with Unicode formulas, `code` in single backticks, and indented blocks for
formulas and tables. RST would take |p| for a substitution and x_ for a link, so everything else is escaped.
"""

import re
import textwrap

MARKED = re.compile(r"(``(?:[^`]|`(?!`))+``|`[^`]+`)")
SPECIAL = re.compile(r"([\\*_|<>:])")
LIST = re.compile(r"^([-+•]|\w+[.)]|\(\w+\)) ")
NOISE = (
    (re.compile(r"\bnumpy\.ndarray\b"), "Array"),
    (re.compile(r"\bjaxtyping\."), ""),
    (re.compile(r"\b(?:typing|collections\.abc|pathlib|types)\.(?=[A-Z])"), ""),
    (re.compile(r"\[ndarray, "), "[Array, "),
)
"""What makes an annotation long and says nothing: where a name was imported from."""


def process(app, what, name, obj, options, lines):
    """Replace the lines of one docstring by RST, in place."""
    text = textwrap.dedent("\n".join(lines)).strip("\n")
    lines[:] = as_rst(text) if text else []


def as_rst(text: str) -> list[str]:
    """RST lines of a docstring."""
    result: list[str] = []
    kind = ""
    for line in text.splitlines():
        if not line.strip():
            result.append("")
            kind = "blank" if kind != "formula" else kind
        elif line.startswith("    "):
            if kind != "formula":
                result += ["", ".. code-block:: text", ""]
            result.append(line)
            kind = "formula"
        else:
            if kind == "formula":
                result.append("")
            result.append(_escaped(line.strip(), first=kind != "text"))
            kind = "text"
    return [*result, ""]


def _escaped(line: str, *, first: bool) -> str:
    """One line of prose; a first word that would begin a list is escaped."""
    parts = MARKED.split(line)
    for k, part in enumerate(parts):
        if k % 2 and part.strip("`") == part.strip("` "):
            before = parts[k - 1][-1:]
            joined = "" if (k == 1 and not before) or before in (" ", "(", "[", "") else "\\ "
            after = parts[k + 1][:1]
            closed = "\\ " if after.isalnum() else ""
            parts[k] = f"{joined}``{part.strip('`')}``{closed}"
        else:
            parts[k] = SPECIAL.sub(r"\\\1", part).replace("`", "\\`")
    text = "".join(parts)
    return f"\\{text}" if first and LIST.match(text) else text


def shorten(app, what, name, obj, options, signature, returns):
    """Annotations without the modules that names come from."""

    def short(text):
        for pattern, replacement in NOISE:
            text = pattern.sub(replacement, text) if text else text
        return text

    return short(signature), short(returns)


def skip(app, what, name, obj, skipped, options):
    """Leave out what msgspec and dataclasses add to every class."""
    return True if name.startswith(("__struct", "__dataclass", "__match_args__", "__annot")) else None
