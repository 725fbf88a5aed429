"""The gains in the paper's units: q, V and P₀ of the Riccati observer, k1, ρ1 and ρ2 of the filter (eq. 8–9)."""

from explorer.model.glossary import PAPER_GAINS
from explorer.model.glossary.gains import BLOCKS
from explorer.widgets.dials import LogDial
from explorer.widgets.form import Form
from explorer.widgets.section import Section, complaining
from rangenav.attitude import AttitudeGains
from rangenav.gains import Gains
from rangenav.number_format import significant
from rangenav.riccati import P0_RANGE, Q_RANGE, V_RANGE, Blocks, RiccatiGains

PROCESS, START = "Process noise V", "Initial variance P₀"
K1_LIMITS, RHO1_LIMITS, RHO2_LIMITS = (0.05, 50.0), (0.01, 100.0), (1e-4, 10.0)
"""Ranges of the sliders, narrower than what the model accepts."""


class PaperDials:
    """A dial for each gain. As in the paper, q is an inverse measurement noise, and V is the process noise."""

    def __init__(self, form: Form) -> None:
        self.noise = section = Section(form, "Riccati observer: q and V")
        with section:
            self._q = _dial(section, "q", Q_RANGE)
            self._process = Section(form, PROCESS, expanded=False)
            with self._process as section:
                self._v = {block: _dial(section, f"v {block}", V_RANGE) for block in BLOCKS}
        self._start = section = Section(form, START, expanded=False)
        with section:
            self._p0 = {block: _dial(section, f"p0 {block}", P0_RANGE) for block in BLOCKS}

    def add_attitude(self, form: Form) -> None:
        """Add the dials of the attitude filter to the folder that is being built."""
        self.attitude = section = Section(form)
        with section:
            self._k1 = _dial(section, "k1", K1_LIMITS)
            self._rho1 = _dial(section, "rho1", RHO1_LIMITS)
            self._rho2 = _dial(section, "rho2", RHO2_LIMITS)

    def refresh(self) -> None:
        """Show below the dials why the gains are invalid. Raises InvalidInputError."""
        with complaining(self.noise, self._process, self._start, self.attitude):
            riccati = self.read().riccati
        self._describe(riccati)

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
        self._describe(current)

    def _describe(self, riccati: RiccatiGains) -> None:
        """Say in the folded headings what is inside."""
        self._process.caption(f"{PROCESS}: {_span(riccati.v)}")
        self._start.caption(f"{START}: {_span(riccati.p0)}")

    def show(self, visible: bool, *, noise: bool) -> None:
        """Show or hide the dials; `noise` is whether q and V are used, which noise-matched gains leave unused."""
        self.noise.show(visible and noise)
        self._start.show(visible)
        self.attitude.show(visible)


def _dial(section: Section, key: str, limits: tuple[float, float]) -> LogDial:
    """The dial of a gain, with the label and the hint of its term."""
    term = PAPER_GAINS[key]
    return LogDial(section, term.caption, limits, hint=term.hint)


def _span(blocks: Blocks) -> str:
    """The least and the largest of the values."""
    values = [getattr(blocks, block) for block in BLOCKS]
    low, high = significant(min(values), 2), significant(max(values), 2)
    return low if low == high else f"{low} to {high}"


def _read_blocks(dials: dict[str, LogDial]) -> Blocks:
    return Blocks(**{block: dial.read() for block, dial in dials.items()})
