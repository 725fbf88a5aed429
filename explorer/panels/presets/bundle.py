"""Export: the settings on the page, certified from the written bytes, as one zip with the formats chosen.

What is refused has its cures as buttons: each changes what is on the page, and exports again.
"""

from dataclasses import replace
from functools import partial

from explorer.model.changes import with_changes
from explorer.model.compute import Picture
from explorer.model.jobs import Jobs
from explorer.model.settings import effective
from explorer.storage.bundle import Bundle, Refused, Send, motion_in, pack
from explorer.storage.catalog import Catalog
from explorer.storage.preset_file import file_name
from explorer.widgets.controls import Number, Switch
from explorer.widgets.form import Action, Form
from explorer.widgets.html import NOTE, bullets, upper_first
from explorer.widgets.page import Page
from explorer.widgets.progress import ProgressPanel
from explorer.widgets.section import Section
from rangenav import formats
from rangenav.certificate.cures import Cure
from rangenav.formats import ExportOptions, Format, hover_ramps
from rangenav.inputs import require_within
from rangenav.preset import Preset
from rangenav.progress import Cancelled, Progress
from rangenav.repair import ExportTarget
from rangenav.vehicle import CRAZYFLIE

FORMAT_HINT = "Goes into the zip beside the preset and its certificate. {}"
ALL_HINT = "Chooses every format, or none."
UNCERTIFIED_HINT = (
    "A file that misses the requirement is refused, with what is missing and what would cure it. "
    "Switched on, it is written with “uncertified” in its name."
)
RAMP_LABEL = "ramps"
RAMP_HINT = (
    "From hover into the path, and back to hover, in a reference or a polynomial file. Longer ramps ask less of the "
    "vehicle; the certificate covers what lies between them."
)
EXPORT_HINT = "Certifies the written bytes, then downloads the zip."
CURE_HINT = "Makes this change on the page, and exports again. Ctrl+Z takes it back."
EXPORTING = "export"
LOOK = "no small change cures that; a larger one may"
LOOK_HINT = "Looks for a change of the motion that meets the requirement, and shows it below the verdict."


def _nothing() -> None:
    """Look for nothing: where there is no repair."""


def choices() -> tuple[Format, ...]:
    """The formats with a switch: all that are written but the preset, which is in every zip."""
    return tuple(row for row in formats.writable() if row.certified_as != "preset")


