"""Frames become fewer while the server is late, and come back at the full rate when it is not."""

import pytest

from explorer.model.pace import LEAST_RATE, RATE, USUAL, Pace


def late(pace: Pace, seconds: float, frames: int = 200) -> Pace:
    for _ in range(frames):
        pace.observe(seconds)
    return pace


def test_a_server_that_has_time_draws_at_the_full_rate() -> None:
    assert 1 / late(Pace(), USUAL).period == pytest.approx(RATE)
    assert RATE >= 15, "frames a second that look smooth"


def test_the_rate_falls_with_the_lateness_and_recovers() -> None:
    pace = Pace()
    periods = [late(pace, seconds).period for seconds in (0.0, 0.02, 0.04)]
    assert periods == sorted(set(periods))
    assert 1 / late(pace, 10.0).period == pytest.approx(LEAST_RATE)
    assert 1 / late(pace, 0.0).period == pytest.approx(RATE)
