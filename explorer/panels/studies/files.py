"""The buttons that save a map: as a picture, as a table, and as a study's file with the preset that it names."""

from collections.abc import Callable
from functools import partial

from explorer.panels.studies import map_file
from explorer.panels.studies.map_file import MapFormat
from explorer.panels.studies.picture import Shown
from explorer.storage.bundle import Send
from explorer.widgets.form import Form
from explorer.widgets.html import NOTE, escaped
from explorer.widgets.section import Section
from rangenav import preset
from rangenav.progress import Cancelled, Progress
from rangenav.studies import study_file
from rangenav.studies.study import Study

LABEL = "save map as"
HINT = (
    "CSV: every metric of every point that is computed. Study: the same map as a file for the command line, which "
    "runs it with more points on more machines. Preset: the design on the page, which a click on a cell takes."
)
STUDY_PRESET = "Preset of the study"
STUDY_PRESET_HINT = "The design that the map was computed for: the study's file names it, because it is no shipped one."
STUDY_FILE = "map-study.toml"
COMMAND = f"rangenav study run {STUDY_FILE} -o map.zarr"


class MapFiles:
    """A row of buttons, and the command that runs the study's file."""

    def __init__(
        self,
        form: Form,
        shown: Callable[[], tuple[Study, Shown]],
        design: Callable[[], tuple[str, bytes]],
        send: Send,
    ) -> None:
        """shown: the map on the page; it raises ValueError if there is none. design: the file of the design on the
        page, with its name. `send` downloads a file."""
        self._shown, self._design, self._send, self._jobs = shown, design, send, form.new_jobs()
        pictures = {kind.upper(): partial(self._write, kind) for kind in ("png", "svg", "csv")}
        study = {"Study": self._write_study, "Preset": self._write_preset}
        self._section = Section(form)
        with self._section:
            self._buttons = form.buttons(LABEL, pictures | study, hint=HINT)
            self._command = form.gui.add_html("", visible=False)
            self._own = form.button(STUDY_PRESET, self._write_study_preset, hint=STUDY_PRESET_HINT, quiet=True)
            self._own.visible = False
        self._buttons.visible = False

    def show(self, visible: bool) -> None:
        """Show or hide the buttons."""
        if visible != self._buttons.visible:
            self._buttons.visible = visible
        if not visible:
            self._command.visible = self._own.visible = False

    def _write(self, kind: MapFormat) -> None:
        """Write a file in a job: a picture takes half a second."""
        with self._section.answering():
            study, shown = self._shown()

        def work(_progress: Progress, _cancelled: Cancelled) -> bytes:
            return map_file.table(study, shown) if kind == "csv" else map_file.picture(shown, kind)

        name = f"map-{shown.metric.replace('_', '-')}.{kind}"
        self._jobs.start(name, work, partial(self._send, name), self._section.complaint.say)

    def _write_study(self) -> None:
        """Download the study's file, and say how to run it."""
        with self._section.answering():
            study, shown = self._shown()
        (named,) = study.file.presets
        own = named.endswith(".toml")
        first = f"Put it into one folder with <b>{escaped(named)}</b>, which the button below saves. " if own else ""
        self._command.content = NOTE.format(f"{first}Then type, on any machine with rangenav:<pre>{COMMAND}</pre>")
        self._command.visible, self._own.visible = True, own
        self._send(STUDY_FILE, study_file.dumps(map_file.study(study, shown)).encode())

    def _write_preset(self) -> None:
        with self._section.answering():
            self._send(*self._design())

    def _write_study_preset(self) -> None:
        with self._section.answering():
            study, _ = self._shown()
        (named,), (base,) = study.file.presets, study.bases
        self._send(named, preset.dumps(base).encode())
