"""The least μ of every window: bounded even for nearly planar paths, which W in double precision takes for planar."""

import math

import numpy as np
import pytest

from rangenav.observability import excitation
from rangenav.observability.excitation_bound import excitation_bounds
from rangenav.observability.excitation_core import core_bounds
from rangenav.observability.worst_excitation import EVERY, FLIGHT, worst_excitation
from rangenav.signals import Formula, MinimumSnap, Multisine, Tone, Waypoint
from tests.support import random_motions
from tests.support.motion_examples import turned

WINDOW, DURATION = 4.0, 12.0


def nearly_planar(share: float, *, seed: int) -> Multisine:
    """Tones of a metre in a plane, and across it tones of a share of that."""
    rng = np.random.default_rng(seed)
    axes = np.linalg.qr(rng.standard_normal((3, 3)))[0].T
    size = (1.0, 1.0, 0.8, 0.8, share, share)
    axis = (0, 0, 1, 1, 2, 2)
    return turned(
        [(s * axes[k], float(rng.uniform(2, 8)), float(rng.uniform(0, 6))) for s, k in zip(size, axis, strict=True)]
    )


@pytest.mark.parametrize("seed", range(6))
def test_cores_bound_the_excitation_of_every_window_of_a_nearly_planar_path(seed: int):
    path = nearly_planar(1e-6, seed=seed)
    found = core_bounds(path, WINDOW, DURATION - WINDOW)
    assert found is not None
    dense = excitation.eigenvalues(path, np.linspace(0, DURATION - WINDOW, 1501), WINDOW)[:, 0]
    assert 0.95 * dense.min() < found.lower <= dense.min() * (1 + 1e-6)
    assert dense.min() <= found.upper
    assert found.least == pytest.approx(excitation.eigenvalues(path, np.array([found.at]), WINDOW)[0, 0], rel=1e-5)
    assert dense.max() <= found.upper_everywhere


def test_what_derivatives_of_w_prove_nothing_of_is_proven_by_cores():
    path = nearly_planar(1e-6, seed=1)
    second = excitation_bounds(path, WINDOW, DURATION - WINDOW)
    required = 0.5 * float(excitation.eigenvalues(path, np.linspace(0, 8, 401), WINDOW)[:, 0].min())
    assert second.lower < required
    found = worst_excitation(path, WINDOW, DURATION, required)
    assert (found.meets(required), found.starts) == (True, FLIGHT)


@pytest.mark.parametrize("share", [0.0, 1e-12])
def test_a_path_within_a_plane_is_not_said_to_leave_it(share: float):
    path = nearly_planar(share, seed=2)
    assert core_bounds(path, WINDOW, DURATION - WINDOW) is None
    assert worst_excitation(path, WINDOW, DURATION, 1e-3).meets(1e-3) is False


def test_cores_bound_polynomials_between_knots_too():
    rng = np.random.default_rng(3)
    points = tuple(
        Waypoint(time=float(t), value=(float(x), float(y), 1e-5 * float(z)))
        for t, (x, y, z) in zip(np.arange(0.0, 13.0), rng.uniform(-1, 1, (13, 3)), strict=True)
    )
    path = MinimumSnap(points=points)
    found = core_bounds(path, WINDOW, 8.0)
    assert found is not None
    dense = excitation.eigenvalues(path, np.linspace(0, 8.0, 1501), WINDOW)[:, 0]
    assert 0.9 * dense.min() < found.lower <= dense.min() * (1 + 1e-6)


def test_a_pause_that_no_bound_covers_is_found_by_a_dense_sample():
    """The size of the motion falls to nothing around t = 137.3 s, for less than one of 200 steps."""
    dip = "(1 - exp(-sqrt(((t - 137.3)/1.2)*((t - 137.3)/1.2) + 1e-3)**16))"
    path = Formula(x=f"{dip}*sin(5*t)", y=f"{dip}*sin(8*t)", z=f"{dip}*sin(7*t)")
    found = worst_excitation(path, 2.0, 400.0, 1.0)
    assert found.bounds is None
    assert abs(found.at + 1.0 - 137.3) < 0.3
    near = excitation.eigenvalues(path, np.linspace(134.0, 138.0, 801), 2.0)[:, 0]
    assert 0.98 * near.min() < found.mu <= near.min()
    assert found.meets(2 * found.mu) is False
    assert found.meets(0.5 * found.mu) is None  # a sample proves nothing


def test_every_t_is_claimed_of_a_period_and_the_flight_of_what_does_not_repeat():
    loop = Multisine(tones=(Tone(axis="x", amplitude=1.0, frequency=1.0), Tone(axis="y", amplitude=1.0, frequency=2.0)))
    other = Multisine(tones=(*loop.tones, Tone(axis="z", amplitude=1.0, frequency=math.e)))
    assert worst_excitation(loop, 4.0, 20.0, 1.0).starts == EVERY
    assert worst_excitation(other, 4.0, 20.0, 1e-3).starts == FLIGHT


def test_bounds_that_are_all_error_are_no_reason_to_call_the_excitation_nothing():
    """A formula that pauses, whose snap has a bound of 1e5 times its size: windows that are evaluated have its μ."""
    pausing = random_motions.random_preset("formula", 22)
    window, end = pausing.requirement.window, pausing.duration - pausing.requirement.window
    bounds = excitation_bounds(pausing.path, window, end)
    assert bounds.least <= bounds.floor
    assert bounds.floor > pausing.requirement.mu
    found = worst_excitation(pausing.path, window, pausing.duration, pausing.requirement.mu)
    every = excitation.eigenvalues(pausing.path, np.linspace(0.0, end, 501), window)[:, 0]
    assert found.bounds is None
    assert "have an error of" in str(found.reason)
    assert found.floor < found.mu == pytest.approx(every.min(), rel=0.02)
