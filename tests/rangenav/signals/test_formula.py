"""Formulas: sympy as witness, errors that point at the character, bounds that enclose, work that is bounded."""

import contextlib
import math
import re
import time

import msgspec
import numpy as np
import pytest
import sympy

from rangenav import preset
from rangenav.analysis import analyse
from rangenav.signals import Formula, expressions, series
from rangenav.signals.intervals import ELEMENTARY, Interval

pytestmark = pytest.mark.slow


TIMES = np.linspace(0.05, 3, 60)
WITNESSES = [
    "sin(2*t) + cos(3*t - 1)",
    "tan(t/3)",
    "asin(sin(t)/2)",
    "acos(t/4)",
    "atan(3*t - 4)",
    "sinh(t) - cosh(t/2)",
    "tanh(5*t - 6)",
    "asinh(t**2)",
    "acosh(1.5 + t)",
    "atanh(t/4)",
    "exp(-t**2)*log(1 + t)",
    "sqrt(t)*t**2.5",
    "pow(1 + t, -1.5)",
    "t**7 - 3*t**-2",
    "(1 + t)**t",
    "2**(-t)*e**sin(pi*t)",
    "1/(1 + t**2)/(2 + sin(t))",
    "-(-t)**3",
    "exp(exp(sin(t)))",
    "3",
    "t",
    "+t - -2*t + 1.5e-1",
]


@pytest.mark.parametrize("text", WITNESSES)
@pytest.mark.parametrize("order", range(6))
def test_every_derivative_is_the_one_sympy_finds(text, order):
    t = sympy.symbols("t")
    expression = sympy.parse_expr(text, local_dict={"e": sympy.E, "pow": sympy.Pow})
    derivative = sympy.diff(expression, t, order)
    witness = np.array([float(derivative.evalf(30, subs={t: sympy.Float(value, 30)})) for value in TIMES[::6].tolist()])
    computed = Formula(y=text)(TIMES[::6], order)[:, 1]
    # twenty operations of a relative 1e-16 each, on terms that may be a thousand times their sum
    np.testing.assert_allclose(computed, witness, rtol=1e-11, atol=1e-11 * (1 + np.abs(witness).max()))


def test_powers_bind_as_in_python_and_numbers_fold():
    assert Formula(x="-2**2")(np.zeros(1))[0, 0] == -4
    assert Formula(x="2**3**2")(np.zeros(1))[0, 0] == 512
    assert expressions.parse("2*pi/(4 - 2)") == expressions.Node("number", value=math.pi)
    assert Formula(x="t**0/(t**0)")(np.zeros(1))[0, 0] == 1


MISTAKES = [
    ("", 1, "the formula is empty"),
    ("  ", 1, "the formula is empty"),
    ("8t", 2, "an operator such as * is missing before t"),
    ("sin(t) cos(t)", 8, "an operator such as * is missing before cos"),
    ("2(t)", 2, "an operator such as * is missing before ("),
    ("t + ", 4, "t, a number or a function is missing at the end"),
    ("t * / 2", 5, "t, a number or a function is missing before /"),
    ("sin t", 5, "sin needs parentheses, as in sin(t)"),
    ("sin()", 5, "t, a number or a function is missing before )"),
    ("sin(t", 6, "a ) is missing at the end"),
    ("t)", 2, "this ) closes nothing"),
    ("1)+(2", 2, "this ) closes nothing"),
    ("t^2", 2, "^ has no meaning in a formula: write ** for a power"),
    ("x = t", 1, "x is not known"),
    ("t = 2", 3, "= has no meaning in a formula"),
    ("sine(t)", 1, "sine is not known: did you mean sin?"),
    ("abs(t)", 1, "abs has kinks or jumps"),
    ("3 + __import__('os')", 5, "__import__ is not known"),
    ("(1).real", 4, ". has no meaning in a formula"),
    ("t.real", 2, ". has no meaning in a formula"),
    ("lambda: t", 1, "lambda is not known"),
    ("[t]", 1, "[ has no meaning"),
    ("'t'", 1, "' has no meaning"),
    ("t if t else t", 3, "if is not known"),
    ("sin(t, t)", 1, "sin takes 1 argument"),
    ("pow(t)", 1, "pow takes 2 arguments"),
    ("(t, t)", 1, "this is no formula"),
    ("t // 2", 4, "t, a number or a function is missing before /"),
    ("t\n", 2, "U+000A has no meaning"),
    ("t\x00", 2, "U+0000 has no meaning"),
    ("2 × t", 3, "× has no meaning"),
    ("ｔ", 1, "ｔ has no meaning"),
    ("1 + 1/(2 - 2)", 8, "this divides by zero"),
    ("t/0", 3, "this divides by zero"),
    ("log(0)", 1, "log has no finite value here"),
    ("1e400*t", 1, "this number is too large"),
    ("9**9**9**9", 4, "the exponent must lie between -64 and 64"),
    ("t**1000", 1, "the exponent must lie between -64 and 64"),
    ("(" * 100 + "t" + ")" * 100, 41, "parentheses are nested too deeply"),
    ("-" * 900 + "t", 152, "the formula is too large"),
    ("+".join("t" * 400), None, "the formula is too large"),
]


