"""The page, or the open lesson, as one HTML file for people without this program: a button and two baked sliders."""

from collections.abc import Callable
from functools import partial

from explorer.handout import handout
from explorer.lessons.lesson import Lesson
from explorer.model import field_path
from explorer.model.settings import Settings
from explorer.widgets.form import Form
from explorer.widgets.progress import ProgressPanel
from explorer.widgets.section import Section
from rangenav.progress import Cancelled, Progress

NONE = "none"
PATHS = (
    "gains.attitude.k1",
    "gains.riccati.q",
    "requirement.window",
    "sensors.noise.range",
    "time_scale",
    "path.tones.1.amplitude",
    "path.tones.2.amplitude",
    "path.tones.3.amplitude",
)
"""The numbers that can be baked from the page; the command line takes any."""
NAME = "handout"
"""The name of the job."""
HINT = (
    "The motion, the plots and the verdict as they are now, in one HTML file: it opens from disk without a network. "
    "While a lesson is open, its text is in the file, too."
)
SLIDER_HINT = "A number that can be moved in the file: 15 values from a tenth to ten times of what it is now."


class HandoutPanel:
    """Two menus and a button."""

    def __init__(
        self,
        form: Form,
        *,
        settings: Callable[[], tuple[str, Settings]],
        lesson: Callable[[], Lesson | None],
        download: Callable[[str, bytes], None],
    ) -> None:
        """`settings`: the name of the preset's file, and the settings; `download` downloads a file."""
        self._settings, self._lesson, self._download = settings, lesson, download
        self._jobs = form.new_jobs()
        self._paths = {field_path.label(path): path for path in PATHS}
        self._section = section = Section(form, "A handout for people without this program", expanded=False)
        with section:
            options = (NONE, *self._paths)
            self._menus = [
                form.gui.add_dropdown(label, options, hint=SLIDER_HINT) for label in ("first slider", "second slider")
            ]
            form.button("Save as one HTML file", self._start, hint=HINT)
            self._progress = ProgressPanel(form, self._jobs)
        form.command("Handout: save the page as one HTML file", self._start)

    def _start(self) -> None:
        with self._section.answering():
            file_name, settings = self._settings()
            lesson, stem = self._lesson(), file_name.removesuffix(".toml")
            chosen = tuple(dict.fromkeys(menu.value for menu in self._menus if menu.value in self._paths))
            sliders = tuple(self._paths[label] for label in chosen)

            def work(progress: Progress, cancelled: Cancelled) -> bytes:
                return handout(settings, sliders, lesson=lesson, name=stem, progress=progress, cancelled=cancelled)

            name = f"{stem if lesson is None else lesson.name}.html"
            self._progress.start(NAME, work, partial(self._download, name), self._section.complaint.say)
