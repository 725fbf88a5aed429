"""A schedule of the gain k1: high while the measured vectors differ from the expected ones, low once they agree."""

from explorer.model.glossary import PAPER_GAINS
from explorer.widgets.controls import Switch
from explorer.widgets.dials import LogDial
from explorer.widgets.form import Form
from explorer.widgets.html import NOTE
from explorer.widgets.section import Section
from rangenav.attitude import HALFWAY_RANGE, MEMORY_RANGE, AttitudeGains, Schedule

STEADY_LIMITS = (0.01, 50.0)
EXPLANATION = (
    "k1 falls to its final value as the misalignment, a smoothed mean of 1 − cos of the angles to the magnetic field "
    "and to gravity, falls. The theorem assumes a constant k1: of a scheduled one it says nothing."
)


class ScheduleDials:
    """A switch for the schedule, and three dials. The values of the dials stay while the schedule is off."""

    def __init__(self, form: Form) -> None:
        self._section = Section(form)
        with self._section as section:
            self.enabled = Switch(section, PAPER_GAINS["schedule"].caption, hint=PAPER_GAINS["schedule"].hint)
            self.dials_section = Section(form)
        with self.dials_section as section:
            form.gui.add_html(NOTE.format(EXPLANATION))
            steady, halfway, memory = (PAPER_GAINS[name] for name in ("steady", "halfway", "memory"))
            self.steady = LogDial(section, steady.caption, STEADY_LIMITS, hint=steady.hint)
            self.halfway = LogDial(section, halfway.caption, HALFWAY_RANGE, hint=halfway.hint)
            self._memory = LogDial(section, memory.caption, MEMORY_RANGE, hint=memory.hint)
        self._last_valid = Schedule()

    @property
    def draft(self) -> Schedule:
        """The schedule on the dials while it is switched off; the default schedule while it is switched on."""
        return Schedule() if self.enabled.read() else self._last_valid

    def refresh(self, gains: AttitudeGains) -> None:
        """Show the dials if the switch is on. Raises InvalidInputError after showing the reason below the dials."""
        on = self.enabled.read()
        self.dials_section.show(on)
        if on:
            with self.dials_section.catching():
                self._last_valid = self.read(gains).schedule or self._last_valid

    def read(self, gains: AttitudeGains) -> AttitudeGains:
        """The gains with the schedule chosen. Raises InvalidInputError."""
        if not self.enabled.read():
            return gains
        with self.dials_section.checking():
            steady, halfway, memory = self.steady.read(), self.halfway.read(), self._memory.read()
            schedule = Schedule(steady=steady, halfway=halfway, memory=memory)
            return AttitudeGains(k1=gains.k1, rho1=gains.rho1, rho2=gains.rho2, schedule=schedule)

    def write(self, schedule: Schedule | None, base: Schedule | None, draft: Schedule) -> None:
        """Show a schedule; if there is none, show the draft with the switch off."""
        self.enabled.write(schedule is not None, base is not None)
        self._last_valid, default = schedule or draft, base or Schedule()
        self.steady.write(self._last_valid.steady, default.steady)
        self.halfway.write(self._last_valid.halfway, default.halfway)
        self._memory.write(self._last_valid.memory, default.memory)
        self.dials_section.show(schedule is not None)
