"""Windows of paths made of pieces: exact between knots, whatever jumps there, and bounded before any work is done."""

import itertools
import math
import re
from typing import Literal

import numpy as np
import pytest
import scipy.integrate
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from rangenav import analysis, preset
from rangenav.observability import accuracy, excitation, quadrature, rows, spectrum
from rangenav.signals import (
    Formula,
    MinimumSnap,
    Multisine,
    Piece,
    Polynomials,
    Sum,
    Tone,
    Waypoint,
    Waypoints,
    knots,
    slowed,
)
from tests.support import exact_integrals
from tests.support.signal_examples import (
    LOOP,
    MINIMUM_SNAP,
    MINIMUM_SNAP_LOOP,
    MULTISINE,
    POLYNOMIALS,
    WAYPOINTS,
    polynomial_file,
    timed,
)

pytestmark = pytest.mark.slow


GRAVITY = (0.0, 0.0, 9.81)
ANCHOR = (0.1, -0.2, 1.5)
WINDOW = 3.0


def uneven(family, *, gap: float, seed: int, period: float | None = None):
    """Waypoints a second apart, but for three of them that are `gap` (s) apart and as near to each other in place."""
    rng = np.random.default_rng(seed)
    time = np.array([0.0, 1.1, 1.9, 3.0, 3.0 + gap, 3.0 + 2 * gap, 4.2, 5.1, 6.3])
    value = rng.normal(size=(len(time), 3))
    value[4:6] = value[3] + gap * rng.normal(size=(2, 3))
    points = tuple(Waypoint(time=float(t), value=tuple(v.tolist())) for t, v in zip(time, value, strict=True))
    return family(points=points, period=period)


def jumping(*, seed: int, ends: Literal["hold", "repeat"]) -> Polynomials:
    """Pieces that begin where the last one ended, with a rate and a curvature of their own: all but the place jumps."""
    rng = np.random.default_rng(seed)
    pieces, at = [], np.zeros(3)
    for duration in (0.7, 0.05, 1.3, 0.4, 2.1, 0.9):
        table = rng.normal(size=(3, 8)) / (duration ** np.arange(8) * np.array([1, 1, 1, 2, 6, 24, 60, 120]))
        table[:, 0] = at
        at = table @ duration ** np.arange(8)
        x, y, z = (tuple(row.tolist()) for row in table)
        pieces.append(Piece(duration=duration, x=x, y=y, z=z))
    return Polynomials(pieces=tuple(pieces), ends=ends)


CURVES = {
    "waypoints": WAYPOINTS,
    "closed waypoints": LOOP,
    "minimum snap": MINIMUM_SNAP,
    "closed minimum snap": MINIMUM_SNAP_LOOP,
    "polynomials": POLYNOMIALS,
    "waypoints 0.05 s apart": uneven(Waypoints, gap=0.05, seed=1),
    "closed waypoints 0.05 s apart": uneven(Waypoints, gap=0.05, seed=2, period=7.0),
    "minimum snap 0.05 s apart": uneven(MinimumSnap, gap=0.05, seed=3),
    "closed minimum snap 0.05 s apart": uneven(MinimumSnap, gap=0.05, seed=4, period=7.0),
    "jumping polynomials": jumping(seed=5, ends="hold"),
    "repeated jumping polynomials": jumping(seed=6, ends="repeat"),
}
curves = pytest.mark.parametrize("curve", CURVES.values(), ids=CURVES)


@curves
def test_excitation_is_the_exact_integral_from_any_moment_on(curve):
    """Singular values are exact to the rounding of the largest: the snap of close waypoints cancels three digits."""
    start = np.array([0.0, 0.3, 1.234, 2.95, 4.8, 9.77])
    singular = np.sqrt(excitation.eigenvalues(curve, start, WINDOW))
    for k, t in enumerate(start):
        witness = np.sqrt(np.maximum(exact_integrals.excitation(curve, float(t), WINDOW), 0))
        np.testing.assert_allclose(singular[k], witness, rtol=1e-11, atol=1e-12 * witness[-1])


@curves
def test_gramians_are_exact_above_their_floor(curve):
    """Singular values against 50 digits: off by the rounding of the largest; those that count, by 1e-5 of theirs."""
    start = np.array([0.0, 1.234, 2.95])
    lifted = spectrum.window_spectra(curve, GRAVITY, start, WINDOW)
    local = spectrum.nonlinear_spectra(curve, ANCHOR, start, WINDOW)
    for k, t in enumerate(start):
        for computed, witness in (
            (lifted, exact_integrals.lifted(curve, GRAVITY, float(t), WINDOW)),
            (local, exact_integrals.nonlinear(curve, ANCHOR, float(t), WINDOW)),
        ):
            _assert_same_singular_values(computed, k, witness)


