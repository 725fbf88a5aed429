"""Observability in depth: the excitation's ellipsoid, how long to fly, the 13 functions, frozen test and misprints."""

import math
import re
from fractions import Fraction

import numpy as np
import pytest
import scipy.integrate
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from rangenav import analysis, model, motion, preset, record, so3
from rangenav.observability import accuracy, ellipsoid, excitation, frozen, functions, horizon, printed, rows, spectrum
from rangenav.signals import Multisine, Tone
from tests.support.motion_examples import tumbling
from tests.support.refusals import exactly

pytestmark = pytest.mark.slow


SHIPPED = [file.stem for file in preset.shipped_files()]
SLOW, CIRCLE, HOVER = preset.load("paper-slow"), preset.load("circle"), preset.load("hover")
laws = settings(max_examples=40)
unit_cube = st.tuples(*[st.floats(-1.0, 1.0)] * 3)


def horizon_of(name: str, **chosen) -> horizon.Horizon:
    p = preset.load(name)
    wanted = {"sigma": 0.1, "rate": 50.0, "position_sigma": p.requirement.position_sigma} | chosen
    return horizon.horizon(p.path, p.world, p.duration, **wanted)


# The excitation's ellipsoid


@pytest.mark.parametrize("name", ["paper-slow", "lissajous", "soft", "tilted-circle"])
def test_the_ellipsoid_is_that_of_the_integral_of_the_snap(name: str):
    p = preset.load(name)
    computed = ellipsoid.ellipsoid(p.path, 1.3, 4.0)
    time = np.linspace(1.3, 5.3, 4001)
    snap = p.path(time, 4)
    exact = np.asarray(scipy.integrate.simpson(snap[:, :, None] * snap[:, None, :], x=time, axis=0))
    again = computed.axes @ np.diag(computed.semi_axes**2) @ computed.axes.T
    np.testing.assert_allclose(again, exact, atol=1e-9 * np.abs(exact).max())
    assert np.linalg.det(computed.axes) == pytest.approx(1.0)
    assert (np.diff(computed.eigenvalues) >= 0).all()
    assert computed.weakest @ exact @ computed.weakest == pytest.approx(computed.eigenvalues[0], abs=1e-9 * exact.max())


def test_the_weakest_axis_is_named_and_where_nothing_is_excited_it_is_said():
    assert ellipsoid.ellipsoid(CIRCLE.path, 0.0, 6.0).summary == (
        "nothing is excited along z: the path has no snap there"
    )
    assert ellipsoid.ellipsoid(HOVER.path, 0.0, 6.0).summary == (
        "nothing is excited: the path has no snap in this window"
    )
    one = Multisine(tones=(Tone(axis="y", amplitude=1.0, frequency=2.0),))
    assert ellipsoid.ellipsoid(one, 0.0, 6.0).summary == "nothing is excited but y: the path has no snap there"
    weak = ellipsoid.ellipsoid(preset.load("wiggle").path, 0.0, 6.0)
    ratio = math.sqrt(weak.eigenvalues[2] / weak.eigenvalues[0])
    less = f"the snap along it is {ratio:.3g} times smaller than along z (rms)"
    assert weak.summary == f"weakest along x: μ = {weak.eigenvalues[0]:.3g} m²/s⁷; {less}"


# How long must I fly?


@pytest.mark.parametrize("name", ["paper-slow", "lissajous", "wiggle", "circle"])
def test_rank_by_length_is_the_rank_of_those_windows(name: str):
    p, how_long = preset.load(name), horizon_of(name)
    for length, rank in zip(how_long.length[::5], how_long.rank[::5], strict=True):
        first = spectrum.window_spectra(p.path, p.world.gravity, np.array([0.0]), float(length)).rank[0]
        assert rank[0] == first
        assert rank[1] <= rank[0]


@pytest.mark.parametrize("name", ["paper-slow", "lissajous", "wiggle"])
def test_sigma_by_length_is_what_each_windows_own_ranges_predict(name: str):
    p, how_long = preset.load(name), horizon_of(name)
    for length, sigma in zip(how_long.length[::4], how_long.sigma[::4], strict=True):
        length = float(length)
        exact = accuracy.predict(p.path, p.world, 0.0, length, sigma=0.1, rate=50.0, kind="lifted", at="end").position
        if math.isnan(exact):
            assert sigma[0] == math.inf
        else:
            # the last range may lie a whole interval before the end, and σ falls with up to the length to the 14th
            assert sigma[0] == pytest.approx(exact, rel=math.expm1(14 * 0.02 / length) + 0.02)
        assert sigma[1] >= sigma[0]


