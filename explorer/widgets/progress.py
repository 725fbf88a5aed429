"""The running job of a panel: its name, its progress and a button to stop it, beside the button that started it."""

import html
from collections.abc import Callable

from explorer.model.jobs import Job, Jobs, T, Work
from explorer.widgets.form import Form

STOP_HINT = "Ends the work at once; what was there before stays."


class ProgressPanel:
    """A line, a bar and a button, below the button whose work `start` begins. The form draws them."""

    def __init__(self, form: Form, jobs: Jobs) -> None:
        self._form, self._jobs, self._shown = form, jobs, False
        self._job: Job | None = None
        self.away = False
        """Whether the work was begun by a button elsewhere, such as one of the verdict, or by the palette."""
        self.line = form.gui.add_markdown("", visible=False)
        self._bar = form.gui.add_progress_bar(0.0, visible=False, animated=True)
        self.button = form.button("Stop", self.stop, hint=STOP_HINT)
        self.button.visible = False
        form.progress.append(self)

    def start(self, name: str, work: Work[T], done: Callable[[T], None], failed: Callable[[str], None]) -> Job:
        """Start a job of this panel, as `Jobs.start` does."""
        self.away = self._form.away
        self._job = self._jobs.start(name, work, done, failed)
        return self._job

    def stop(self) -> None:
        """End the job of this panel, if it is still running."""
        self._jobs.drop(self._job)

    @property
    def running(self) -> Job | None:
        """The job of this panel; None if there is none, or once its result was delivered."""
        job = self._jobs.running
        return job if job is self._job else None

    def draw(self) -> None:
        """Show the progress of the running job."""
        job = self.running
        if (job is not None) != self._shown:
            self._shown = job is not None
            self.line.visible = self._bar.visible = self.button.visible = self._shown
        if job is not None:
            self._bar.value = 100 * job.fraction
            line = _line(job)
            if line != self.line.content:
                self.line.content = line


def _line(job: Job) -> str:
    name, percent, ahead = html.escape(job.name), f"{100 * job.fraction:.0f} %", job.ahead
    if not ahead:
        return f"Working: {name}, {percent}"
    before = "1 job is" if ahead == 1 else f"{ahead} jobs are"
    return f"Waiting: {name}, {percent}. {before} before it on this machine."
