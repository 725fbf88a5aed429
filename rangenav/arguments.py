"""Arrays and numbers as a caller gives them, checked once: every public function that computes calls these first.

A compiled kernel reads memory at the places that shapes promise. So what a caller gives becomes an array of float64, in
C order, aligned and writeable, of the shape that is wanted, or a ValueError that names the argument, the shape wanted
and the shape given. Lists, integers and other precisions are converted; text, objects, booleans and complex numbers are
refused. A read-only array is copied: numba would compile every kernel once more for its type.
"""

import math
from typing import Any

import numpy as np
from numpy import ndarray as Array

DOUBLE = np.dtype(np.float64)
NUMBERS = "fiu"
"""Kinds of dtype that are converted: floats, integers, unsigned integers."""
REAL = (int, float, np.floating, np.integer)
Shape = tuple[int | str, ...]
"""Of an array: a letter stands for any length."""


def array(name: str, value: Any, shape: Shape, *, none: str = "") -> Array:
    """`value` as float64 of this shape; the same array where it is one already. Its numbers may be NaN or infinite.

    Raises ValueError in one sentence that names the argument, the shape wanted and the shape given; `none` is what the
    sentence adds where None was given.
    """
    if (
        type(value) is Array
        and value.dtype is DOUBLE  # an equal one that is another object is found, and not copied, below
        and value.flags.carray
        and (value.shape == shape or _fits(value.shape, shape))
    ):
        return value
    return _converted(name, value, shape, none)


def finite_array(name: str, value: Any, shape: Shape) -> Array:
    """The same, of finite numbers only. Raises ValueError naming the first place of one that is not."""
    checked = array(name, value, shape)
    finite = np.isfinite(checked)
    if not finite.all():
        place = ", ".join(str(int(k)) for k in np.argwhere(~finite)[0])
        raise ValueError(f"{name} must be finite, got {checked[~finite][0]} at [{place}]")
    return checked


def increasing_array(name: str, value: Any, shape: Shape) -> Array:
    """The same, of finite numbers each larger than the one before. Raises ValueError naming the first that is not."""
    checked = finite_array(name, value, shape)
    late = np.flatnonzero(~(np.diff(checked) > 0))
    if len(late):
        k = int(late[0])
        raise ValueError(f"{name} must increase: broken at [{k + 1}], {checked[k + 1]:g} after {checked[k]:g}")
    return checked


def number(name: str, value: Any) -> float:
    """`value` as a finite float. Raises ValueError for what is no real number (a boolean is none)."""
    kind = type(value)
    if kind is np.float64:
        value = float(value)
    elif kind is not float:
        if not isinstance(value, REAL) or kind is bool:
            raise ValueError(f"{name} must be a number, got {described(value)}")
        value = _as_float(value)
    if not math.isfinite(value):
        raise ValueError(f"{name} must be a finite number, got {value}")
    return value


def instance(name: str, value: Any, wanted: type, *, called: str) -> None:
    """Raise ValueError unless `value` is one of `wanted`, which the sentence calls `called`."""
    if not isinstance(value, wanted):
        raise ValueError(f"{name} must be a {called}, got {described(value)}")


def described(value: Any) -> str:
    """What a value is, for a sentence: an array by its shape, text in quotes, anything else by its type."""
    if value is None or isinstance(value, bool | np.bool_):
        return str(value)
    if isinstance(value, str):
        return repr(value if len(value) <= 40 else value[:39] + "…")
    if isinstance(value, Array):
        return f"an array of shape {value.shape}"
    return type(value).__name__


def _converted(name: str, value: Any, shape: Shape, none: str) -> Array:
    if isinstance(value, np.ma.MaskedArray):
        raise ValueError(f"{name} must not be a masked array: what its mask hides would be read")
    try:
        given = np.asarray(value)
    except (ValueError, TypeError, OverflowError):  # rows of different lengths, or an object that numpy cannot read
        raise ValueError(f"{name} must have shape {_written(shape)}, got rows of different lengths") from None
    if given.dtype.kind not in NUMBERS:
        raise ValueError(f"{name} must hold numbers, got {_strange(given)}{none if _has_none(given) else ''}")
    if not _fits(given.shape, shape):
        raise ValueError(f"{name} must have shape {_written(shape)}, got {given.shape}")
    with np.errstate(over="ignore"):  # a longdouble beyond float64 becomes infinite, and is refused as such
        return np.require(given, dtype=DOUBLE, requirements=("C", "A", "W", "E"))


def _as_float(value: Any) -> float:
    try:
        return float(value)
    except OverflowError:  # an int of hundreds of digits
        return math.inf


def _fits(given: tuple[int, ...], wanted: Shape) -> bool:
    if len(given) != len(wanted):
        return False
    for k, length in enumerate(wanted):  # noqa: SIM110, a generator takes five times as long
        if type(length) is not str and given[k] != length:
            return False
    return True


def _written(shape: Shape) -> str:
    """As numpy writes a shape, with letters for the lengths that are free."""
    return f"({', '.join(str(length) for length in shape)}{',' if len(shape) == 1 else ''})"


def _has_none(given: Array) -> bool:
    return given.dtype.kind == "O" and any(entry is None for entry in given.flat)


def _strange(given: Array) -> str:
    """What an array holds instead of numbers."""
    if _has_none(given):
        return "None"
    if given.dtype.kind == "O":
        return f"objects of type {', '.join(sorted({type(entry).__name__ for entry in given.flat}))}"
    return {"b": "booleans", "c": "complex numbers", "U": "text", "S": "bytes"}.get(given.dtype.kind, str(given.dtype))
