"""Auto-tune: a search of gains for a chosen tradeoff, their score on held-out seeds, and a curve to pick others from.

The job searches for the settings that it was started with, whatever the visitor changes meanwhile; another preset ends
it. Its gains come on the page only by “Use these gains”, which can be undone. The panel says so if the page shows
another path or other sensors by then.
"""

import msgspec

from explorer.model.compute import Picture
from explorer.model.jobs import Jobs
from explorer.model.settings import effective
from explorer.panels.gains import tradeoff_plot
from explorer.panels.gains import tuning_text as text
from explorer.panels.gains.curve_picker import CurvePicker
from explorer.panels.gains.tradeoff_plot import ATTITUDE, POSITION, MarkedPoints
from explorer.panels.gains.tuning_options import TuningOptions
from explorer.panels.presets import Page
from explorer.widgets.answer import AnswerButton
from explorer.widgets.form import Action, Form
from explorer.widgets.html import NOTE
from explorer.widgets.progress import ProgressPanel
from explorer.widgets.section import Section
from rangenav import tradeoff, tune
from rangenav.gains import Gains
from rangenav.preset import Preset
from rangenav.progress import Cancelled, Progress
from rangenav.tradeoff import Point
from rangenav.tune import Tuned

SEARCH_SHARE = 0.95
"""Share of the work that is the search; the rest scores the gains on held-out seeds."""
TUNE_HINT = "Searches the gains from those on the page. The page stays usable; nothing changes until you say so."
USE_HINT = "Puts the picked gains on the page, and pins the run before as A; Ctrl+Z takes them back."
DISCARD_HINT = "Forgets what the search has found; the gains on the page stay as they are."
USE = AnswerButton(event="use-gains", label="Use these gains", hint=USE_HINT, main=True)
DISCARD = AnswerButton(event="discard-gains", label="Discard", hint=DISCARD_HINT)


