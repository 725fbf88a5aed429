"""The largest σ over every window, against least squares in 60 digits, random windows, and equal rounds."""

import math
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rangenav.motion import World
from rangenav.observability import every_range_window
from rangenav.observability.every_range_window import RangeWindows
from rangenav.signals import Multisine, Tone, Waypoint, Waypoints
from rangenav.signals.multisine import LETTERS

pytestmark = pytest.mark.slow

WORLD = World(gravity=(0.0, 0.0, 9.81), anchor=(0.3, -0.2, 2.0))
LISSAJOUS = Multisine(
    tones=(
        Tone(axis="x", amplitude=1.0, frequency=1.5, phase=1.57),
        Tone(axis="y", amplitude=0.8, frequency=3.0),
        Tone(axis="z", amplitude=0.5, frequency=4.5, phase=0.78),
    )
)
SLOW = Multisine(
    tones=(
        Tone(axis="x", amplitude=4.0, frequency=0.071),
        Tone(axis="y", amplitude=3.0, frequency=0.113, phase=1.0),
        Tone(axis="z", amplitude=2.0, frequency=0.167, phase=2.0),
    )
)


def precise(path: Multisine, at: float, window: float, stamps: list[Any], sigma: float) -> float:
    """σ of the position at the window's end, from 𝒞Φ of ranges at these stamps, by normal equations in 60 digits."""
    with mp.workdps(60):
        end = mp.mpf(at) + mp.mpf(window)

        def value(t: Any, order: int) -> list[Any]:
            total = [mp.mpf(0)] * 3
            for tone in path.tones:
                w = mp.mpf(tone.frequency)
                total["xyz".index(tone.axis)] += (
                    mp.mpf(tone.amplitude) * w**order * mp.sin(w * t + mp.mpf(tone.phase) + order * mp.pi / 2)
                )
            return total

        p0, v0 = value(end, 0), value(end, 1)
        information: Any = mp.zeros(13)
        for t in stamps:
            tau, p = t - end, value(t, 0)
            D = [p[i] - p0[i] - tau * v0[i] - tau**2 / 2 * mp.mpf(WORLD.gravity[i]) for i in range(3)]
            row: Any = mp.matrix(
                [1, tau, tau**2 / 2, tau**3 / 6, *D, *(tau * d for d in D), *(tau**2 / 2 * d for d in D)]
            )
            d2 = sum((p[i] - mp.mpf(WORLD.anchor[i])) ** 2 for i in range(3))
            information += row * row.T / (d2 * mp.mpf(sigma) ** 2 + mp.mpf(sigma) ** 4 / 2)
        covariance: Any = information**-1
        return float(mp.sqrt(covariance[4, 4] + covariance[5, 5] + covariance[6, 6]))


@pytest.mark.parametrize(
    ("path", "duration", "window", "rate", "rounding"),
    [
        (LISSAJOUS, 20.0, 8.0, 5.0, 1e-6),
        (LISSAJOUS, 6.0, 1.2, 20.0, 0.03),  # σ = 54 000 km
        (SLOW, 900.0, 300.0, 0.1, 1e-5),
        (SLOW, 300.0, 61.3, 0.5, 1e-5),
    ],
)
def test_the_worst_window_has_the_sigma_of_least_squares_in_sixty_digits(path, duration, window, rate, rounding):
    found = every_range_window.worst(path, WORLD, duration, window, sigma=0.1, rate=rate)
    stamps = [mp.mpf(k) / mp.mpf(rate) for k in range(found.first, found.last + 1)]
    exact = precise(path, found.at, window, stamps, 0.1)
    assert found.sigma <= found.bound
    assert exact <= found.bound <= exact * (1 + rounding)


def plain(path: Multisine, t: float, window: float, rate: float) -> float:
    """σ at the end of the window that starts at t, from the ranges in it, by singular values of scaled rows."""
    k = np.arange(math.ceil(t * rate), math.floor((t + window) * rate) + 1)
    tau = k / rate - t - window
    p, p0, v0 = path(k / rate), path(np.array([t + window]))[0], path(np.array([t + window]), 1)[0]
    D = p - p0 - tau[:, None] * v0 - tau[:, None] ** 2 / 2 * np.asarray(WORLD.gravity)
    s = tau[:, None]
    H = np.hstack([np.ones_like(s), s, s**2 / 2, s**3 / 6, D, s * D, s**2 / 2 * D])
    H /= np.sqrt(np.sum((p - np.asarray(WORLD.anchor)) ** 2, axis=1) * 0.01 + 0.1**4 / 2)[:, None]
    scale = np.linalg.norm(H, axis=0)
    _, singular, right = np.linalg.svd(H / scale, full_matrices=False)
    return float(np.linalg.norm((right.T / singular)[4:7] / scale[4:7, None]))


