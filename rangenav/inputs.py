"""What a person chooses is a frozen value: equal by value, hashable, finite, and readable from TOML.

Inputs are `msgspec.Struct`s rather than dataclasses because only those refuse unknown keys and form tagged unions;
they are frozen all the same. Each class says so again, and keyword-only: type checkers do not inherit the one, nor
msgspec the other.

msgspec checks types when it reads a file, and not when Python calls the class. `Input.__post_init__` checks them in
both cases, so that a value made in Python is the value that its file gives: whole numbers become floats where the field
is a float, lists and arrays become tuples, scalars of numpy become Python's. Equality, hashes and caches rely on it.
msgspec 0.22 is the first version whose `structs.replace` calls `__post_init__`.
"""

import math
from collections.abc import Callable
from functools import cache
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import msgspec
import numpy as np

from rangenav.arguments import described, number

MAX_SENTENCE = 300
"""Characters of a parser's message."""
LONGEST_WORD = 40
"""Characters; a longer one is cut."""
Vec3 = tuple[float, float, float]
Check = Callable[[str, Any], Any]
"""(name of the field, value) -> the value in the field's type, the same object where it has that type already."""


class Input(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Base of every input: every field has its type, and numbers are finite. Subclasses add rules in `__post_init__`.

    Raises ValueError in one sentence that names the field.
    """

    def __post_init__(self) -> None:
        for name, check in _checks(type(self)).items():
            value = getattr(self, name)
            checked = check(name, value)
            if checked is not value:
                msgspec.structs.force_setattr(self, name, checked)


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
    if low <= value <= high:  # before the sentence, which takes longer than the rule
        return
    unit = f" {unit}" if unit else ""
    raise ValueError(f"{name} must lie between {low:g} and {high:g}{unit}, got {value:g}")


def shortened(sentence: str) -> str:
    """One line of a readable length, for the message of a parser: it repeats a wrong value whole, then says where it
    stands."""
    line = " ".join(sentence.split())
    half = MAX_SENTENCE // 2
    return line if len(line) <= MAX_SENTENCE else f"{_words(line[:half])} … {_words(line[-half:][::-1])[::-1]}"


def _words(cut: str) -> str:
    """A text that was cut, without the word that the cut went through, unless the word is very long."""
    head, _, word = cut.rpartition(" ")
    return head if head and len(word) <= LONGEST_WORD else cut


@cache
def _checks(kind: type[Input]) -> dict[str, Check]:
    """A check for each field of a class, found once."""
    hints = get_type_hints(kind)
    return {name: _check(hints[name]) for name in kind.__struct_fields__}


def _check(hint: Any) -> Check:
    """The check of one type. Raises TypeError for a type that no field has had so far: it needs a line here."""
    simple: dict[Any, Check] = {float: number, int: _whole, bool: _flag, str: _text, NoneType: _nothing}
    if hint in simple:
        return simple[hint]
    origin, parts = get_origin(hint), get_args(hint)
    if origin is Literal:
        return _choice(parts)
    if origin is tuple and parts[-1] is ...:
        return _sequence(_check(parts[0]))
    if origin is tuple:
        return _row(parts)
    if origin in (Union, UnionType):
        return _union(parts)
    if isinstance(hint, type) and issubclass(hint, msgspec.Struct):
        return _one_of((hint,))
    raise TypeError(f"no check for a field of type {hint}")


def _whole(name: str, value: Any) -> int:
    if type(value) is int:
        return value
    exact = number(name, value)
    if not exact.is_integer():
        raise ValueError(f"{name} must be a whole number, got {exact:g}")
    return int(value)


def _flag(name: str, value: Any) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} must be true or false, got {described(value)}")
    return bool(value)


def _text(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{name} must be text, got {described(value)}")
    return value if type(value) is str else str(value)


def _nothing(name: str, value: Any) -> None:
    if value is not None:
        raise ValueError(f"{name} must be None, got {described(value)}")


def _choice(options: tuple[Any, ...]) -> Check:
    def check(name: str, value: Any) -> Any:
        given = value.item() if isinstance(value, np.generic) else value
        for option in options:
            if type(given) is type(option) and given == option:
                return given
        raise ValueError(f"{name} must be one of {', '.join(map(repr, options))}, got {described(value)}")

    return check


def _sequence(entry: Check) -> Check:
    def check(name: str, value: Any) -> tuple[Any, ...]:
        entries = _entries(name, value)
        checked = tuple(entry(name, one) for one in entries)
        return _same(value, checked)

    return check


def _row(parts: tuple[Any, ...]) -> Check:
    each = [_check(part) for part in parts]
    of_numbers = all(part is float for part in parts)

    def check(name: str, value: Any) -> tuple[Any, ...]:
        if of_numbers and type(value) is tuple and len(value) == len(each) and _finite_floats(value):
            return value  # most rows: a third of the time that what follows takes
        entries = _entries(name, value)
        if len(entries) != len(each):
            raise ValueError(f"{name} must have {len(each)} entries, got {len(entries)}")
        return _same(value, tuple(entry(name, one) for entry, one in zip(each, entries, strict=True)))

    return check


def _finite_floats(row: tuple[Any, ...]) -> bool:
    for entry in row:  # noqa: SIM110, a generator takes twice as long
        if type(entry) is not float or not math.isfinite(entry):
            return False
    return True


def _union(parts: tuple[Any, ...]) -> Check:
    """None, or one of several Structs, or the one other type that may stand there."""
    structs = tuple(part for part in parts if isinstance(part, type) and issubclass(part, msgspec.Struct))
    others = tuple(part for part in parts if part not in structs and part is not NoneType)
    optional = NoneType in parts
    if len(others) > 1 or (others and structs):
        raise TypeError(f"no check for a field of types {parts}")
    inner = _check(others[0]) if others else _one_of(structs)

    def check(name: str, value: Any) -> Any:
        return None if optional and value is None else inner(name, value)

    return check


def _one_of(kinds: tuple[Any, ...]) -> Check:
    names = ", ".join(kind.__name__ for kind in kinds)

    def check(name: str, value: Any) -> Any:
        if not isinstance(value, kinds):
            raise ValueError(f"{name} must be a {names}, got {described(value)}")
        return value

    return check


def _entries(name: str, value: Any) -> tuple[Any, ...] | list[Any]:
    if isinstance(value, np.ndarray) and value.ndim > 0:
        return value.tolist()
    if not isinstance(value, tuple | list):
        raise ValueError(f"{name} must be a tuple, got {described(value)}")
    return value


def _same(value: Any, checked: tuple[Any, ...]) -> tuple[Any, ...]:
    """`value` itself where no entry was converted: msgspec leaves a default out of a file only if it is that object."""
    if type(value) is tuple and all(a is b for a, b in zip(value, checked, strict=True)):
        return value
    return checked
