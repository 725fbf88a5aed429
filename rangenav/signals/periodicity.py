"""What a formula's tree says about all time: is it a straight line, which frequencies does it repeat with?"""

from collections.abc import Iterable

from rangenav.signals.expressions import Node

TURNING = {"sin": 1.0, "cos": 1.0, "tan": 2.0}
"""Repeats of each function in a turn of 2π."""


def line(node: Node) -> tuple[float, float] | None:
    """(value at 0, slope) if the tree is a straight line in t, else None."""
    if node.is_number:
        return node.value, 0.0
    if node.operation == "t":
        return 0.0, 1.0
    sides = [line(argument) for argument in node.arguments]
    if len(sides) != 2 or sides[0] is None or sides[1] is None:
        return None
    (a, b), (c, d) = sides[0], sides[1]
    match node.operation:
        case "+":
            return a + c, b + d
        case "-":
            return a - c, b - d
        case "*" if b == 0 or d == 0:
            return a * c, a * d + b * c
        case "/" if d == 0 and c != 0:
            return a / c, b / c
    return None


def frequencies(node: Node) -> frozenset[float] | None:
    """The frequencies (rad/s) of all terms except straight lines; None if a term is not periodic."""
    if line(node) is not None:
        return frozenset()
    if node.operation in ("+", "-"):
        return _union(frequencies(argument) for argument in node.arguments)
    if node.operation == "*" and any(argument.is_number for argument in node.arguments):
        return _union(frequencies(argument) for argument in node.arguments)
    return _repeating(node)


def _repeating(node: Node) -> frozenset[float] | None:
    """As `frequencies`, but a straight line counts as not periodic: it multiplies or bends another term."""
    if node.is_number:
        return frozenset()
    inner = line(node.arguments[0]) if node.operation in TURNING else None
    if inner is not None:
        return frozenset({abs(inner[1]) * TURNING[node.operation]} - {0.0})
    if node.operation == "t":
        return None
    return _union(_repeating(argument) for argument in node.arguments)


def _union(parts: Iterable[frozenset[float] | None]) -> frozenset[float] | None:
    union: frozenset[float] = frozenset()
    for part in parts:
        if part is None:
            return None
        union |= part
    return union
