"""What a person chooses is a frozen value: equal by value, hashable, finite, and readable from TOML.

Inputs are `msgspec.Struct`s rather than dataclasses because only those refuse unknown keys and form tagged unions;
they are frozen all the same. Each class says so again, and keyword-only: type checkers do not inherit the one, nor
msgspec the other.
"""

import math
from typing import Any

import msgspec

Vec3 = tuple[float, float, float]


class Input(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Base of every input: refuses numbers that are not finite. Subclasses add their rules in `__post_init__`."""

    def __post_init__(self) -> None:
        for name in self.__struct_fields__:
            refuse_nonfinite(name, getattr(self, name))


def refuse_nonfinite(name: str, value: Any) -> None:
    """Raise ValueError if a number, or any number in a tuple, is NaN or infinite."""
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{name} must be a finite number, got {value}")
    if isinstance(value, tuple):
        for entry in value:
            refuse_nonfinite(name, entry)


def require(holds: bool, sentence: str) -> None:
    """Raise ValueError with `sentence` unless `holds`; the sentence names the field, the rule and the value."""
    if not holds:
        raise ValueError(sentence)


def require_within(name: str, value: float, low: float, high: float, unit: str = "") -> None:
    """Raise ValueError unless low ≤ value ≤ high."""
    unit = f" {unit}" if unit else ""
    require(low <= value <= high, f"{name} must lie between {low:g} and {high:g}{unit}, got {value:g}")
