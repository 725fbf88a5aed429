"""`rangenav import`: another tool's path as a preset, with what the file did not say asked and not assumed."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from rangenav import formats
from rangenav import preset as presets
from rangenav.commands.output import print_json, require_place
from rangenav.commands.progress import working
from rangenav.inputs import Vec3

if TYPE_CHECKING:
    FormatName = str
else:
    FormatName = Literal[tuple(row.name for row in formats.rows() if row.reads)]


def import_(
    path: tyro.conf.Positional[Path],
    *,
    from_: Annotated[FormatName, tyro.conf.arg(name="from")],
    output: Annotated[Path, tyro.conf.arg(aliases=["-o"], metavar="PRESET.toml")],
    duration: float | None = None,
    frame: Literal["z-up", "z-down"] | None = None,
    knots: float | None = None,
    anchor: Vec3 = (0.0, 0.0, 0.0),
    json: bool = False,
) -> None:
    """Make a preset of another tool's path, and say what its motion lets one range tell.

    Example: rangenav import path.csv --from reference -o mine.toml

    Args:
        path: The file to read; for euroc a ground-truth csv.
        from_: Its format.
        output: The preset to write.
        duration: Seconds of it to fly; all by default.
        frame: Which way z points, where the format does not say.
        knots: Seconds between the knots through sampled poses; as wide as stays within a centimetre by default.
        anchor: Where the anchor stands (m), which no path says.
        json: Print one JSON object.
    """
    from rangenav import analysis
    from rangenav.commands.text import exchange as text
    from rangenav.commands.text import layout
    from rangenav.formats.path_preset import as_preset

    require_place("-o", output, ".toml")
    if from_ == "preset":
        presets.save(presets.load(path), output)
        return print_json({"preset": str(output)}) if json else layout.show(text.copied(path, output))
    confirm = {} if frame is None else {"frame": frame}
    with working(f"reading {path}"):
        found = formats.read(path, from_, confirm=confirm, knots=knots)
        made = as_preset(found, duration=duration, anchor=anchor)
        answer = _report(found, made, output)
    presets.save(made, output)
    if json:
        return print_json(answer)
    return layout.show(text.imported(made, analysis.analyse(made), answer, source=found.source))


def _report(found: Any, made: presets.Preset, output: Path) -> dict[str, Any]:
    from rangenav import analysis
    from rangenav.signals import Flown

    seen = analysis.analyse(made)
    flown = isinstance(made.angular_velocity, Flown)
    report: dict[str, Any] = {
        "preset": str(output),
        "format": found.format,
        "rows": found.rows,
        "rate": found.rate,
        "duration": found.duration,
        "used": made.duration,
        "frame": found.frame,
        "snap_from": "the file" if found.derivatives == "file" else "a fit: it is not in the file",
        "fit_error": found.fit_error,
        "findings": list(found.findings),
        "attitude": "as flown" if flown else "the body does not turn: flying this path has no attitude somewhere",
        "excitation": {"window": made.requirement.window, "mu": seen.mu, "floor": seen.mu_floor},
        "rank": seen.rank,
        "verdict": seen.verdict.word,
    }
    if found.rate is None:
        report["rate_reason"] = "null: pieces and no samples"
    if found.fit_error is None:
        report["fit_error_reason"] = "null: the path is the file's own"
    if not seen.verdict.judged:
        report |= {"excitation": None, "rank": None, "reason": f"null: {seen.verdict.reason}"}
    return report
