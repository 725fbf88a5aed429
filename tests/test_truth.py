"""Verdicts and certificates of random motions of every kind, against a dense scan in extended precision.

`benchmarks/truth.py` judges 160 motions of each kind in the same way. Here there are as many of each as take about a
second and a half: a proof and its certificate take a tenth of a second to half a second, a scan less.
"""

import pytest

from tests.support import random_motions, truth

pytestmark = pytest.mark.slow

EACH = {
    "tones": 8,
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
    "formula": 3,
    "sum": 5,
}


@pytest.mark.parametrize("kind", random_motions.KINDS)
def test_no_random_motion_is_certified_or_called_observable_falsely(kind: str):
    for seed in range(EACH[kind]):
        found = truth.judged(kind, seed, count=30)
        assert not found.false_certificate, found
        assert not found.false_observable, found
        assert not found.disagreement, found
