"""The gains in the paper's units: q, V and P₀ of the Riccati observer, k1, ρ1 and ρ2 of the filter (eq. 8–9)."""

from explorer.widgets.dials import LogDial
from explorer.widgets.form import Form
from explorer.widgets.section import Section, complaining
from rangenav.attitude import AttitudeGains
from rangenav.gains import Gains
from rangenav.riccati import P0_RANGE, Q_RANGE, V_RANGE, Blocks, RiccatiGains

BLOCKS = {"xi": "ξ", "position": "p", "velocity": "v", "gravity": "g"}
K1_LIMITS, RHO1_LIMITS, RHO2_LIMITS = (0.05, 50.0), (0.01, 100.0), (1e-4, 10.0)
"""Ranges of the sliders, narrower than what the model accepts."""


class PaperDials:
    """A dial for each gain. As in the paper, q is an inverse measurement noise, and V is the process noise."""

    def __init__(self, form: Form) -> None:
        self.noise = section = Section(form, "Riccati observer: q and V")
        with section:
            hint = (
                "q (1/(m⁴ s)): inverse noise density of y = ½d² in Ṗ = AP + PAᵀ − PCᵀqCP + V (paper, eq. 8). "
                "Larger trusts the ranges more."
            )
            self._q = LogDial(section, "q", Q_RANGE, hint=hint)
            self._process = Section(form, "Process noise V", expanded=False)
            meaning = (
                "process noise density per second: larger forgets faster, follows faster, is noisier (paper, eq. 8)"
            )
            with self._process as section:
                self._v = _blocks(section, "V", V_RANGE, meaning)
        self._start = section = Section(form, "Initial covariance P₀", expanded=False)
        with section:
            meaning = "diagonal of P(0): how wrong the initial estimate may be, squared (paper, eq. 8)"
            self._p0 = _blocks(section, "P₀", P0_RANGE, meaning)

    def add_attitude(self, form: Form) -> None:
        """Add the dials of the attitude filter to the folder that is being built."""
        self.attitude = section = Section(form)
        with section:
            hint = "k1 (1/s): scales the whole correction σ = ρ1 (m × R̂ᵀm) + ρ2 (ĝ × R̂ᵀg) (paper, eq. 9)."
            self._k1 = LogDial(section, "k1", K1_LIMITS, hint=hint, unit="1/s")
            hint = "ρ1 (no unit): weight of the magnetometer, whose vector has length 1 (paper, eq. 9)."
            self._rho1 = LogDial(section, "ρ1", RHO1_LIMITS, hint=hint)
            hint = "ρ2 (s⁴/m²): weight of the estimated gravity. It multiplies |g|² ≈ 96, so 1 is stiff at low rates."
            self._rho2 = LogDial(section, "ρ2", RHO2_LIMITS, hint=hint)

    def refresh(self) -> None:
        """Show below the dials why the gains are invalid. Raises InvalidInputError."""
        with complaining(self.noise, self._process, self._start, self.attitude):
            self.read()

    def read(self) -> Gains:
        """The gains chosen, in constant mode without a schedule. Raises InvalidInputError."""
        with self.noise.checking():
            q = RiccatiGains(q=self._q.read()).q
        with self._process.checking():
            v = RiccatiGains(v=_read_blocks(self._v)).v
        with self._start.checking():
            riccati = RiccatiGains(q=q, v=v, p0=_read_blocks(self._p0))
        with self.attitude.checking():
            attitude = AttitudeGains(k1=self._k1.read(), rho1=self._rho1.read(), rho2=self._rho2.read())
        return Gains(riccati=riccati, attitude=attitude)

    def write(self, gains: Gains, base: Gains) -> None:
        """Show gains."""
        current, original = gains.riccati, base.riccati
        self._q.write(current.q, original.q)
        for name in BLOCKS:
            self._v[name].write(getattr(current.v, name), getattr(original.v, name))
            self._p0[name].write(getattr(current.p0, name), getattr(original.p0, name))
        self._k1.write(gains.attitude.k1, base.attitude.k1)
        self._rho1.write(gains.attitude.rho1, base.attitude.rho1)
        self._rho2.write(gains.attitude.rho2, base.attitude.rho2)

    def show(self, visible: bool, *, noise: bool) -> None:
        """Show or hide the dials; `noise` is whether q and V are used, which noise-matched gains leave unused."""
        self.noise.show(visible and noise)
        self._start.show(visible)
        self.attitude.show(visible)


def _blocks(section: Section, name: str, limits: tuple[float, float], meaning: str) -> dict[str, LogDial]:
    """One dial for each block of the 13-state."""

    def dial(block: str, letter: str) -> LogDial:
        hint = f"{name}: the {block} block, in the square of its unit: {meaning}."
        return LogDial(section, f"{name}({letter})", limits, hint=hint)

    return {block: dial(block, letter) for block, letter in BLOCKS.items()}


def _read_blocks(dials: dict[str, LogDial]) -> Blocks:
    return Blocks(**{block: dial.read() for block, dial in dials.items()})
