"""Verdicts and certificates of random motions of every kind against an independent dense scan of their windows.

A scan by least squares in extended precision (`tests/support/dense_scan.py`) evaluates windows at random, evenly, and
around the one that is said to be the worst. Printed are the claims that it contradicts:
    false certificates     a certificate that meets its requirements, or states a bound, and a window that breaks it
    false observables      a motion called observable, and a window whose σ exceeds the requirement
    false refusals         a motion refused, although no window of the scan misses anything by 2 %; with the reasons
    disagreements          analysis and certificate give different verdicts
The verdicts of sampled windows, which the page shows while a hand moves, are counted for comparison.
    python benchmarks/truth.py --each 160
"""

import argparse
import collections
import time

from timing import Target, report, versions

from tests.support import random_motions, truth
from tests.support.truth import Judged

EACH, SCANNED = 160, 60
"""Motions of each of the 13 kinds, and scanned windows of each."""


def main() -> None:
    """Judge, compare, print."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--each", type=int, default=EACH)
    each = parser.parse_args().each
    began = time.perf_counter()
    every = [truth.judged(kind, seed, count=SCANNED) for kind in random_motions.KINDS for seed in range(each)]
    rows = [_row(kind, [one for one in every if one.kind == kind]) for kind in random_motions.KINDS]
    total = _row("all", every)
    refused = [f"{one.kind} {one.seed}: {one.false_refusal}" for one in every if one.false_refusal]
    wrong = [f"{one}" for one in every if one.false_certificate or one.false_observable or one.disagreement]
    report(
        "truth",
        title=f"{len(every)} random motions in {time.perf_counter() - began:.0f} s",
        columns=("", "motions", "false certificates", "observables", "refusals", "disagreements", "sampled differs"),
        rows=[*rows, total],
        targets=[
            _none("false certificates", sum(one.false_certificate for one in every)),
            _none("false observables", sum(one.false_observable for one in every)),
            _none("disagreements", sum(one.disagreement for one in every)),
        ],
        notes=[*wrong, *refused],
        figures={"words": dict(collections.Counter(one.said for one in every)), **versions("numpy")},
    )


def _none(name: str, count: int) -> Target:
    return Target(name=name, value=count, bound=0, at_least=False)


def _row(name: str, some: list[Judged]) -> tuple[str, ...]:
    counts = (
        len(some),
        sum(one.false_certificate for one in some),
        sum(one.false_observable for one in some),
        sum(bool(one.false_refusal) for one in some),
        sum(one.disagreement for one in some),
        sum(one.said != one.sampled for one in some),
    )
    return (name, *(str(count) for count in counts))


if __name__ == "__main__":
    main()
