"""Verdicts and certificates of random motions of every kind, against a dense scan in extended precision.

`benchmarks/truth.py` judges 160 motions of each kind in the same way. Here there are as many of each as take about a
second: a proof and its certificate take a tenth of a second to half a second, a scan less. A motion is drawn with a
range noise that makes about half of them observable; the seeds below are of motions of both sorts, and of some that are
nearly observable or nearly not.
"""

import pytest

from tests.support import random_motions, truth

pytestmark = pytest.mark.slow

SEEDS = {
    "tones": (0, 2, 5, 8),
    "beats": (0, 1, 2),
    "slow": (1, 3, 4, 5),
    "few ranges": (0, 2, 3, 4, 5, 7),
    "aliased": (0, 1),
    "nearly planar": (0, 1, 3, 5),
    "planar": (0, 1, 2, 3, 4, 5, 6, 7),
    "short windows": (0, 1, 4, 5),
    "waypoints": (1, 2, 3, 5, 6),
    "minimum snap": (0, 2, 3, 4, 8),
    "polynomials": (0, 1, 2, 3, 4, 7),
    "formula": (3, 4),
    "sum": (0, 1, 2),
}


DEGENERATE = ("aliased", "planar")
BORDER = (0.8, 1.25)
"""σ in the largest with which a motion is observable."""


@pytest.mark.parametrize("kind", random_motions.KINDS)
def test_no_random_motion_is_certified_or_called_observable_falsely(kind: str):
    every = [truth.judged(kind, seed, count=30) for seed in SEEDS[kind]]
    for found in every:
        assert not found.false_certificate, found
        assert not found.false_observable, found
        assert not found.disagreement, found
    words = {found.said for found in every}
    if kind in DEGENERATE:  # a test of motions that are all of one kind could not fail
        assert "blind" in words
        assert "observable" not in words
    else:
        assert {"observable", "weak"} <= words
        assert any(BORDER[0] < found.sigma / found.allowed < BORDER[1] for found in every)
