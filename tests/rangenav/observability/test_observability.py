"""Known ranks for random motions, spectra in 50 digits, accuracy and the words for what cannot be seen."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from scipy.spatial.transform import Rotation

from rangenav import analysis, preset
from rangenav.motion import World
from rangenav.observability import accuracy, blindness, excitation, quadrature, rows, spectrum
from rangenav.signals import Multisine, Signal, Tone
from tests.support import precise_gramian
from tests.support.motion_examples import circle, tilted, turned

GRAVITY = (0.0, 0.0, 9.81)
SHIPPED = [file.stem for file in preset.shipped_files()]
SINES = [name for name in SHIPPED if isinstance(preset.load(name).path, Multisine)]
"""Those whose path is also known in fifty digits."""
KNOWN_RANKS = {
    "hover": (5, 3),
    "turning-hover": (5, 3),
    "line": (5, 4),
    "circle": (11, 9),
    "tilted-circle": (11, 9),
    "helix": (11, 9),
    "vertical-circle": (10, 9),
    "paper-implied": (11, 6),
    "lissajous": (13, 9),
    "soft": (13, 9),
    "wiggle": (13, 9),
    "paper": (13, 9),
    "paper-slow": (13, 9),
    "barrel": (13, 9),
    "trefoil": (13, 9),
    "torus": (13, 9),
    "hand-held": (13, 9),
    "eight-repaired": (13, 9),
    "figure-eight": (11, 9),
    "minimum-snap": (10, 9),
}

amplitudes = st.floats(0.1, 5.0)
frequencies = st.floats(1.0, 4.0)
phases = st.floats(0.0, 2 * math.pi)
tilts = st.floats(0.0, math.radians(80))
offsets = st.tuples(*[st.floats(-3.0, 3.0)] * 3)
laws = settings(max_examples=40)


def lifted_rank(path: Signal, window: float, gravity: tuple = GRAVITY) -> int:
    return int(spectrum.window_spectra(path, gravity, np.array([0.3]), window).rank[0])


def nonlinear_rank(path: Signal, window: float, anchor: tuple) -> int:
    return int(spectrum.nonlinear_spectra(path, anchor, np.array([0.3]), window).rank[0])


@laws
@given(offset=offsets)
def test_hover_is_rank_5_of_13_and_3_of_9_and_without_gravity_4(offset: tuple):
    """Distance to the anchor at least .5 m: at the anchor itself even the radius is lost to first order."""
    path = Multisine(offset=offset)
    assert lifted_rank(path, 6.0) == 5
    assert lifted_rank(path, 6.0, (0.0, 0.0, 0.0)) == 4
    if np.linalg.norm(offset) > 0.5:
        assert nonlinear_rank(path, 6.0, (0.0, 0.0, 0.0)) == 3


@laws
@given(offset=offsets, drift=offsets)
def test_a_straight_line_is_rank_5_of_13_and_4_of_9(offset: tuple, drift: tuple):
    path = Multisine(offset=offset, drift=drift)
    assert lifted_rank(path, 6.0) == 5
    along = np.cross(offset, drift)
    if np.linalg.norm(along) > 0.5:  # off the anchor by more than 10 cm at any speed: the line does not point at it
        assert nonlinear_rank(path, 6.0, (0.0, 0.0, 0.0)) == 4


@laws
@given(radius=amplitudes, w=frequencies, phase=phases, height=st.floats(0.5, 3.0))
def test_a_horizontal_circle_is_rank_11_and_nonlinear_6_in_plane_9_off_it(
    radius: float, w: float, phase: float, height: float
):
    path = circle(radius, w, phase, Rotation.identity())
    assert lifted_rank(path, 6.0) == 11
    assert lifted_rank(path, 6.0, (0.0, 0.0, 0.0)) == 10
    assert nonlinear_rank(path, 6.0, (0.3 * radius, 0.2 * radius, 0.0)) == 6
    assert nonlinear_rank(path, 6.0, (0.3 * radius, 0.2 * radius, height)) == 9


@laws
@given(radius=amplitudes, w=frequencies, phase=phases, tilt=tilts, heading=phases, climb=st.floats(0.1, 1.0))
def test_tilting_or_climbing_leaves_a_circle_at_rank_11(
    radius: float, w: float, phase: float, tilt: float, heading: float, climb: float
):
    path = circle(radius, w, phase, tilted(tilt, heading))
    assert lifted_rank(path, 6.0) == 11
    assert lifted_rank(replace(path, drift=(0.0, 0.0, climb)), 6.0) == 11


@laws
@given(radius=amplitudes, w=frequencies, phase=phases, heading=phases)
def test_a_vertical_circle_is_rank_10(radius: float, w: float, phase: float, heading: float):
    assert lifted_rank(circle(radius, w, phase, tilted(math.pi / 2, heading)), 6.0) == 10


@laws
@given(radius=amplitudes, height=amplitudes, w=frequencies, phase=phases, shift=phases)
def test_a_z_sine_of_the_circles_own_frequency_only_tilts_it(
    radius: float, height: float, w: float, phase: float, shift: float
):
    path = circle(radius, w, phase, Rotation.identity())
    same = Tone(axis="z", amplitude=min(height, radius), frequency=w, phase=shift)
    assert lifted_rank(replace(path, tones=(*path.tones, same)), 6.0) == 11


@laws
@given(size=st.tuples(*[amplitudes] * 3), w=frequencies, shifts=st.tuples(*[phases] * 3), turn=offsets)
def test_three_frequencies_on_three_axes_are_rank_13_however_they_are_turned(
    size: tuple, w: float, shifts: tuple, turn: tuple
):
    axes = Rotation.from_rotvec(turn).as_matrix().T
    path = turned([(size[k] * axes[k], (k + 1) * w, shifts[k]) for k in range(3)])
    assert lifted_rank(path, 6.0) == 13
    assert nonlinear_rank(path, 6.0, (0.5, -0.4, 0.3)) == 9


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_preset_has_its_known_ranks(name: str):
    analysed = analysis.analyse(preset.load(name))
    assert (analysed.rank, analysed.nonlinear_rank) == KNOWN_RANKS[name]


@pytest.mark.parametrize("name", SINES)
def test_spectra_agree_with_fifty_digits_above_their_floor(name: str):
    p = preset.load(name)
    analysed = analysis.analyse(p)
    exact = precise_gramian.gramian_eigenvalues(p, analysed.gramian_at, p.requirement.window)
    above = [k for k in range(13) if analysed.gramian[k] > analysed.floor]
    assert len(above) == analysed.rank
    for k in above:
        assert abs(analysed.gramian[k] / float(exact[k]) - 1) < 1e-3, (k, analysed.gramian[k], exact[k])
    assert all(analysed.gramian >= 0)


@pytest.mark.parametrize(("window", "least"), [(0.25, 4.9e-26), (0.5, 1e-19), (1.0, 1e-12), (2.0, 1e-6)])
def test_short_windows_keep_their_digits_where_eigvalsh_would_return_noise(window: float, least: float):
    """λ_min of the paper's own path; forming W loses everything below 1e-17 λ_max."""
    p = preset.load("paper")
    spectra = spectrum.window_spectra(p.path, p.world.gravity, np.array([0.3]), window)
    exact = precise_gramian.gramian_eigenvalues(p, 0.3, window)
    np.testing.assert_allclose(spectra.eigenvalues[0], [float(value) for value in exact], rtol=1e-3)
    assert 0.1 < spectra.eigenvalues[0, 0] / least < 10


