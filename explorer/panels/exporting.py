"""Export: what is on the page, certified from its written bytes, as one zip with the formats chosen."""

from explorer.jobs import Cancelled, Jobs, Progress
from explorer.panels.controls import Choice, Switch
from explorer.panels.notes import NOTE, bullets
from explorer.panels.presets import Page
from explorer.panels.sheet import Section, Sheet
from explorer.parcel import EVERYTHING, Parcel, Send, parcel
from explorer.settings import effective
from explorer.shelf import Shelf
from explorer.written import file_name

FORMATS = {
    "": "preset and certificate only",
    "reference": "reference CSV (Agilicious, GTSAM)",
    "polynomial": "polynomials (Crazyflie)",
    "bag": "ROS 2 bag",
    "mcap": "MCAP",
    "tum": "TUM trajectory",
    "euroc": "EuRoC folder",
    "mat": "MATLAB .mat",
    "npz": "NumPy .npz",
    "csv": "plain CSV",
    "log": "log CSV with truth",
    "all": "everything",
}
WHAT = "What goes into the zip beside the preset and its certificate."
MARKED = (
    "Files that miss the requirement are refused, with what is missing and what would help. "
    "Switched on, they are written with “uncertified” in their names."
)


class PackPanel:
    """A format, a switch and a button."""

    def __init__(self, sheet: Sheet, shelf: Shelf, page: Page, jobs: Jobs, send: Send) -> None:
        self._shelf, self._page, self._jobs, self._send = shelf, page, jobs, send
        self._section = section = Section(sheet, "Certified files", expanded=False)
        with section:
            self._format = Choice(section, "with", FORMATS, hint=WHAT)
            self._marked = Switch(section, "even if uncertified", hint=MARKED)
            sheet.button("Export as a zip", self._export, hint="Certifies the written bytes, then downloads the zip.")
            self._said = sheet.gui.add_html("", visible=False)
        sheet.command("Export as a zip", self._export)

    def _export(self) -> None:
        with self._section.catching():
            settings, chosen, marked = self._page.read(), self._format.read(), self._marked.read()
        shown = effective(settings)
        stem = file_name(settings.origin, shown, self._shelf.presets[settings.origin]).removesuffix(".toml")
        forms = EVERYTHING if chosen == "all" else (chosen,) if chosen else ()
        self._said.visible = False

        def work(progress: Progress, cancelled: Cancelled) -> Parcel:
            return parcel(shown, stem, forms, uncertified=marked, progress=progress, cancelled=cancelled)

        self._jobs.start("export", work, self._done, self._section.complaint.say)

    def _done(self, packed: Parcel) -> None:
        self._send(packed.name, packed.content)
        self._said.content = NOTE.format(bullets((f"{packed.name}, {len(packed.content)} bytes", *packed.notes)))
        self._said.visible = True