def test_the_shortest_full_rank_and_accurate_lengths_hold_and_a_little_shorter_ones_do_not():
    how_long = horizon_of("paper-slow")
    full, good = how_long.full_rank[0], how_long.accurate[0]
    assert full is not None
    assert good is not None
    assert 0.1 < full < 2.0 < good < 8.0

    def rank(length: float) -> int:
        return int(spectrum.window_spectra(SLOW.path, SLOW.world.gravity, np.array([0.0]), length).rank[0])

    def error(length: float) -> float:
        start = np.array([0.0])
        return float(
            accuracy.end_sigmas(SLOW.path, SLOW.world, start, length, sigma=0.1, rate=50.0, kind="lifted")[0, 0]
        )

    gap = np.diff(how_long.length).max() / 2**horizon.HALVINGS
    assert rank(full) == 13
    assert rank(full - 1.01 * gap) < 13
    wanted = SLOW.requirement.position_sigma
    assert error(good) <= wanted < error(good - 1.01 * gap)
    assert how_long.summary.startswith(f"From 0 s: rank 13 after {full:.3g} s, σ ≤ {wanted:g} m after {good:.3g} s. ")


@pytest.mark.parametrize("name", ["hover", "line", "circle", "helix", "vertical-circle", "paper-implied"])
def test_no_length_makes_a_blind_path_observable(name: str):
    how_long = horizon_of(name)
    assert how_long.full_rank == how_long.accurate == (None, None)
    assert (how_long.sigma == np.inf).all()
    assert how_long.summary == (
        "From 0 s no window of up to 20 s has rank 13. "
        f"At the worst of {horizon.STARTS + 1} starts no window of up to 20 s has rank 13."
    )


def test_an_accuracy_that_is_never_met_is_told_with_the_best_there_is():
    how_long = horizon_of("wiggle")
    assert how_long.accurate == (None, None)
    best = how_long.sigma[:, 1].min()
    assert f"σ ≤ 0.5 m not within 20 s ({best:.3g} m at best)." in how_long.summary


def test_windows_that_do_not_fit_behind_the_chosen_start_are_left_out():
    how_long = horizon_of("paper-slow", start=15.0)
    beyond = how_long.length > 5.0
    assert np.isnan(how_long.rank[beyond, 0]).all()
    assert np.isnan(how_long.sigma[beyond, 0]).all()
    assert np.isfinite(how_long.rank[~beyond, 0]).all()
    assert np.isfinite(how_long.rank[:, 1]).all()
    last = horizon_of("paper-slow", start=19.99)
    assert last.full_rank[0] is None
    with pytest.raises(ValueError, match=exactly("start must lie between 0 and the flight's end at 20 s, got 20 s")):
        horizon_of("paper-slow", start=20.0)


def test_fewer_ranges_than_unknowns_determine_nothing():
    how_long = horizon_of("paper-slow", rate=2.0)
    assert (how_long.sigma[how_long.length * 2.0 < 11.5] == np.inf).all()
    assert np.isfinite(how_long.sigma[-1]).all()


def test_lost_ranges_cost_accuracy_by_the_root_of_their_share_and_no_rank():
    """Each σ is 1/√share times as large; what has 13 ranges still has 13, each worth less."""
    every, quarter = horizon_of("paper-slow"), horizon_of("paper-slow", share=0.25)
    np.testing.assert_array_equal(quarter.rank, every.rank)
    np.testing.assert_allclose(quarter.sigma, 2.0 * every.sigma, rtol=1e-6)


def test_a_long_fast_flight_is_looked_at_as_far_as_it_can_be_integrated():
    path = preset.load("wiggle").path
    how_long = horizon.horizon(path, SLOW.world, 600.0, sigma=0.1, rate=50.0, position_sigma=0.5)
    assert 10.0 < how_long.length[-1] < 600.0 / 16
    assert len(how_long.length) == horizon.SHORT + horizon.LONG


