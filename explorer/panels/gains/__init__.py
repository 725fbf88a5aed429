"""The Gains tab: the cascade's gains in the paper's units or in physical units. A preset stores the paper's gains."""

from functools import partial

from msgspec.structs import replace

from explorer.model.compute import Picture
from explorer.model.gain_units import context_of
from explorer.model.glossary import PAPER_GAINS
from explorer.model.settings import GainUnits, Settings
from explorer.panels.gains import summary
from explorer.panels.gains.paper_units import PaperDials
from explorer.panels.gains.physical_units import PhysicalDials
from explorer.panels.gains.schedule import ScheduleDials
from explorer.widgets.controls import Choice
from explorer.widgets.form import Form
from explorer.widgets.html import NOTE
from explorer.widgets.section import Section
from rangenav.gains import Gains

UNITS_LABELS: dict[GainUnits, str] = {"paper": "the paper's letters", "physical": "physical quantities"}
MODE_LABELS = {"constant": "constant (the paper's theorem)", "noise-matched": "noise-matched (outside it)"}


class GainsPanel:
    """All gains of the cascade, in one of two kinds of units."""

    def __init__(self, form: Form) -> None:
        self._section = section = Section(form)
        with section:
            units, mode = PAPER_GAINS["gain units"], PAPER_GAINS["gain mode"]
            self.units_choice = Choice(section, units.caption, UNITS_LABELS, hint=units.hint)
            self.mode = Choice(section, mode.caption, MODE_LABELS, hint=mode.hint)
            self.mode_line = form.gui.add_html("")
        self.paper_dials, self.physical_dials = PaperDials(form), PhysicalDials(form)
        with Section(form, "Attitude filter"):
            self.paper_dials.add_attitude(form)
            self.physical_dials.add_attitude(form)
            self._rates = form.gui.add_html("")
            self.schedule_dials = ScheduleDials(form)
        self.other_units_section = Section(form, summary.OTHER_UNITS["paper"])
        with self.other_units_section:
            self.other_units_table = form.gui.add_html("")
        self.units: GainUnits = "paper"
        """The units in use."""
        self._picture: Picture | None = None
        self._gains = self._base = Gains()

    def refresh(self, without_gains: Settings) -> None:
        """Show the gains in the units chosen, on the dials in use; physical units depend on the other settings.

        Raises InvalidInputError after showing the reason below the control.
        """
        with self._section.catching():
            _, chosen_units = self.mode.read(), self.units_choice.read()
        self._refresh_dials(without_gains)
        self.schedule_dials.refresh(self._unscheduled().attitude)
        self._gains = self.read(without_gains).preset.gains
        if chosen_units != self.units:
            self._show_units(chosen_units)
            if chosen_units == "physical":
                self._refresh_dials(without_gains)
            if self._picture is not None:
                self.draw(self._picture)
        self._hide_unused(self._gains)

    def read(self, without_gains: Settings) -> Settings:
        """The settings with the gains on the dials on the page. Raises InvalidInputError."""
        with self._section.checking():
            mode = self.mode.read()
        unscheduled = self._unscheduled()
        gains = replace(unscheduled, mode=mode, attitude=self.schedule_dials.read(unscheduled.attitude))
        drafts = replace(without_gains.drafts, schedule=self.schedule_dials.draft)
        return replace(without_gains, preset=replace(without_gains.preset, gains=gains), drafts=drafts)

    def write(self, settings: Settings, base: Gains) -> None:
        """Show the gains of some settings, in the units in use."""
        gains = settings.preset.gains
        self._gains, self._base = gains, base
        self.mode.write(gains.mode, base.mode)
        self.schedule_dials.write(gains.attitude.schedule, base.attitude.schedule, settings.drafts.schedule)
        self._show_units(self.units)
        self._hide_unused(gains)

    def use_units(self, units: GainUnits) -> None:
        """Show the gains in these units from now on."""
        self.units_choice.write(units, None)
        self._show_units(units)
        self._hide_unused(self._gains)

    def draw(self, picture: Picture) -> None:
        """Show what follows from the gains."""
        self._picture = picture
        for line, content in (
            (self._rates, summary.rates(picture, self.units)),
            (self.other_units_table, summary.in_other_units(picture, self.units)),
        ):
            if content != line.content:
                line.content = content

    def _refresh_dials(self, without_gains: Settings) -> None:
        if self.units == "paper":
            self.paper_dials.refresh()
        else:
            self.physical_dials.refresh(partial(context_of, without_gains))

    def _unscheduled(self) -> Gains:
        """The gains on the dials of the units in use, in constant mode without a schedule."""
        return self.paper_dials.read() if self.units == "paper" else self.physical_dials.read()

    def _show_units(self, units: GainUnits) -> None:
        """Show the same gains on the dials of these units."""
        self.units = units
        self.other_units_section.caption(summary.OTHER_UNITS[units])
        if units == "paper":
            self.paper_dials.write(self._gains, self._base)
        else:
            unscheduled = replace(self._gains.attitude, schedule=None)
            self.physical_dials.write(replace(self._gains, mode="constant", attitude=unscheduled), self._base)

    def _hide_unused(self, gains: Gains) -> None:
        """Show the dials that are in use, and hide the others."""
        noise = gains.mode == "constant"
        self.paper_dials.show(self.units == "paper", noise=noise)
        self.physical_dials.show(self.units == "physical", noise=noise)
        text = NOTE.format(summary.MODE_TEXTS[gains.mode])
        if text != self.mode_line.content:
            self.mode_line.content = text
