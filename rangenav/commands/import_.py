"""`rangenav import`: another tool's path as a preset, with what the file did not say asked and not assumed."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import msgspec
import tyro

from rangenav import formats
from rangenav import preset as presets
from rangenav.commands.output import print_json, require_place
from rangenav.commands.progress import working
from rangenav.inputs import Vec3
from rangenav.vehicle import BY_NAME

if TYPE_CHECKING:
    FormatName = str
    VehicleName = str
else:
    VehicleName = Literal[tuple(BY_NAME)]
    FormatName = Literal[tuple(row.name for row in formats.rows() if row.reads)]


def import_(
    path: tyro.conf.Positional[Path],
    *,
    from_: Annotated[FormatName, tyro.conf.arg(name="from")],
    output: Annotated[Path, tyro.conf.arg(aliases=["-o"], metavar="PRESET.toml")],
    duration: float | None = None,
    frame: Literal["z-up", "z-down"] | None = None,
    lines: Literal["drop"] | None = None,
    time_unit: Literal["s", "ms", "us", "ns"] | None = None,
    gaps: Literal["longest", "bridge"] | None = None,
    begin: float | None = None,
    end: float | None = None,
    knots: float | None = None,
    anchor: Vec3 | None = None,
    ends: Literal["hold", "repeat"] | None = None,
    window: float | None = None,
    vehicle: VehicleName | None = None,
    json: bool = False,
) -> None:
    """Make a preset of another tool's path, and say what its motion lets one range tell.

    Example: rangenav import path.csv --from reference -o mine.toml

    Args:
        path: The file to read; for euroc a ground-truth csv.
        from_: Its format.
        output: The preset to write.
        duration: Seconds of it to fly; all by default, and several loops of a path that closes.
        frame: Which way z points, where the format does not say.
        lines: Drop lines whose stamps repeat or go back.
        time_unit: Confirms the unit of the stamps.
        gaps: Use the longest part without a gap, or draw the curve through the gaps.
        begin: Read the path from here (s from the first row); 0 reads the ramps of an own export, too.
        end: Read the path to here (s from the first row).
        knots: Seconds between the knots through sampled poses; as wide as the samples allow by default.
        anchor: Where the anchor stands (m), which no path says; outside the path, below it, by default.
        ends: What the path does after its end; by default it repeats if it ends where it begins.
        window: Window δ (s) over which the path is judged; 6 s by default, half the path if that is shorter, and
            whole loops of 10 to 20 s of a path that repeats.
        vehicle: Vehicle whose limits the path is to keep; none by default.
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
    given = {"frame": frame, "lines": lines, "time": time_unit, "gaps": gaps}
    confirm = {key: value for key, value in given.items() if value is not None}
    with working(f"reading {path}"):
        imported = formats.read(path, from_, confirm=confirm, knots=knots, part=(begin, end))
        preset = as_preset(imported, duration=duration, anchor=anchor, ends=ends)
        if window is not None:
            preset = presets.with_window(preset, window, source=f"{path}, --window")
        if vehicle is not None:
            preset = msgspec.structs.replace(preset, vehicle=BY_NAME[vehicle])
        answer = _report(imported, preset, output)
    presets.save(preset, output)
    if json:
        return print_json(answer)
    return layout.show(text.imported(preset, analysis.analyse(preset), answer, source=imported.source))


def _report(imported: Any, preset: presets.Preset, output: Path) -> dict[str, Any]:
    from rangenav import analysis
    from rangenav import report as reports
    from rangenav.formats.path_preset import choices
    from rangenav.signals import Flown

    analysed = analysis.analyse(preset)
    flown = isinstance(preset.angular_velocity, Flown)
    report: dict[str, Any] = {
        "preset": str(output),
        "format": imported.format,
        "rows": imported.rows,
        "rate": imported.rate,
        "duration": imported.duration,
        "used": preset.duration,
        "frame": imported.frame,
        "snap_from": "the file" if imported.derivatives == "file" else "a fit: it is not in the file",
        "fit_error": imported.fit_error,
        "findings": list(imported.findings),
        "assumed": list(choices(preset, imported)),
        "attitude": "as flown" if flown else "the body does not turn: flying this path has no attitude somewhere",
        "excitation": {"window": preset.requirement.window, "mu": analysed.mu, "floor": analysed.mu_floor},
        "rank": analysed.rank,
        **reports.verdict(preset, analysed),
    }
    if imported.rate is None:
        report["rate_reason"] = "null: pieces and no samples"
    if imported.fit_error is None:
        report["fit_error_reason"] = "null: the path is the file's own"
    if not analysed.verdict.judged:
        report |= {"excitation": None, "rank": None, "reason": f"null: {analysed.verdict.reason}"}
    return report
