"""Verdicts and certificates of random motions of every kind, against a dense scan in extended precision.

`benchmarks/truth.py` judges 2,000 motions in the same way; here there are a few of each kind, because a scan takes half
a second.
"""

import pytest

from tests.support import random_motions, truth

pytestmark = pytest.mark.slow

EACH = 3


@pytest.mark.parametrize("kind", random_motions.KINDS)
def test_no_random_motion_is_certified_or_called_observable_falsely(kind: str):
    for seed in range(EACH):
        found = truth.judged(kind, seed, count=30)
        assert not found.false_certificate, found
        assert not found.false_observable, found
        assert not found.disagreement, found
