"""Export: the settings on the page, certified from the written bytes, as one zip with the formats chosen."""

from explorer.model.jobs import Jobs
from explorer.model.settings import effective
from explorer.storage.bundle import Bundle, Send, pack
from explorer.storage.catalog import Catalog
from explorer.storage.preset_file import file_name
from explorer.widgets.controls import Switch
from explorer.widgets.form import Form
from explorer.widgets.html import NOTE, bullets
from explorer.widgets.page import Page
from explorer.widgets.section import Section
from rangenav import formats
from rangenav.formats import Format
from rangenav.progress import Cancelled, Progress

FORMAT_HINT = "Goes into the zip beside the preset and its certificate. {}"
ALL_HINT = "Chooses every format, or none."
UNCERTIFIED_HINT = (
    "Files that miss the requirement are refused, with what is missing and what would help. "
    "Switched on, they are written with “uncertified” in their names."
)


def choices() -> tuple[Format, ...]:
    """The formats with a switch: all that are written but the preset, which is in every zip."""
    return tuple(row for row in formats.writable() if row.certified_as != "preset")


class BundlePanel:
    """A switch for each format, one for files that miss the requirement, and a button."""

    def __init__(self, form: Form, catalog: Catalog, page: Page, jobs: Jobs, send: Send) -> None:
        self._catalog, self._page, self._jobs, self._send = catalog, page, jobs, send
        self._section = section = Section(form, "Download with certificate", expanded=False)
        with section:
            form.buttons("formats", {"all": self._all, "none": self._none}, hint=ALL_HINT)
            self.formats = {
                row.name: Switch(section, row.label, hint=FORMAT_HINT.format(row.hint)) for row in choices()
            }
            self._even_uncertified = Switch(section, "even if uncertified", hint=UNCERTIFIED_HINT)
            form.button("Export as a zip", self._export, hint="Certifies the written bytes, then downloads the zip.")
            self._result_line = form.gui.add_html("", visible=False)
        form.command("Export as a zip", self._export)

    def _all(self) -> None:
        for switch in self.formats.values():
            switch.show(True)

    def _none(self) -> None:
        for switch in self.formats.values():
            switch.show(False)

    def _export(self) -> None:
        with self._section.answering():
            settings, even_uncertified = self._page.read(), self._even_uncertified.read()
            names = tuple(name for name, switch in self.formats.items() if switch.read())
        shown = effective(settings)
        stem = file_name(settings.origin, shown, self._catalog.presets[settings.origin]).removesuffix(".toml")
        self._result_line.visible = False

        def work(progress: Progress, cancelled: Cancelled) -> Bundle:
            return pack(shown, stem, names, uncertified=even_uncertified, progress=progress, cancelled=cancelled)

        self._jobs.start("export", work, self._done, self._refuse)

    def _refuse(self, reason: str) -> None:
        """Show a line for each failure, until something else is on the page."""
        first, *more = reason.split("; ")
        head, refused, rest = first.partition(": refused: ")
        self._section.answer(f"{head}{refused}".removesuffix(": "), more=((rest,) if rest else ()) + tuple(more))

    def _done(self, bundle: Bundle) -> None:
        self._send(bundle.name, bundle.content)
        self._result_line.content = NOTE.format(bullets((f"{bundle.name}, {len(bundle.content)} bytes", *bundle.notes)))
        self._result_line.visible = True
