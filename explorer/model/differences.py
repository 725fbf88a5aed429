"""What differs between two runs, as sentences: the settings, and the figures that follow from them."""

import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import msgspec

from explorer.model.compute import Picture
from explorer.model.glossary import field_label
from explorer.model.settings import PRINTED_LABELS, Printed
from rangenav.number_format import percent, quantity, significant
from rangenav.preset import Preset

NOTABLE = 0.005
"""Relative: a smaller change of a figure is not listed."""
MAX_CHOICES = 24
NOT_REACHED = "not reached"
MIN_FACTOR = 10.0
"""A change by this factor or more is written as a factor, a smaller one in percent."""


class Figure(NamedTuple):
    """One number of a run; None where the run does not have it."""

    name: str
    unit: str
    of: Callable[[Picture], float | None]
    steady: bool = False
    """Whether it is a mean over the last quarter, which nothing is once an observer has diverged."""


FIGURES = (
    Figure("quantities determined", "of 13", lambda p: p.analysis.rank),
    Figure("excitation μ", "m²/s⁷", lambda p: p.analysis.resolved_mu),
    Figure("best error from one window, linear model", "m", lambda p: p.analysis.lifted_end.position),
    Figure("best error from one window, true model", "m", lambda p: p.analysis.nonlinear_end.position),
    Figure("steady position error", "m", lambda p: p.summary.steady_position, steady=True),
    Figure("steady velocity error", "m/s", lambda p: p.summary.steady_velocity, steady=True),
    Figure("steady attitude error", "°", lambda p: p.summary.steady_attitude_deg, steady=True),
    Figure("position settled", "s", lambda p: p.summary.settle_position_s),
    Figure("attitude settled", "s", lambda p: p.summary.settle_attitude_s),
    Figure("largest position error", "m", lambda p: p.summary.peak_position),
    Figure("thrust over weight", "", lambda p: p.limits.thrust_to_weight),
    Figure("speed", "m/s", lambda p: p.limits.speed),
)


def figures(a: Picture, b: Picture) -> list[str]:
    """One sentence for each figure that changed from A to B."""
    before, after = a.analysis.verdict.summary, b.analysis.verdict.summary
    sentences = [f"{before} → {after}"] if before != after else []
    first, second = (run.summary.fit.summary(blind=run.analysis.blind) for run in (a, b))
    if first != second:
        sentences.append(f"on its ranges: {first} → {second}")
    for name, run in (("A", a), ("B", b)):
        if run.summary.diverged:
            sentences.append(f"{name}'s observer has diverged: {run.summary.divergence}")
    changes = ((figure, reached(figure, a), reached(figure, b)) for figure in FIGURES)
    return sentences + [_sentence(figure, x, y) for figure, x, y in changes if notable(x, y)]


def reached(figure: Figure, run: Picture) -> float | None:
    """A figure of a run; None where the run does not have it: nothing of a diverged observer is steady."""
    return None if figure.steady and run.summary.diverged else figure.of(run)


def notable(before: float | None, after: float | None) -> bool:
    """Whether a figure changed by more than half a percent, or exists in one run only."""
    x, y = _number(before), _number(after)
    if math.isnan(x) or math.isnan(y):
        return math.isnan(x) != math.isnan(y)
    return abs(y - x) > NOTABLE * max(abs(x), abs(y))


def chosen(a: Picture, b: Picture) -> list[str]:
    """All that was chosen otherwise: the switches “as printed”, then the settings of the preset."""
    before, after = a.settings.printed, b.settings.printed
    names = (name for name in PRINTED_LABELS if getattr(before, name) != getattr(after, name))
    switches = [_capital(f"{PRINTED_LABELS[name]}: {_state(before, name)} → {_state(after, name)}") for name in names]
    return switches + choices(a.preset, b.preset)


def choices(a: Preset, b: Preset) -> list[str]:
    """The settings that differ, by their labels on the page: the first of them, then the number of the others."""
    differing = list(_choices(msgspec.to_builtins(a), msgspec.to_builtins(b), ""))
    more = len(differing) - MAX_CHOICES
    return differing if more <= 0 else [*differing[:MAX_CHOICES], f"and {more} more"]


def _choices(a: Any, b: Any, where: str) -> Iterator[str]:
    if isinstance(a, dict) and isinstance(b, dict) and a.get("type") == b.get("type"):
        for key in a | b:
            if key not in ("title", "story", "expect"):
                yield from _choices(a.get(key), b.get(key), f"{where}.{key}" if where else key)
    elif isinstance(a, list | tuple) and isinstance(b, list | tuple) and len(a) == len(b) and _has_tables(a):
        for k, (x, y) in enumerate(zip(a, b, strict=True)):
            yield from _choices(x, y, f"{where}[{k + 1}]")
    elif a != b:
        label = _capital(field_label(where))
        yield f"{label}: {_value(a)} → {_value(b)}" if _short(a) and _short(b) else f"{label}: another one"


def _state(printed: Printed, name: str) -> str:
    return "on" if getattr(printed, name) else "off"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _has_tables(entries: Any) -> bool:
    return any(isinstance(entry, dict) for entry in entries)


def _short(value: Any) -> bool:
    """Whether a value can be written in a few characters: a number, a short text or a vector."""
    numbers = isinstance(value, list | tuple) and len(value) <= 3 and all(isinstance(x, float | int) for x in value)
    return numbers or value is None or isinstance(value, float | int) or (isinstance(value, str) and len(value) < 24)


def _value(value: Any) -> str:
    if isinstance(value, list | tuple):
        return f"({', '.join(_value(entry) for entry in value)})"
    if value is None:
        return "none"
    return significant(value, 4) if isinstance(value, float) else str(value)


def _sentence(figure: Figure, before: float | None, after: float | None) -> str:
    x, y = _number(before), _number(after)
    # the unit stands once, behind the last number
    first = quantity(x, figure.unit if math.isnan(y) else "", otherwise=NOT_REACHED)
    text = f"{figure.name} {first} → {quantity(y, figure.unit, otherwise=NOT_REACHED)}".rstrip()
    return (
        f"{text} ({_how_much(x, y)})" if x > 0 and y > 0 and math.isfinite(x + y) and figure.unit != "of 13" else text
    )


def _number(value: float | None) -> float:
    return math.nan if value is None or not math.isfinite(value) else float(value)


def _how_much(x: float, y: float) -> str:
    ratio = y / x
    if not 1 / MIN_FACTOR < ratio < MIN_FACTOR:
        return f"{significant(ratio)} times as much" if ratio > 1 else f"{significant(1 / ratio)} times less"
    return f"{percent(abs(ratio - 1))} {'more' if ratio > 1 else 'less'}" if abs(ratio - 1) >= 0.01 else "about 1 %"