@pytest.mark.parametrize(("text", "column", "sentence"), MISTAKES)
def test_a_mistake_is_told_in_one_sentence_that_names_axis_and_column(text, column, sentence):
    with pytest.raises(ValueError, match=re.escape(sentence)) as refused:
        Formula(z=text)
    said = str(refused.value)
    assert said.startswith("z: ")
    assert column is None or said.endswith(f"(column {column})")
    assert len(said) < 160
    assert "\n" not in said


@pytest.mark.parametrize("text", ["t" * 10_000_000, "(" * 10_000_000, "9" * 10_000_000, "sin(" * 2_500_000])
def test_ten_megabytes_are_refused_at_once(text):
    began = time.perf_counter()
    with pytest.raises(ValueError, match="a formula may have 1000 characters, this one has 10000000"):
        Formula(x=text)
    assert time.perf_counter() - began < 0.1


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("1/t", "path: x: 1/t has no finite value at t = 0 s"),
        ("sqrt(t)", "path: x: sqrt(t) has no finite derivative of order 1 at t = 0 s"),
        ("log(t - 3)", "at t = 0 s"),
        ("1/(t - 5)", "at t = 5 s"),
        ("exp(t)", "path: x: the value of exp(t) exceeds 1e+07 at t = 16.12 s"),
        ("exp(exp(t))", "at t = "),
        ("acos(t/4)", "path: x: acos(t/4) has no finite value at t = 4.005 s"),
        ("tan(t*pi/10)", "at t = 5 s"),
        ("t**64", "at t = "),
        ("(0 - 2)**t", "log has no finite value here"),
    ],
)
def test_what_is_not_finite_in_the_flight_is_refused_naming_axis_and_time(text, sentence):
    with pytest.raises(ValueError, match=re.escape(sentence)):
        msgspec.structs.replace(preset.load("soft"), path=Formula(x=text))


def test_a_long_formula_over_a_long_flight_is_refused_before_any_work():
    long = Formula(x="+".join(f"sin({k}*t)" for k in range(60)))
    sensors = msgspec.structs.replace(preset.load("soft").sensors, imu_rate=3000.0)
    began = time.perf_counter()
    with pytest.raises(ValueError, match="operations at 1800000 moments is too much work"):
        msgspec.structs.replace(preset.load("soft"), path=long, duration=600.0, sensors=sensors)
    assert time.perf_counter() - began < 0.5


@pytest.mark.parametrize("text", [*WITNESSES, "1/(2 + sin(3*t))", "sin(t)*cos(2*t)**2", "tanh(3*sin(t))"])
@pytest.mark.parametrize("order", [0, 1, 4, 5])
def test_bounds_enclose_every_value(text, order):
    signal = Formula(x=text)
    grid = np.linspace(0.05, 2.9, 2001)
    assert np.abs(signal(grid, order)[:, 0]).max() <= signal.bound(order) * (1 + 1e-15)


def test_bounds_are_sharp_where_they_matter():
    assert Formula(x="2*sin(3*t)").bound(4) == pytest.approx(162, rel=1e-12)
    paper = Formula(x="cos(8*t)", y="0.3*sin(16*t + pi/12)", z="-(sqrt(3)/4)*sin(16*t - pi/9)")
    assert paper.bound(4) == pytest.approx(preset.load("paper").path.bound(4), rel=1e-9)
    shaped = Formula(x="1/(2 + sin(3*t))")
    largest = np.abs(shaped(np.linspace(0, 2.2, 5001), 4)).max()
    assert largest <= shaped.bound(4) < 2.5 * largest
    assert Formula(x="t**3").bound(2) == math.inf
    assert Formula(x="t**3").bound(4) == 0


