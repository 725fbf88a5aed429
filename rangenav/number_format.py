"""How a number is written for people: significant digits, the unit, powers of ten, and a word where there is no number.

    significant(0.01234)            0.0123       fixed-point notation from 0.001 to 9999, which no whole number leaves
    significant(1.234e-6)           1.23e-6      an exponent without sign and zeros that say nothing
    quantity(math.nan, "m")         not determined
    power_of_ten(-6)                10⁻⁶

Certificates and the command line's JSON do not come through here: their sentences are compared byte by byte, and are
written with Python's own format specifiers.
"""

import math
import re
from collections.abc import Iterable

NOT_DETERMINED = "not determined"
NEVER = "never"
DASH = "–"
SMALLEST_FIXED, LARGEST_FIXED = 1e-3, 1e4
"""Fixed-point notation from the first up to the second: there it is no longer than the other, and easier to read."""
MINUS = "\N{MINUS SIGN}"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
PRINTED_NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+(?:e[+-]?\d+)?|e[+-]?\d+)(?![\w.]\d)")
"""A number with a decimal point or an exponent; a whole number stays as it is."""
UNBROKEN = "\N{NO-BREAK SPACE}"
BEFORE_UNIT = re.compile(r"(?<=\d) (?=(?:[mkμ]?m|m?s|Hz|k?g|N|mT|μT|rad|m²|°|%|times)(?![\w-])|\d{3}(?!\d))")
"""The space between a number and its unit, and that between groups of three digits."""
CLOSE_UNITS = ("", "°", "%")
"""Units that follow their number without a space."""


def significant(value: float, digits: int = 3) -> str:
    """The value to so many significant digits, without zeros at the end; a dash for NaN, ∞ and −∞ as they are."""
    if math.isnan(value):
        return DASH
    if math.isinf(value):
        return "∞" if value > 0 else f"{MINUS}∞"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    size = abs(float(f"{mantissa}e{exponent}"))
    if size == 0:
        return "0"
    if not SMALLEST_FIXED <= size < LARGEST_FIXED:
        return f"{mantissa.rstrip('0').rstrip('.') if '.' in mantissa else mantissa}e{int(exponent)}"
    return f"{value:.0f}" if int(exponent) >= digits else f"{value:.{digits}g}"


def quantity(value: float | None, unit: str = "", *, digits: int = 3, otherwise: str = NOT_DETERMINED) -> str:
    """The value with its unit; the word `otherwise` where there is none: None, NaN or ±∞."""
    if value is None or not math.isfinite(value):
        return otherwise
    return f"{significant(value, digits)}{'' if unit in CLOSE_UNITS else ' '}{unit}"


def shortened(sentence: str, digits: int = 3) -> str:
    """A sentence of the library, whose numbers Python's format specifiers wrote, with all numbers that have a decimal
    point to so many significant digits: 14.5664 s becomes 14.6 s. A sentence on a bound needs four digits: three of
    them would move the bound."""
    return PRINTED_NUMBER.sub(lambda number: significant(float(number[0]), digits), sentence)


def unbroken(sentence: str) -> str:
    """The sentence with no-break spaces between numbers and their units, and inside of 16 384: no line ends there."""
    return BEFORE_UNIT.sub(UNBROKEN, sentence)


def vector(values: Iterable[float], digits: int = 3) -> str:
    """(1, 2.5, -0.3)"""
    return f"({', '.join(significant(value, digits) for value in values)})"


def percent(share: float) -> str:
    """A share of 1 as whole percents; a dash for NaN."""
    return DASH if math.isnan(share) else f"{share:z.0%}"


def fixed(value: float, decimals: int = 2) -> str:
    """So many decimals; what is rounded to zero has no sign."""
    return f"{value:z.{decimals}f}"


def signed(value: float, decimals: int = 3) -> str:
    """So many decimals, with a minus sign that is as wide as a plus sign, and no sign where they are all zero."""
    return fixed(value, decimals).replace("-", MINUS)


def power_of_ten(exponent: int) -> str:
    """10⁻⁶"""
    return f"10{str(exponent).translate(SUPERSCRIPTS)}"


def subscript(number: int) -> str:
    """₁₃"""
    return str(number).translate(SUBSCRIPTS)