def _assert_same_singular_values(computed: spectrum.Spectrum, k: int, witness: np.ndarray) -> None:
    root, values = np.sqrt(np.maximum(witness, 0)), np.sqrt(computed.eigenvalues[k])
    np.testing.assert_allclose(values, root, rtol=1e-13, atol=1e-15 * root[-1])
    counts = computed.eigenvalues[k] > computed.floor[k]
    np.testing.assert_allclose(values[counts], root[counts], rtol=1e-5)
    assert (root[~counts] <= 1e-13 * root[-1]).all()


def test_panels_across_the_knots_would_be_wrong_where_the_snap_jumps():
    """What the panels are for: 96 nodes that do not know the knots, on six pieces, against 4 on each that do."""
    curve = jumping(seed=6, ends="repeat")
    witness = exact_integrals.excitation(curve, 0.3, WINDOW)
    x, weight = np.polynomial.legendre.leggauss(96)
    snap = curve(0.3 + WINDOW * (x + 1) / 2, 4) * np.sqrt(weight * WINDOW / 2)[:, None]
    across = np.linalg.svd(snap, compute_uv=False)[::-1] ** 2
    assert np.abs(across / witness - 1).max() > 1e-3
    np.testing.assert_allclose(excitation.eigenvalues(curve, np.array([0.3]), WINDOW)[0], witness, rtol=1e-10)


WIGGLES = {
    "a tone": Multisine(tones=(Tone(axis="y", amplitude=0.05, frequency=7.0),), drift=(0.0, 0.2, 0.0)),
    "fast tones": Multisine(
        tones=(Tone(axis="x", amplitude=1e-3, frequency=60.0), Tone(axis="z", amplitude=0.02, frequency=11.0))
    ),
    "a formula": Formula(x="0.1*sin(3*t)*cos(2*t)", z="0.05*sin(4*t)**2"),
    "other pieces": uneven(MinimumSnap, gap=0.11, seed=9),
    "itself, slower": slowed(MINIMUM_SNAP, 1.3),
}


@pytest.mark.parametrize("wiggle", WIGGLES.values(), ids=WIGGLES)
@pytest.mark.parametrize("base", [WAYPOINTS, LOOP, jumping(seed=7, ends="repeat")], ids=["open", "closed", "jumping"])
def test_a_sum_is_integrated_between_the_knots_of_both_parts(base, wiggle):
    """Excitation and the lifted Gramian against scipy's adaptive quadrature, told where the knots are."""
    curve, start = Sum(base=base, wiggle=wiggle, offset=(1.0, 0.0, -2.0), drift=(0.1, 0.0, 0.0)), 0.77
    points = knots.knots(curve, start, start + WINDOW)
    edges = np.concatenate([[start], points, [start + WINDOW]])

    def integral(outer) -> np.ndarray:
        parts = [
            scipy.integrate.quad_vec(outer, a, b, epsrel=1e-13, limit=400)[0] for a, b in itertools.pairwise(edges)
        ]
        return np.sum(parts, axis=0)

    def snaps(t: float) -> np.ndarray:
        snap = curve(np.array(t), 4)
        return np.outer(snap, snap)

    def lifted(t: float) -> np.ndarray:
        row = rows.lifted(curve, GRAVITY, np.array([start]), np.array([t - start]))[0, 0]
        return np.outer(row, row)

    eigenvalues = excitation.eigenvalues(curve, np.array([start]), WINDOW)[0]
    witness = np.linalg.eigvalsh(integral(snaps))
    np.testing.assert_allclose(eigenvalues, witness, rtol=1e-10, atol=1e-12 * witness[-1])
    seen = rows.sample(curve, np.array([start]), WINDOW)
    R = rows.triangles(seen, seen.weight, lambda part: rows.lifted_of(part, GRAVITY, "start"))[0]
    expected = integral(lifted) / WINDOW
    np.testing.assert_allclose(R.T @ R, expected, atol=1e-12 * np.abs(expected).max())


