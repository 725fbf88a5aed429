"""What every family of signals must keep: exact derivatives, honest bounds and periods, lossless files."""

import math
from typing import get_args

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rangenav import preset
from rangenav.analysis import analyse
from rangenav.signals import (
    Family,
    Flown,
    Formula,
    Multisine,
    Sum,
    Tone,
    curved_part,
    piecewise,
    slowed,
    waypoints,
)
from rangenav.signals.base import SignalBase
from tests.support.signal_examples import (
    BLIND,
    EXAMPLES,
    LOOP,
    MINIMUM_SNAP,
    MINIMUM_SNAP_LOOP,
    MULTISINE,
    PERIODIC_FORMULA,
    WAYPOINTS,
)

pytestmark = pytest.mark.slow


SMOOTH_ORDERS = {"minimum snap": 3, "polynomials": 3, "standing still": 9}
"""Up to which derivative each is continuous everywhere; the others at least to snap."""
DENSE = np.linspace(0, 13, 2001)
names = pytest.mark.parametrize("name", EXAMPLES)


def knots(name):
    """Times at which a family's pieces meet."""
    every = [part.piecewise() for part in EXAMPLES[name].parts()]
    return np.concatenate([np.empty(0), *(pieces.knots for pieces in every if pieces is not None)])


def test_every_family_has_an_example():
    assert {type(signal) for signal in EXAMPLES.values()} == {*get_args(Family), Sum}


@names
@pytest.mark.parametrize("order", range(1, 6))
def test_each_derivative_is_the_central_difference_of_the_one_before(name, order):
    signal = EXAMPLES[name]
    h = 2e-4
    t = DENSE[5:-5]
    near = np.abs(t[:, None] - knots(name)).min(axis=1, initial=np.inf) < 2 * h  # a difference must not span a knot
    t = t[~near]
    difference = (signal(t + h, order - 1) - signal(t - h, order - 1)) / (2 * h)
    # truncation h²/6 times two derivatives more, found on the samples; rounding eps/h of what is subtracted
    truncation = h**2 / 6 * np.linalg.norm(signal(DENSE, order + 2), axis=1).max() * 1.5
    rounding = 1e-15 * 50 / h * (1 + np.linalg.norm(signal(DENSE, order - 1), axis=1).max())
    assert np.linalg.norm(signal(t, order) - difference, axis=1).max() <= truncation + rounding


@names
def test_derivatives_up_to_snap_have_no_steps_where_pieces_meet(name):
    signal = EXAMPLES[name]
    for order in range(min(SMOOTH_ORDERS.get(name, 4), 4) + 1):
        for knot in knots(name):
            before, after = signal(np.array([knot - 1e-9, knot + 1e-9]), order)
            # two nanoseconds of the next derivative, and the rounding of coefficients of degree 9
            size = 1 + np.linalg.norm(signal(DENSE, order + 1), axis=1).max()
            assert np.linalg.norm(after - before) < 1e-8 * size


@names
@pytest.mark.parametrize("order", range(7))
def test_bounds_are_never_exceeded(name, order):
    signal = EXAMPLES[name]
    largest = np.linalg.norm(signal(np.linspace(0, 40, 20001), order), axis=-1).max()
    assert largest <= signal.bound(order) * (1 + 1e-12)


@names
def test_the_bound_of_what_may_jump_is_infinite(name):
    """A bound of order k says how fast order k − 1 can change: not at all bounded if that jumps."""
    first = SMOOTH_ORDERS.get(name)
    if first == 3:
        assert math.isfinite(EXAMPLES[name].bound(4))
        assert EXAMPLES[name].bound(5) == math.inf


@names
@pytest.mark.parametrize("order", range(2, 6))
def test_the_period_repeats_every_derivative_from_the_second_on(name, order):
    signal = EXAMPLES[name]
    period = signal.period
    if not period:
        pytest.skip("no period")
    t = np.linspace(0, 20, 501)
    scale = 1 + np.linalg.norm(signal(t, order), axis=1).max()
    np.testing.assert_allclose(signal(t + period, order), signal(t, order), atol=1e-9 * scale)


def test_periods_are_those_of_the_parts():
    assert EXAMPLES["closed waypoints"].period == 11.0
    assert EXAMPLES["waypoints"].period is None
    assert EXAMPLES["formula"].period is None
    assert PERIODIC_FORMULA.period == pytest.approx(2 * math.pi)
    assert EXAMPLES["sum of periodic"].period == pytest.approx(11.0)
    assert Sum(base=MULTISINE, wiggle=Multisine(tones=(Tone(axis="x", amplitude=1, frequency=math.e),))).period is None
    assert Sum(base=Multisine(), wiggle=Multisine(drift=(1.0, 0.0, 0.0))).period == 0
    repeating = msgspec.structs.replace(EXAMPLES["polynomials"], ends="repeat")
    assert repeating.period == pytest.approx(12.0)


@pytest.mark.parametrize("closed", [LOOP, MINIMUM_SNAP_LOOP])
def test_closed_curves_close_to_the_fourth_derivative_and_beyond(closed):
    steps = piecewise.jumps(closed.piecewise(), range(closed.degree))[0]
    sizes = [piecewise.hull(closed.piecewise(), order) for order in range(closed.degree)]
    assert np.all(np.linalg.norm(steps, axis=1) < 1e-10 * np.array(sizes))