def test_the_sampled_sum_tends_to_the_integral():
    p = preset.load("paper-slow")
    start = np.linspace(0, 10, 5)
    exact = spectrum.window_spectra(p.path, p.world.gravity, start, 2.0).eigenvalues
    errors = [
        np.abs(spectrum.sampled_spectra(p.path, p.world.gravity, start, 2.0, rate=rate).eigenvalues / exact - 1).max()
        for rate in (100.0, 200.0, 400.0)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize(("gravity", "rank"), [(GRAVITY, 9), ((3.0, -5.0, 7.0), 10)])
def test_a_three_dimensional_cubic_snap_excites_everything_and_is_blind(gravity: tuple, rank: int):
    """p⁗ = (τ, τ², τ³): all 13 functions are polynomials of degree ≤ 9, so rank ≤ 10, yet ∫p⁗p⁗ᵀ is regular.

    All ten powers occur if gravity has a part on every axis; along z alone τ⁴ comes only with τ⁹.
    """
    tau, weight = np.polynomial.legendre.leggauss(40)
    tau, weight = (tau + 1) / 2, weight / 2
    D = np.stack([tau**5 / 120, tau**6 / 360, tau**7 / 840], axis=-1) - tau[:, None] ** 2 / 2 * np.asarray(gravity)
    powers = np.stack([np.ones_like(tau), tau, tau**2 / 2, tau**3 / 6], axis=-1)
    matrix = np.concatenate([powers, D, tau[:, None] * D, tau[:, None] ** 2 / 2 * D], axis=-1)[None]
    spectra = spectrum.spectra(matrix, weight, 1.0, time_powers=spectrum.LIFTED_TIME_POWERS, rounding=0.0)
    assert spectra.rank[0] == rank
    snap = np.stack([tau, tau**2, tau**3], axis=-1)
    assert np.linalg.eigvalsh(np.einsum("k,ki,kj->ij", weight, snap, snap))[0] > 1e-4


def test_nonlinear_rows_are_the_gradient_of_half_squared_range():
    """Against finite differences of ½|p + τv + ½τ²(g + …)|²: a change at t moves p(t+τ) by δp + τδv + ½τ²δg."""
    p = preset.load("lissajous")
    tau, start, anchor, step = np.array([0.0, 0.7, 2.0]), 0.4, np.asarray(p.world.anchor), 1e-6
    computed = rows.nonlinear(p.path, p.world.anchor, np.array([start]), tau)[0]
    for column in range(9):
        delta = np.zeros(9)
        delta[column] = step
        shift = delta[:3] + tau[:, None] * delta[3:6] + tau[:, None] ** 2 / 2 * delta[6:]
        q = p.path(start + tau) - anchor
        difference = (np.sum((q + shift) ** 2, axis=-1) - np.sum((q - shift) ** 2, axis=-1)) / (4 * step)
        np.testing.assert_allclose(computed[:, column], difference, atol=1e-8)


def test_reduced_rows_are_the_fourth_derivative_of_the_lifted_output():
    p = preset.load("lissajous")
    tau, h = np.array([0.5, 1.0]), 5e-3
    stencil = np.array([1.0, -4.0, 6.0, -4.0, 1.0]) / h**4
    lifted = rows.lifted(p.path, p.world.gravity, np.array([0.4]), np.concatenate([tau + k * h for k in range(-2, 3)]))
    fourth = np.einsum("s,skc->kc", stencil, lifted[0, :, 4:].reshape(5, 2, 9))
    exact = rows.reduced(p.path, p.world.gravity, np.array([0.4]), tau)[0]
    np.testing.assert_allclose(fourth, exact, rtol=1e-3, atol=1e-3 * np.abs(exact).max())  # stencil error h²/6 · |d⁶|


def test_predicted_accuracy_is_the_inverse_of_the_information():
    """Against a dense inverse in 50 digits of Σ hᵀh/(d²σ² + ½σ⁴) and of Σ hᵀh/(d²σ²)."""
    p = preset.load("paper-slow")
    rate, sigma, window, start = 10.0, 0.1, 6.0, 0.5
    tau = np.arange(61) / rate
    d2 = np.sum(p.path(start + tau) ** 2, axis=-1)
    cases: dict[accuracy.Problem, tuple[np.ndarray, np.ndarray, int]] = {
        "lifted": (rows.lifted(p.path, p.world.gravity, np.array([start]), tau)[0], d2 * sigma**2 + sigma**4 / 2, 4),
        "nonlinear": (rows.nonlinear(p.path, p.world.anchor, np.array([start]), tau)[0], d2 * sigma**2, 0),
    }
    for kind, (matrix, variance, first) in cases.items():
        J = precise_gramian.mp.matrix((matrix / np.sqrt(variance)[:, None]).tolist())
        covariance = (J.T * J) ** -1
        predicted = accuracy.predict(p.path, p.world, start, window, sigma=sigma, rate=rate, kind=kind, at="start")
        for k, name in enumerate(("position", "velocity", "gravity")):
            trace = sum(covariance[i, i] for i in range(first + 3 * k, first + 3 * k + 3))
            assert getattr(predicted, name) == pytest.approx(float(precise_gramian.mp.sqrt(trace)), rel=1e-6), (
                kind,
                name,
            )


def test_accuracy_at_the_end_is_the_start_carried_by_the_transition():
    """cov_end = Φ cov_start Φᵀ; gravity does not move, and for the nonlinear rows Φ is the double integrator's."""
    p = preset.load("lissajous")
    arguments = {"sigma": 0.1, "rate": 50.0, "kind": "nonlinear"}
    start = accuracy.predict(p.path, p.world, 1.0, 6.0, at="start", **arguments)
    end = accuracy.predict(p.path, p.world, 1.0, 6.0, at="end", **arguments)
    assert start.gravity == pytest.approx(end.gravity, rel=1e-9)
    assert start.position != pytest.approx(end.position, rel=0.01)
    matrix = rows.nonlinear(p.path, p.world.anchor, np.array([1.0]), np.arange(301) / 50.0)[0]
    distance = np.linalg.norm(p.path(1.0 + np.arange(301) / 50.0) - np.asarray(p.world.anchor), axis=-1)
    covariance = np.linalg.inv((matrix / (0.1 * distance)[:, None]).T @ (matrix / (0.1 * distance)[:, None]))
    phi = np.kron(np.array([[1, 6.0, 18.0], [0, 1, 6.0], [0, 0, 1]]), np.eye(3))
    assert end.position == pytest.approx(np.sqrt(np.trace((phi @ covariance @ phi.T)[:3, :3])), rel=1e-6)


def test_figures_the_design_quotes():
    """Paper's path over 1 s: tens of metres, more at the start than at the end; slowed, 2 s is rank 13 and 80 km."""
    paper, slow = preset.load("paper"), preset.load("paper-slow")
    arguments = {"sigma": 0.1, "rate": 200.0, "kind": "lifted"}
    start = accuracy.predict(paper.path, paper.world, 0.0, 1.0, at="start", **arguments).position
    end = accuracy.predict(paper.path, paper.world, 0.0, 1.0, at="end", **arguments).position
    assert start == pytest.approx(56, rel=0.1)
    assert end == pytest.approx(39, rel=0.1)
    assert lifted_rank(slow.path, 2.0) == 13
    assert accuracy.predict(slow.path, slow.world, 0.0, 2.0, at="start", **arguments).position == pytest.approx(
        8e4, rel=0.1
    )


def test_accuracy_scales_with_the_noise_and_vanishes_without_it():
    p = preset.load("paper")

    def position(sigma: float, kind: accuracy.Problem) -> float:
        return accuracy.predict(p.path, p.world, 0.0, 6.0, sigma=sigma, rate=50.0, kind=kind, at="end").position

    assert position(0.2, "nonlinear") == pytest.approx(2 * position(0.1, "nonlinear"), rel=1e-9)
    assert position(0.0, "lifted") == 0.0
    assert math.isfinite(
        accuracy.predict(
            p.path, World(anchor=tuple(p.path(np.array(0.0)))), 0.0, 6.0, sigma=0.1, rate=50.0, kind="lifted", at="end"
        ).position
    )


@pytest.mark.parametrize(("name", "tolerance"), [("lissajous", 0.01), ("paper-slow", 0.07)])
def test_window_accuracy_by_integral_matches_the_sum_over_ranges(name: str, tolerance: float):
    """The slowed paper path passes the anchor at 16 cm, where 1/d² has a peak narrower than the nodes."""
    p = preset.load(name)
    start = np.linspace(0, 12, 7)
    integral = accuracy.end_sigmas(p.path, p.world, start, 6.0, sigma=0.1, rate=50.0, kind="lifted")
    for k, t in enumerate(start):
        exact = accuracy.predict(p.path, p.world, float(t), 6.0, sigma=0.1, rate=50.0, kind="lifted", at="end")
        assert integral[k, 0] == pytest.approx(exact.position, rel=tolerance)


def test_what_is_blind_is_called_by_its_name():
    words = {name: [d.summary for d in analysis.analyse(preset.load(name)).directions] for name in SHIPPED}
    assert words["circle"] == [
        "nothing excites z: the path has no snap along it; position and velocity along z cannot be told"
    ]
    assert [sentence.split()[2].rstrip(":") for sentence in words["hover"]] == ["x", "y", "z"]
    assert "(0.00, 0.87, 0.50)" in words["paper-implied"][0]
    assert "(-0.50, 0.00, 0.87)" in words["tilted-circle"][0]
    assert words["vertical-circle"] == [
        "nothing excites y: the path has no snap along it; position, velocity and gravity along y cannot be told"
    ]
    assert all(words[name] == [] for name in ("paper", "paper-slow", "lissajous", "soft", "wiggle"))


@laws
@given(tilt=tilts, heading=phases, radius=amplitudes, w=frequencies)
def test_the_blind_direction_of_a_circle_is_its_normal(tilt: float, heading: float, radius: float, w: float):
    orientation = tilted(tilt, heading)
    path = circle(radius, w, 0.0, orientation)
    spectra = spectrum.window_spectra(path, GRAVITY, np.array([0.0]), 6.0)
    values, axes = excitation.directions(path, 0.0, 6.0)
    (direction,) = [d for d in blindness.directions(spectrum.null_basis(spectra, 0), values, axes) if "snap" in d.kinds]
    assert abs(direction.vector @ orientation.as_matrix()[:, 2]) == pytest.approx(1, abs=1e-9)


def test_the_null_space_is_what_the_rows_do_not_see():
    p = preset.load("hover")
    spectra = spectrum.window_spectra(p.path, p.world.gravity, np.array([0.0]), 6.0)
    tau, _ = quadrature.nodes(p.path, np.array([0.0]), 6.0)
    scaled = rows.lifted(p.path, p.world.gravity, np.array([0.0]), tau)[0] * 6.0 ** -spectrum.LIFTED_TIME_POWERS.astype(
        float
    )
    assert spectrum.null_basis(spectra, 0).shape == (13, 8)
    assert np.abs(scaled @ spectrum.null_basis(spectra, 0)).max() < 1e-11


def test_the_gramian_does_not_know_offset_or_anchor():
    p = preset.load("lissajous")
    start = np.linspace(0, 10, 5)
    near = spectrum.window_spectra(p.path, p.world.gravity, start, 6.0)
    far = spectrum.window_spectra(
        replace(p.path, offset=(1e4, -1e4, 1e4), drift=(100.0, 0.0, 0.0)), p.world.gravity, start, 6.0
    )
    np.testing.assert_array_equal(near.eigenvalues, far.eigenvalues)


@pytest.mark.parametrize("name", ["paper", "paper-slow", "lissajous", "soft", "wiggle"])
def test_accuracy_and_verdict_are_those_of_the_window_worst_for_accuracy(name: str):
    """Not of the window with the least singular value, which is another one."""
    p = preset.load(name)
    analysed = analysis.analyse(p)
    worst = np.max(analysed.windows.sigma_lifted)
    assert analysed.lifted_end.position < 1.15 * worst  # the curve is one of ranges at all times
    between = replace(p.requirement, position_sigma=0.9 * worst)
    assert analysis.analyse(replace(p, requirement=between)).verdict.word == "weak"


@pytest.mark.parametrize("name", SHIPPED)
def test_an_excitation_below_its_floor_is_an_unobservable_motion(name: str):
    """But for one: between its knots a minimum-snap curve is a polynomial, excited everywhere and of rank 10."""
    p = preset.load(name)
    analysed = analysis.analyse(p)
    unexcited = analysed.mu < analysed.mu_floor or analysed.mu == 0
    assert unexcited == (p.expect == "unobservable" and name != "minimum-snap")


def test_three_verdicts():
    paper = preset.load("paper")
    assert analysis.analyse(paper).verdict.word == "observable"
    assert analysis.analyse(preset.load("hover")).verdict.word == "blind"
    assert analysis.analyse(preset.with_window(preset.load("paper-slow"), 2.0, source="here")).verdict.word == "weak"
    assert analysis.analyse(preset.load("wiggle")).verdict.word == "weak"


def test_too_long_a_window_for_fast_tones_is_refused():
    path = Multisine(tones=(Tone(axis="x", amplitude=1, frequency=600),))
    with pytest.raises(ValueError, match=r"requirement.window must be at most 1.92 s for tones of 600 rad/s"):
        spectrum.window_spectra(path, GRAVITY, np.array([0.0]), 100.0)
