"""What is being worked on, how far it is, and a button to stop it; above the verdict, and only while there is work."""

import html

from explorer.model.jobs import Jobs
from explorer.widgets.form import Form


class ProgressPanel:
    """A line, a bar and a button."""

    def __init__(self, form: Form, jobs: Jobs) -> None:
        self._jobs, self._shown = jobs, False
        self._line = form.gui.add_markdown("", visible=False)
        self._bar = form.gui.add_progress_bar(0.0, visible=False, animated=True)
        self._button = form.button("Stop", jobs.cancel, hint="Ends the work at once; what was there before stays.")
        self._button.visible = False

    def draw(self) -> None:
        """Show how far the job at work is."""
        job = self._jobs.running
        if (job is not None) != self._shown:
            self._shown = job is not None
            self._line.visible = self._bar.visible = self._button.visible = self._shown
        if job is not None:
            self._bar.value = 100 * job.fraction
            line = f"Working: **{html.escape(job.name)}**, {100 * job.fraction:.0f} %"
            if line != self._line.content:
                self._line.content = line
