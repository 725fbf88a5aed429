"""A preset file for download: the settings as TOML, with the verdict in comment lines at its beginning.

The verdict is computed from the TOML text of the same file.
"""

import msgspec

from explorer.model.settings import Settings, effective
from rangenav import analysis, preset
from rangenav.analysis import Analysis
from rangenav.number_format import quantity
from rangenav.preset import Preset
from rangenav.sensors import noise_assumption

PRINTED_START = (
    "# printed: this path starts from the paper's p(0) and v(0), which its formula does not have; it drifts\n"
)
UNITS = "# units: m, s, rad, and those that follow from them (m/s, rad/s², m²/s⁷); rates in Hz\n"
UNJUDGED = (
    "# verdict: none, not judged: the path jumps, or its snap is a fit's; `rangenav certify` on this file says which\n"
)


def document(settings: Settings) -> bytes:
    """The preset file of some settings."""
    text = preset.dumps(as_it_became(effective(settings)))
    read_back = preset.loads(text, source="this file")
    start = PRINTED_START if settings.printed.initial_values else ""
    return (verdict_comments(read_back) + start + UNITS + "\n" + text).encode()


def as_it_became(chosen: Preset) -> Preset:
    """A preset that is observable expects so. One that was drawn from a blind preset would break the promise of that
    one, and tell its story."""
    if chosen.expect == "observable" or analysis.analyse(chosen, compiled=True).verdict.word != "observable":
        return chosen
    return msgspec.structs.replace(chosen, expect="observable", story="")


def verdict_comments(shown: Preset) -> str:
    """Comment lines with the verdict and its figures; they contain no text of the preset.

    For an imported curve that jumps, or whose snap comes from a fit, they state that nothing is judged."""
    motion_analysis, requirement = analysis.analyse(shown, compiled=True), shown.requirement
    if not motion_analysis.verdict.judged:
        return UNJUDGED
    met, windows = _excited(motion_analysis, requirement.mu)
    lifted, nonlinear = (
        quantity(end.position, "m", digits=4) for end in (motion_analysis.lifted_end, motion_analysis.nonlinear_end)
    )
    lines = [
        f"verdict: {motion_analysis.verdict.word}; rank {motion_analysis.rank} of 13 "
        f"(nonlinear {motion_analysis.nonlinear_rank} of 9); required mu {met}",
        f"mu = {motion_analysis.mu:.6g} m²/s⁷, the least eigenvalue of ∫p⁗p⁗ᵀ over {windows} of "
        f"{requirement.window:g} s (worst from t = {motion_analysis.mu_at:.3g} s); "
        f"required: {requirement.mu:.6g}: {met}",
        f"predicted 1-sigma position at the end of the worst window: {lifted} lifted, "
        f"{nonlinear} nonlinear in that same window; required {requirement.position_sigma:g} m",
        f"it assumes {noise_assumption(shown.sensors)}",
    ]
    if motion_analysis.verdict.reason:
        lines.append(str(motion_analysis.verdict))
    lines += [f"blind: {direction.summary}" for direction in motion_analysis.directions]
    return "".join(f"# {line}\n" for line in lines)


def _excited(shown: Analysis, required: float) -> tuple[str, str]:
    """Whether the required μ is met, and by which windows: "every window" is written of what is proven alone."""
    proven = None if shown.proof is None else shown.proof.excitation.meets(required)
    if proven is None:
        return ("met on these" if shown.mu >= required else "NOT met"), "sampled windows"
    return ("met" if proven else "NOT met"), "every window"


def file_name(name: str, shown: Preset, shipped: Preset) -> str:
    """The name of the file: the preset's name, marked if the preset was changed."""
    stem = name.rpartition(":")[2]
    return f"{stem}.toml" if shown == shipped else f"{stem}-changed.toml"