@names
def test_files_hold_every_family_without_loss(name):
    p = msgspec.structs.replace(preset.load("soft"), path=EXAMPLES[name], angular_velocity=EXAMPLES[name])
    again = preset.loads(preset.dumps(p), source="round trip")
    assert again == p
    assert again.path == EXAMPLES[name]
    assert hash(again.path) == hash(EXAMPLES[name])


@settings(max_examples=30)
@given(st.lists(st.floats(-100, 100), min_size=3, max_size=3), st.floats(0.5, 2))
def test_any_numbers_survive_a_file(value, gap):
    path = waypoints.move(WAYPOINTS, 1, tuple(value))
    path = slowed(path, gap)
    p = msgspec.structs.replace(preset.load("soft"), path=path)
    assert preset.loads(preset.dumps(p), source="round trip").path == path


def test_unknown_keys_and_kinds_are_refused_where_they_stand():
    text = preset.dumps(msgspec.structs.replace(preset.load("soft"), path=WAYPOINTS))
    with pytest.raises(ValueError, match=r"unknown field `colour` - at `\$.path`"):
        preset.loads(text.replace('kind = "waypoints"', 'kind = "waypoints"\ncolour = 1'), source="p.toml")
    with pytest.raises(ValueError, match=r"Invalid value 'bezier' - at `\$.path.kind`"):
        preset.loads(text.replace('"waypoints"', '"bezier"'), source="p.toml")


@names
def test_bent_keeps_what_second_and_higher_derivatives_know(name):
    signal = EXAMPLES[name]
    straight = signal(DENSE) - curved_part(signal)(DENSE)
    line = np.polynomial.polynomial.polyfit(DENSE, straight, 1)
    fitted = line[0] + DENSE[:, None] * line[1]
    np.testing.assert_allclose(straight, fitted, atol=1e-10)
    for order in range(2, 5):
        scale = 1 + np.linalg.norm(signal(DENSE, order), axis=1).max()
        np.testing.assert_allclose(curved_part(signal)(DENSE, order), signal(DENSE, order), atol=1e-9 * scale)


@names
def test_every_family_is_analysed(name):
    requirement = msgspec.structs.replace(preset.load("soft").requirement, window=5.0)
    p = msgspec.structs.replace(preset.load("soft"), path=EXAMPLES[name], requirement=requirement, duration=12.0)
    analysed = analyse(p)
    assert (analysed.rank == 13) == (name not in BLIND)
    assert (analysed.bound_for_all_t is None) == (EXAMPLES[name].period is None)
    if analysed.bound_for_all_t:
        assert 0.8 * analysed.mu < analysed.bound_for_all_t <= analysed.mu * (1 + 1e-9) or name != "closed waypoints"


def test_bandwidth_until_is_finite_where_a_chirp_has_none():
    chirp = Formula(x="sin(t**2/5)")
    assert chirp.bandwidth == math.inf
    assert 0.99 * 0.4 * 20 <= chirp.bandwidth_until(20.0) < 1.1 * 0.4 * 20  # it sweeps to 2t/5
    assert Sum(base=MINIMUM_SNAP, wiggle=chirp).bandwidth_until(20.0) == chirp.bandwidth_until(20.0)
    assert MULTISINE.bandwidth_until(20.0) == MULTISINE.bandwidth == 6.0


def test_a_flown_body_survives_a_file():
    p = msgspec.structs.replace(preset.load("soft"), angular_velocity=Flown(yaw="0.3*sin(t)"))
    assert preset.loads(preset.dumps(p), source="round trip") == p


class Circle(SignalBase, frozen=True, kw_only=True, tag="circle", tag_field="kind"):
    """A family that only says which signal it is equivalent to, as a new one may begin."""

    radius: float

    def equivalent(self) -> Formula:
        """The circle as formulas."""
        return Formula(x=f"{self.radius!r}*cos(t)", y=f"{self.radius!r}*sin(t)", z="0")


def test_a_family_that_names_an_equivalent_signal_answers_every_question_as_that_signal_does():
    circle = Circle(radius=2.0)
    formula, edges = circle.equivalent(), np.linspace(0.0, 5.0, 6)
    for order in range(6):
        np.testing.assert_array_equal(circle(DENSE, order), formula(DENSE, order))
        assert circle.bound(order) == formula.bound(order)
    np.testing.assert_array_equal(circle.jet(DENSE, 4), formula.jet(DENSE, 4))
    orders = range(2, 5)
    np.testing.assert_array_equal(circle.derivative_bounds(edges, orders), formula.derivative_bounds(edges, orders))
    assert (circle.bandwidth, circle.period) == (formula.bandwidth, formula.period)
    assert circle.bandwidth_until(3.0) == formula.bandwidth_until(3.0)
    assert (circle.operations(), circle.bound_stretches) == (formula.operations(), formula.bound_stretches)
    assert circle.parts() == (circle,)
    assert circle.piecewise() is None
    assert circle.slowed(2.0) == formula.slowed(2.0)
    assert circle.mapped(2 * np.eye(3), np.ones(3)) == formula.mapped(2 * np.eye(3), np.ones(3))
    np.testing.assert_array_equal(circle.curved_part()(DENSE, 2), formula(DENSE, 2))
