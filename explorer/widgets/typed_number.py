"""A number as a person types it: 5000, 5e3, 5 000, −0.2. viser's own boxes drop an e and cut what is out of range."""

import math
import re
import unicodedata

from rangenav.number_format import UNBROKEN, significant

NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?")
GROUPED = re.compile(r"(?<=\d) (?=\d{3}(?!\d))")
"""A blank between groups of three digits."""
MAX_LENGTH = 40
"""Characters of a box, and of what a sentence quotes."""


def parse(text: str) -> float:
    """The number that a text says. Raises ValueError with the rule and an example for any other text."""
    plain = "".join(" " if unicodedata.category(letter) == "Zs" else letter for letter in text[: MAX_LENGTH + 1])
    plain = GROUPED.sub("", plain.strip().replace("\N{MINUS SIGN}", "-"))
    if len(text) > MAX_LENGTH or NUMBER.fullmatch(plain) is None:
        quoted = f"“{text[:MAX_LENGTH]}” is not a number" if text.strip() else "the box is empty"
        point = f", or {plain.replace(',', '.')} with a point" if NUMBER.fullmatch(plain.replace(",", ".", 1)) else ""
        raise ValueError(f"{quoted}; a number is typed as 5000, 5e3 or 5{UNBROKEN}000{point}")
    value = float(plain)
    if not math.isfinite(value):
        raise ValueError(f"“{text}” is larger than any number that can be used")
    return value


def text(value: float, longest: int = 12) -> str:
    """The number as it is typed: all its digits where they are few, else four, in at most so many characters."""
    digits = f"{value:.0f}" if value % 1 == 0 and abs(value) < 1e16 else f"{value:.9g}"
    return digits if len(digits) <= longest and "e" not in digits else significant(value, 4)
