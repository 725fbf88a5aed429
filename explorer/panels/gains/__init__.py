"""The Gains tab: the cascade's gains in the paper's letters or in physical words; the preset stores the letters."""

from functools import partial

from msgspec.structs import replace

from explorer.model.compute import Picture
from explorer.model.gain_units import context_of
from explorer.model.settings import GainUnits, Settings
from explorer.panels.gains import summary
from explorer.panels.gains.paper_units import PaperDials
from explorer.panels.gains.physical_units import PhysicalDials
from explorer.panels.gains.schedule import ScheduleDials
from explorer.widgets.controls import Choice
from explorer.widgets.form import Form, Section
from explorer.widgets.html import NOTE
from rangenav.gains import Gains

LANGUAGES: dict[GainUnits, str] = {"paper": "in the paper's letters", "physical": "in physical words"}
MODES = {"constant": "constant (the paper's theorem)", "noise-matched": "noise-matched (outside it)"}


class GainsPanel:
    """All gains of the cascade, in one of two languages."""

    def __init__(self, form: Form) -> None:
        self._section = section = Section(form)
        with section:
            hint = "Letters or words for the same gains. Switching changes none of them, and is no step to undo."
            self._wanted = Choice(section, "shown", LANGUAGES, hint=hint)
            hint = "Whether q and V stay as they are set (paper, eq. 8), or follow from the noise at the estimate."
            self._mode = Choice(section, "gains", MODES, hint=hint)
            self._mode_words = form.gui.add_html("")
        self._paper, self._physical = PaperDials(form), PhysicalDials(form)
        with Section(form, "Attitude filter"):
            self._paper.add_attitude(form)
            self._physical.add_attitude(form)
            self._rates = form.gui.add_html("")
            self._schedule = ScheduleDials(form)
        self._beside = Section(form, summary.OTHERS["paper"])
        with self._beside:
            self._table = form.gui.add_html("")
        self.units: GainUnits = "paper"
        """The one in use."""
        self._picture: Picture | None = None
        self._gains = self._base = Gains()

    def read(self, others: Settings) -> Settings:
        """Settings with the gains chosen, all else given. Raises Refused after saying why beside the control."""
        with self._section.catching():
            mode, wanted = self._mode.read(), self._wanted.read()
        plain = self._paper.read() if self.units == "paper" else self._physical.read(partial(context_of, others))
        gains = replace(plain, mode=mode, attitude=self._schedule.read(plain.attitude))
        self._gains = gains
        if wanted != self.units:
            self._turn_to(wanted)
            if wanted == "physical":
                self._physical.read(partial(context_of, others))  # shows them
            if self._picture is not None:
                self.draw(self._picture)
        self._arrange(gains)
        drafts = replace(others.drafts, schedule=self._schedule.draft)
        return replace(others, preset=replace(others.preset, gains=gains), drafts=drafts)

    def write(self, settings: Settings, base: Gains) -> None:
        """Show the gains of some settings, in the language in use."""
        gains = settings.preset.gains
        self._gains, self._base = gains, base
        self._mode.write(gains.mode, base.mode)
        self._schedule.write(gains.attitude.schedule, base.attitude.schedule, settings.drafts.schedule)
        self._turn_to(self.units)
        self._arrange(gains)

    def use_units(self, units: GainUnits) -> None:
        """Use a language from now on."""
        self._wanted.write(units, None)
        self._turn_to(units)
        self._arrange(self._gains)

    def draw(self, picture: Picture) -> None:
        """Show what follows from the gains."""
        self._picture = picture
        for line, content in (
            (self._rates, summary.rates(picture, self.units)),
            (self._table, summary.in_other_units(picture, self.units)),
        ):
            if content != line.content:
                line.content = content

    def _turn_to(self, units: GainUnits) -> None:
        """The gains as they are, on the dials of a language."""
        self.units = units
        self._beside.caption(summary.OTHERS[units])
        if units == "paper":
            self._paper.write(self._gains, self._base)
        else:
            plain = replace(self._gains.attitude, schedule=None)
            self._physical.write(replace(self._gains, mode="constant", attitude=plain), self._base)

    def _arrange(self, gains: Gains) -> None:
        """Only what is in use is on the page."""
        noise = gains.mode == "constant"
        self._paper.show(self.units == "paper", noise=noise)
        self._physical.show(self.units == "physical", noise=noise)
        words = NOTE.format(summary.MODE_WORDS[gains.mode])
        if words != self._mode_words.content:
            self._mode_words.content = words
