"""One switch for each misprint of the paper that changes a computation, with its effect on the present picture."""

from collections.abc import Callable
from dataclasses import dataclass

import msgspec
import numpy as np

from explorer.model.compute import Picture
from explorer.model.settings import PRINTED_LABELS, Printed, Settings
from explorer.storage.catalog import Catalog
from explorer.widgets.controls import Switch
from explorer.widgets.form import Action, Form
from explorer.widgets.page import Page
from explorer.widgets.section import Section
from rangenav.number_format import significant

EQUILIBRIA_NOTE = (
    "There is no switch for the undesired equilibria. They are printed as I − 2uuᵀ, whose determinant is −1, so no "
    "attitude can be there. The true ones are 2uuᵀ − I, turns by 180° about an eigenvector u of M."
)
TURNING_HOVER = "turning-hover"
FALSE_CERTIFICATE = "Printed against derived, on a hover"
FALSE_HINT = (
    "Opens a vehicle that stands still and turns, and shows two runs side by side: A with the printed φ and the "
    "integral in body axes, B with the derived ones. The printed condition holds, and the position cannot be told."
)


class PrintedPanel:
    """The switches "as printed"."""

    def __init__(
        self, form: Form, catalog: Catalog, page: Page, *, pin: Callable[[Settings], None], show_side_by_side: Action
    ) -> None:
        """`pin` pins the run of these settings as A; `show_side_by_side` shows A beside the run on the page."""
        self._catalog, self._page, self._pin, self._show_side_by_side = catalog, page, pin, show_side_by_side
        section = Section(form, "As printed in the paper", expanded=False)
        with section:
            form.gui.add_markdown("Each switch follows the printed paper where it departs from what can be derived.")
            form.button(FALSE_CERTIFICATE, self._show_false_certificate, hint=FALSE_HINT)
            self._switches = {
                name: _MisprintSwitch(section, PRINTED_LABELS[name], misprint.hint)
                for name, misprint in MISPRINTS.items()
            }
            form.gui.add_markdown(EQUILIBRIA_NOTE)

        form.command(FALSE_CERTIFICATE, self._show_false_certificate)

    def read(self) -> Printed:
        """The switches that are on."""
        return Printed(**{name: misprint.switch.read() for name, misprint in self._switches.items()})

    def write(self, printed: Printed) -> None:
        """Show switches."""
        for name, misprint in self._switches.items():
            misprint.switch.write(getattr(printed, name), False)

    def _show_false_certificate(self) -> None:
        derived = self._catalog.open(TURNING_HOVER)
        self._page.write(derived)
        self._pin(msgspec.structs.replace(derived, printed=Printed(excitation=True, body_axes=True)))
        self._show_side_by_side()

    def draw(self, picture: Picture) -> None:
        """Show below each switch its effect on a picture."""
        for name, misprint in self._switches.items():
            misprint.draw(MISPRINTS[name].consequence(picture))


@dataclass(frozen=True)
class Misprint:
    """One departure."""

    hint: str
    consequence: Callable[[Picture], str]


class _MisprintSwitch:
    def __init__(self, section: Section, label: str, hint: str) -> None:
        self.switch = Switch(section, label, hint=hint)
        self._line = section.gui.add_markdown("")

    def draw(self, sentence: str) -> None:
        if sentence != self._line.content:
            self._line.content = sentence


def _model(picture: Picture) -> str:
    error = f"the mean position error over the last quarter is {significant(picture.summary.steady_position)} m"
    if picture.settings.printed.model:
        return f"On: ξ₄ is fed a third of what it should be; {error}, and it never converges."
    return f"Off: {error}."


def _excitation(picture: Picture) -> str:
    return _printed_mu(picture, picture.settings.printed.excitation)


def _body_axes(picture: Picture) -> str:
    return _printed_mu(picture, picture.settings.printed.body_axes)


def _printed_mu(picture: Picture, on: bool) -> str:
    mu, needed = picture.analysis.mu, picture.preset.requirement.mu
    derived = _or_zero(mu, picture.analysis.mu_floor)
    if not on:
        return f"Off: μ = {derived} m²/s⁷."
    printed = float(np.min(picture.printed_excitation))
    false_certificate = " — a false certificate" if printed >= needed > mu else ""
    return f"On: μ reads {significant(printed)} m²/s⁷ where the derived one is {derived}{false_certificate}."


def _reduced_row(picture: Picture) -> str:
    derived = _or_zero(picture.analysis.reduced_min, picture.analysis.reduced_floor)
    if not picture.settings.printed.reduced_row:
        return f"Off: the least eigenvalue of the reduced pair is {derived}, in SI units."
    printed = significant(picture.reduced_min)
    return f"On: the least eigenvalue of the reduced pair is {printed}; the derived one is {derived}, in SI units."


def _or_zero(value: float, floor: float) -> str:
    return significant(value) if value >= floor else "0 within rounding errors"


def _initial_values(picture: Picture) -> str:
    if not picture.settings.printed.initial_values:
        return "Off: p(0) and v(0) follow from the formula."
    position = picture.motion.position
    drift = float(np.linalg.norm(position[-1] - position[0]))
    return f"On: the path is {significant(drift)} m from its start after {picture.preset.duration:g} s; it drifts away."


def _attitude_rate(picture: Picture) -> str:
    slowest = picture.attitude_time_constants[0]
    state = "On" if picture.settings.printed.attitude_rate else "Off"
    return f"{state}: the slowest time constant of a small attitude error is {significant(slowest)} s."


MISPRINTS = {
    "model": Misprint(
        "Printed: C₅ ≡ 0 and B_m with |g|² (paper, eq. 6–7). Derived: C₅ = 6 on the g block and 3|g|² into ξ₄.",
        _model,
    ),
    "excitation": Misprint(
        "Printed: φ = ä − ω×ȧ − 2ω×(ω×a). Derived: φ = ä + 2ω×ȧ + ω̇×a + ω×(ω×a) = Rᵀp⁗ (paper, eq. 11–12).",
        _excitation,
    ),
    "reduced_row": Misprint(
        "Printed: 4ȧᵀ − 3aᵀ[ω]x. Derived: 4ȧᵀ − 4aᵀ[ω]x (paper, eq. 11–12, the reduced pair).",
        _reduced_row,
    ),
    "body_axes": Misprint(
        "Printed: pair (Ā, R̄ r₄), so the integral of φφᵀ runs in body axes. Derived: inertial axes, ∫p⁗p⁗ᵀ.",
        _body_axes,
    ),
    "initial_values": Misprint(
        "Printed: p(0) = (1, 0, 0), v(0) = (−.0125, 2.5, −4.33), which belong to another, planar path.",
        _initial_values,
    ),
    "attitude_rate": Misprint(
        "Printed: the error equation has −k1 R̂ψ(MR̃). Derived: −2 k1 ψ(MR̃), twice as fast (paper, eq. 10).",
        _attitude_rate,
    ),
}
