"""Numbers on the command line are finite and of a sensible length: one rule for every option of every command."""

import math
from collections.abc import Callable
from typing import Any

from tyro.constructors import ConstructorRegistry, PrimitiveConstructorSpec, PrimitiveTypeInfo

MAX_DIGITS = 18
"""Characters of a whole number: all such numbers fit into 64 bits."""
SHOWN = 20
"""Characters of a wrong number that a message repeats."""

registry = ConstructorRegistry()


@registry.primitive_rule
def number_rule(type_info: PrimitiveTypeInfo) -> PrimitiveConstructorSpec[Any] | None:
    """How tyro reads floats and whole numbers, of options that may be left out too; None for other types."""
    if type_info.type in (float, float | None):
        return _spec(float, finite)
    if type_info.type in (int, int | None):
        return _spec(int, whole)
    return None


def finite(text: str) -> float:
    """A finite number. Raises ValueError."""
    try:
        value = math.nan if "_" in text else float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"must be a finite number, got {_shown(text)}")
    return value


def whole(text: str) -> int:
    """A whole number of at most 18 digits. Raises ValueError."""
    try:
        if len(text) > MAX_DIGITS or "_" in text:
            raise ValueError
        return int(text)
    except ValueError:
        raise ValueError(f"must be a whole number of at most {MAX_DIGITS} digits, got {_shown(text)}") from None


def _spec(kind: type, read: Callable[[str], Any]) -> PrimitiveConstructorSpec[Any]:
    return PrimitiveConstructorSpec(
        nargs=1,
        metavar=kind.__name__.upper(),
        instance_from_str=lambda arguments: read(arguments[0]),
        is_instance=lambda value: value is None or isinstance(value, int if kind is int else int | float),
        str_from_instance=lambda value: [str(value)],
    )


def _shown(text: str) -> str:
    return repr(text if len(text) <= SHOWN else text[:SHOWN] + "…")