# The 13 functions


@pytest.mark.parametrize("name", ["paper-slow", "helix"])
def test_the_functions_are_the_powers_and_the_double_integral_of_the_apparent_acceleration(name: str):
    p, start = preset.load(name), 0.7
    dependence = functions.functions(p.path, p.world.gravity, start, 3.0, points=4)

    def departure(tau: float, axis: int) -> float:
        def integrand(r: float) -> float:
            return (tau - r) * (p.path(np.array(start + r), 2)[axis] - p.world.gravity[axis])

        return scipy.integrate.quad(integrand, 0.0, tau, epsabs=1e-11)[0]

    for tau, row in zip(dependence.tau, dependence.values, strict=True):
        D = np.array([departure(float(tau), axis) for axis in range(3)])
        exact = np.concatenate([[1, tau, tau**2 / 2, tau**3 / 6], D, tau * D, tau**2 / 2 * D])
        np.testing.assert_allclose(row, exact, atol=1e-8)
    assert len(functions.NAMES) == model.STATES


def terms(side: str) -> list[tuple[float, str]]:
    """(coefficient, name) of each term of a relation's side."""
    names = "|".join(re.escape(name) for name in sorted(functions.NAMES, key=len, reverse=True))
    matches = re.findall(rf"(−|\+|^)\s*([\d.]+(?:e[-+]\d+)?\s+)?({names})(?= |$)", side.strip())
    return [((-1.0 if sign == "−" else 1.0) * float(number or 1.0), name) for sign, number, name in matches]


@pytest.mark.parametrize("name", SHIPPED)
def test_every_relation_holds_on_the_window_and_there_are_as_many_as_the_rank_lacks(name: str):
    p = preset.load(name)
    dependence = functions.functions(p.path, p.world.gravity, 1.3, p.requirement.window)
    assert len(dependence.relations) == model.STATES - dependence.rank
    column = {name: dependence.values[:, k] for k, name in enumerate(functions.NAMES)}
    scale = np.abs(dependence.values).max()
    for relation in dependence.relations:
        left, right = relation.split(" = ")
        total = sum((c * column[n] for c, n in terms(right)), np.zeros(len(dependence.tau)))
        assert right == "0" or terms(right), relation
        # as many digits of the coefficients as the relation needs: three, or nine between polynomials (minimum-snap)
        np.testing.assert_allclose(column[left], total, atol=5e-3 * scale)


def test_a_hover_and_a_horizontal_circle_say_what_they_lack():
    gravity = HOVER.world.gravity
    hover = functions.functions(HOVER.path, gravity, 0.0, 6.0)
    assert hover.relations[:4] == ("D_x = 0", "D_y = 0", "D_z = −9.81 τ²/2", "τ D_x = 0")
    circle = functions.functions(CIRCLE.path, gravity, 0.0, 6.0)
    assert circle.relations == ("D_z = −9.81 τ²/2", "τ D_z = −29.4 τ³/6")
    assert circle.unseen == ("p_z +1 m with ξ₃ +9.81 m²/s²", "v_z +1 m/s with ξ₄ +29.4 m²/s³")


@pytest.mark.parametrize("name", ["hover", "circle", "tilted-circle", "vertical-circle", "paper-implied"])
def test_a_null_vector_carried_through_the_model_never_reaches_the_output(name: str):
    """By exact transitions over steps with constant a, as an observer takes them: 500 of 4 ms."""
    p, h = preset.load(name), 4e-3
    dependence = functions.functions(p.path, p.world.gravity, 0.0, 500 * h)
    assert len(dependence.null) == len(dependence.unseen) == model.STATES - dependence.rank > 0
    accel = p.path((np.arange(500) + 0.5) * h, 2) - np.asarray(p.world.gravity)
    state, outputs = dependence.null.T, []
    for a in accel:
        state = model.transition(a, h, gravity_norm=9.81)[0] @ state
        outputs.append(state[0])
    # along a null vector a does not vary, so the steps are exact; the vectors are good to 1e-9
    assert np.abs(outputs).max() < 1e-6
    assert np.abs(state).max() >= 1.0


