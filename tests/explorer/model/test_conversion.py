"""A signal converted into another family resembles the one that it was converted from."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from explorer.model import conversion
from explorer.panels.motion.families import BY_NAME, PATH_LABELS, family_name
from explorer.panels.motion.families.table import Table
from rangenav import preset
from rangenav.signals import Flown, Multisine, Polynomials, Tone
from tests.support.signal_examples import EXAMPLES

DURATION = 10.0
TIME = np.linspace(0, DURATION, 300)


@pytest.mark.parametrize("kind", PATH_LABELS)
@pytest.mark.parametrize("family", [name for name, signal in EXAMPLES.items() if not hasattr(signal, "base")])
def test_every_family_is_converted_into_every_other(family: str, kind: str):
    converted_signal = conversion.converted(EXAMPLES[family], BY_NAME[kind].convert, DURATION)
    assert family_name(converted_signal) == kind


@pytest.mark.parametrize("name", ["paper-slow", "lissajous", "soft", "circle"])
def test_sines_become_the_same_formulas_to_the_last_digit_that_matters(name: str):
    path = preset.load(name).path
    assert isinstance(path, Multisine)
    converted_signal = conversion.formula(path, DURATION)
    for order in range(5):
        assert np.allclose(converted_signal(TIME, order), path(TIME, order), rtol=1e-12, atol=1e-12)


@given(st.floats(0.1, 3), st.floats(0.3, 4), st.floats(-3, 3))
def test_a_curve_through_points_passes_where_the_path_passes(amplitude: float, frequency: float, phase: float):
    path = Multisine(tones=tuple(Tone(axis=a, amplitude=amplitude, frequency=frequency, phase=phase) for a in "xyz"))  # type: ignore[arg-type]
    converted_signal = conversion.waypoints(path, DURATION)
    for point in converted_signal.points:
        assert np.allclose(point.value, path(np.array([point.time]))[0], atol=1e-3)


def test_a_minimum_snap_curve_becomes_its_own_polynomials():
    curve = conversion.minimum_snap(preset.load("soft").path, DURATION)  # type: ignore[arg-type]
    converted_signal = conversion.polynomials(curve, DURATION)
    assert isinstance(converted_signal, Polynomials)
    assert np.allclose(converted_signal(TIME), curve(TIME), atol=1e-9)


def test_the_strongest_tones_of_a_formula_are_found():
    drawn = conversion.sines(conversion.formula(preset.load("lissajous").path, DURATION), DURATION)  # type: ignore[arg-type]
    expected = preset.load("lissajous").path
    assert np.allclose(drawn(TIME), expected(TIME), atol=2e-3)


def test_a_flown_body_and_a_constant_are_converted_both_ways():
    assert conversion.converted(preset.load("soft").path, conversion.flown, DURATION) == Flown()
    assert conversion.converted(Flown(), conversion.sines, DURATION) == Multisine()
    constant = conversion.converted(Multisine(offset=(1.0, 2.0, 3.0)), conversion.constant, DURATION)
    assert constant == Multisine(offset=(1.0, 2.0, 3.0))
    for kind in ("formula", "waypoints"):
        assert family_name(conversion.converted(Flown(), BY_NAME[kind].convert, DURATION)) == kind


PAIRS = st.lists(st.tuples(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6)), max_size=20)


def _pair(cells: list[float]) -> tuple[float, float]:
    return cells[0], cells[1]


@given(PAIRS)
def test_a_table_that_nobody_touched_gives_back_every_digit(rows: list[tuple[float, float]]):
    table = Table(("a", "b"), _pair, list)
    assert table.parse(table.format(rows), rows) == tuple(rows)


@given(PAIRS, st.integers(0, 20))
def test_a_line_that_was_touched_leaves_the_others_exact(rows: list[tuple[float, float]], k: int):
    table = Table(("a", "b"), _pair, list)
    lines = table.format(rows).split("\n") if rows else []
    lines.insert(min(k, len(lines)), " 7, 8 ")
    parsed = list(table.parse("\n".join(lines), rows))
    assert parsed[min(k, len(lines) - 1)] == (7.0, 8.0)
    assert [row for i, row in enumerate(parsed) if i != min(k, len(lines) - 1)] == rows
