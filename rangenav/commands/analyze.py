"""`rangenav analyze`: what a motion lets one range tell."""

from rangenav import preset as presets
from rangenav.commands.output import PresetName, print_json
from rangenav.commands.progress import working


def analyze(preset: PresetName, *, window: float | None = None, json: bool = False) -> None:
    """Say what one range can tell of a preset's motion: rank, excitation, blind directions, accuracy, vehicle.

    Example: rangenav analyze paper-slow --window 4

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        window: Window δ in seconds; the preset's own by default.
        json: Print one JSON object.
    """
    from rangenav import analysis, report
    from rangenav.commands.text import analyze as text
    from rangenav.commands.text import layout

    chosen = presets.load(preset)
    if window is not None:
        chosen = presets.with_window(chosen, window, source=f"{preset}, --window")
    with working(f"analysing {preset}"):
        analysed = analysis.analyse(chosen)
    if json:
        return print_json(report.analysis_report(chosen, analysed, name=preset))
    return layout.show(text.report(chosen, analysed, name=preset, window=window))
