"""Observability of many windows: rangenav's closed form with singular values, compared with pybounds (13 states, JAX).

The Gramians belong to 151 windows of 0.5 s at 100 Hz along the paper's path. Their least eigenvalue is about 1e-19. A
program that squares the rows and computes eigenvalues loses it and returns negative numbers; the benchmark counts them
for both programs.

The excitation belongs to 101 windows of a piecewise path whose snap jumps at every knot. It is compared with scipy's
quadrature between the knots, and with one Gauss panel across the knots that has as many nodes as rangenav's.
"""

import itertools
from collections.abc import Callable

import numpy as np
from scipy.integrate import quad_vec
from timing import Target, alternate, missing, report, versions

from rangenav import preset
from rangenav.observability import excitation, quadrature, rows
from rangenav.observability.spectrum import window_spectra
from rangenav.signals import Piece, Polynomials, knots

WINDOWS, WINDOW, RATE = 151, 0.5, 100.0
SAMPLES = round(WINDOW * RATE) + 1
ROUNDS, RANGENAV_REPEATS = 5, 20
MIN_RATIO = 500.0
RANGENAV, PEER = "closed form, batched SVD", "pybounds, JAX, 13 states"
PIECES, PIECES_WINDOW, PIECES_WINDOWS = 12, 6.0, 101
MIN_PIECES_RATIO, MAX_DIFFERENCE = 100.0, 1e-9
EXACT, ADAPTIVE, ACROSS = "panels between knots", "scipy quad_vec between knots", "one panel across the knots"


def main() -> None:
    """Measure, compare, print."""
    gramians()
    pieces()


def gramians() -> None:
    """Lifted Gramians, compared with pybounds."""
    paper, start = preset.load("paper"), np.arange(WINDOWS) / RATE

    def gramian_spectra() -> np.ndarray:
        return window_spectra(paper.path, paper.world.gravity, start, WINDOW).eigenvalues

    calls: dict[str, tuple[Callable[[], object], int]] = {RANGENAV: (gramian_spectra, RANGENAV_REPEATS)}
    spectra, notes = (
        {RANGENAV: gramian_spectra()},
        [reason for reason in (missing("pybounds"), missing("jax")) if reason],
    )
    if not notes:
        theirs = _pybounds(paper)
        calls[PEER], spectra[PEER] = (theirs, 1), theirs()
        difference = _disagreement(paper, start, spectra[PEER])
        notes.append("most of a pybounds call is compiling, which every call repeats; see pybounds_windows.py")
        notes.append(f"largest eigenvalues, summed over the same samples: at most {difference:.1e} apart (relative)")
    seconds = alternate(calls, ROUNDS)
    negative = {name: int(np.sum(values < 0)) for name, values in spectra.items()}
    targets = [Target(name="our negative eigenvalues", value=negative[RANGENAV], bound=0, at_least=False)]
    if PEER in seconds:
        ratio = seconds[PEER] / seconds[RANGENAV]
        targets.append(Target(name="pybounds / rangenav", value=ratio, bound=MIN_RATIO, at_least=True, unit="×"))
    report(
        "observability",
        title=f"{WINDOWS} windows of {WINDOW:g} s at {RATE:g} Hz, the paper's path",
        columns=("", "ms", "× rangenav", "negative eigenvalues", "least eigenvalue"),
        rows=[
            (name, f"{1e3 * s:.1f}", f"{s / seconds[RANGENAV]:.3g}", f"{negative[name]}", f"{spectra[name].min():.2e}")
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


def pieces() -> None:
    """Excitation on pieces beside scipy's quadrature."""
    path = _jumping()
    start = np.linspace(0, PIECES * 1.5 - PIECES_WINDOW, PIECES_WINDOWS)
    count = quadrature.nodes(path, start, PIECES_WINDOW, raised=quadrature.SNAP)[0].shape[1]
    calls: dict[str, tuple[Callable[[], np.ndarray], int]] = {
        EXACT: (lambda: excitation.eigenvalues(path, start, PIECES_WINDOW), RANGENAV_REPEATS),
        ADAPTIVE: (lambda: _adaptive(path, start), 1),
        ACROSS: (lambda: _across(path, start, count), RANGENAV_REPEATS),
    }
    result = {name: call() for name, (call, _) in calls.items()}
    difference = {name: float(np.max(np.abs(values / result[ADAPTIVE] - 1))) for name, values in result.items()}
    seconds = alternate(calls, ROUNDS)
    ratio = seconds[ADAPTIVE] / seconds[EXACT]
    report(
        "observability-pieces",
        title=f"Excitation on {PIECES_WINDOWS} windows of {PIECES_WINDOW:g} s, {PIECES} pieces, snap jumps at knots",
        columns=("", "ms", "× rangenav", "largest difference of eigenvalues from scipy's"),
        rows=[
            (name, f"{1e3 * s:.2f}", f"{s / seconds[EXACT]:.3g}", f"{difference[name]:.1e}")
            for name, s in seconds.items()
        ],
        targets=[
            Target(name="scipy / rangenav", value=ratio, bound=MIN_PIECES_RATIO, at_least=True, unit="×"),
            Target(name="difference from scipy", value=difference[EXACT], bound=MAX_DIFFERENCE, at_least=False),
        ],
        notes=[f"{count} nodes in each window, on both panels"],
        figures={
            "milliseconds": {name: 1e3 * value for name, value in seconds.items()},
            "apart": difference,
            "versions": versions("numpy", "scipy"),
        },
    )


def _jumping() -> Polynomials:
    """Pieces of 1.5 s with random coefficients, one after the other in place."""
    rng, at, made = np.random.default_rng(0), np.zeros(3), []
    for _ in range(PIECES):
        table = rng.normal(size=(3, 8)) / 1.5 ** np.arange(8)
        table[:, 0] = at
        at = table @ 1.5 ** np.arange(8)
        x, y, z = (tuple(row.tolist()) for row in table)
        made.append(Piece(duration=1.5, x=x, y=y, z=z))
    return Polynomials(pieces=tuple(made))


def _adaptive(path: Polynomials, start: np.ndarray) -> np.ndarray:
    """Each window cut at its knots, each part integrated by scipy."""

    def outer(t: float) -> np.ndarray:
        snap = path(np.array(t), 4)
        return np.outer(snap, snap)

    result = []
    for t in start.tolist():
        edges = [t, *knots.knots(path, t, t + PIECES_WINDOW).tolist(), t + PIECES_WINDOW]
        result.append(sum(quad_vec(outer, a, b, epsrel=1e-12)[0] for a, b in itertools.pairwise(edges)))
    return np.linalg.eigvalsh(np.array(result))


def _across(path: Polynomials, start: np.ndarray, count: int) -> np.ndarray:
    """As many Gauss nodes on the whole window."""
    x, weight = quadrature.legendre(count)
    snap = path(start[:, None] + PIECES_WINDOW * x, 4) * np.sqrt(PIECES_WINDOW * weight)[:, None]
    return np.linalg.svd(np.linalg.qr(snap, mode="r"), compute_uv=False)[:, ::-1] ** 2


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