tones = st.builds(
    Tone,
    axis=st.sampled_from("xyz"),
    amplitude=st.floats(0.2, 3.0),
    frequency=st.floats(1.0, 8.0),
    phase=st.floats(-3.0, 3.0),
)


@settings(max_examples=25)
@given(
    st.lists(tones, min_size=2, max_size=4),
    st.floats(3.0, 6.0),
    st.floats(0.5, 9.0),
    st.floats(7.0, 30.0),
    st.lists(st.floats(0.0, 1.0), min_size=8, max_size=8),
)
def test_no_window_has_a_larger_sigma(more: list, window: float, longer: float, rate: float, shares: list[float]):
    path = Multisine(tones=(*LISSAJOUS.tones, *more))
    found = every_range_window.worst(path, WORLD, window + longer, window, sigma=0.1, rate=rate)
    for share in shares:
        assert plain(path, share * longer, window, rate) <= found.bound * (1 + 1e-5)
    inward = 1e-9 if found.at < longer / 2 else -1e-9
    beside = [plain(path, min(max(0.0, found.at + d), longer), window, rate) for d in (-1e-7, inward, 1e-7)]
    assert max(beside) == pytest.approx(found.sigma, rel=1e-4)


def test_a_long_flight_of_equal_rounds_is_no_worse_than_three_of_them():
    """A round of 4 s at 50 Hz holds 200 ranges, so the 60 rounds differ in nothing; only the long flight has blocks."""
    loop = Multisine(
        tones=tuple(
            Tone(axis=LETTERS[k], amplitude=1.0, frequency=math.pi / 2 * (k + 1), phase=0.3 * k) for k in range(3)
        )
    )

    def of(duration: float) -> RangeWindows:
        return every_range_window.worst(loop, WORLD, duration, 6.1, sigma=0.1, rate=50.0)

    few, many = of(16.0), of(240.0)
    assert many.sigma == pytest.approx(few.sigma, rel=2e-6)
    assert many.bound <= many.sigma * (1 + 1e-6)
    assert many.sets < 5 * 60 * 400


def test_a_pause_between_two_samples_is_found():
    """In a flight of 120 s the vehicle stops for 5.5 s, less than a window: the worst window begins as it stops."""
    place = {float(t): (math.sin(1.9 * t), math.cos(2.9 * t), math.sin(4.1 * t + 1)) for t in np.arange(0, 120.1, 0.25)}
    flown, paused = (
        every_range_window.worst(
            Waypoints(
                points=tuple(
                    Waypoint(time=t, value=place[101.0] if stopped and 101 <= t <= 106.5 else p)
                    for t, p in place.items()
                )
            ),
            WORLD,
            120.0,
            6.0,
            sigma=0.1,
            rate=20.0,
        )
        for stopped in (False, True)
    )
    assert 100.5 <= paused.at <= 101.1
    assert paused.sigma > 5 * flown.sigma


def test_too_few_ranges_or_ranges_at_one_phase_determine_no_position():
    few = every_range_window.worst(LISSAJOUS, WORLD, 20.0, 8.0, sigma=0.1, rate=1.5)
    assert (few.sigma, few.ranges) == (math.inf, 12)
    aliased = every_range_window.worst(LISSAJOUS, WORLD, 300.0, 100.0, sigma=0.1, rate=1.5 / (2 * math.pi))
    assert aliased.ranges >= 13
    assert aliased.sigma == math.inf


def test_a_planar_path_determines_no_position_however_many_its_ranges():
    planar = Multisine(tones=LISSAJOUS.tones[:2])
    assert every_range_window.worst(planar, WORLD, 20.0, 8.0, sigma=0.1, rate=50.0).sigma == math.inf


def test_ranges_that_are_lost_at_random_widen_sigma_by_the_square_root_of_their_share():
    whole, half = (
        every_range_window.worst(LISSAJOUS, WORLD, 12.0, 8.0, sigma=0.1, rate=10.0, share=share) for share in (1.0, 0.5)
    )
    assert half.sigma == pytest.approx(whole.sigma * math.sqrt(2), rel=1e-9)
    assert half.at == whole.at


def test_without_noise_what_is_determined_is_exact():
    assert every_range_window.worst(LISSAJOUS, WORLD, 12.0, 8.0, sigma=0.0, rate=10.0).sigma == 0.0
    assert every_range_window.worst(LISSAJOUS, WORLD, 12.0, 8.0, sigma=0.0, rate=1.0).sigma == math.inf


@pytest.mark.parametrize(("window", "rate"), [(0.0, 10.0), (21.0, 10.0), (5.0, 0.0), (5.0, math.nan)])
def test_what_cannot_be_asked_is_refused(window: float, rate: float):
    with pytest.raises(ValueError, match=r"window|rate"):
        every_range_window.worst(LISSAJOUS, WORLD, 20.0, window, sigma=0.1, rate=rate)
