"""Many seeds: the run on the page with other noise, as a band from 10 to 90 %. The band belongs to one run."""

import math
from collections.abc import Callable

from explorer.model import comparison
from explorer.model.comparison import RunInputs
from explorer.model.compute import Picture
from explorer.model.glossary import COMPARE
from explorer.model.jobs import Jobs
from explorer.panels.compare import text
from explorer.widgets.controls import Number
from explorer.widgets.form import Form
from explorer.widgets.progress import ProgressPanel
from explorer.widgets.section import Section
from rangenav import ensemble
from rangenav.ensemble import Ensemble
from rangenav.inputs import require

MAX_SEEDS, SEEDS = 100, 20
SEEDS_HINT = "Runs these settings with other noise: the plots then show the median and the band from 10 to 90 %."
OUTDATED = "The settings have changed: the band belonged to others and is gone."
STOPPED = "The settings changed while the seeds ran, so these were stopped."


class SeedsPanel:
    """The number of runs, a button, and what the runs have shown."""

    def __init__(self, form: Form, jobs: Jobs) -> None:
        self._jobs = jobs
        self._picture: Picture | None = None
        self.band: tuple[RunInputs, Ensemble] | None = None
        """The runs with other noise, and the run that they belong to."""
        self._running: tuple[RunInputs, object] | None = None
        self.changed = False
        """Whether the band has changed since it was drawn last."""
        self._message = ""
        self._section = section = Section(form, "Many seeds")
        with section:
            self._count = Number(section, COMPARE["runs"].caption, hint=COMPARE["runs"].hint)
            self._count.write(SEEDS, None)
            form.button("Run the noise seeds", self._run, hint=SEEDS_HINT)
            self._progress = ProgressPanel(form, self._jobs)
            self._clear_button = form.button("Remove the band", self._clear, hint="Takes it off the plots.")
            self._clear_button.visible = False
            self._line = form.gui.add_html("")
        section.check(self._seed_count)

    @property
    def busy(self) -> bool:
        """Whether there is a band, or runs that will make one."""
        return self.band is not None or self._running is not None

    def follow(self, picture: Picture) -> None:
        """Take the picture on the page, whose settings the next runs have."""
        self._picture = picture

    def of_run(self, run: RunInputs) -> Ensemble | None:
        """The runs with other noise that belong to a run; those of another run are stopped and forgotten."""
        if self._running is not None and self._running[0] != run:
            self._stop()
        seeds = self.band[1] if self.band is not None and self.band[0] == run else None
        if self.band is not None and seeds is None:
            self.band, self._message = None, OUTDATED
        return seeds

    def draw(self, picture: Picture, seeds: Ensemble | None) -> None:
        """Show what the runs with other noise have shown."""
        self._line.content = text.seeds(picture, seeds, self._message)
        self._clear_button.visible = seeds is not None

    def forget_preset(self) -> None:
        """Stop the runs, and forget the band: both belong to a preset that is not on the page any more."""
        if self._running is not None:
            self._stop()
        self.changed |= self.band is not None
        self.band, self._message = None, ""

    def _run(self) -> None:
        with self._section.catching():
            seed_count = self._seed_count()
        picture = self._picture
        if picture is None:
            return
        run = comparison.inputs_of(picture)

        def work(progress: Callable[[float], None], cancelled: Callable[[], bool]) -> Ensemble:
            return ensemble.seeds(
                picture.preset, seed_count, form=comparison.form_of(picture), progress=progress, cancelled=cancelled
            )

        def done(band: Ensemble) -> None:
            self.band, self._running, self.changed = (run, band), None, True

        def failed(sentence: str) -> None:
            self._running = None
            self._section.complaint.say(sentence)

        self._progress.start(f"{seed_count} seeds", work, done, failed)
        self._running, self._message, self.changed = (run, self._jobs.running), "", True

    def _seed_count(self) -> int:
        """Raises ValueError with the reason."""
        count = self._count.read()
        whole = math.isfinite(count) and 1 <= count <= MAX_SEEDS and count == int(count)
        require(whole, f"runs must be a whole number between 1 and {MAX_SEEDS}, got {count:g}")
        return int(count)

    def _stop(self) -> None:
        """Stop the runs, because the settings have changed."""
        assert self._running is not None
        if self._jobs.running is self._running[1]:
            self._jobs.cancel()
            self._message = STOPPED
        self._running = None

    def _clear(self) -> None:
        self.band, self.changed = None, True
