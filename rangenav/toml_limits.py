"""Limits of a TOML text, checked before it is parsed: the parser takes memory with the square of a key's dots.

A key of 20,000 dots (40 kB of text) took 1.7 GB, and one of 200,000 dots more than any machine has. The check reads the
text once, token by token, and builds nothing. Of a text that is no TOML it sees at least what the parser sees before it
stops at the error.
"""

import re
from typing import TypeVar

import msgspec

from rangenav.inputs import require, shortened

MAX_BYTES = 1_000_000
"""Bytes of a text; characters, of a text that is decoded already."""
MAX_PARTS = 16
"""Parts of one dotted key; a preset's longest has five."""
MAX_KEY = 100
"""Characters of one key, and of a number."""
MAX_DEPTH = 16
"""Arrays and inline tables inside one another; a preset's deepest has three."""
MAX_KEYS = 50_000
"""Parts of all keys together, and brackets; the parser takes a kilobyte for each. 2000 pieces of a path have 12,000."""
SHOWN = 20
"""Characters of a key that a message repeats."""
QUOTES = "#\"'"
"""First characters of a comment and of strings."""
TOKEN = re.compile(
    r'''"""(?:[^"\\]++|\\.|"(?!""))*+(?:"{3,5}|\\?\Z) | \'\'\'.*?(?:\'{3,5}|\Z)'''
    r"""| "(?:[^"\\\n]|\\[^\n])*"? | '[^'\n]*'?"""
    r"""| \#[^\n]* | [\[\]{}=,\n] | [^\[\]{}=,\n"'\#]+""",
    re.VERBOSE | re.DOTALL,
)
"""A string, a comment, one sign, or all that stands between signs. A string that is not closed ends with its line, or
with the text if it may hold lines. An alternative that begins also ends, so the text is read once."""


T = TypeVar("T")


def decode(text: str, kind: type[T]) -> T:
    """The value in a TOML text. Raises ValueError with one sentence; where a limit is exceeded, nothing is parsed."""
    try:
        refuse_large(text)
        return msgspec.toml.decode(text, type=kind)
    except (msgspec.DecodeError, ValueError) as error:  # ValueError: an integer of thousands of digits
        raise ValueError(shortened(str(error))) from None
    except RecursionError:
        raise ValueError("nested too deeply") from None


def refuse_large(text: str) -> None:
    """Raise ValueError, before the text is parsed, if a limit is exceeded; the sentence names the line and the rule."""
    require(len(text) <= MAX_BYTES, f"larger than {MAX_BYTES} bytes, which no preset is")
    inside: list[str] = []
    key, in_key, keys, brackets, line = "", True, 0, 0, 1
    for match in TOKEN.finditer(text):
        token = match[0]
        word = "".join(token.split())
        if token in ("[", "{"):
            brackets += 1
            if inside or not in_key or key:  # else it begins the name of a table
                inside.append(token)
                in_key, key = token == "{", ""
            _require(len(inside) <= MAX_DEPTH, line, f"more than {MAX_DEPTH} brackets inside one another")
            _require(brackets <= MAX_KEYS, line, f"more than {MAX_KEYS} brackets")
        elif token in ("]", "}"):
            in_key, key = False, ""
            del inside[-1:]
        elif token in ("=", ",", "\n"):
            in_key = token != "=" and (inside[-1] == "{" if inside else token == "\n")
            key = ""
        elif in_key and not token.startswith("#"):
            key += word
            keys += word.count(".") + 1  # dots in a quoted part are counted, too
            _require(key.count(".") < MAX_PARTS, line, f"more than {MAX_PARTS} parts in the key {key[:SHOWN]!r}…")
            _require(len(key) <= MAX_KEY, line, f"more than {MAX_KEY} characters in the key {key[:SHOWN]!r}…")
            _require(keys <= MAX_KEYS, line, f"more than {MAX_KEYS} keys")
        elif token[0] not in QUOTES:
            _require(len(word) <= MAX_KEY, line, f"more than {MAX_KEY} characters in the value {word[:SHOWN]!r}…")
        line += token.count("\n")


def _require(holds: bool, line: int, rule: str) -> None:
    require(holds, f"line {line}: {rule}")
