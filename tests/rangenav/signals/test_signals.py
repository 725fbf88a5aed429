"""Signals against sympy, finite differences and their own laws."""

import math

import msgspec
import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from rangenav import signals
from rangenav.observability import excitation
from rangenav.signals import Multisine, Tone
from rangenav.signals.multisine import Axis
from tests.support.refusals import exactly

EPS = np.finfo(float).eps
ORDERS = range(6)
EXAMPLE = Multisine(
    tones=(
        Tone(axis="x", amplitude=1.0, frequency=8.0, phase=math.pi / 2),
        Tone(axis="y", amplitude=0.3, frequency=16.0, phase=math.pi / 12),
        Tone(axis="z", amplitude=-0.4330127018922193, frequency=16.0, phase=-math.pi / 9),
        Tone(axis="z", amplitude=0.05, frequency=2.5, phase=4.0),
    ),
    offset=(0.5, -2.0, 3.0),
    drift=(-1.0, 0.25, 0.125),
)

tones = st.builds(
    Tone,
    axis=st.sampled_from("xyz"),
    amplitude=st.floats(-5, 5),
    frequency=st.floats(0.05, 50),
    phase=st.floats(-10, 10),
)
triples = st.tuples(*[st.floats(-10, 10)] * 3)
multisines = st.builds(Multisine, tones=st.lists(tones, max_size=4).map(tuple), offset=triples, drift=triples)
times = st.floats(0, 20)


def at(signal, t, order=0):
    """The signal's derivative at one moment."""
    return signal(np.array(t), order)


def rounding(signal, order, t):
    """An argument w t + phase carries a relative error eps, and the sine of size bound passes it on."""
    return 4 * EPS * (1 + signal.bandwidth * t + 20) * (signals.curved_part(signal).bound(order) + 10 * (1 + t))


@pytest.mark.parametrize("order", ORDERS)
def test_every_derivative_is_the_one_sympy_finds(order):
    t = sympy.symbols("t")
    grid = np.linspace(0, 10, 101)
    computed = EXAMPLE(grid, order)
    for name, k in signals.AXES.items():
        terms = [s.amplitude * sympy.sin(s.frequency * t + s.phase) for s in EXAMPLE.tones if s.axis == name]
        formula = EXAMPLE.offset[k] + EXAMPLE.drift[k] * t + sum(terms)
        witness = sympy.lambdify(t, sympy.diff(formula, t, order) + 0 * t, "numpy")(grid)
        # arguments reach 160 rad, where a unit of the last place is 3e-14
        np.testing.assert_allclose(computed[:, k], witness, atol=1e-13 * 16.0**order)


@given(multisines, st.integers(1, 5), times)
def test_each_derivative_is_the_central_difference_of_the_one_before(signal, order, t):
    h = 1e-4 / max(signal.bandwidth, 1.0)
    difference = (at(signal, t + h, order - 1) - at(signal, t - h, order - 1)) / (2 * h)
    truncation = h**2 / 6 * signals.curved_part(signal).bound(order + 2)  # Taylor, with the signal's own bound
    assert np.linalg.norm(at(signal, t, order) - difference) <= truncation + rounding(signal, order - 1, t) / h


@given(multisines, st.integers(0, 5), st.lists(times, min_size=1, max_size=20))
def test_bound_is_never_exceeded(signal, order, moments):
    largest = np.linalg.norm(signal(np.array(moments), order), axis=-1).max()
    assert largest <= signal.bound(order) * (1 + 10 * EPS) + 1e-300


@pytest.mark.parametrize("order", ORDERS)
def test_bound_of_tones_in_step_is_reached(order):
    """Tones whose frequencies are 1 : 5 : 9 peak together a quarter turn into the first one, at every order."""
    parts: list[tuple[Axis, float, float]] = [
        ("x", 2.0, 1.0),
        ("x", 0.5, 5.0),
        ("y", 1.5, 5.0),
        ("z", -1.0, 9.0),
    ]
    together = Multisine(
        tones=tuple(Tone(axis=a, amplitude=A, frequency=w, phase=-order * math.pi / 2) for a, A, w in parts),
        offset=(1.0, 0.0, 0.0),
    )
    peak = np.linalg.norm(at(together, math.pi / 2, order))
    assert peak == pytest.approx(together.bound(order), rel=1e-12)  # the sines are 1 to within (9·eps)²


