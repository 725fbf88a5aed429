"""The running job of a panel: its name, its progress and a button to stop it, beside the button that started it."""

import html

from explorer.model.jobs import Jobs
from explorer.widgets.form import Form


class ProgressPanel:
    """A line, a bar and a button."""

    def __init__(self, form: Form, jobs: Jobs, names: tuple[str, ...]) -> None:
        """`names`: beginnings of the names of the jobs that are shown."""
        self._jobs, self._names, self._shown = jobs, names, False
        self._line = form.gui.add_markdown("", visible=False)
        self._bar = form.gui.add_progress_bar(0.0, visible=False, animated=True)
        self._button = form.button("Stop", jobs.cancel, hint="Ends the work at once; what was there before stays.")
        self._button.visible = False

    def draw(self) -> None:
        """Show the progress of the running job."""
        running = self._jobs.running
        job = running if running is not None and running.name.startswith(self._names) else None
        if (job is not None) != self._shown:
            self._shown = job is not None
            self._line.visible = self._bar.visible = self._button.visible = self._shown
        if job is not None:
            self._bar.value = 100 * job.fraction
            line = f"Working: **{html.escape(job.name)}**, {100 * job.fraction:.0f} %"
            if line != self._line.content:
                self._line.content = line
