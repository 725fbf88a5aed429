"""The text of a formula becomes a small tree, by a whitelist: typed text is never executed.

First every character must belong to a number, a known name or an operator, in an order that makes sense, so mistakes
are found at their column; only then Python's own parser settles precedence, and its tree is translated node by node.
Length, depth and size are bounded before any work starts.
"""

import ast
import math
import re
from dataclasses import dataclass
from difflib import get_close_matches
from functools import lru_cache

import numpy as np

from rangenav import python_text
from rangenav.signals import series
from rangenav.signals.series import Series

MAX_LENGTH = 1000
MAX_NODES, MAX_DEPTH, MAX_PARENTHESES = 300, 150, 40
MAX_EXPONENT = 64
"""Largest constant power: t**64 over ten minutes is 1e178, and the square of more overflows."""
CONSTANTS = {"pi": math.pi, "e": math.e}
KINKED = ("abs", "fabs", "min", "max", "sign", "floor", "ceil", "round", "mod", "fmod", "trunc")
NAMES = ("t", *CONSTANTS, *series.FUNCTIONS, "pow")
TOKEN = re.compile(
    r"[ \t]*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z_0-9]*)|(?P<sign>\*\*|[-+*/(),]))",
    re.ASCII,
)
OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"}
CACHED = 256


@dataclass(frozen=True, slots=True)
class Node:
    """One operation: a number, "t", an operator or a function, and its arguments."""

    operation: str
    arguments: tuple["Node", ...] = ()
    value: float = 0.0
    """The value of a number, or the exponent of "**"."""

    @property
    def is_number(self) -> bool:
        return self.operation == "number"


@lru_cache(maxsize=CACHED)
def parse(text: str) -> Node:
    """The tree of a formula in t. Raises ValueError with one sentence that points at the column (from 1)."""
    if len(text) > MAX_LENGTH:
        raise ValueError(f"a formula may have {MAX_LENGTH} characters, this one has {len(text)}")
    _check_words(text)
    try:
        tree = python_text.expression(f"({text})")  # so leading blanks do no harm, and columns count from 1
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ValueError("this is no formula") from None
    return _Translation().node(tree, depth=0)


def evaluate(node: Node, t: Series, order: int) -> Series:
    """The series of a tree; t is the series of time, over numbers or intervals."""
    if node.is_number:
        return series.constant(node.value)
    if node.operation == "t":
        return t[: order + 1]
    a = [evaluate(argument, t, order) for argument in node.arguments]
    match node.operation:
        case "+":
            return series.add(a[0], a[1])
        case "-":
            return series.add(a[0], series.negative(a[1]))
        case "*":
            return series.multiply(a[0], a[1], order)
        case "/":
            return series.divide(a[0], a[1], order)
        case "**":
            whole = node.value == int(node.value)
            power = series.integer_power(a[0], int(node.value), order) if whole else None
            return series.real_power(a[0], node.value, order) if power is None else power
        case name:
            return series.FUNCTIONS[name](a[0], order)


def size(node: Node) -> int:
    """The number of operations in the tree."""
    return 1 + sum(size(argument) for argument in node.arguments)


def _at(column: int, sentence: str) -> ValueError:
    return ValueError(f"{sentence} (column {column})")


def _check_words(text: str) -> None:
    """Refuse a character that begins no token, an unknown name, and a token in a wrong place."""
    position, depth, wanted, function = 0, 0, True, ""
    end = len(text.rstrip(" \t"))
    while position < end:
        match = TOKEN.match(text, position)
        if match is None:
            column = position + len(text[position:]) - len(text[position:].lstrip(" \t")) + 1
            raise _at(column, _strange(text[column - 1]))
        kind = str(match.lastgroup)
        word, column, position = match[kind], match.start(kind) + 1, match.end()
        if function and word != "(":
            raise _at(column, f"{function} needs parentheses, as in {function}(t)")
        function = ""
        if kind == "name":
            _check_name(word, column)
        opens = kind in ("number", "name") or word == "("
        if opens and not wanted:
            raise _at(column, f"an operator such as * is missing before {word[:20]}")
        if not opens and wanted and word not in ("+", "-"):
            raise _at(column, f"t, a number or a function is missing before {word}")
        depth += (word == "(") - (word == ")")
        if depth < 0 or depth > MAX_PARENTHESES:
            raise _at(column, "this ) closes nothing" if depth < 0 else "parentheses are nested too deeply")
        function = word if word in series.FUNCTIONS or word == "pow" else ""
        wanted = bool(function) or (kind == "sign" and word != ")")
    if wanted:
        raise _at(end + 1, "the formula is empty" if end == 0 else "t, a number or a function is missing at the end")
    if depth:
        raise _at(end + 1, "a ) is missing at the end")