@pytest.mark.parametrize("points", [1, 5000])
def test_a_senseless_number_of_points_is_refused(points: int):
    with pytest.raises(ValueError, match=exactly(f"points must lie between 2 and 4096, got {points}")):
        functions.functions(HOVER.path, HOVER.world.gravity, 0.0, 6.0, points=points)


# The frozen-time test


def exact_rank(gyro: tuple, accel: tuple) -> int:
    """The rank of the same observability matrix in rational arithmetic."""
    A, _ = model.dynamics(np.array(gyro, dtype=float), np.array(accel, dtype=float), gravity_norm=9.81)
    exact = sympy.Matrix(13, 13, lambda i, j: sympy.Rational(Fraction(float(A[i, j]))))
    row = sympy.zeros(1, 13)
    row[0] = 1
    stacked = []
    for _ in range(13):
        stacked.append(row)
        row = row * exact
    return sympy.Matrix.vstack(*stacked).rank()


@pytest.mark.parametrize(
    ("gyro", "accel", "expected"),
    [
        ((1, 2, -1), (3, 1, 2), 11),
        ((1, 2, -1), (1, 0, 1), 10),
        ((0, 0, 2), (1, -3, 0), 10),
        ((1, 2, -1), (2, 4, -2), 5),
        ((0, 0, 0), (0, 0, 9), 5),
        ((1, 2, -1), (0, 0, 0), 4),
        ((0, 0, 0), (0, 0, 0), 4),
    ],
)
def test_frozen_ranks_are_those_of_exact_arithmetic(gyro: tuple, accel: tuple, expected: int):
    assert exact_rank(gyro, accel) == expected
    assert frozen.rank(np.array(gyro, dtype=float), np.array(accel, dtype=float)) == expected


@laws
@given(
    turn=unit_cube,
    angle=st.floats(0.02, math.pi / 2 - 0.02),
    turning=st.floats(-4, 2),
    force=st.floats(-4, 3),
    spin=st.floats(0, 6),
)
def test_a_generic_moment_is_frozen_at_11_whatever_its_size_and_axes(turn, angle, turning, force, spin):
    """From 1e-4 rad/s and m/s² to 100 and 1000: rank has no units, so neither may its numerical test."""
    R = so3.exp(np.array(turn)) @ so3.exp(np.array([0.0, 0.0, spin]))
    gyro = 10.0**turning * R[:, 2]
    accel = 10.0**force * (math.cos(angle) * R[:, 2] + math.sin(angle) * R[:, 0])
    assert frozen.rank(gyro, accel) == 11
    assert frozen.rank(gyro, 10.0**force * R[:, 1]) == 10
    assert frozen.rank(gyro, 10.0**force * R[:, 2]) == 5
    assert frozen.rank(np.zeros(3), accel) == 5


def test_the_frozen_test_misleads_in_both_directions_and_says_so():
    slow = record.simulated(record.truth_inputs(SLOW)).motion
    said = frozen.frozen(slow, 3.0, windowed=13)
    assert (said.body, said.turned) == (11, 5)
    assert said.time == pytest.approx(3.0, abs=0.003)
    assert said.summary.startswith(
        "Frozen at 3 s: rank 11 of 13 in body axes, 5 in turned axes, so the frozen test calls the motion unobservable"
    )
    hover = record.simulated(record.truth_inputs(HOVER)).motion
    said = frozen.frozen(hover, 3.0, windowed=5)
    assert said.body == 11
    assert "The window from there has rank 5" in said.summary
    assert "They need not agree" in frozen.frozen(slow, 3.0, windowed=11).summary


# Printed beside derived


def compared(name: str, turning: Multisine) -> printed.PrintedAndDerived:
    p = preset.load(name)
    truth = motion.simulate(
        p.path, turning, world=p.world, initial_rotation=(0.0, 0.0, 0.0), duration=p.duration, rate=200.0
    )
    analysed = analysis.analyse(p)
    start = np.linspace(0.0, p.duration - p.requirement.window, 9)
    return printed.compare(
        truth,
        start,
        p.requirement.window,
        mu=analysed.mu,
        floor=analysed.mu_floor,
        required=p.requirement.mu,
        rank=analysed.rank,
    )


