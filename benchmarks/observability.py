"""Window Gramians of the lifted model, closed form and singular values, beside pybounds (13 states, JAX).

151 windows of 0.5 s at 100 Hz along the paper's path. The least eigenvalue there is about 1e-19: squaring the rows and
asking for eigenvalues loses it and returns negative numbers, so those are counted on both sides.
"""

from collections.abc import Callable

import numpy as np
from timing import Target, alternate, missing, report, versions

from rangenav import preset
from rangenav.observability import rows
from rangenav.observability.spectrum import window_spectra

WINDOWS, WINDOW, RATE = 151, 0.5, 100.0
SAMPLES = round(WINDOW * RATE) + 1
ROUNDS, OUR_REPEATS = 5, 20
LEAST_RATIO = 300.0
OURS, PEER = "closed form, batched SVD", "pybounds, JAX, 13 states"


def main() -> None:
    """Measure, compare, print."""
    paper, start = preset.load("paper"), np.arange(WINDOWS) / RATE

    def ours() -> np.ndarray:
        return window_spectra(paper.path, paper.world.gravity, start, WINDOW).eigenvalues

    calls: dict[str, tuple[Callable[[], object], int]] = {OURS: (ours, OUR_REPEATS)}
    spectra, notes = {OURS: ours()}, [reason for reason in (missing("pybounds"), missing("jax")) if reason]
    if not notes:
        theirs = _pybounds(paper)
        calls[PEER], spectra[PEER] = (theirs, 1), theirs()
        apart = _disagreement(paper, start, spectra[PEER])
        notes.append("most of a pybounds call is compiling, which every call repeats; see pybounds_windows.py")
        notes.append(f"largest eigenvalues, summed over the same samples: at most {apart:.1e} apart (relative)")
    seconds = alternate(calls, ROUNDS)
    negative = {name: int(np.sum(values < 0)) for name, values in spectra.items()}
    targets = [Target(name="our negative eigenvalues", value=negative[OURS], bound=0, at_least=False)]
    if PEER in seconds:
        ratio = seconds[PEER] / seconds[OURS]
        targets.append(Target(name="pybounds / ours", value=ratio, bound=LEAST_RATIO, at_least=True, unit="×"))
    report(
        "observability",
        title=f"{WINDOWS} windows of {WINDOW:g} s at {RATE:g} Hz, the paper's path",
        columns=("", "ms", "× ours", "negative eigenvalues", "least eigenvalue"),
        rows=[
            (name, f"{1e3 * s:.1f}", f"{s / seconds[OURS]:.3g}", f"{negative[name]}", f"{spectra[name].min():.2e}")
            for name, s in seconds.items()
        ],
        targets=targets,
        notes=notes,
        figures={
            "milliseconds": {name: 1e3 * value for name, value in seconds.items()},
            "negative_eigenvalues": negative,
            "versions": versions("numpy", "pybounds", "jax"),
        },
    )


def _pybounds(paper: preset.Preset) -> Callable[[], np.ndarray]:
    """A documented call with the eigenvalues of its Gramians."""
    from pybounds_windows import Peer

    peer = Peer(paper, windows=WINDOWS, samples=SAMPLES, rate=RATE)
    return lambda: np.linalg.eigvalsh(peer.gramians())


def _disagreement(paper: preset.Preset, start: np.ndarray, theirs: np.ndarray) -> float:
    """How far the largest eigenvalues are apart over the same samples, to know that both did the same task."""
    lifted = rows.lifted(paper.path, paper.world.gravity, start, np.arange(SAMPLES) / RATE)
    largest = np.linalg.norm(lifted, ord=2, axis=(1, 2)) ** 2 / SAMPLES
    return float(np.max(np.abs(theirs[:, -1] / largest - 1)))


if __name__ == "__main__":
    main()