@curves
def test_weights_sum_to_one_and_no_panel_has_a_knot_inside(curve):
    start = np.linspace(0.0, 9.0, 23)
    tau, weight = quadrature.nodes(curve, start, WINDOW)
    assert tau.shape == weight.shape
    assert (tau >= 0).all()
    assert (tau <= WINDOW * (1 + 1e-15)).all()
    assert (weight >= 0).all()
    np.testing.assert_allclose(weight.sum(axis=1), 1, rtol=1e-13)
    for k, t in enumerate(start):  # the mean of a step at a knot is exact only if a panel ends there
        for knot in knots.knots(curve, float(t), float(t) + WINDOW):
            before = float(np.sum(weight[k, t + tau[k] < knot]))
            assert before == pytest.approx((knot - t) / WINDOW, abs=1e-13)


@curves
def test_shared_rows_are_those_of_each_window_alone(curve):
    """The path is evaluated once, without its straight part, and rows are computed for a few windows at a time."""
    start = np.linspace(0.0, 8.0, 71)
    seen = rows.sample(curve, start, WINDOW)
    assert seen.tau.size > rows.CHUNK / 2
    shifts: dict[rows.Moment, float] = {"start": 0.0, "end": WINDOW}
    for moment, shift in shifts.items():
        lifted = rows.lifted(curve, GRAVITY, start + shift, seen.tau - shift)
        local = rows.nonlinear(curve, ANCHOR, start + shift, seen.tau - shift)
        # D at the end subtracts δ · velocity: what the rows themselves call rounding, times τ²/2
        np.testing.assert_allclose(rows.lifted_of(seen, GRAVITY, moment), lifted, atol=10 * seen.rounding)
        np.testing.assert_allclose(rows.nonlinear_of(seen, ANCHOR, moment), local, atol=10 * seen.rounding)
    for made, n in ((lambda part: rows.lifted_of(part, GRAVITY, "start"), 13), (_local_rows, 9)):
        R, matrix = rows.triangles(seen, seen.weight, made), made(seen)
        assert R.shape == (71, n, n)
        expected = np.einsum("wk,wki,wkj->wij", seen.weight, matrix, matrix)
        np.testing.assert_allclose(R.swapaxes(1, 2) @ R, expected, atol=1e-12 * np.abs(expected).max())


def _local_rows(part: rows.PathSamples) -> np.ndarray:
    return rows.nonlinear_of(part, ANCHOR, "start")


durations = st.lists(st.floats(0.05, 2.0), min_size=1, max_size=12)


@settings(max_examples=60)
@given(
    durations,
    st.booleans(),
    st.sampled_from([0.0, 3.0, 100.0]),
    st.floats(0.1, 6.0),
    st.lists(st.floats(0.0, 1.0), min_size=1, max_size=20),
)
def test_no_window_has_more_nodes_than_were_counted_beforehand(lengths, repeats, frequency, window, shares):
    x = (0.0, 1.0, 0.5, 0.2, 0.1, 0.1, 0.1, 0.1)
    pieces = tuple(Piece(duration=length, x=x) for length in lengths)
    curve, until = Polynomials(pieces=pieces, ends="repeat" if repeats else "hold"), window + 5.0
    if frequency:
        tone = Tone(axis="z", amplitude=0.1, frequency=frequency)
        curve = Sum(base=curve, wiggle=Multisine(tones=(tone,)))
    start = np.array([share * 5.0 for share in shares])
    count = quadrature.count(curve, window, until)
    assert quadrature.nodes(curve, start, window)[0].shape[1] <= count
    quadrature.refuse(curve, window, until)


def many(count: int, end: float) -> Waypoints:
    time = np.linspace(0.0, end, count)
    value = np.stack([np.cos(1.5 * time), np.sin(2.25 * time), np.sin(3 * time)], axis=-1)
    return Waypoints(
        points=tuple(Waypoint(time=float(t), value=tuple(v.tolist())) for t, v in zip(time, value, strict=True))
    )


def test_two_thousand_waypoints_in_twenty_seconds_are_refused_before_any_work():
    curve, soft = many(2000, 20.0), preset.load("soft")
    sentence = "requirement.window must hold at most 512 pieces of the path, got 60"
    with pytest.raises(ValueError, match=re.escape(sentence)):
        replace(soft, path=curve, duration=20.0, requirement=replace(soft.requirement, window=6.0))
    with pytest.raises(ValueError, match=re.escape(sentence)):
        spectrum.window_spectra(curve, GRAVITY, np.linspace(0, 14, 101), 6.0)


