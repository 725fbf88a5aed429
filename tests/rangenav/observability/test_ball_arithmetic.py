"""Interval bounds and the bound of μ against ball arithmetic (FLINT's Arb), which rounds outwards by other means.

A number of Arb is a ball that holds the true value; `a <= b` between balls is true only where it is proven.
"""

import math
from collections.abc import Callable

import numpy as np
import pytest
from flint import acb, acb_series, arb, arb_mat, arb_series, ctx
from hypothesis import given, settings
from hypothesis import strategies as st

from rangenav.observability import derivative_bounds
from rangenav.observability.excitation_bound import excitation_bounds
from rangenav.signals import Formula
from rangenav.signals.intervals import ELEMENTARY, Interval

pytestmark = pytest.mark.slow


BITS = 128
"""Of the balls: their radii are then far below a double's last place."""
SPANS = {
    "sin": (-50.0, 50.0),
    "cos": (-50.0, 50.0),
    "tan": (-1.5, 1.5),
    "exp": (-20.0, 20.0),
    "log": (1e-6, 1e6),
    "sinh": (-20.0, 20.0),
    "cosh": (-20.0, 20.0),
    "tanh": (-20.0, 20.0),
    "asin": (-1.0, 1.0),
    "acos": (-1.0, 1.0),
    "atan": (-50.0, 50.0),
    "asinh": (-50.0, 50.0),
    "acosh": (1.0, 50.0),
    "atanh": (-0.999, 0.999),
}
"""Where each elementary function is tried."""
FORMULAS: dict[str, tuple[str, Callable]] = {
    "three sines": ("sin(3*t) + 0.5*sin(5*t)", lambda t: (3 * t).sin() + (5 * t).sin() / 2),
    "fading": ("cos(2*t)*exp(-t/5)", lambda t: (2 * t).cos() * (-t / 5).exp()),
    "smooth step": ("tanh(t - 4)", lambda t: 1 - 2 / ((2 * (t - 4)).exp() + 1)),
    "root": ("sqrt(4 + sin(4*t))", lambda t: (4 + (4 * t).sin()).sqrt()),
}
AXES = ("three sines", "fading", "root")
PATH = Formula(x=FORMULAS[AXES[0]][0], y=FORMULAS[AXES[1]][0], z=FORMULAS[AXES[2]][0])
WINDOW, END = 3.0, 6.0


@pytest.fixture(autouse=True)
def _precise():
    before, ctx.prec = ctx.prec, BITS
    yield
    ctx.prec = before


def test_every_elementary_function_but_the_power_is_tried():
    assert set(SPANS) | {"pow"} == set(ELEMENTARY)


@settings(max_examples=60)
@given(st.sampled_from(sorted(SPANS)), st.floats(0, 1), st.floats(0, 1), st.floats(0, 1))
def test_an_enclosure_holds_the_value_at_every_point_of_its_interval(name: str, one: float, other: float, share: float):
    low, high = SPANS[name]
    left, right = sorted(low + (high - low) * part for part in (one, other))
    point = min(max(left + share * (right - left), left), right)
    enclosure = ELEMENTARY[name](Interval(np.array([left]), np.array([right])))
    true = getattr(arb(point), name)()
    assert not arb(float(enclosure.low[0])) > true
    assert not arb(float(enclosure.high[0])) < true
    ulp = np.finfo(float).eps * max(1.0, abs(float(true)))  # and it is sharp where the interval is a point
    thin = ELEMENTARY[name](Interval(np.array([point]), np.array([point])))
    if np.isfinite(thin.high[0] - thin.low[0]):
        assert thin.high[0] - thin.low[0] <= 100 * ulp * (1 + abs(point))


def derivative(expression: Callable, time: float, order: int) -> arb:
    """The derivative of one formula as a ball, from its power series about the time."""
    length = ctx.cap
    ctx.cap = order + 2
    try:
        series = expression(arb_series([arb(time), 1]))
        return series[order] * math.factorial(order)
    finally:
        ctx.cap = length


@pytest.mark.parametrize("name", list(FORMULAS))
@pytest.mark.parametrize("order", range(4, 9))
def test_no_derivative_of_a_formula_exceeds_its_bound(name: str, order: int):
    text, expression = FORMULAS[name]
    signal = Formula(x=text, y="0", z="0")
    edges = derivative_bounds.stretches(signal, 8.0)
    bound = signal.derivative_bounds(edges, range(order, order + 1))[0]
    for k, share in ((3, 0.2), (100, 0.5), (128, 0.5), (200, 0.9)):
        time = float(edges[k] + share * (edges[k + 1] - edges[k]))
        assert abs(derivative(expression, time, order)) <= arb(float(bound[k]))
        assert bound[k] < 1e6  # a bound that is no use proves nothing


def excitation(start: float) -> arb_mat:
    """W(t) = ∫ p⁗p⁗ᵀ over one window, each entry a ball that holds the integral."""

    def entry(one: str, other: str) -> arb:
        return acb.integral(lambda s, _: snap(one, s) * snap(other, s), acb(start), acb(start) + acb(WINDOW)).real

    return arb_mat([[entry(one, other) for other in AXES] for one in AXES])


def snap(axis: str, time: acb) -> acb:
    """The fourth derivative of one axis at a complex ball, from its power series."""
    length = ctx.cap
    ctx.cap = 6
    try:
        return FORMULAS[axis][1](acb_series([time, 1]))[4] * 24
    finally:
        ctx.cap = length


@pytest.mark.parametrize("start", [0.0, 1.2345, 2.9, 4.4321, 6.0])
def test_the_excitation_of_every_window_is_proven_to_exceed_the_lower_bound(start: float):
    """W − lower · I is positive definite by Sylvester's criterion, in balls: a proof, not a sample of directions."""
    proven = excitation_bounds(PATH, WINDOW, END)
    assert proven.lower > 0
    assert all(minor > 0 for minor in leading_minors(excitation(start), proven.lower))


def leading_minors(matrix: arb_mat, less: float) -> list[arb]:
    """The leading principal minors of the matrix − less · I, as balls."""
    shifted = [[matrix[i, j] - (arb(less) if i == j else 0) for j in range(3)] for i in range(3)]
    return [arb_mat([row[:size] for row in shifted[:size]]).det() for size in (1, 2, 3)]


def test_the_upper_bound_is_no_lower_than_the_worst_window():
    """At the window named as the worst, W − upper · I is not positive definite: some minor is proven to be negative."""
    proven = excitation_bounds(PATH, WINDOW, END)
    assert any(minor < 0 for minor in leading_minors(excitation(proven.at), proven.upper))
