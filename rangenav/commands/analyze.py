"""`rangenav analyze`: what a motion lets one range tell."""

from rangenav import preset as presets
from rangenav.commands.output import PresetName, print_json, print_table


def analyze(preset: PresetName, *, window: float | None = None, json: bool = False) -> None:
    """Say what a preset's motion lets one range tell: excitation, Gramian, rank, blind directions, accuracy.

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        window: Window δ in seconds; the preset's own by default.
        json: Print one JSON object.
    """
    from rangenav import analysis, report

    chosen = presets.load(preset)
    if window is not None:
        chosen = analysis.with_window(chosen, window, source=f"{preset}, --window")
    found = report.analysis_report(chosen, analysis.analyse(chosen), name=preset)
    return print_json(found) if json else print_table(f"{chosen.title}: {found['verdict'] or 'not judged'}", found)