@pytest.mark.parametrize("name", [*series.FUNCTIONS])
def test_interval_functions_enclose(name):
    rng = np.random.default_rng(0)
    low = rng.uniform(-4, 4, 400)
    interval = Interval(low, low + rng.exponential(0.5, 400))
    if name in ("log", "sqrt"):
        interval = Interval(np.abs(low) + 1e-9, np.abs(low) + 1e-9 + (interval.high - interval.low))
    computed = series.sqrt((interval,), 0)[0] if name == "sqrt" else ELEMENTARY[name](interval)
    with np.errstate(invalid="ignore"):
        for share in np.linspace(0, 1, 11):
            inside = interval.low + share * (interval.high - interval.low)
            value = series.FUNCTIONS[name]((inside,), 0)[0]
            known = np.isfinite(value)
            assert np.all(computed.low[known] <= value[known])
            assert np.all(value[known] <= computed.high[known])


def test_interval_arithmetic_is_rounded_outwards():
    third = Interval(np.ones(1), np.ones(1)) / 3.0
    assert third.low[0] < 1 / 3 < third.high[0] or (
        third.low[0] <= 1 / 3 <= third.high[0] and third.low[0] < third.high[0]
    )
    assert (Interval(np.array([-1.0]), np.array([1.0])) * Interval(np.array([0.0]), np.array([np.inf]))).high[
        0
    ] == np.inf
    assert (1.0 / Interval(np.array([-1.0]), np.array([1.0]))).magnitude() == np.inf


@pytest.mark.parametrize(
    ("text", "period"),
    [
        ("cos(8*t)", math.pi / 4),
        ("sin(t)*cos(2*t) + 3*t", 2 * math.pi),
        ("sin(t/3 + 1)**2", 6 * math.pi),
        ("tan(t)/10", math.pi),
        ("exp(sin(2*t)) + 5", math.pi),
        ("t", 0.0),
        ("t*sin(t)", None),
        ("sin(t**2)", None),
        ("sin(t) + sin(pi*t)", None),
        ("exp(-t)", None),
    ],
)
def test_periods_are_read_off_the_formula(text, period):
    computed = Formula(x=text).period
    assert computed == (pytest.approx(period) if period else period)


def test_two_thousand_points_to_snap_take_about_a_millisecond():
    signal = Formula(x="cos(8*t)", y="0.3*sin(16*t + pi/12)", z="-0.433*sin(16*t - pi/9)")
    grid = np.linspace(0, 10, 2000)
    signal(grid, 4)
    best = min(_seconds(lambda: signal(grid, 4)) for _ in range(20))
    assert best < 5e-3  # 0.3 ms when nothing else runs; shapes are checked here, and machines are shared


def _seconds(work):
    began = time.thread_time()
    work()
    return time.thread_time() - began


LONG = [
    "*".join(["(1.01 + sin({w}*t)/9)"] * 24),
    "+".join(f"exp(sin({{w}}*t + {k}))/(2 + cos({k}*t))" for k in range(12)),
]


@pytest.mark.parametrize("text", LONG)
@pytest.mark.parametrize("w", [1, 20, 150])
def test_the_longest_formulas_are_analysed_or_refused_within_a_second(text, w):
    """Whatever is typed is answered, with a picture or a sentence, before somebody wonders."""
    x = text.format(w=w)
    began = time.thread_time()
    with contextlib.suppress(ValueError):
        analyse(msgspec.structs.replace(preset.load("soft"), path=Formula(x=x, y=x + " + 1", z=x + " + 2")))
    assert time.thread_time() - began < 3.0  # a second at most on two slow cores; shapes are checked here


def test_a_bound_of_tiny_values_is_no_zero():
    """The squares of 1e-239 underflow."""
    faint = Formula(x="exp(0 - 548 - 55 * t)")
    for order in range(6):
        assert 0 < np.abs(faint(np.zeros(1), order)).max() <= faint.bound(order) * (1 + 1e-12)
        assert faint.derivative_bounds(np.array([0.0, 1.0]), range(order + 1))[order, 0] > 0
