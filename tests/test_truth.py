"""Verdicts and certificates of random motions of every kind, against a dense scan in extended precision.

`benchmarks/truth.py` judges 160 motions of each kind in the same way. Here there are as many of each as take about a
second and a half: a proof and its certificate take a tenth of a second to half a second, a scan less. A motion is drawn
with a range noise that makes about half of them observable, and many of them nearly so or nearly not.
"""

import pytest

from tests.support import random_motions, truth

pytestmark = pytest.mark.slow

EACH = {
    "tones": 9,
    "beats": 5,
    "slow": 6,
    "few ranges": 8,
    "aliased": 2,
    "nearly planar": 6,
    "planar": 14,
    "short windows": 6,
    "waypoints": 7,
    "minimum snap": 9,
    "polynomials": 9,
    "formula": 5,
    "sum": 5,
}


DEGENERATE = ("aliased", "planar")
BORDER = (0.8, 1.25)
"""σ in the largest with which a motion is observable."""


@pytest.mark.parametrize("kind", random_motions.KINDS)
def test_no_random_motion_is_certified_or_called_observable_falsely(kind: str):
    every = [truth.judged(kind, seed, count=30) for seed in range(EACH[kind])]
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