@pytest.mark.parametrize(("name", "rank"), [("hover", 5), ("circle", 11)])
def test_the_printed_condition_certifies_a_tumbling_body_that_cannot_be_observed(name: str, rank: int):
    both_conditions = compared(name, tumbling())
    assert both_conditions.false_certificate
    assert both_conditions.mu == 0.0
    assert both_conditions.mu_printed == both_conditions.least_printed.min() > 10
    assert both_conditions.summary == (
        f"False certificate: as printed, the condition holds for a motion of rank {rank} of 13 "
        f"(printed μ = {both_conditions.mu_printed:.3g}, derived μ = 0, required 1 m²/s⁷)."
    )
    if name == "hover":
        assert both_conditions.phi == 0.0 < both_conditions.phi_printed


def test_without_turning_the_misprints_make_no_difference():
    """ω = 0: both formulas are ä, and body axes are inertial ones."""
    both_conditions = compared("paper-slow", Multisine())
    assert both_conditions.phi == pytest.approx(both_conditions.phi_printed)
    np.testing.assert_allclose(both_conditions.least_printed, both_conditions.least_formula, rtol=1e-9)
    np.testing.assert_allclose(both_conditions.least_printed, both_conditions.least_axes, rtol=1e-9)
    assert both_conditions.mu_printed == pytest.approx(both_conditions.mu, rel=0.02)  # nine windows instead of 401
    assert not both_conditions.false_certificate


@pytest.mark.parametrize(
    ("mu", "mu_printed", "rank", "sentence"),
    [
        (5.0, 0.2, 13, "As printed, the condition refuses what the derived one accepts (printed μ = 0.2, "
         "derived μ = 5, required 1 m²/s⁷); the rank is 13."),
        (0.2, 5.0, 13, "As printed, the condition holds where the derived one does not (printed μ = 5, "
         "derived μ = 0.2, required 1 m²/s⁷); the rank is 13."),
        (5.0, 5.0, 10, "Both conditions hold, yet the rank is 10 of 13 (printed μ = 5, derived μ = 5, required "
         "1 m²/s⁷): they need a longer window."),
        (5.0, 6.0, 13, "Both conditions hold (printed μ = 6, derived μ = 5, required 1 m²/s⁷); the rank is 13 of 13."),
        (0.0, 0.0, 5, "Both conditions fail (printed μ = 0, derived μ = 0, required 1 m²/s⁷); the rank is 5 of 13."),
    ],
)  # fmt: skip
def test_each_outcome_has_its_sentence(mu: float, mu_printed: float, rank: int, sentence: str):
    assert printed.verdict(mu, mu_printed, required=1.0, rank=rank) == sentence


def test_the_four_signals_are_those_of_the_chosen_switches():
    p = preset.load("circle")
    truth = record.simulated(record.truth_inputs(p)).motion
    start = np.array([0.0, 5.0])
    both_conditions = printed.compare(truth, start, 6.0, mu=0.0, floor=1.0, required=1.0, rank=11)
    body = excitation.phi(truth)
    inside = (truth.time >= 5.0 - 1e-9) & (truth.time <= 11.0 + 1e-9)
    integral = np.trapezoid(body[inside][:, :, None] * body[inside][:, None, :], truth.time[inside], axis=0)
    assert both_conditions.least_axes[1] == pytest.approx(np.linalg.eigvalsh(integral)[0], rel=1e-9)


# Tall windows


def test_tall_windows_decomposed_by_blocks_have_the_singular_values_of_all_their_rows():
    path = preset.load("wiggle").path
    seen = rows.sample(path, np.array([0.0, 1.0]), 18.0)
    assert seen.tau.shape[1] > rows.TALLEST
    triangles = rows.triangles(seen, seen.weight, lambda part: rows.lifted_of(part, SLOW.world.gravity, "start"))
    whole = rows.lifted_of(seen, SLOW.world.gravity, "start") * np.sqrt(seen.weight)[..., None]
    scale = 18.0 ** -spectrum.LIFTED_TIME_POWERS.astype(float)
    blocks, at_once = (np.linalg.svd(matrix * scale, compute_uv=False) for matrix in (triangles, whole))
    np.testing.assert_allclose(blocks, at_once, atol=1e-14 * at_once.max())
