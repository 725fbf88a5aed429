"""Everything that is computed is a frozen dataclass, time first, compared by identity, which prints as a few lines.

    >>> record.run(preset.load("paper")).estimate
    Estimate(time (4001) 0 … 20 s, state (4001, 13) -245 … 254, covariance (4001, 3, 3, 3) -43.3 … 100,
        xi_variance (4001, 4) 0.00191 … 2.51e+05, rotation (4001, 3, 3) -0.998 … 1,
        innovation (4001, 2) -0.357 … 0.393 (2 not finite), k1 (4001) 4 1/s)

An array is shown as its shape, its least and its largest finite number, and its unit where all of it has one.
"""

import ast
import dataclasses
import itertools
import re
from functools import cache
from typing import Any, TypeVar, dataclass_transform

import numpy as np

from rangenav import python_text

T = TypeVar("T")
WIDTH = 110
"""Characters of a line."""
LONGEST = 60
"""Characters of a text that is shown."""
UNIT = re.compile(
    r"(?:1/s|1/\(m⁴ s\)|s⁴/m²|Hz|(?:m|s|rad|\(rad/s\)|\(m/s²\))[²³⁴⁷]?(?:/(?:s|Hz)(?:[²³⁴⁷]|\^[\d.]+)?)?)(?=[,.:;]|$)"
)
"""What the docstring under a field begins with, if it begins with a unit."""


@dataclass_transform(frozen_default=True, eq_default=False, kw_only_default=True)
def result(kind: type[T]) -> type[T]:
    """The decorator of every class of results: a frozen, keyword-only dataclass without equality, of a short `repr`."""
    decorated = dataclasses.dataclass(frozen=True, eq=False, kw_only=True, repr=False)(kind)
    decorated.__repr__ = summary  # pyright: ignore[reportAttributeAccessIssue]
    return decorated


def summary(results: Any) -> str:
    """The fields of a result in a few lines: shapes and spans instead of numbers."""
    known = units(type(results))
    parts = [
        f"{field.name} {_shown(getattr(results, field.name))}{known.get(field.name, '')}"
        for field in dataclasses.fields(results)
    ]
    lines = [f"{type(results).__name__}("]
    for k, part in enumerate(parts):
        text = part + (")" if k == len(parts) - 1 else ", ")
        if len(lines[-1]) + len(text) > WIDTH:
            lines.append("    ")
        lines[-1] += text
    return "\n".join(line.rstrip() for line in lines)


def _shown(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return _array(value)
    if isinstance(value, float | np.floating):
        return f"{value:.6g}"
    if isinstance(value, str):
        return repr(value if len(value) <= LONGEST else value[: LONGEST - 1] + "…")
    if value is None or isinstance(value, bool | int):
        return str(value)
    if isinstance(value, tuple | list):
        return _several(value)
    title = getattr(value, "title", None) or getattr(value, "name", None)
    return type(value).__name__ + (f" {title!r}" if isinstance(title, str) else "")


def _several(values: Any) -> str:
    if len(values) <= 3 and all(value is None or isinstance(value, str | float | int) for value in values):
        return f"({', '.join(_shown(value) for value in values)})"
    kinds = sorted({type(value).__name__ for value in values})
    return f"{len(values)} × {' or '.join(kinds)}" if len(values) else "none"


def _array(values: np.ndarray) -> str:
    shape = f"({', '.join(str(length) for length in values.shape)})"
    if values.dtype == bool:
        return f"{shape} {int(values.sum())} true"
    if not np.issubdtype(values.dtype, np.number):
        return f"{shape} {values.dtype}"
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return f"{shape} none finite" if values.size else shape
    low, high = finite.min(), finite.max()
    span = f"{low:.3g}" if low == high else f"{low:.3g} … {high:.3g}"
    missing = values.size - finite.size
    return f"{shape} {span}{f' ({missing} not finite)' if missing else ''}"


@cache
def units(kind: type) -> dict[str, str]:
    """Units by field, with a blank before each, read from the docstrings under them: they are written once, there."""
    body, known = python_text.class_statements(kind), {}
    for field, docstring in itertools.pairwise(body):
        if not (isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)):
            continue
        if isinstance(docstring, ast.Expr) and isinstance(docstring.value, ast.Constant):
            unit = UNIT.match(str(docstring.value.value))
            if unit:
                known[field.target.id] = f" {unit[0]}"
    return known
