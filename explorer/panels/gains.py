"""The Gains tab: the Riccati observer's q, v and p0, and the attitude filter's k1, ρ1 and ρ2 (paper, eq. 8–9)."""

from typing import Literal

import numpy as np

from explorer.compute import Picture
from explorer.panels.controls import Choice, LogDial
from explorer.panels.sheet import Section, Sheet
from rangenav.attitude import AttitudeGains, Schedule
from rangenav.gains import Gains
from rangenav.riccati import P0_RANGE, Q_RANGE, V_RANGE, Blocks, RiccatiGains

MODES: dict[Literal["constant", "noise-matched"], str] = {
    "constant": "constant (the paper's theorem)",
    "noise-matched": "noise-matched (outside it)",
}
BLOCKS = {"xi": "ξ", "position": "p", "velocity": "v", "gravity": "g"}
K1_LIMITS, RHO1_LIMITS, RHO2_LIMITS = (0.05, 50.0), (0.01, 100.0), (1e-4, 10.0)
"""Ranges of the sliders, narrower than what the model accepts."""


class GainsPanel:
    """All gains of the cascade."""

    def __init__(self, sheet: Sheet) -> None:
        self._section = section = Section(sheet)
        hint = (
            "constant: q and v below (paper, eq. 8). noise-matched: both follow from the sensors' noise at the current "
            "estimate; better in practice, but the gain then depends on the estimate and the theorem says nothing."
        )
        with section:
            self._mode = Choice(section, "gains", MODES, hint=hint)
        self._riccati = _RiccatiFolder(sheet)
        self._attitude = _AttitudeFolder(sheet)

    def read(self) -> Gains:
        """The gains chosen. Raises Refused after saying why beside the control."""
        with self._section.catching():
            mode = self._mode.read()
        riccati, attitude = self._riccati.read(), self._attitude.read()
        return Gains(mode=mode, riccati=riccati, attitude=attitude)

    def write(self, gains: Gains, base: Gains) -> None:
        """Show gains."""
        self._mode.write(gains.mode, base.mode)
        self._riccati.write(gains.riccati, base.riccati)
        self._attitude.write(gains.attitude, base.attitude)

    def draw(self, picture: Picture) -> None:
        """Show what follows from the gains."""
        self._riccati.draw(picture)
        self._attitude.draw(picture)


class _RiccatiFolder:
    """q, v and p0; here Q is inverse measurement noise and V process noise, unlike Kalman's letters."""

    def __init__(self, sheet: Sheet) -> None:
        self._section = section = Section(sheet, "Riccati observer: q and V")
        with section:
            hint = (
                "q (1/(m⁴ s)): inverse noise density of y = ½d² in Ṗ = AP + PAᵀ − PCᵀqCP + V (paper, eq. 8). "
                "Larger trusts the ranges more."
            )
            self._q = LogDial(section, "q", Q_RANGE, hint=hint)
            why = "process noise density per second: larger forgets faster, follows faster, is noisier (paper, eq. 8)"
            self._v = _blocks(section, "V", V_RANGE, why)
            self._line = sheet.gui.add_markdown("", visible=False)
        self._start = section = Section(sheet, "Initial covariance P₀", expanded=False)
        with section:
            why = "diagonal of P(0): how wrong the initial estimate may be, squared (paper, eq. 8)"
            self._p0 = _blocks(section, "P₀", P0_RANGE, why)

    def read(self) -> RiccatiGains:
        with self._section.catching():
            q, v = self._q.read(), _read_blocks(self._v)
            checked = RiccatiGains(q=q, v=v)
        with self._start.catching():
            return RiccatiGains(q=checked.q, v=checked.v, p0=_read_blocks(self._p0))

    def write(self, gains: RiccatiGains, base: RiccatiGains) -> None:
        self._q.write(gains.q, base.q)
        for name in BLOCKS:
            self._v[name].write(getattr(gains.v, name), getattr(base.v, name))
            self._p0[name].write(getattr(gains.p0, name), getattr(base.p0, name))

    def draw(self, picture: Picture) -> None:
        matched = picture.preset.gains.mode == "noise-matched"
        self._line.visible = matched
        if matched:
            self._line.content = "q and V are not used now: noise-matched gains take theirs from the sensors' noise."


class _AttitudeFolder:
    """k1, ρ1, ρ2 and the time constants they give."""

    def __init__(self, sheet: Sheet) -> None:
        self._section = section = Section(sheet, "Attitude filter")
        with section:
            hint = "k1 (1/s): scales the whole correction σ = ρ1 (m × R̂ᵀm) + ρ2 (ĝ × R̂ᵀg) (paper, eq. 9)."
            self._k1 = LogDial(section, "k1", K1_LIMITS, hint=hint, unit="1/s")
            hint = "ρ1 (no unit): weight of the magnetometer, whose vector has length 1 (paper, eq. 9)."
            self._rho1 = LogDial(section, "ρ1", RHO1_LIMITS, hint=hint)
            hint = "ρ2 (s⁴/m²): weight of the estimated gravity. It multiplies |g|² ≈ 96, so 1 is stiff at low rates."
            self._rho2 = LogDial(section, "ρ2", RHO2_LIMITS, hint=hint)
            self._line = sheet.gui.add_markdown("")
        self._schedule: Schedule | None = None
        """A preset's schedule of k1 is kept as it is: it has no controls yet."""

    def read(self) -> AttitudeGains:
        with self._section.catching():
            k1, rho1, rho2 = self._k1.read(), self._rho1.read(), self._rho2.read()
            return AttitudeGains(k1=k1, rho1=rho1, rho2=rho2, schedule=self._schedule)

    def write(self, gains: AttitudeGains, base: AttitudeGains) -> None:
        self._k1.write(gains.k1, base.k1)
        self._rho1.write(gains.rho1, base.rho1)
        self._rho2.write(gains.rho2, base.rho2)
        self._schedule = gains.schedule

    def draw(self, picture: Picture) -> None:
        rho2 = picture.preset.gains.attitude.rho2
        squared = float(np.dot(picture.preset.world.gravity, picture.preset.world.gravity))
        constants = ", ".join(f"{seconds:.3g}" for seconds in picture.attitude_time_constants)
        printed = " **as printed**" if picture.settings.printed.attitude_rate else ""
        line = f"ρ2·|g|² = **{rho2 * squared:.3g}** (|g|² = {squared:.1f}), beside ρ1\n\n"
        line += f"time constants{printed}: **{constants} s**"
        if line != self._line.content:
            self._line.content = line


def _blocks(section: Section, name: str, limits: tuple[float, float], why: str) -> dict[str, LogDial]:
    """One dial for each block of the 13-state."""

    def dial(block: str, letter: str) -> LogDial:
        hint = f"{name}: the {block} block, in the square of its unit: {why}."
        return LogDial(section, f"{name}({letter})", limits, hint=hint)

    return {block: dial(block, letter) for block, letter in BLOCKS.items()}


def _read_blocks(dials: dict[str, LogDial]) -> Blocks:
    return Blocks(**{block: dial.read() for block, dial in dials.items()})
