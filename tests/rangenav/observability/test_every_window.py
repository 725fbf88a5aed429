"""The rank over every window: proved by cores, and lower where a stretch between samples is degenerate."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from rangenav import analysis, preset
from rangenav.inputs import Vec3
from rangenav.observability import quadrature_bound, spectrum
from rangenav.observability.every_window import rank_over_every_window
from rangenav.preset import Requirement
from rangenav.signals import Formula, Multisine, Polynomials, Signal, Sum, Tone, Waypoint, Waypoints
from rangenav.signals.polynomials import Piece

pytestmark = pytest.mark.slow

GRAVITY: Vec3 = (0.0, 0.0, 9.81)
SOFT = preset.load("soft")
LISSAJOUS = Multisine(
    tones=(
        Tone(axis="x", amplitude=1.0, frequency=2.0),
        Tone(axis="y", amplitude=1.0, frequency=4.0, phase=0.5),
        Tone(axis="z", amplitude=0.5, frequency=6.0, phase=1.0),
    )
)


def ranks(path: Signal, starts: np.ndarray, window: float) -> np.ndarray:
    return spectrum.window_spectra(path, GRAVITY, starts, window).rank


def hops(times: list[float], seed: int, flat: range = range(0)) -> Polynomials:
    """From rest to rest between random places, p + (q − p)(10u³ − 15u⁴ + 6u⁵); a pause in a time above 1 s.

    The hops with numbers in `flat` keep their height.
    """
    rng = np.random.default_rng(seed)
    place, pieces = rng.uniform(-1, 1, 3), []
    for k, length in enumerate(times):
        following = place if length > 1.0 else rng.uniform(-1, 1, 3)
        step = np.where([True, True, k not in flat], following - place, 0.0)
        axes = [
            (a, 0.0, 0.0, 10 * s / length**3, -15 * s / length**4, 6 * s / length**5, 0.0, 0.0)
            for a, s in zip(place.tolist(), step.tolist(), strict=True)
        ]
        pieces.append(Piece(duration=length, x=axes[0], y=axes[1], z=axes[2]))
        place = place + step
    return Polynomials(pieces=tuple(pieces))


WAYPOINTS = Waypoints(
    points=tuple(
        Waypoint(time=0.8 * k, value=tuple(np.random.default_rng(k).uniform(-1, 1, 3).tolist()))  # pyright: ignore
        for k in range(14)
    ),
    period=11.2,
)
PATHS: dict[str, Signal] = {
    "tones": LISSAJOUS,
    "formula": Formula(x="sin(2*t)", y="cos(4*t+0.5*sin(t))", z="0.5*sin(6*t)"),
    "waypoints": WAYPOINTS,
    "polynomials": hops([0.7] * 30, 1),
    "sum": Sum(base=WAYPOINTS, wiggle=LISSAJOUS),
}


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS)
def test_of_every_family_rank_13_is_proved_and_no_window_lies_below_the_bounds(path: Signal):
    proof = rank_over_every_window(path, GRAVITY, 16.0, 5.0)
    assert (proof.rank, proof.proved, proof.unproved) == (13, True, ())
    assert proof.margin > 1
    starts = np.random.default_rng(0).uniform(0, 11.0, 200)
    dense = spectrum.window_spectra(path, GRAVITY, starts, 5.0)
    assert proof.smallest_found is not None
    assert proof.smallest_found <= dense.scaled[:, -1].min() * (1 + 0.01)
    here = spectrum.window_spectra(path, GRAVITY, np.array([proof.at]), 5.0)
    assert here.scaled[0, -1] == pytest.approx(proof.smallest_found, rel=1e-6)
    if isinstance(path, Formula):  # nothing bounds what its quadrature leaves out
        assert (proof.smallest_singular, proof.eigenvalue, proof.quadrature) == (None, None, None)
        return
    assert proof.smallest_singular is not None
    assert proof.eigenvalue is not None
    assert proof.quadrature is not None
    assert proof.quadrature < 1e-9
    assert proof.smallest_singular <= dense.scaled[:, -1].min() * (1 + 1e-9)
    assert proof.eigenvalue <= dense.eigenvalues[:, 0].min() * (1 + 1e-9)
    assert 0.5 * proof.smallest_found < proof.smallest_singular <= proof.smallest_found


@pytest.mark.parametrize("name", ["hover", "circle", "paper-implied", "vertical-circle", "minimum-snap"])
def test_a_lower_rank_is_proved_as_well(name: str):
    p = preset.load(name)
    window = p.requirement.window
    proof = rank_over_every_window(p.path, p.world.gravity, p.duration, window)
    starts = np.linspace(0, p.duration - window, 57)
    assert proof.rank == spectrum.window_spectra(p.path, p.world.gravity, starts, window).rank.min()
    assert proof.proved
    assert (proof.smallest_singular, proof.smallest_found) == (None, None)


def test_of_a_formula_whose_rounding_has_no_known_bound_the_rank_is_sampled():
    """√(t² − 10t + 25.01) is smooth, but intervals cannot tell that its argument stays positive."""
    text = "sin(6*t) + 0.1*sqrt(t*t - 10*t + 25.01)"
    proof = rank_over_every_window(Formula(x="sin(2*t)", y="cos(4*t)", z=text), GRAVITY, 16.0, 5.0)
    assert (proof.rank, proof.proved, proof.unproved) == (13, False, ((0.0, 11.0),))
    assert proof.smallest_singular is None


def test_the_error_of_the_quadrature_is_bounded_and_a_margin_that_it_could_eat_shows_nothing():
    bound = quadrature_bound.relative(LISSAJOUS, 5.0, 16.0, size=30.0, margin=1e8)
    assert 0 < bound < 1e-9
    assert quadrature_bound.relative(LISSAJOUS, 5.0, 16.0, size=30.0, margin=1e-6) == 1.0
    assert quadrature_bound.relative(WAYPOINTS, 5.0, 16.0, size=30.0, margin=1e8) == 0.0
    assert not quadrature_bound.known(PATHS["formula"])


HOP = 0.05


@pytest.mark.parametrize("before", [401, 484])
def test_a_pause_of_one_window_between_two_samples_is_found(before: int):
    """101 and 201 samples of the flight see rank 13 everywhere; the window in which the path rests has rank 5."""
    path = hops([HOP] * before + [4.0] + [HOP] * (1120 - before), 7)
    for count in (101, 201):
        assert ranks(path, np.linspace(0, 56.0, count), 4.0).min() == 13
    proof = rank_over_every_window(path, GRAVITY, 60.0, 4.0)
    assert (proof.rank, proof.proved) == (5, True)
    assert proof.at == pytest.approx(before * HOP, abs=1e-3)


def test_a_stretch_in_a_plane_between_two_samples_is_found():
    """The hops 401 to 481 keep their height for 4.05 s, so a window of 4 s can lie in a plane."""
    path = hops([HOP] * 1200, 7, flat=range(401, 482))
    for count in (101, 201):
        assert ranks(path, np.linspace(0, 56.0, count), 4.0).min() == 13
    proof = rank_over_every_window(path, GRAVITY, 60.0, 4.0)
    assert (proof.rank, proof.proved) == (11, True)
    assert 400 * HOP < proof.at < 403 * HOP
    assert ranks(path, np.array([proof.at]), 4.0)[0] == 11


def test_slow_motions_of_hours_are_proved_and_a_period_makes_it_every_time():
    tones = (("x", 60.0, 0.02), ("y", 40.0, 0.04), ("z", 8.0, 0.05))
    yoyo = Multisine(tones=tuple(Tone(axis=axis, amplitude=a, frequency=w) for axis, a, w in tones))  # pyright: ignore
    hour = rank_over_every_window(yoyo, GRAVITY, 3600.0, 300.0)
    assert (hour.rank, hour.proved) == (13, True)
    period = rank_over_every_window(yoyo, GRAVITY, 2 * math.pi / 0.01 + 300.0, 300.0)
    assert (period.rank, period.proved) == (13, True)
    assert period.smallest_singular is not None
    assert hour.smallest_singular is not None
    assert period.smallest_found is not None
    assert 0.5 * period.smallest_found < min(hour.smallest_singular, period.smallest_singular) < period.smallest_found


def test_one_window_is_its_own_flight_and_what_fits_in_none_is_refused():
    assert rank_over_every_window(LISSAJOUS, GRAVITY, 6.0, 6.0).proved
    with pytest.raises(ValueError, match="window must be no longer than the flight, 5 s, got 6 s"):
        rank_over_every_window(LISSAJOUS, GRAVITY, 5.0, 6.0)


def test_of_more_windows_than_can_be_decomposed_the_rank_is_sampled():
    proof = rank_over_every_window(LISSAJOUS, GRAVITY, 1e6, 6.0)
    assert (proof.rank, proof.proved, proof.unproved) == (13, False, ((0.0, 1e6 - 6.0),))
    assert proof.smallest_singular is None


def test_analysis_names_the_pause_between_its_samples():
    """The worst of the sampled windows has rank 13; the analysis is blind where the path rests for one window."""
    pausing = replace(
        SOFT,
        sensors=replace(SOFT.sensors, range_rate=5.0),
        path=hops([HOP] * 401 + [4.0] + [HOP] * 719, 7),
        duration=60.0,
        angular_velocity=Multisine(),
        requirement=Requirement(window=4.0, mu=1e-9),
    )
    found = analysis.analyse(pausing)
    assert (found.verdict.word, found.rank) == ("blind", 5)
    assert found.gramian_at == pytest.approx(401 * HOP, abs=1e-3)