class BundlePanel:
    """A switch for each format, the ramps, one for files that miss the requirement, a button, and what was refused."""

    def __init__(
        self, form: Form, catalog: Catalog, page: Page, jobs: Jobs, send: Send, *, repair: Action = _nothing
    ) -> None:
        """`repair` looks for a change that makes the motion observable."""
        self._form, self._catalog, self._page, self._send = form, catalog, page, send
        self._repair = repair
        self._section = section = Section(form, "Download with certificate", expanded=False)
        self.exported: tuple[str, bytes] | None = None
        """The format and the content of the motion that was exported last."""
        self._cures_section: Section | None = None
        self._cured: Preset | None = None
        self._packed: Preset | None = None
        """What the zip that is named holds."""
        """What the cures on the page are for."""
        with section:
            form.buttons("formats", {"all": self._all, "none": self._none}, hint=ALL_HINT)
            self.formats = {
                row.name: Switch(section, row.label, hint=FORMAT_HINT.format(row.hint)) for row in choices()
            }
            self._ramp = Number(section, f"{RAMP_LABEL} (s)", hint=RAMP_HINT)
            self._ramp.show(formats.RAMP)
            self._even_uncertified = Switch(
                section, "write files that miss the requirement, too", hint=UNCERTIFIED_HINT
            )
            form.button("Export as a zip", self._export, hint=EXPORT_HINT)
            self._progress = ProgressPanel(form, jobs)
            self._result_line = form.gui.add_html("", visible=False)
        section.check(self._ramp_length)
        form.command("Export as a zip", self._export)

    def draw(self, picture: Picture) -> None:
        """Take the cures and the name of the zip from the page when they are those of something else."""
        shown = effective(picture.settings)
        if self._cured is not None and shown != self._cured:
            self._forget_cures()
        if self._packed is not None and shown != self._packed:
            self._packed, self._result_line.visible = None, False

    def forget_preset(self) -> None:
        """Drop the name of the zip and the cures: they belong to a preset that is not on the page any more."""
        self._result_line.visible = False
        self._forget_cures()

    def target(self, preset: Preset) -> ExportTarget | None:
        """The format of a motion that a repair has in mind: one that is switched on, or what the vehicle flies."""
        motions = [row.name for row in choices() if row.certified_as == "motion" and self.formats[row.name].read()]
        if not motions and preset.vehicle.name == CRAZYFLIE.name:
            motions = ["polynomial"]
        if not motions:
            return None
        return ExportTarget(format_name=motions[0], options=ExportOptions(ramp=self._ramp_length()))

    def choose(self, format_name: str) -> None:
        """Switch a format on."""
        self.formats[format_name].show(True)

    def _all(self) -> None:
        for switch in self.formats.values():
            switch.show(True)

    def _none(self) -> None:
        for switch in self.formats.values():
            switch.show(False)

    def _ramp_length(self) -> float:
        """s. Raises ValueError for a length that no file takes."""
        length = self._ramp.read()
        require_within(RAMP_LABEL, length, hover_ramps.SHORTEST, hover_ramps.LONGEST, "s")
        return length

    def _export(self) -> None:
        self._result_line.visible = False
        with self._section.answering():
            self._start(ExportOptions(ramp=self._ramp_length()))

    def _start(self, options: ExportOptions) -> None:
        settings, even_uncertified = self._page.read(), self._even_uncertified.read()
        names = tuple(name for name, switch in self.formats.items() if switch.read())
        shown = effective(settings)
        stem = file_name(settings.origin, shown, self._catalog.presets[settings.origin]).removesuffix(".toml")
        self._result_line.visible = False
        self._forget_cures()

        def work(progress: Progress, cancelled: Cancelled) -> Bundle:
            return pack(
                shown,
                stem,
                names,
                options=options,
                uncertified=even_uncertified,
                progress=progress,
                cancelled=cancelled,
            )

        self._progress.start(EXPORTING, work, partial(self._done, shown, names), self._refuse)

    def _refuse(self, reason: str) -> None:
        """Show a line for each failure, until something else is on the page."""
        first, *more = reason.split("; ")
        head, refused, rest = first.partition(": refused: ")
        self._section.answer(f"{head}{refused}".removesuffix(": "), more=((rest,) if rest else ()) + tuple(more))

    def _done(self, shown: Preset, names: tuple[str, ...], bundle: Bundle) -> None:
        if bundle.content:
            self.exported = motion_in(bundle, names)
            self._send(bundle.name, bundle.content)
            sentences = (f"{bundle.name}, {len(bundle.content)} bytes", *bundle.notes)
            self._result_line.content = NOTE.format(bullets(sentences))
            self._result_line.visible, self._packed = True, shown
        elif bundle.refused:
            self._refuse(bundle.refused[0].reason)
        if bundle.refused:
            self._show_cures(shown, bundle.refused[0])

    def _show_cures(self, shown: Preset, refused: Refused) -> None:
        """A button for each cure of the first file that was refused."""
        self._cured = shown
        with self._section:
            self._cures_section = section = Section(
                self._form, f"What cures it ({formats.row(refused.format_name).label})"
            )
        with section:
            for cure in refused.cures:
                self._form.button(_label(cure), partial(self._cure, shown, cure), hint=CURE_HINT)
            if not refused.cures:
                self._form.gui.add_html(NOTE.format(bullets((LOOK,))))
                self._form.button("Make it observable", self._repair, hint=LOOK_HINT, away=True)

    def _cure(self, shown: Preset, cure: Cure) -> None:
        with self._section.answering():
            self._page.write(with_changes(self._page.read(), shown, cure.preset))
            self._ramp.show(cure.options.ramp)
            if cure.format_name not in ("preset", *(name for name, switch in self.formats.items() if switch.read())):
                self._none()
                self.choose(cure.format_name)
            self._start(replace(cure.options, ramp=self._ramp.read()))

    def _forget_cures(self) -> None:
        self._cured = None
        if self._cures_section is not None:
            self._cures_section.remove()
            self._cures_section = None


def _label(cure: Cure) -> str:
    """The cure as the label of a button."""
    return upper_first(cure.text)
