"""`rangenav tune` for a person."""

from collections.abc import Iterator
from typing import Any

from rangenav.commands.text import layout
from rangenav.commands.text.layout import Report, group
from rangenav.commands.text.verdict import Json
from rangenav.number_format import percent, quantity, significant
from rangenav.verdict import Sign

MEASURES = (
    ("settled", "runs that settle", "%"),
    ("settle_position_s", "position settles after", "s"),
    ("settle_attitude_s", "attitude settles after", "s"),
    ("steady_position", "steady position error", "m"),
    ("steady_attitude_deg", "steady attitude error", "°"),
)
"""Key of the answer, name, unit."""
SIDES = ("before", "after")
MOST_POINTS = 3
"""Points of each tradeoff curve that are shown; `--json` has all of them."""


def report(answer: Json, *, name: str) -> Report:
    """Gains before and after the search, judged on held-out seeds; `answer` is the JSON object."""
    objective, held = answer["objective"], answer["held_out"]
    better = objective["after"] < objective["before"]
    sign: Sign = "✓" if better else "!"
    first, last = held["seeds"]
    saved, typed = answer["saved"], layout.argument(answer["saved"] or name)
    save = (f"simulate {typed}",) if saved else (f"tune {typed} -o tuned.toml",)
    return Report(
        subject=layout.subject(name),
        sign=sign,
        answer=f"{'better gains were found' if better else 'no better gains were found'} "
        f"(objective {significant(objective['before'])} → {significant(objective['after'])})",
        groups=(
            *group("the search", f"{answer['evaluations']} gains tried, {answer['runs']} training runs each"),
            *group("held-out seeds", _compared(held), f"(seeds {first} to {last}, before → after)"),
            *group("training seeds", _compared(answer["training"])),
            *group("random starts", f"held: {_change(answer['starts_held'], '%')}"),
            *group("gains changed", _gains(answer["gains"])),
            *(one for part, points in answer["curve"].items() for one in group(f"{part} tradeoff", _points(points))),
            *group("saved", saved),
            *layout.next_commands(*save),
        ),
    )


def _compared(sides: Json) -> list[str]:
    return [f"{name}: {_change({side: sides[side][key] for side in SIDES}, unit)}" for key, name, unit in MEASURES]


def _change(sides: Json, unit: str) -> str:
    before, after = (percent(sides[side]) if unit == "%" else quantity(sides[side], unit) for side in SIDES)
    return f"{before} → {after}"


def _gains(sides: Json) -> list[str]:
    """The gains that the search has changed, named as in a preset's file."""
    before, after = dict(_leaves(sides["before"])), dict(_leaves(sides["after"]))
    changed = [f"{key}: {_value(value)} → {_value(after[key])}" for key, value in before.items() if after[key] != value]
    return changed or ["none"]


def _leaves(value: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, entry in value.items():
            yield from _leaves(entry, (*path, key))
    else:
        yield " ".join(path), value


def _value(value: Any) -> str:
    if isinstance(value, list | tuple):
        return f"({', '.join(_value(entry) for entry in value)})"
    return significant(value) if isinstance(value, float) else str(value)


def _points(points: list[Json]) -> list[str]:
    """The fastest, the middle and the most exact point of a tradeoff curve."""
    chosen = points if len(points) <= MOST_POINTS else [points[0], points[len(points) // 2], points[-1]]
    return [point["words"].replace(" °", "°") for point in chosen]
