"""What a repair has found, as text: the change, its certificate, and figures and drawings before and after it."""

from explorer.model.certificate_text import certificate_sentence
from explorer.panels.presets.card import drawings
from explorer.widgets.html import NOTE, bullets, table, upper_first
from rangenav.certificate.figures import Figures
from rangenav.number_format import quantity, shortened, significant
from rangenav.preset import Preset
from rangenav.repair import Repair

ROUNDING = 1e-12
"""m²/s⁷: a smaller μ is rounding error."""
SIDE_BY_SIDE = "display:flex;gap:0.8em;align-items:center;padding:0.3em 0"
DRAWINGS = f'<div style="{SIDE_BY_SIDE}"><b>{{}}</b>{{}}</div>'


def found(result: Repair) -> str:
    """The change as HTML: sentences, both paths, and a table."""
    sides = (("before", drawings(result.before)), ("proposed", drawings(result.after)))
    return NOTE.format(
        bullets(repair_text(result)) + "".join(DRAWINGS.format(*side) for side in sides) + figures(result)
    )


def outcome(result: Repair) -> str:
    """The change, what it is predicted to reach, and with which noise."""
    wanted = quantity(result.after.requirement.position_sigma, "m")
    state = "certified" if result.certificate.certified else "not certified"
    change, predicted = shortened(result.description), _sigma(result.figures_after)
    return (
        f"Proposed, green in the scene: {change}. Predicted error ±{predicted}, wanted ±{wanted}; {state}. "
        f"Searched with ranges of {noise_text(result.after)}."
    )


def noise_text(preset: Preset) -> str:
    """With which noise of the ranges an error is predicted, and where that is changed."""
    return f"{quantity(preset.sensors.sigma.range, 'm')} of noise (Sensors tab)"


def repair_text(result: Repair) -> tuple[str, ...]:
    """Sentences: the change, and the verdict of the certificate of its result."""
    certificate = result.certificate
    failures = "; ".join(map(certificate_sentence, certificate.failures))
    certificate_text = "certified" if certificate.certified else f"not certified: {failures}"
    broken = certificate.vehicle.broken
    vehicle_text = "within the vehicle's limits" if not broken else f"too much for the vehicle: {'; '.join(broken)}"
    tried = f"After {result.evaluations} motions tried: {certificate_text}; {vehicle_text}"
    return upper_first(shortened(result.description)), tried, f"Searched with ranges of {noise_text(result.after)}"


def figures(result: Repair) -> str:
    """A table of μ and σ before and after the change."""
    before, after = result.figures_before, result.figures_after
    return table(
        ("", "before", "proposed"),
        (
            ("μ (m²/s⁷)", _mu(before), _mu(after)),
            ("predicted σ", _sigma(before), _sigma(after)),
            (
                "required",
                "",
                f"μ ≥ {significant(result.after.requirement.mu)}, σ ≤ {result.after.requirement.position_sigma:g} m",
            ),
        ),
    )


def _mu(figure: Figures) -> str:
    return significant(figure.mu) if figure.mu > ROUNDING else "nothing"


def _sigma(figure: Figures) -> str:
    return quantity(figure.sigma, "m", otherwise="blind")