def test_a_drifting_signal_is_unbounded_but_its_rate_is_not():
    drifting = Multisine(drift=(0.0, 3.0, -4.0), tones=(Tone(axis="x", amplitude=2.0, frequency=6.0),))
    assert drifting.bound(0) == math.inf
    assert drifting.bound(1) == pytest.approx(math.sqrt(12**2 + 3**2 + 4**2))
    assert drifting.bound(2) == pytest.approx(72)


@given(
    st.floats(0.1, 5),
    st.lists(st.tuples(st.sampled_from("xyz"), st.integers(1, 30), st.integers(1, 6)), min_size=1, max_size=4),
    st.integers(2, 5),
    times,
)
def test_the_period_repeats_every_derivative(base, ratios, order, t):
    signal = Multisine(
        tones=tuple(Tone(axis=a, amplitude=1.0, frequency=base * n / m, phase=0.3) for a, n, m in ratios),
        drift=(1.0, 2.0, 3.0),
    )
    period = signal.period
    assert period is not None
    shift = at(signal, t + period, order) - at(signal, t, order)
    # the period of up to 60 base turns has the relative error of the frequencies' ratios, 1e-15
    assert np.linalg.norm(shift) <= 1e-11 * signal.bound(order) * (1 + base * 30 * (t + period)) / 100


@pytest.mark.parametrize(
    ("frequencies", "period"),
    [
        ((2.0,), math.pi),
        ((8.0, 16.0), math.pi / 4),
        ((30.0, 40.0, 50.0), math.pi / 5),
        ((1.5, 2.25, 3.0), 8 * math.pi / 3),
    ],
)
def test_the_period_is_the_shortest(frequencies, period):
    signal = Multisine(tones=tuple(Tone(axis="x", amplitude=1.0, frequency=w, phase=1.0) for w in frequencies))
    assert signal.period == pytest.approx(period, rel=1e-14)
    for divisor in (2, 3, 5):
        grid = np.linspace(0, period, 50)
        assert np.abs(signal(grid + period / divisor) - signal(grid)).max() > 0.1


@pytest.mark.parametrize("ratio", [math.sqrt(2), math.pi, (1 + math.sqrt(5)) / 2, math.e])
def test_incommensurate_tones_have_no_period(ratio):
    signal = Multisine(tones=tuple(Tone(axis="x", amplitude=1.0, frequency=w) for w in (1.0, ratio)))
    assert signal.period is None


def test_without_tones_every_period_will_do_and_silent_tones_do_not_count():
    assert Multisine(offset=(1.0, 2.0, 3.0), drift=(1.0, 0.0, 0.0)).period == 0
    silent = Tone(axis="y", amplitude=0.0, frequency=math.sqrt(2))
    assert Multisine(tones=(silent,)).period == 0
    assert Multisine(tones=(silent, Tone(axis="x", amplitude=1.0, frequency=4.0))).period == pytest.approx(math.pi / 2)


@given(multisines, st.floats(0.1, 10), st.integers(0, 5), times)
def test_slowing_by_s_divides_the_kth_derivative_by_s_to_the_k(signal, factor, order, t):
    slow = signals.slowed(signal, factor)
    expected = at(signal, t, order) / factor**order
    assert np.linalg.norm(at(slow, t * factor, order) - expected) <= 10 * rounding(signal, order, t) / factor**order


@pytest.mark.parametrize("factor", [0.5, 2.0, 4.0])
def test_slowing_by_s_divides_the_excitation_over_a_period_by_s_to_the_7(factor):
    """Snap falls by s⁻⁴, its square by s⁻⁸, and the period is s times longer."""
    path = signals.curved_part(msgspec.structs.replace(EXAMPLE, tones=EXAMPLE.tones[:3]))
    slow = signals.slowed(path, factor)
    assert path.period is not None
    assert slow.period is not None
    assert slow.period == pytest.approx(factor * path.period, rel=1e-13)
    fast = excitation.eigenvalues(path, np.array([0.1]), path.period)
    # quadrature is exact to rounding; eigenvalues are within a factor 50 of each other
    np.testing.assert_allclose(
        excitation.eigenvalues(slow, np.array([0.1 * factor]), slow.period), fast / factor**7, rtol=1e-11
    )


