"""The lifted rank against 60 digits: degenerate and random motions over windows of 0.2 to 600 s, early and late.

For each length of window it prints how many ranks differ, and how far the remainders that count and those that do not
stay from their floor. A rank above the exact one would be a motion called observable that is not. A rank below it means
that rounding hides what the exact functions have.
"""

import numpy as np

from rangenav.inputs import Vec3
from rangenav.observability import gramian_rank, rows
from rangenav.observability.cubic_fit import CUBIC
from tests.support import precise_rank

GRAVITY: Vec3 = (0.0, 0.0, 9.81)
WINDOWS = (0.2, 0.6, 2.0, 6.0, 20.0, 60.0, 200.0, 600.0)
DRAWS = 12
STARTS = (0.0, 0.37, 11.0)
"""In windows."""


def main() -> None:
    """Compare, print."""
    print("window   ranks   too high   too low   least that counts   largest that does not   (1 is the floor)")
    for window in WINDOWS:
        high, low, counted, least, largest = 0, 0, 0, np.inf, 0.0
        for draw in range(DRAWS):
            for path in precise_rank.motions(window, np.random.default_rng(draw)).values():
                start = STARTS[draw % len(STARTS)] * window
                samples = rows.sample(path, np.array([start]), window)
                of = gramian_rank.of(samples, GRAVITY, samples.weight, "start")
                rank, exact = int(of.rank[0]), precise_rank.rank(path, GRAVITY, start, window)
                high, low, counted = high + (rank > exact), low + (rank < exact), counted + 1
                inside = of.singular[0, : rank - CUBIC]
                least = min(least, float(inside.min(initial=np.inf)))
                largest = max(largest, float(of.singular[0, rank - CUBIC :].max(initial=0.0)))
        print(f"{window:5g} s {counted:7d} {high:10d} {low:9d} {least:19.3g} {largest:23.3g}")


if __name__ == "__main__":
    main()
