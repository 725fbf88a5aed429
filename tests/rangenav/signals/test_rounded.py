"""The rounding of a signal's values has a bound, against ball arithmetic (FLINT's Arb) and between all samples."""

import math

import numpy as np
import pytest
from flint import arb, ctx

from rangenav.observability import derivative_bounds, rounding, rows
from rangenav.signals import Formula, Multisine, Polynomials, Signal, Sum, Tone, curved_part
from rangenav.signals.polynomials import Piece

EPSILON = float(np.finfo(float).eps)
TONES = Multisine(
    tones=(
        Tone(axis="x", amplitude=3.0, frequency=7.0, phase=40.0),
        Tone(axis="x", amplitude=1.0, frequency=1.1),
        Tone(axis="y", amplitude=2.0, frequency=5.0, phase=1.0),
    )
)
FORMULA = Formula(
    x="exp(-0.1*t)*sin(30*t + 1)/(2 + cos(t))", y="sqrt(1 + t*t) - t", z="tanh(sin(2*t))**3*(t - 20)", slower=1.5
)
BENT = (0.3, -0.2, 0.3, 0.1, -0.3, 0.2, 0.1, -0.02)
STRAIGHT = (5.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
PIECES = Polynomials(
    pieces=(
        Piece(duration=3.0, x=(1.0, 2.0, -3.0, 1.0, 0.5, 0.0, 0.0, 0.1), y=STRAIGHT, z=BENT),
        Piece(duration=3.0, x=BENT, y=BENT, z=STRAIGHT),
    )
)


def exact(signal: Signal, t: float) -> list[arb]:
    """x, y and z at a time, as balls."""
    time = arb(t)
    match signal:
        case Multisine():
            values = [arb(0), arb(0), arb(0)]
            for tone in signal.tones:
                values["xyz".index(tone.axis)] += tone.amplitude * (tone.frequency * time + tone.phase).sin()
            return values
        case Formula():
            u = time / arb(signal.slower)
            x = (arb(-0.1) * u).exp() * (30 * u + 1).sin() / (2 + u.cos())
            return [x, (1 + u * u).sqrt() - u, (2 * u).sin().tanh() ** 3 * (u - 20)]
        case Polynomials():
            first = t < 3.0
            piece, local = signal.pieces[0 if first else 1], time - arb(0.0 if first else 3.0)
            return [
                sum((arb(c) * local**k for k, c in enumerate(axis)), arb(0)) for axis in (piece.x, piece.y, piece.z)
            ]
        case _:
            raise AssertionError


@pytest.mark.parametrize("signal", [TONES, FORMULA, PIECES], ids=["tones", "formula", "pieces"])
def distance(balls: list[arb], values: np.ndarray) -> float:
    return math.hypot(*(float(abs(ball - arb(float(v)))) for ball, v in zip(balls, values, strict=True)))


@pytest.mark.parametrize("signal", [TONES, FORMULA, PIECES], ids=["tones", "formula", "pieces"])
def test_no_value_is_further_from_the_exact_one_than_the_bound(signal: Signal):
    until = 6.0 if isinstance(signal, Polynomials) else 30.0
    bound = signal.rounding_bound(derivative_bounds.stretches(signal, until))
    times, before = np.random.default_rng(3).uniform(0, until, 400), ctx.prec
    ctx.prec = 120
    try:
        off = max(distance(exact(signal, t), signal(np.array(t))) for t in times.tolist())
    finally:
        ctx.prec = before
    assert 0 < off <= bound * EPSILON
    assert bound * EPSILON < 3e3 * off


def test_a_sum_and_a_slower_motion_have_bounds_too():
    edges = np.linspace(0, 6.0, 65)
    both = Sum(base=FORMULA, wiggle=TONES)
    assert both.rounding_bound(edges) > FORMULA.rounding_bound(edges) + TONES.rounding_bound(edges)
    assert TONES.slowed(2.0).rounding_bound(edges) < TONES.rounding_bound(edges)


def test_a_spike_between_all_samples_is_in_the_bound():
    """A hop of 100 m for a few microseconds lies between the samples of windows half a window apart."""
    spiked = Formula(x="sin(2*t) + 100/(1 + ((t - 3.14171)*1e6)**4)", y="cos(4*t)", z="sin(6*t)")
    samples = rows.sample(curved_part(spiked), np.linspace(0, 8.0, 5), 4.0)
    assert np.abs(samples.curved).max() < 3.0
    assert rounding.bound(spiked, 12.0) > 100.0


def test_what_intervals_cannot_enclose_has_no_bound():
    unknown = Formula(x="sqrt(t*t - 10*t + 25.01)", y="t", z="t")
    assert unknown.rounding_bound(np.linspace(0, 12.0, 65)) == math.inf
