"""The vehicle, its limits, the share of each that the motion uses, and the time of the largest use."""

from explorer.model import palette
from explorer.model.compute import Picture
from explorer.model.drawn import Drawn
from explorer.model.glossary import MOTION
from explorer.widgets.controls import Choice
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from rangenav import vehicle
from rangenav.number_format import significant
from rangenav.vehicle import CATALOGUE, Vehicle

NO_LIMITS = "any vehicle, no limits"
"""What the menu calls the vehicle that has none."""
CELL = "padding:0.1em 0.5em 0.1em 0;white-space:nowrap"
BAR = (
    '<div style="width:2.2em;height:0.55em;background:{};display:inline-block;vertical-align:middle">'
    '<div style="width:{:.0f}%;height:100%;background:{}"></div></div>'
)
SHORT_UNITS = {"times the weight": "× weight"}
SHORT_NAMES = {"least distance to the anchor": "to the anchor"}


class VehiclePanel:
    """A menu of vehicles, and a table of what the motion uses."""

    def __init__(self, form: Form) -> None:
        self._section = section = Section(form, "Vehicle and its limits")
        with section:
            self._choice = Choice(section, MOTION["vehicle"].caption, _labels(CATALOGUE), hint=MOTION["vehicle"].hint)
            self._table = form.gui.add_html("")
        self._drawn = Drawn()

    def refresh(self) -> None:
        """Show below the control why the vehicle is invalid. Raises InvalidInputError."""
        with self._section.catching():
            self.read()

    def read(self) -> Vehicle:
        """The vehicle chosen. Raises InvalidInputError."""
        with self._section.checking():
            return self._choice.read()

    def write(self, chosen: Vehicle, base: Vehicle) -> None:
        """Show a vehicle; the menu also offers one that only a preset has."""
        self._choice.offer(_labels((*CATALOGUE, *(own for own in (base, chosen) if own not in CATALOGUE))))
        self._choice.write(chosen, base)

    def draw(self, picture: Picture) -> None:
        """Show what the motion uses against the limits of the vehicle."""
        if not self._drawn.changed(picture.motion, picture.preset.vehicle, picture.preset.world):
            return
        head = _cells("", "worst", "of the limit" if picture.preset.vehicle != vehicle.FREE else "", "at")
        rows = head + "".join(
            _row(use) for use in vehicle.uses(picture.motion, picture.preset.vehicle, world=picture.preset.world)
        )
        style = "padding:0.1em 0.9em 0.6em;font-size:0.78em;line-height:1.45;font-variant-numeric:tabular-nums"
        content = f'<div style="{style}"><table style="border-collapse:collapse">{rows}</table></div>'
        if content != self._table.content:
            self._table.content = content


def _labels(vehicles: tuple[Vehicle, ...]) -> dict[Vehicle, str]:
    """The label of each vehicle: its name, with an addition if another vehicle has the same name."""
    labels: dict[Vehicle, str] = {}
    for candidate in vehicles:
        label = NO_LIMITS if candidate == vehicle.FREE else candidate.name
        while label in labels.values():
            label += " (of the preset)"
        labels.setdefault(candidate, label)
    return labels


def _row(use: vehicle.Use) -> str:
    worst, when = f"{significant(use.reached)} {SHORT_UNITS.get(use.unit, use.unit)}", f"{use.at:.1f} s"
    name = SHORT_NAMES.get(use.name, use.name)
    if use.allowed is None:
        return _cells(name, worst, "", when)
    mark, colour = ("✕", palette.ERROR) if use.broken else ("✓", palette.GOOD)
    share = 100 * min(use.share, 1.0)
    allowed = f"{BAR.format(palette.BAR_TRACK, share, colour)} {'≥' if use.least else '≤'} {significant(use.allowed)}"
    return _cells(f'<span style="color:{colour}">{mark}</span> {name}', worst, allowed, when)


def _cells(*cells: str) -> str:
    return "<tr>" + "".join(f'<td style="{CELL}">{cell}</td>' for cell in cells) + "</tr>"
