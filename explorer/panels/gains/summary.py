"""What follows from the gains: time constants, stiffness, and the same gains in the units that are not in use."""

import html

import numpy as np
from msgspec.structs import replace

from explorer.model import palette
from explorer.model.compute import Picture
from explorer.model.gain_units import context_of
from explorer.model.glossary import PAPER_GAINS, in_labels
from explorer.model.glossary.gains import BLOCKS
from explorer.model.settings import GainUnits
from explorer.panels.gains.physical_units import labelled_values
from explorer.widgets.dial_control import DIGITS
from explorer.widgets.html import NOTE, table
from rangenav import attitude
from rangenav.gains import Gains
from rangenav.number_format import quantity, significant

MODE_TEXTS = {
    "constant": "q and V stay as they are set, as the theorem assumes.",
    "noise-matched": (
        "q and V are worked out at every sample from the noise in the Sensors tab, at the current estimate. So their "
        "own dials are not shown; P₀ and the attitude filter are as set. Usually more accurate, but the gain then "
        "depends on the estimate, and the theorem says nothing about it. Where the ranges contradict the start, "
        "constant gains with q and V as set run for some seconds."
    ),
}
OTHER_UNITS: dict[GainUnits, str] = {
    "paper": "The same as physical quantities",
    "physical": "The same in the paper's letters",
}
STIFFNESS_WARNING = f'<div style="color:{palette.WARNING};font-weight:600;margin-top:0.4em">▲ {{}}</div>'


DIAL_NAMES: dict[GainUnits, dict[str, str]] = {
    "paper": {"rho": "ρ"},
    "physical": {
        "lower k1 or rho2": "raise the slowest time constant T or lower the gravity over magnetometer weight",
        "lower k1 or rho1": "raise the slowest time constant T",
    },
}
"""Names in the library's sentence → names of the dials that are shown."""


def rates(picture: Picture, units: GainUnits = "paper") -> str:
    """The time constants of a small attitude error, for a schedule at both its ends, and a warning of stiffness."""
    p = picture.preset
    gains, gravity_squared = p.gains.attitude, float(np.dot(p.world.gravity, p.world.gravity))
    unscheduled, ends = replace(gains, schedule=None), [(gains.k1, picture.attitude_time_constants)]
    if gains.schedule is not None:
        form = "printed" if picture.settings.printed.attitude_rate else "derived"
        ends = [
            (gains.k1, attitude.time_constants(unscheduled, p.world, form)),
            (gains.schedule.steady, picture.attitude_time_constants),
        ]
    printed = ", <b>as printed</b>" if picture.settings.printed.attitude_rate else ""
    rows = [
        (f"at k1 = {significant(k1, DIGITS)}", ", ".join(significant(one) for one in constants) + " s")
        for k1, constants in ends
    ]
    text = f"time constants of a small attitude error{printed}:{table((), rows)}"
    weight = f"weight of gravity ρ2·|g|² = <b>{significant(gains.rho2 * gravity_squared)}</b>"
    text += (
        f"{weight} with |g|² = {gravity_squared:.1f}; weight of the magnetometer ρ1 = {significant(gains.rho1, DIGITS)}"
    )
    warning = attitude.stiffness(gains, p.world, imu_rate=p.sensors.imu_rate, mag_rate=p.sensors.mag_rate)
    if warning is None:
        return NOTE.format(text)
    for library_name, dial_name in DIAL_NAMES[units].items():
        warning = warning.replace(library_name, dial_name)
    return NOTE.format(text + STIFFNESS_WARNING.format(html.escape(warning)))


def in_other_units(picture: Picture, units: GainUnits) -> str:
    """A table of the gains of a picture in the units that are not in use."""
    try:
        context = context_of(picture.settings)
    except ValueError as error:
        return NOTE.format(html.escape(f"not converted: the path's typical {error}"))
    gains = picture.preset.gains
    try:
        entries = labelled_values(gains, context) if units == "paper" else _paper_values(gains)
    except ValueError as error:
        return NOTE.format(html.escape(f"not converted: {in_labels(str(error))}"))
    cells = [(label, f"{significant(value, DIGITS)} {unit}".rstrip()) for label, value, unit in entries]
    distance, speed = quantity(context.at.distance, "m"), quantity(context.at.speed, "m/s")
    heading = f"at the path's typical {distance} from the anchor and {speed}"
    return NOTE.format(html.escape(heading) + table((), cells))


def _paper_values(gains: Gains) -> list[tuple[str, float, str]]:
    riccati, attitude_gains = gains.riccati, gains.attitude
    values = {
        "q": riccati.q,
        **{f"v {block}": getattr(riccati.v, block) for block in BLOCKS},
        **{f"p0 {block}": getattr(riccati.p0, block) for block in BLOCKS},
        **{name: getattr(attitude_gains, name) for name in ("k1", "rho1", "rho2")},
    }
    return [(PAPER_GAINS[name].label, value, PAPER_GAINS[name].unit) for name, value in values.items()]