@pytest.mark.parametrize("factor", [0.0, -1.0, math.nan, math.inf])
def test_a_time_scale_that_is_no_positive_number_is_refused(factor):
    with pytest.raises(ValueError, match="the time scale must be a positive number"):
        signals.slowed(EXAMPLE, factor)


def test_speeding_up_past_the_fastest_tone_is_refused_by_name():
    with pytest.raises(ValueError, match="frequency must lie between"):
        signals.slowed(EXAMPLE, 1e-6)


@given(multisines, triples, triples, times)
def test_with_start_sets_position_and_velocity_and_keeps_what_bends(signal, position, velocity, t):
    moved = signals.with_start(signal, position=position, velocity=velocity)
    np.testing.assert_allclose(at(moved, 0.0), position, atol=100 * EPS)  # sums of numbers up to 30
    np.testing.assert_allclose(at(moved, 0.0, 1), velocity, atol=2000 * EPS)  # and up to 5·50·4
    for order in range(2, 6):
        np.testing.assert_array_equal(at(moved, t, order), at(signal, t, order))
    # what is left is the difference of the two starts, drifting
    shift = np.asarray(position) - at(signal, 0.0) + t * (np.asarray(velocity) - at(signal, 0.0, 1))
    np.testing.assert_allclose(at(moved, t) - at(signal, t), shift, atol=1e5 * EPS)


@given(multisines, times)
def test_bent_drops_offset_and_drift_and_nothing_else(signal, t):
    straight = np.asarray(signal.offset) + t * np.asarray(signal.drift)
    np.testing.assert_allclose(at(signals.curved_part(signal), t) + straight, at(signal, t), atol=1000 * EPS)
    np.testing.assert_array_equal(at(signals.curved_part(signal), t, 2), at(signal, t, 2))


@given(multisines, st.integers(0, 5))
def test_grids_of_any_shape_are_evaluated_entry_by_entry(signal, order):
    grid = np.array([[0.0, 1.0, 2.5], [3.0, 7.0, 11.0]])
    values = signal(grid, order)
    assert values.shape == (2, 3, 3)
    for i in np.ndindex(grid.shape):
        # numpy's vector loop and its scalar loop may round sines differently
        np.testing.assert_allclose(values[i], at(signal, grid[i], order), atol=rounding(signal, order, grid[i]))


def test_bandwidth_is_the_fastest_tone():
    assert EXAMPLE.bandwidth == 16.0
    assert Multisine(offset=(1.0, 0.0, 0.0)).bandwidth == 0.0


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"amplitude": math.nan}, "amplitude must be a finite number, got nan"),
        ({"amplitude": math.inf}, "amplitude must be a finite number, got inf"),
        ({"amplitude": -1.1e4}, "amplitude must lie between -10000 and 10000, got -11000"),
        ({"frequency": 0.0}, "frequency must lie between 1e-06 and 10000 rad/s, got 0"),
        ({"frequency": -2.0}, "frequency must lie between 1e-06 and 10000 rad/s, got -2"),
        ({"frequency": 10001.0}, "frequency must lie between 1e-06 and 10000 rad/s, got 10001"),
        ({"phase": -math.inf}, "phase must be a finite number, got -inf"),
    ],
)
def test_a_tone_outside_its_limits_is_refused_in_one_sentence(fields, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        Tone(**{"axis": "x", "amplitude": 1.0, "frequency": 1.0, **fields})


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"tones": (Tone(axis="x", amplitude=1.0, frequency=1.0),) * 65}, "at most 64 tones, got 65"),
        ({"offset": (0.0, math.nan, 0.0)}, "offset must be a finite number, got nan"),
        ({"drift": (math.inf, 0.0, 0.0)}, "drift must be a finite number, got inf"),
        ({"offset": (0.0, 0.0, -1e7)}, "offset must lie between -1e+06 and 1e+06, got -1e+07"),
        ({"drift": (0.0, 2e5, 0.0)}, "drift must lie between -100000 and 100000, got 200000"),
    ],
)
def test_a_multisine_outside_its_limits_is_refused_in_one_sentence(fields, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        Multisine(**fields)


def test_the_limits_themselves_are_allowed():
    tone = Tone(axis="z", amplitude=-1e4, frequency=1e4, phase=1e6)
    assert np.isfinite(Multisine(tones=(tone,) * 64, offset=(1e6, -1e6, 0.0), drift=(1e5, 0.0, -1e5)).bound(5))
