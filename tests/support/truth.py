"""One motion's verdict and certificate against a dense scan: what was claimed falsely, and what was refused falsely."""

import math
from dataclasses import dataclass

import numpy as np

from rangenav import analysis, certificate, verdict
from rangenav import preset as presets
from rangenav.certificate import Certificate
from rangenav.observability import excitation
from rangenav.preset import Preset
from tests.support import dense_scan, random_motions

SURE = 1e-4
"""Share by which the scan must differ before a claim is called false: it is rounded, too."""
NEAR = 0.02
"""Share: a refusal is called false only if the scan, which may miss the worst window, stays so far within."""


@dataclass(frozen=True, kw_only=True)
class Judged:
    """What one motion was said to be, and what a scan has of it."""

    kind: str
    seed: int
    said: str
    sampled: str
    allowed: float
    """m: the largest σ with which the motion is observable."""
    sigma: float
    """m: the largest of the scan; infinite where a window does not determine the position."""
    bound: float
    mu: float
    """m²/s⁷: the least of the scan."""
    false_certificate: bool
    false_observable: bool
    false_refusal: str
    """Why it was refused, although the scan has no window that misses; empty if it was not."""
    disagreement: bool
    """Whether analysis and certificate differ in their verdict, or in whether the required μ is reached."""


def judged(kind: str, seed: int, *, count: int) -> Judged:
    """Judge the random motion of one kind and seed, and scan so many windows of it."""
    preset = random_motions.random_preset(kind, seed)
    analysed, issued = analysis.analyse(preset), certificate.certify(presets.dumps(preset).encode(), source=kind)
    needed, at = preset.requirement, analysed.accuracy_at
    each = np.array([dense_scan.sigma(preset, float(t)) for t in dense_scan.starts(preset, at, count=count, seed=seed)])
    sigma = float(each.max())
    start = dense_scan.starts(preset, analysed.mu_at, count=10 * count, seed=seed)
    mu = float(excitation.eigenvalues(preset.path, start, needed.window)[:, 0].min())
    assert analysed.proof is not None
    bound = analysed.proof.accuracy.windows.bound
    too_far, too_weak = sigma > needed.position_sigma * (1 + SURE), mu < needed.mu * (1 - SURE)
    return Judged(
        kind=kind,
        seed=seed,
        said=analysed.verdict.word,
        sampled=analysis.sampled(preset).verdict.word,
        allowed=min(needed.position_sigma, verdict.sphere(analysed.farthest)),
        sigma=sigma,
        bound=bound,
        mu=mu,
        false_certificate=(issued.meets and (too_far or too_weak)) or _bound_fails(issued, sigma, mu),
        false_observable=analysed.verdict.word == "observable"
        and (too_far or sigma > verdict.sphere(analysed.farthest)),
        false_refusal=_refused(issued, sigma, mu, preset, analysed.farthest),
        disagreement=analysed.verdict.summary != certificate.verdict_of(issued).summary,
    )


def _bound_fails(issued: Certificate, sigma: float, mu: float) -> bool:
    """Whether a window of the scan breaks a bound of the certificate."""
    bound, lower = issued.accuracy.bound, issued.excitation.lower
    above = isinstance(bound, float) and sigma > bound * (1 + SURE)
    return above or (lower is not None and mu < lower * (1 - SURE))


def _refused(issued: Certificate, sigma: float, mu: float, preset: Preset, farthest: float) -> str:
    needed, allowed = preset.requirement, min(preset.requirement.position_sigma, verdict.sphere(farthest))
    within = math.isfinite(sigma) and sigma <= allowed * (1 - NEAR) and mu >= needed.mu * (1 + NEAR)
    if issued.meets or not within:
        return ""
    return "; ".join(check.words for check in issued.checks if not check.met)
