"""The gains in physical units: noise, errors of the start, factors, time constant, weight (rangenav.physical_gains).

The panel keeps the gains and shows physical values computed from them. A value that the visitor moves is converted back
into gains; all other gains stay the same to the last digit. When the path, the world or the rates change, the same
gains have other physical values.
"""

from collections.abc import Callable

from msgspec.structs import asdict, replace

from explorer.model.gain_units import GAIN_LIMITS, GainContext, in_paper_units, in_physical_units
from explorer.model.glossary import PHYSICAL_GAINS, in_labels
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.dials import LogDial
from explorer.widgets.form import Form
from explorer.widgets.section import Section, complaining
from rangenav.gains import Gains
from rangenav.physical_gains import PhysicalGains

NOISE = ("range_sigma", "accel_sigma", "gyro_sigma")
FACTORS = ("position_factor", "velocity_factor")
PRIOR = ("position_box", "velocity_box", "gravity_box", "xi_factor")
ATTITUDE = ("attitude_time", "gravity_weight")


class PhysicalDials:
    """A dial for each physical value."""

    def __init__(self, form: Form) -> None:
        self.dials: dict[str, LogDial] = {}
        self.sections: dict[str, Section] = {}
        self.noise = Section(form, "Noise that the gains assume: q and V")
        self._add(self.noise, NOISE)
        with self.noise:
            factors = Section(form, "Extra drift: factors on V", expanded=False)
        self._add(factors, FACTORS)
        self._prior = Section(form, "Initial errors that the gains assume: P₀", expanded=False)
        self._add(self._prior, PRIOR)
        self._context: GainContext | None = None
        """The context in which the values shown were computed; None while written gains are not shown yet."""

    def _add(self, section: Section, names: tuple[str, ...]) -> None:
        with section:
            for name in names:
                term = PHYSICAL_GAINS[name]
                self.dials[name] = LogDial(section, term.caption, GAIN_LIMITS[name], hint=term.hint)
                self.sections[name] = section

    def add_attitude(self, form: Form) -> None:
        """Add the dials of the attitude filter to the folder that is being built."""
        self.attitude = Section(form)
        self._add(self.attitude, ATTITUDE)

    def write(self, gains: Gains, base: Gains) -> None:
        """Take gains. The next `refresh` shows them, because their physical values depend on the path."""
        self._gains, self._base, self._context = gains, base, None

    def show(self, visible: bool, *, noise: bool) -> None:
        """Show or hide the dials; `noise` is whether q and V are used, which noise-matched gains leave unused."""
        self.noise.show(visible and noise)
        self._prior.show(visible)
        self.attitude.show(visible)

    def refresh(self, current_context: Callable[[], GainContext]) -> None:
        """Take over the values that were moved, and show the values that the gains have in the current context.

        Gains that have no physical values stay as they are. Raises InvalidInputError after showing the reason.
        """
        with complaining(*self._all_sections):
            entered = {} if self._context is None else self._entered()
        moved_dials = {name: value for name, value in entered.items() if value != self._read_values[name]}
        try:
            context = current_context()
        except ValueError as error:
            self._keep_without_values(f"the path's typical {error}", error, moved_dials)
            return
        if context != self._context:
            try:
                self._show_values(context, moved_dials)
            except ValueError as error:
                self._keep_without_values(in_labels(str(error)), error, moved_dials)
                return
            with complaining(*self._all_sections):
                entered = self._entered()
        with complaining(*self._all_sections):
            self._gains = self._gains_from(entered, context)
        self._read_values = entered

    def read(self) -> Gains:
        """The gains as written or as moved, in constant mode without a schedule. Raises InvalidInputError."""
        return self._gains if self._context is None else self._gains_from(self._entered(), self._context)

    @property
    def _all_sections(self) -> tuple[Section, ...]:
        return tuple(dict.fromkeys(self.sections.values()))

    def _keep_without_values(self, why: str, error: ValueError, moved_dials: dict[str, float]) -> None:
        """Leave the gains as they are, and show why they have no physical values. A dial that was moved is refused."""
        self.noise.complaint.say(f"no physical values: {why}")
        if moved_dials:
            raise InvalidInputError from error

    def _entered(self) -> dict[str, float]:
        """The values of the dials."""
        entered = {}
        for name, dial in self.dials.items():
            with self.sections[name].checking():
                entered[name] = dial.read()
        return entered

    def _show_values(self, context: GainContext, moved_dials: dict[str, float]) -> None:
        """Show the values of the gains in a context. Dials that were moved at the same time keep their values; a dial
        that was reset to the preset's value goes on showing the preset's value."""
        before = None if self._context is None else self._base_values
        values = (
            in_physical_units(self._gains, context),
            in_physical_units(self._base, context),
        )  # both, or ValueError before anything is shown
        self._context, self._shown_gains, (self._values, self._base_values) = context, self._gains, values
        for name, dial in self.dials.items():
            value, base, typed = getattr(self._values, name), getattr(self._base_values, name), moved_dials.get(name)
            if typed is not None:
                value = base if typed == getattr(before, name) else typed
            dial.write(value, base)

    def _gains_from(self, entered: dict[str, float], context: GainContext) -> Gains:
        changed = [name for name, value in entered.items() if value != getattr(self._values, name)]
        if not changed:
            return self._shown_gains
        try:
            values: PhysicalGains = replace(self._values, **entered)
            return in_paper_units(values, context, (self._base, self._shown_gains))
        except ValueError as error:
            sentence = str(error)
            cause = next((name for name in changed if name in sentence), changed[0])
            raise InvalidInputError(self.sections[cause].complaint) from ValueError(in_labels(sentence))


def labelled_values(gains: Gains, context: GainContext) -> list[tuple[str, float, str]]:
    """Label, value and unit of every physical value."""
    values = asdict(in_physical_units(gains, context))
    return [(term.label, values[name], term.unit) for name, term in PHYSICAL_GAINS.items()]
