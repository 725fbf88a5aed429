"""A value made in Python is the value that its file gives: the same types, equal, with the same hash, or refused."""

# pyright: reportArgumentType=false
# Values of the wrong type are what this file is about.

import importlib
import pkgutil
from collections.abc import Iterator
from typing import Any, Literal

import msgspec
import numpy as np
import pytest

import explorer
import rangenav
from rangenav import preset
from rangenav.inputs import Input, Vec3
from rangenav.motion import World
from rangenav.record import TruthInputs, truth_inputs
from rangenav.signals import Multisine, Piece, Polynomials, Tone, Waypoint, Waypoints
from tests.support.refusals import exactly


def every_input() -> list[type[Input]]:
    """The classes that are made. A base, whose name begins with an underscore, is checked as its descendants."""
    for package in (rangenav, explorer):
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if not module.name.endswith("__main__"):
                importlib.import_module(module.name)
    classes, inputs = [Input], []
    while classes:
        kind = classes.pop()
        classes += kind.__subclasses__()
        base = kind.__name__.startswith("_") and kind.__subclasses__()
        if kind.__struct_fields__ and not base and kind.__module__.startswith(("rangenav", "explorer")):
            inputs.append(kind)
    return sorted(inputs, key=lambda kind: (kind.__module__, kind.__name__))


INPUTS = every_input()


def inside(value: Any) -> Iterator[Input]:
    """The inputs that a value is made of, itself among them."""
    if isinstance(value, Input):
        yield value
        value = msgspec.structs.astuple(value)
    if isinstance(value, tuple):
        for entry in value:
            yield from inside(entry)


def as_numpy(value: Any) -> Any:
    """The same numbers as a program would hold them: lists, arrays, and scalars of numpy."""
    if isinstance(value, bool):
        return np.bool_(value)
    if isinstance(value, int):
        return np.int64(value)
    if isinstance(value, float):
        return int(value) if value.is_integer() and abs(value) < 2**53 else np.float64(value)
    if isinstance(value, str):
        return np.str_(value)
    if isinstance(value, tuple) and value and all(isinstance(entry, float) for entry in value):
        return np.array(value)
    return [as_numpy(entry) for entry in value] if isinstance(value, tuple) else value


@pytest.mark.parametrize("name", preset.shipped())
def test_lists_and_numbers_of_numpy_make_the_value_of_the_file(name):
    for value in inside(preset.load(name)):
        fields = {field: as_numpy(getattr(value, field)) for field in value.__struct_fields__}
        made = type(value)(**fields)
        assert made == value
        assert hash(made) == hash(value)
        assert repr(made) == repr(value)
        assert msgspec.structs.replace(value, **fields) == value


def test_what_is_cached_by_its_input_is_found_again():
    course = truth_inputs(preset.load("paper"))
    table = {course: "found"}
    again = TruthInputs(**{name: as_numpy(getattr(course, name)) for name in course.__struct_fields__})
    assert table[again] == "found"


@pytest.mark.parametrize("kind", INPUTS, ids=lambda kind: kind.__name__)
def test_no_field_of_any_input_takes_an_object_or_a_number_in_place_of_its_type(kind):
    """Every class that there is, so that a field of a new type cannot be left unchecked."""
    needed = dict.fromkeys(kind.__struct_fields__, object())
    for value in (object(), 1j, b"bytes", {"a": 1}):
        with pytest.raises(ValueError, match=rf"\A{kind.__struct_fields__[0]} must "):
            kind(**needed | {kind.__struct_fields__[0]: value})


@pytest.mark.parametrize("kind", INPUTS, ids=lambda kind: kind.__name__)
def test_a_boolean_is_no_number_in_any_field_of_any_input(kind):
    for info in msgspec.structs.fields(kind):
        if info.type in (float, int, float | None):
            defaults = {
                one.name: one.default for one in msgspec.structs.fields(kind) if one.default is not msgspec.NODEFAULT
            }
            before = kind.__struct_fields__[: kind.__struct_fields__.index(info.name)]
            if set(before) <= set(defaults):  # the fields before it are checked first
                fields = dict.fromkeys(kind.__struct_fields__, 1.0) | defaults | {info.name: True}
                with pytest.raises(ValueError, match=exactly(f"{info.name} must be a number, got True")):
                    kind(**fields)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: Waypoint(time="1", value=(0, 0, 0)), "time must be a number, got '1'"),
        (lambda: Waypoint(time=1, value=(0, 0)), "value must have 3 entries, got 2"),
        (lambda: Waypoint(time=1, value=(0, 0, None)), "value must be a number, got None"),
        (lambda: Waypoint(time=1, value=np.array([0, 0, np.nan])), "value must be a finite number, got nan"),
        (lambda: Waypoint(time=1, value=5.0), "value must be a tuple, got float"),
        (lambda: Tone(axis="w", amplitude=1, frequency=1), "axis must be one of 'x', 'y', 'z', got 'w'"),
        (lambda: Multisine(tones=[1]), "tones must be a Tone, got int"),
        (lambda: Polynomials(pieces=Piece(duration=1)), "pieces must be a tuple, got Piece"),
        (lambda: World(gravity=None), "gravity must be a tuple, got None"),
        (lambda: msgspec.structs.replace(preset.load("paper"), seed=1.5), "seed must be a whole number, got 1.5"),
        (lambda: msgspec.structs.replace(preset.load("paper"), title=5), "title must be text, got int"),
        (
            lambda: msgspec.structs.replace(preset.load("paper"), path=np.zeros(3)),
            "path must be a Multisine, Formula, ",
        ),
    ],
)
def test_anything_else_is_refused_in_one_sentence_that_names_the_field(make, sentence):
    with pytest.raises(ValueError, match=rf"\A{exactly(sentence)[2:-2]}"):
        make()


def test_a_default_stays_the_object_that_it_is():
    """msgspec leaves a default out of a file only if it is that very object: a copy would be written."""
    assert b"offset" not in msgspec.toml.encode(Waypoints(points=[Waypoint(time=t, value=(t, 0, 0)) for t in range(3)]))
    assert Multisine().offset is Multisine().offset


def test_a_type_that_no_check_knows_is_refused_when_the_class_is_first_used():
    class Odd(Input, frozen=True, kw_only=True):
        table: dict[str, float]

    with pytest.raises(TypeError, match=r"no check for a field of type dict\[str, float\]"):
        Odd(table={})


def test_optional_and_literal_fields_take_their_own_values_only():
    class Choice(Input, frozen=True, kw_only=True):
        vector: Vec3 | None = None
        kind: Literal[1, "a"] = 1

    assert Choice(vector=[1, 2, 3], kind=np.int8(1)) == Choice(vector=(1.0, 2.0, 3.0))
    with pytest.raises(ValueError, match=exactly("kind must be one of 1, 'a', got True")):
        Choice(kind=True)
