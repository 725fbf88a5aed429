"""Formulas of any kind of text."""

from random import Random

import numpy as np

from rangenav.signals import Formula, expressions, series
from tests.fuzz import sentences

GRID = np.linspace(0, 10, 48)
WORDS = [
    *expressions.NAMES,
    *expressions.KINKED,
    "lambda",
    "import",
    "__import__",
    "exec",
    "eval",
    "t.real",
    "if",
    "for",
]
SIGNS = [
    "+",
    "-",
    "*",
    "/",
    "**",
    "(",
    ")",
    ",",
    ".",
    "^",
    "=",
    " ",
    "//",
    "%",
    "@",
    "[",
    "]",
    "{",
    "'",
    '"',
    "\\",
    "\n",
    ";",
    ":=",
]
NUMBERS = [
    "0",
    "1",
    "2",
    "3.5",
    "1e-9",
    "1e9",
    "1e308",
    "9" * 40,
    "0x1f",
    "1_0",
    "2j",
    ".5",
    "5.",
    "1e",
    "-7",
    "64",
    "65",
]


def formula(random: Random) -> None:
    """Text of any kind as a formula: refused in one line, or evaluated, bounded and found finite."""
    text = _formula_text(random)
    try:
        signal = Formula(x=text)
        value = signal(GRID, random.randrange(6))
    except ValueError as error:
        sentences.check(str(error), "x: ")
        return
    assert np.isfinite(value).all(), text
    if random.random() < 0.05:
        order = random.randrange(6)
        try:
            largest = float(np.abs(signal(GRID, order)[:, 0]).max())
        except ValueError:
            return
        assert largest <= signal.bound(order) * (1 + 1e-12) or largest < 1e-290, text
        assert signal.period is None or signal.period >= 0
        assert signal.bandwidth_until(10.0) >= 0


def _formula_text(random: Random) -> str:
    kind = random.random()
    if kind < 0.35:
        return _grown(random, random.randint(0, 5))
    if kind < 0.65:
        text = _grown(random, random.randint(1, 4))
        for _ in range(random.randint(1, 3)):
            start = random.randint(0, len(text))
            text = text[:start] + random.choice((*SIGNS, *NUMBERS, *WORDS)) + text[start + random.choice((0, 1, 2)) :]
        return text
    if kind < 0.9:
        return "".join(random.choice((*SIGNS, *NUMBERS, *WORDS)) for _ in range(random.randint(0, 25)))
    if kind < 0.95:
        return "".join(chr(random.randrange(1, 0x2FFF)) for _ in range(random.randint(0, 30)))
    return random.choice(("(", "-", "sin(", "t**", "t+", "9", "1/", "+t")) * random.randint(1, 3000)


def _grown(random: Random, depth: int) -> str:
    """A formula that follows the grammar."""
    if depth == 0:
        return random.choice(("t", "t", "pi", "e", str(random.randint(0, 9)), f"{random.uniform(0, 20):.3g}"))
    inner = _grown(random, depth - 1)
    kind = random.random()
    if kind < 0.35:
        return f"{random.choice([*series.FUNCTIONS])}({inner})"
    if kind < 0.45:
        return f"({inner})**{random.choice(('2', '3', '-1', '0.5', '-2', '7', '1.5', 't'))}"
    if kind < 0.5:
        return f"-({inner})"
    return f"({inner}) {random.choice('+-*/')} ({_grown(random, random.randrange(depth))})"