def test_two_thousand_waypoints_in_a_minute_are_analysed():
    soft = preset.load("soft")
    analysed = analysis.analyse(
        replace(soft, path=many(2000, 60.0), duration=60.0, requirement=replace(soft.requirement, window=2.0))
    )
    assert analysed.rank == 13


def test_a_period_too_short_to_list_its_knots_is_refused():
    blink = Waypoints(points=timed(count=2, end=0.001), period=0.002)
    with pytest.raises(ValueError, match="a signal may have 200000 knots in 600 s, this one has up to 6"):
        quadrature.count(blink, 6.0, 600.0)


def test_fast_tones_on_pieces_are_refused_as_they_are_alone():
    curve = Sum(base=WAYPOINTS, wiggle=Multisine(tones=(Tone(axis="x", amplitude=1e-4, frequency=600.0),)))
    sentence = "requirement.window must be at most 1.92 s for tones of 600 rad/s, got 6 s"
    with pytest.raises(ValueError, match=re.escape(sentence)):
        quadrature.refuse(curve, 6.0, 20.0)


def _burst(direction: tuple[float, float, float], duration: float) -> Piece:
    """A piece whose snap is constant."""
    x, y, z = ((0.0, 0.0, 0.0, 0.0, a / 24, 0.0, 0.0, 0.0) for a in direction)
    return Piece(duration=duration, x=x, y=y, z=z)


def _turns(size: float, count: int) -> tuple[Piece, ...]:
    """Snap of one size along x, y and z in turn, 0.02 s each: 0.06 s excite everything."""
    x, y, z = (size, 0.0, 0.0), (0.0, size, 0.0), (0.0, 0.0, size)
    return (_burst(x, 0.02), _burst(y, 0.02), _burst(z, 0.02)) * count


def test_a_rest_is_found_by_the_window_that_starts_and_ends_with_it():
    """A window of 1.5 s that is 0.08 s early or late sees a whole turn; those at the rest's knots see too little."""
    curve = Polynomials(pieces=(*_turns(1.0, 10), _burst((0.0, 0.0, 0.0), 1.5), *_turns(1.0, 10)))
    start = np.linspace(0.0, 1.2, 8)
    on_grid = excitation.eigenvalues(curve, start, 1.5)[:, 0]
    values, at = excitation.worst(curve, start, 1.5)
    assert on_grid.min() > 0.01
    assert 0.6 - 0.04 - 1e-12 <= at <= 0.6 + 0.04 + 1e-12  # two directions of three do not excite either
    assert values[0] < 1e-12


def test_a_weak_end_is_worst_in_the_window_that_ends_where_something_stronger_begins():
    """Weaker, then weakest, then strong: as late as it may be, but not a knot later."""
    curve = Polynomials(pieces=(*_turns(0.2, 15), *_turns(0.1, 10), *_turns(9.0, 20)))
    start = np.linspace(0.01, 0.81, 9)
    values, at = excitation.worst(curve, start, 1.2)
    assert at == pytest.approx(0.3, abs=1e-12)
    np.testing.assert_allclose(values, exact_integrals.excitation(curve, 0.3, 1.2), rtol=1e-10)


@curves
def test_sums_over_cells_find_the_window_that_looking_at_each_finds(curve):
    start = np.linspace(0.0, 8.0, 301)
    values, at = excitation.worst(curve, start, WINDOW)
    each = excitation.eigenvalues(curve, start, WINDOW)
    assert values[0] <= each[:, 0].min() * (1 + 1e-9)
    np.testing.assert_allclose(excitation.eigenvalues(curve, np.array([at]), WINDOW)[0], values, rtol=1e-12)
    points = knots.knots(curve, 0.0, 8.0 + WINDOW)
    known = np.concatenate([start, points, points - WINDOW])
    assert np.abs(known - at).min() < 1e-12


PERIODIC = {name: curve for name, curve in CURVES.items() if curve.period is not None}
PERIODIC["a closed path and a tone"] = Sum(
    base=LOOP, wiggle=Multisine(tones=(Tone(axis="z", amplitude=0.1, frequency=4 * math.pi / 11),))
)