class TuningPanel:
    """Options of the search, a button, and its result: figures, the tradeoff curve, and a slider to pick from it."""

    def __init__(self, form: Form, page: Page, jobs: Jobs, pin: Action) -> None:
        """`pin` pins the run on the page as A."""
        self._page, self._pin = page, pin
        self._picture: Picture | None = None
        self.result: tuple[Preset, Tuned] | None = None
        self.picked: Point | None = None
        self._held_out_jobs = form.new_jobs()
        self.outcome = ""
        """What the last search has found; empty once that was used or discarded."""
        self._held_out_points: dict[Gains, Point] = {}
        """The scores on held-out seeds, of the best gains and of those that were picked."""
        self._runs_used, self._summary_text = 0, ""
        self._used: tuple[Picture, Point] | None = None
        """The picture before the gains were used, and these gains."""
        self._section = section = Section(form, "Auto-tune", expanded=False)
        with section:
            self._options = TuningOptions(section)
            form.button("Tune the gains", self.start, hint=TUNE_HINT)
            self.progress = ProgressPanel(form, jobs)
            self._summary_block, self._plots_block = form.gui.add_html(""), form.gui.add_html("")
            self._curve = CurvePicker(form, section)
            self._picked_block = form.gui.add_html("")
            self._use = form.button("Use these gains", self._use_picked, hint=USE_HINT)
            self._used_block = form.gui.add_html("", visible=False)
            self._discard = form.button("Discard the search", self._forget_result, hint=DISCARD_HINT)
        section.check(self._checked)
        self._curve.when_moved(curve=self._choose_curve, place=self._pick)
        self._forget_result()
        form.command("Auto-tune", self.start)

    def draw(self, picture: Picture) -> None:
        """Take the picture on the page, which may have other settings than the search had."""
        self._picture = picture
        self._update_text()

    def start(self) -> None:
        """Look for better gains."""
        with self._section.catching():
            preset, (steadiness, runs, evaluations) = effective(self._page.read()), self._options.read()

        def work(progress: Progress, cancelled: Cancelled) -> Tuned:
            return tune.tune(
                preset,
                runs=runs,
                evaluations=evaluations,
                steadiness=steadiness,
                progress=lambda share: progress(SEARCH_SHARE * share),
                cancelled=cancelled,
            )

        def done(tuned: Tuned) -> None:
            self._show(preset, tuned, runs)

        self.outcome = ""
        self.progress.start(f"auto-tune, {evaluations} gains", work, done, self._section.complaint.say)

    def _checked(self) -> None:
        """Check the options, and what is picked of a result. Raises ValueError with the reason."""
        self._options.read()
        self._curve.check()

    @property
    def choices(self) -> tuple[Point, ...]:
        """The points of the trade-off curve that is shown."""
        return self._curve.choices

    def _show(self, preset: Preset, tuned: Tuned, runs: int) -> None:
        self.result, self.picked, self._runs_used = (preset, tuned), tuned.after, runs
        self._held_out_points = {one.gains: one for one in (tuned.held_out_before, tuned.held_out_after)}
        self._summary_text, self.outcome = text.summary(tuned, runs), text.outcome(tuned, runs)
        self._curve.begin(tuned)
        self._show_result(True)
        self._update_text()
        self._plot()

    def _choose_curve(self) -> None:
        """Show another curve."""
        with self._section.catching():
            self._curve.check_curve()
        if self.result is not None:
            self._curve.offer(self.result[1])
        self._pick()

    def _pick(self) -> None:
        with self._section.catching():
            self.picked = self._curve.point()
        self._score_held_out(self.picked)
        self._update_text()
        self._plot()

    def _score_held_out(self, picked: Point) -> None:
        """Score picked gains on the held-out seeds, in some tens of ms."""
        if self.result is None or picked.gains in self._held_out_points:
            return
        preset, count = self.result[0], self._runs_used

        def work(_: Progress, cancelled: Cancelled) -> Point:
            return tradeoff.score(
                picked.gains, tradeoff.runs(preset, preset.seed, count), preset=preset, cancelled=cancelled
            )

        def done(point: Point) -> None:
            self._held_out_points[point.gains] = point
            self._update_text()

        self._held_out_jobs.start("held-out seeds", work, done, self._section.complaint.say)

    def _update_text(self) -> None:
        """Update the text about the result and about the picked gains."""
        if self.result is not None and self.picked is not None:
            preset, tuned = self.result
            differs = text.differs(preset, self._picture)
            self._summary_block.content = NOTE.format(self._summary_text + differs)
            if differs:
                self.outcome = ""
            held_out = self._held_out_points.get(self.picked.gains)
            self._update_used(tuned)
            self._picked_block.content = NOTE.format(text.picked(self.picked, held_out, tuned, self._picture))

    def _update_used(self, tuned: Tuned) -> None:
        """Say what the used gains have done, for as long as the run in view has them."""
        content = ""
        if self._used is not None and self._picture is not None:
            before, point = self._used
            if self._picture.preset == msgspec.structs.replace(before.preset, gains=point.gains):
                content = NOTE.format(text.used(before, self._picture, point, tuned, self._runs_used))
        self._used_block.content = content
        self._used_block.visible = bool(content)

    def _plot(self) -> None:
        """Draw the curves. They depend on the result alone, so a new picture does not draw them again."""
        if self.result is not None and self.picked is not None:
            tuned = self.result[1]
            marked = MarkedPoints(start=tuned.before, best=tuned.after, picked=self.picked, choices=self.choices)
            plots = "".join(tradeoff_plot.plot(axes, tuned.points, marked) for axes in (POSITION, ATTITUDE))
            self._plots_block.content = NOTE.format(plots + tradeoff_plot.legend())

    @property
    def actions(self) -> dict[str, Action]:
        """What the buttons below the verdict do, by the names that they send."""
        return {USE.event: self._use_picked, DISCARD.event: self._forget_result}

    @property
    def answers(self) -> tuple[AnswerButton, ...]:
        """The buttons below the verdict."""
        better = self.result is not None and self.result[1].after is not self.result[1].before
        return (USE, DISCARD) if better else (DISCARD,)

    def _use_picked(self) -> None:
        self.outcome = ""
        if self.picked is not None:
            settings = self._page.read()
            if settings.preset.gains != self.picked.gains:
                self._pin()
            preset = msgspec.structs.replace(settings.preset, gains=self.picked.gains)
            self._page.write(msgspec.structs.replace(settings, preset=preset))
            if self._picture is not None and self._picture.settings == settings:
                self._used = self._picture, self.picked

    def forget_preset(self) -> None:
        """Stop the search, and forget what it has found: it belongs to a run that is not on the page any more."""
        self.progress.stop()
        self._forget_result()

    def _forget_result(self) -> None:
        self._held_out_jobs.cancel()
        self.result = self.picked = self._used = None
        self.outcome = ""
        self._used_block.visible = False
        self._curve.forget()
        self._show_result(False)

    def _show_result(self, visible: bool) -> None:
        for part in (self._summary_block, self._plots_block, self._picked_block, self._use, self._discard):
            part.visible = visible
        self._curve.show(visible)
