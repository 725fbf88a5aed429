"""Window Gramians of the lifted model, closed form and singular values, beside pybounds (13 states, JAX).

151 windows of 0.5 s at 100 Hz along the paper's path. The least eigenvalue there is about 1e-19: squaring the rows and
asking for eigenvalues loses it and returns negative numbers, so those are counted on both sides.
"""

import numpy as np
from timing import Target, median_seconds, missing, report, versions

from rangenav import preset
from rangenav.observability import rows
from rangenav.observability.spectrum import window_spectra

WINDOWS, WINDOW, RATE = 151, 0.5, 100.0
SAMPLES = round(WINDOW * RATE) + 1
RUNS, PEER_RUNS = 51, 5
LEAST_RATIO = 300.0


def main() -> None:
    """Measure, compare, print."""
    paper = preset.load("paper")
    start = np.arange(WINDOWS) / RATE
    ours = window_spectra(paper.path, paper.world.gravity, start, WINDOW)
    our_seconds = median_seconds(lambda: window_spectra(paper.path, paper.world.gravity, start, WINDOW), RUNS)
    negative = int(np.sum(ours.eigenvalues < 0))
    table = [
        ("closed form, batched SVD", f"{our_seconds * 1e3:.2f}", "1", str(negative), f"{ours.eigenvalues.min():.2e}")
    ]
    targets = [Target(name="our negative eigenvalues", value=negative, bound=0, at_least=False)]
    figures: dict[str, object] = {"milliseconds": our_seconds * 1e3, "windows": WINDOWS}
    notes = [reason for reason in (missing("pybounds"), missing("jax")) if reason]
    if not notes:
        peer_seconds, spectrum = _pybounds(paper)
        ratio, peer_negative = peer_seconds / our_seconds, int(np.sum(spectrum < 0))
        agreement = _agreement(paper, start, spectrum)
        table.append(
            (
                "pybounds, JAX, 13 states",
                f"{peer_seconds * 1e3:.0f}",
                f"{ratio:.0f}",
                str(peer_negative),
                f"{spectrum.min():.2e}",
            )
        )
        targets.append(Target(name="pybounds / ours", value=ratio, bound=LEAST_RATIO, at_least=True, unit="×"))
        figures |= {"pybounds_milliseconds": peer_seconds * 1e3, "pybounds_negative": peer_negative}
        figures["pybounds_windows_with_negative"] = int(np.sum(np.any(spectrum < 0, axis=1)))
        notes.append(f"largest eigenvalues, sums over the same samples: at most {agreement:.1e} apart (relative)")
    report(
        "observability",
        title=f"{WINDOWS} windows of {WINDOW:g} s at {RATE:g} Hz, the paper's path",
        columns=("", "ms", "× ours", "negative eigenvalues", "least eigenvalue"),
        rows=table,
        targets=targets,
        notes=notes,
        figures=figures | {"versions": versions("numpy", "pybounds", "jax")},
    )


def _pybounds(paper: preset.Preset) -> tuple[float, np.ndarray]:
    """Seconds of a documented call with the eigenvalues of its Gramians, and those eigenvalues."""
    from pybounds_windows import Peer

    peer = Peer(paper, windows=WINDOWS, samples=SAMPLES, rate=RATE)
    elapsed = median_seconds(lambda: np.linalg.eigvalsh(peer.gramians()), PEER_RUNS)
    return elapsed, np.linalg.eigvalsh(peer.gramians())


def _agreement(paper: preset.Preset, start: np.ndarray, theirs: np.ndarray) -> float:
    """How far the largest eigenvalues are apart over the same samples, to know that both did the same task."""
    lifted = rows.lifted(paper.path, paper.world.gravity, start, np.arange(SAMPLES) / RATE)
    largest = np.linalg.norm(lifted, ord=2, axis=(1, 2)) ** 2 / SAMPLES
    return float(np.max(np.abs(theirs[:, -1] / largest - 1)))


if __name__ == "__main__":
    main()