@pytest.mark.parametrize("curve", PERIODIC.values(), ids=PERIODIC)
def test_the_bound_for_all_t_holds_between_knots_too(curve):
    """Also where the snap jumps, and the rate of the excitation with it: below every window, and not far below."""
    window = 0.6 * curve.period
    bound = excitation.bound_for_all_t(curve, window)
    rng = np.random.default_rng(3)
    some = rng.uniform(0, 40, 2000)
    least = min(excitation.eigenvalues(curve, some, window)[:, 0].min(), excitation.worst(curve, some, window)[0][0])
    if math.isinf(curve.bound(4)):  # position, velocity, acceleration or jerk jumps: no snap says what that does
        assert bound is None
    else:
        assert bound is not None
        assert 0.9 * least < bound <= least * (1 + 1e-12)


def test_a_snap_that_jumps_has_a_bound_for_all_t():
    """Bumps from rest to rest along each axis in turn, with a jump of the snap at the top of each."""
    axes = [tuple(np.polynomial.polynomial.polyfromroots([0] * 4 + [1] * 3) * s) for s in (1.0, -2.0, 0.5)]
    quiet = (0.0,) * 8
    shapes = [(axes[0], quiet, quiet), (quiet, axes[1], quiet), (quiet, quiet, axes[2])]
    # t⁴(t−1)³ leaves at rest up to jerk and returns with a jump of the jerk; its mirror image takes that jump away
    pieces = []
    for x, y, z in shapes:
        there = Piece(duration=1.0, x=x, y=y, z=z)
        pieces += [there, _mirrored(there)]
    curve = Polynomials(pieces=tuple(pieces), ends="repeat")
    assert np.abs(curve(np.array([1.0 - 1e-12, 1.0]), 4)).max() > 1
    assert math.isinf(curve.bound(5))
    bound = excitation.bound_for_all_t(curve, 6.5)
    least = excitation.worst(curve, np.linspace(0, 6, 1001), 6.5)[0][0]
    assert bound is not None
    assert 0.9 * least < bound <= least


def _mirrored(piece: Piece) -> Piece:
    """−p(1 − t): the piece run backwards, upside down."""

    def axis(coefficients: tuple) -> tuple:
        p = np.polynomial.Polynomial(coefficients)(np.polynomial.Polynomial([1.0, -1.0]))
        return tuple((-np.pad(p.coef, (0, 8 - len(p.coef)))).tolist())

    return Piece(duration=piece.duration, x=axis(piece.x), y=axis(piece.y), z=axis(piece.z))


def test_accuracy_by_triangles_is_accuracy_by_singular_vectors():
    """A window is inverted as a triangle only where no singular value is in doubt; a dense inverse is the witness."""
    soft = preset.load("soft")
    for curve in (WAYPOINTS, LOOP, MULTISINE):
        seen = accuracy.ranged(curve, 0.5, 6.0, 50.0)
        distance2 = np.sum((seen.position - np.asarray(soft.world.anchor)[:, None]) ** 2, axis=1)[0]
        matrix = rows.nonlinear_of(seen, soft.world.anchor, "end")[0] / (0.1 * np.sqrt(distance2))[:, None]
        covariance = np.linalg.inv(matrix.T @ matrix)  # nine unknowns, condition 1e9 at worst: seven digits are left
        predicted = accuracy.of_ranges(seen, soft.world, sigma=0.1, kind="nonlinear", at="end")
        for k, value in enumerate((predicted.position, predicted.velocity, predicted.gravity)):
            block = slice(3 * k, 3 * k + 3)
            assert value == pytest.approx(math.sqrt(np.trace(covariance[block, block])), rel=1e-6)


@pytest.mark.parametrize("name", ["cs1_seq1_19.csv", "cs2_figure8.csv", "cs2_multi_traj0.csv"])
def test_files_of_others_are_integrated_exactly(name):
    curve = polynomial_file(name)
    start = np.linspace(0.1, curve_duration(curve) - 5.0, 4)
    eigenvalues = excitation.eigenvalues(curve, start, 4.0)
    for k, t in enumerate(start):
        witness = exact_integrals.excitation(curve, float(t), 4.0)
        np.testing.assert_allclose(
            np.sqrt(eigenvalues[k]), np.sqrt(np.maximum(witness, 0)), atol=1e-12 * witness[-1] ** 0.5
        )
    lifted = spectrum.window_spectra(curve, GRAVITY, start[:1], 4.0)
    witness = exact_integrals.lifted(curve, GRAVITY, float(start[0]), 4.0)
    _assert_same_singular_values(lifted, 0, witness)


def curve_duration(curve: Polynomials) -> float:
    return math.fsum(piece.duration for piece in curve.pieces)
