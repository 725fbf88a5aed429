"""Excitation: the integral of the snap, the bound for all t, the derived and the printed φ, the reduced pair."""

import math

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from rangenav import motion, preset
from rangenav.observability import excitation, reduced
from rangenav.signals import Multisine, Tone, slowed
from tests.support.motion_examples import tumbling

GRAVITY = (0.0, 0.0, 9.81)
REPEATING = [file.stem for file in preset.shipped_files() if preset.load(file.stem).path.period is not None]
laws = settings(max_examples=40)


def test_excitation_is_the_integral_of_the_snap():
    p = preset.load("paper-slow")

    def entry(i: int, j: int) -> float:
        def product(t: float) -> float:
            snap = p.path(np.array(t), 4)
            return snap[i] * snap[j]

        return scipy.integrate.quad(product, 1.0, 7.0, epsabs=1e-9, epsrel=1e-12, limit=200)[0]

    exact = np.linalg.eigvalsh([[entry(i, j) for j in range(3)] for i in range(3)])
    np.testing.assert_allclose(excitation.eigenvalues(p.path, np.array([1.0]), 6.0)[0], exact, rtol=1e-10)


@laws
@given(factor=st.floats(0.3, 4.0), start=st.floats(0.0, 3.0))
def test_slowing_time_scales_the_excitation_of_a_period_by_the_seventh_power(factor: float, start: float):
    path = preset.load("paper-slow").path
    period = 2 * math.pi / 2.0
    fast = excitation.eigenvalues(path, np.array([start]), period)
    slow = excitation.eigenvalues(slowed(path, factor), np.array([start * factor]), period * factor)
    np.testing.assert_allclose(slow, fast * factor**-7, rtol=1e-9)


@pytest.mark.parametrize("name", REPEATING)
def test_the_bound_for_all_t_lies_below_every_window_and_close_to_the_worst(name: str):
    p = preset.load(name)
    bound = excitation.bound_for_all_t(p.path, p.requirement.window)
    rng = np.random.default_rng(7)
    least = excitation.eigenvalues(p.path, rng.uniform(0, 40, 3000), p.requirement.window)[:, 0].min()
    assert bound is not None
    assert bound <= least + 1e-9
    if least > 1.0:
        assert bound > 0.9 * least


def test_without_a_common_period_nothing_is_said_for_all_t():
    path = Multisine(
        tones=(Tone(axis="x", amplitude=1, frequency=1), Tone(axis="y", amplitude=1, frequency=math.sqrt(2)))
    )
    assert excitation.bound_for_all_t(path, 2.0) is None


def test_phi_is_the_second_derivative_of_the_apparent_acceleration_in_body_axes():
    """Derived φ = ä + 2ω×ȧ + ω̇×a + ω×(ω×a), with ȧ and ä by finite differences of a itself."""
    p = preset.load("lissajous")
    rate = 2000.0
    truth = motion.simulate(
        p.path, p.angular_velocity, world=p.world, initial_rotation=p.initial_rotation, duration=4.0, rate=rate
    )
    a, w, alpha = truth.apparent_acceleration, truth.angular_velocity, truth.angular_acceleration
    first = (a[2:] - a[:-2]) * (rate / 2)
    second = (a[2:] - 2 * a[1:-1] + a[:-2]) * rate**2
    a, w, alpha = a[1:-1], w[1:-1], alpha[1:-1]
    by_differences = second + 2 * np.cross(w, first) + np.cross(alpha, a) + np.cross(w, np.cross(w, a))
    printed = second - np.cross(w, first) - 2 * np.cross(w, np.cross(w, a))
    scale = np.abs(by_differences).max()
    np.testing.assert_allclose(
        excitation.phi(truth)[1:-1], by_differences, atol=1e-4 * scale
    )  # h² = 2.5e-7 and rounding
    np.testing.assert_allclose(excitation.phi_printed(truth)[1:-1], printed, atol=1e-4 * scale)


@pytest.mark.parametrize("name", ["hover", "circle"])
def test_the_printed_phi_in_body_axes_certifies_what_cannot_be_observed(name: str):
    p = preset.load(name)
    truth = motion.simulate(
        p.path, tumbling(), world=p.world, initial_rotation=(0.0, 0.0, 0.0), duration=10.0, rate=200.0
    )
    start = np.linspace(0, 4, 9)

    def least(printed_formula: bool, body_axes: bool) -> float:
        signal = excitation.chosen_signal(truth, printed_formula=printed_formula, body_axes=body_axes)
        return excitation.sampled_eigenvalues(signal, truth.time, start, 6.0)[:, 0].min()

    assert least(True, True) > 10
    assert least(False, False) < 1e-6
    assert excitation.eigenvalues(p.path, start, 6.0)[:, 0].max() < 1e-6
    if name == "circle":  # either misprint alone does it, too
        assert least(False, True) > 10


def test_sampled_and_exact_excitation_agree():
    p = preset.load("paper-slow")
    truth = motion.simulate(
        p.path, p.angular_velocity, world=p.world, initial_rotation=p.initial_rotation, duration=10.0, rate=200.0
    )
    signal = excitation.chosen_signal(truth, printed_formula=False, body_axes=False)
    start = np.linspace(0, 4, 5)
    np.testing.assert_allclose(
        excitation.sampled_eigenvalues(signal, truth.time, start, 6.0),
        excitation.eigenvalues(p.path, start, 6.0),
        rtol=1e-3,  # trapezoid at 200 Hz
    )


def test_reduced_pair_from_samples_and_in_closed_form_agree_and_the_misprint_does_not():
    p = preset.load("paper-slow")
    truth = motion.simulate(
        p.path, tumbling(), world=p.world, initial_rotation=(0.0, 0.0, 0.0), duration=10.0, rate=400.0
    )
    exact, floor = reduced.least_eigenvalue(p.path, p.world.gravity, 1.0, 6.0)
    assert exact > 1e6 * floor
    switches = {"printed_formula": False, "printed_row": False, "body_axes": False}
    assert reduced.sampled_least_eigenvalue(truth, 1.0, 6.0, **switches) == pytest.approx(exact, rel=1e-3)
    for one in switches:
        assert reduced.sampled_least_eigenvalue(truth, 1.0, 6.0, **{**switches, one: True}) != pytest.approx(
            exact, rel=0.05
        )