def _strange(character: str) -> str:
    hints = {"^": "write ** for a power", "=": "write only what stands to its right"}
    shown = character if character.isprintable() else f"U+{ord(character):04X}"
    return f"{shown} has no meaning in a formula" + (f": {hints[character]}" if character in hints else "")


def _check_name(name: str, column: int) -> None:
    if name in NAMES:
        return
    if name in KINKED:
        raise _at(column, f"{name} has kinks or jumps, where derivatives do not exist: use something smooth instead")
    close = get_close_matches(name[:20], NAMES, n=1, cutoff=0.6)
    hint = f"did you mean {close[0]}?" if close else "known are t, pi, e and functions such as sin, exp, sqrt"
    raise _at(column, f"{name[:20]} is not known: {hint}")


class _Translation:
    """Python's tree as nodes; counts the nodes."""

    def __init__(self) -> None:
        self._count = 0

    def node(self, tree: ast.expr, *, depth: int) -> Node:
        self._count += 1
        column = tree.col_offset
        if self._count > MAX_NODES or depth > MAX_DEPTH:
            raise _at(
                column, f"the formula is too large: at most {MAX_NODES} operations, {MAX_DEPTH} inside one another"
            )
        match tree:
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                return _number(value, column)
            case ast.Name(id="t"):
                return Node("t")
            case ast.Name(id=name) if name in CONSTANTS:
                return Node("number", value=CONSTANTS[name])
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.node(operand, depth=depth + 1)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return _folded(Node("*", (Node("number", value=-1.0), self.node(operand, depth=depth + 1))), column)
            case ast.BinOp(left=left, op=operator, right=right) if type(operator) in OPERATORS:
                sides = self.node(left, depth=depth + 1), self.node(right, depth=depth + 1)
                operation = OPERATORS[type(operator)]
                if operation == "/" and sides[1].is_number and sides[1].value == 0:
                    raise _at(right.col_offset, "this divides by zero")
                return (
                    _power(sides[0], sides[1], column) if operation == "**" else _folded(Node(operation, sides), column)
                )
            case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
                return self._call(name, arguments, column, depth)
        raise _at(column, "this is no formula")

    def _call(self, name: str, arguments: list[ast.expr], column: int, depth: int) -> Node:
        wanted = 2 if name == "pow" else 1
        if len(arguments) != wanted or any(isinstance(argument, ast.Starred) for argument in arguments):
            raise _at(column, f"{name} takes {wanted} argument{'s' * (wanted > 1)}")
        inner = tuple(self.node(argument, depth=depth + 1) for argument in arguments)
        return _power(inner[0], inner[1], column) if name == "pow" else _folded(Node(name, inner), column)


def _number(value: float, column: int) -> Node:
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise _at(column, "this number is too large")
    return Node("number", value=number)


def _power(base: Node, exponent: Node, column: int) -> Node:
    """A constant exponent is kept as a number; any other power is exp(exponent · log base)."""
    if not exponent.is_number:
        return _folded(Node("exp", (Node("*", (exponent, _folded(Node("log", (base,)), column))),)), column)
    if abs(exponent.value) > MAX_EXPONENT:
        raise _at(column, f"the exponent must lie between -{MAX_EXPONENT} and {MAX_EXPONENT}")
    if exponent.value == 0:
        return Node("number", value=1.0)
    return _folded(Node("**", (base,), exponent.value), column)


def _folded(node: Node, column: int) -> Node:
    """A node whose arguments are numbers becomes a number."""
    if not all(argument.is_number for argument in node.arguments):
        return node
    with np.errstate(all="ignore"):
        try:
            value = float(evaluate(node, (0.0,), 0)[0])
        except (ZeroDivisionError, OverflowError, ValueError):
            value = math.nan
    if not math.isfinite(value):
        raise _at(column, f"{node.operation} has no finite value here")
    return Node("number", value=value)
