"""The Presets tab: pick one, read what it teaches, reproduce the paper's figures, download what is on the page."""

import html
import math

from explorer.panels.controls import Choice
from explorer.panels.sheet import Action, Section, Sheet
from explorer.settings import Settings, effective
from rangenav import analysis, preset
from rangenav.preset import Preset

PRINTED_START = (
    "# printed: this path starts from the paper's p(0) and v(0), which its formula does not have; it drifts\n"
)
FIGURES = (
    "Loads the paper's own scenario and shows the position, velocity and gravity errors (fig. 3), the attitude error "
    "(fig. 4) and the true and estimated path (fig. 5)."
)
DOWNLOAD = "A TOML file of what is on the page now; its first lines state the verdict, computed from the file itself."
EXPECTED = {
    "observable": "● expected observable",
    "weak": "▲ expected weak",
    "unobservable": "✕ expected unobservable",
}


class PresetsPanel:
    """Picker and buttons."""

    def __init__(
        self, sheet: Sheet, presets: dict[str, Preset], *, again: Action, paper: Action, download: Action
    ) -> None:
        self._section = section = Section(sheet)
        titles = {name: f"{shown.title} ({name})" for name, shown in presets.items()}
        with section:
            hint = "Every shipped motion, with its sensors, gains and requirement. Ctrl+Z brings back what was there."
            self._choice = Choice(section, "preset", titles, hint=hint)
            self._story = sheet.gui.add_html("")
            for label, action, hint in (
                ("Start this preset again", again, "Puts every control back to what the preset says."),
                ("The paper's figures 3–5", paper, FIGURES),
                ("Download this preset", download, DOWNLOAD),
            ):
                sheet.button(label, action, hint=hint)
                sheet.command(label, action)

    def read(self) -> str:
        """The name of the chosen preset. Raises Refused if the browser sent another."""
        with self._section.catching():
            return self._choice.read()

    def write(self, name: str, shown: Preset) -> None:
        """Show a preset's name, story and expectation."""
        self._choice.write(name, name)
        expected = EXPECTED[shown.expect]
        style = "font-size:0.85em;line-height:1.45;padding:0 0.9em 0.6em"
        self._story.content = f'<div style="{style}">{html.escape(shown.story)}<br><b>{expected}</b></div>'


def document(settings: Settings) -> bytes:
    """A preset as a TOML file; the verdict in its first lines is computed from the text that follows them."""
    text = preset.dumps(effective(settings))
    read_back = preset.loads(text, source="this file")
    start = PRINTED_START if settings.printed.initial_values else ""
    return (verdict_comments(read_back) + start + "\n" + text).encode()


def verdict_comments(shown: Preset) -> str:
    """Comment lines that state what was computed, without a word from the preset's own text."""
    found, needed = analysis.analyse(shown), shown.requirement
    met = "met" if found.mu >= needed.mu else "NOT met"
    lines = [
        f"verdict: {found.verdict}; rank {found.rank} of 13 (nonlinear {found.nonlinear_rank} of 9); required mu {met}",
        f"mu = {found.mu:.6g} m²/s⁷, the least eigenvalue of ∫p⁗p⁗ᵀ over every window of {needed.window:g} s "
        f"(worst from t = {found.mu_at:.3g} s); required: {needed.mu:.6g}: {met}",
        f"predicted 1-sigma position at the end of the worst window: {_metres(found.lifted_end.position)} lifted, "
        f"{_metres(found.nonlinear_end.position)} nonlinear; required {needed.position_sigma:g} m",
        f"it assumes {analysis.noise_note(shown.sensors)}",
    ]
    lines += [f"blind: {direction.words}" for direction in found.directions]
    return "".join(f"# {line}\n" for line in lines)


def file_name(name: str, shown: Preset, shipped: Preset) -> str:
    """The name of the download: the shipped preset's, marked if it was changed."""
    return f"{name}.toml" if shown == shipped else f"{name}-changed.toml"


def _metres(sigma: float) -> str:
    return f"{sigma:.4g} m" if math.isfinite(sigma) else "not determined"
