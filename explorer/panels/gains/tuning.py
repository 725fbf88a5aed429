"""Auto-tune: gains by search for a stated trade, judged on seeds it has not seen, and the curve to pick others from.

The job goes on for the settings it was started with, whatever is done meanwhile; what it finds is put on the page only
by “Use these gains”, an ordinary change, and it is said when the page shows another path or other sensors by then.
"""

import math

import msgspec
import viser

from explorer.model.compute import Picture
from explorer.model.jobs import Jobs
from explorer.model.settings import effective
from explorer.panels.gains import tradeoff_plot
from explorer.panels.gains import tuning_text as words
from explorer.panels.gains.tradeoff_plot import ATTITUDE, POSITION, Marked
from explorer.panels.presets import Page
from explorer.widgets.controls import Number
from explorer.widgets.form import Form, Section
from explorer.widgets.html import NOTE
from rangenav import tradeoff, tune
from rangenav.gains import Gains
from rangenav.inputs import require
from rangenav.preset import Preset
from rangenav.progress import Cancelled, Progress
from rangenav.tradeoff import Measure, Point
from rangenav.tune import Tuned

MAX_RUNS, RUNS = 32, 8
MAX_EVALUATIONS, EVALUATIONS = 2000, 300
STEADINESS = 0.5
SEARCH_SHARE = 0.95
"""Of the work; the rest is what the gains found are held against."""
CURVES: dict[str, tuple[Measure, Measure]] = {
    "both together": ("settle", "steady"),
    "position": ("settle_position", "steady_position"),
    "attitude": ("settle_attitude", "steady_attitude"),
}
WEIGHT = "steadiness w"
BALANCE = (
    "0: settling soon is all that counts; 1: being exact afterwards. J = (1 − w) ln(settling time) + w ln(steady "
    "error), of position and attitude together; lower is better."
)
RUNS_HINT = f"How many noise seeds the gains are tried on, 1 to {MAX_RUNS}; as many others judge them afterwards."
EVALUATIONS_HINT = f"How many gains are tried, 1 to {MAX_EVALUATIONS}."
TUNE = "Searches the gains from those on the page. The page stays usable; nothing changes until you say so."
CURVE = "Whose trade-off curve to walk along: gains that none of those tried beats both in settling and in exactness."
WALK = "Left: settles soonest. Right: most exact afterwards."
USE = "Puts the picked gains on the page; Ctrl+Z takes them back."
LEAVE = "Forgets what was found; what is on the page stays as it is."
Shown = viser.GuiHtmlHandle


class TuningPanel:
    """What to search for, a button, and what was found: figures, the curve, and a way to pick from it."""

    def __init__(self, form: Form, page: Page, jobs: Jobs) -> None:
        self._page, self._jobs = page, jobs
        self._picture: Picture | None = None
        self._found: tuple[Preset, Tuned] | None = None
        self._picked: Point | None = None
        self._walk: tuple[Point, ...] = ()
        self._judging = form.new_jobs()
        self._judged: dict[Gains, Point] = {}
        """What gains that were found or picked reach on held-out seeds."""
        self._held_out, self._summary = 0, ""
        self._section = section = Section(form, "Auto-tune", expanded=False)
        with section:
            marks = ((0.0, "soon"), (1.0, "exact"))
            self._steadiness = form.gui.add_slider(WEIGHT, 0.0, 1.0, 0.05, STEADINESS, hint=BALANCE, marks=marks)
            self._runs = Number(section, "seeds", step=1, hint=RUNS_HINT)
            self._evaluations = Number(section, "gains to try", step=10, hint=EVALUATIONS_HINT)
            self._runs.write(RUNS, None)
            self._evaluations.write(EVALUATIONS, None)
            form.button("Tune the gains", self._start, hint=TUNE)
            self._said, self._plots = form.gui.add_html(""), form.gui.add_html("")
            self._curve = form.gui.add_dropdown("pick along", tuple(CURVES), hint=CURVE)
            self._place = form.gui.add_slider("place", 1, 2, 1, 1, hint=WALK)
            self._told = form.gui.add_html("")
            self._use = form.button("Use these gains", self._take, hint=USE)
            self._leave = form.button("Discard", self._forget, hint=LEAVE)
        self._curve.on_update(
            lambda event: form.do(self._walk_along, step=False) if event.client_id is not None else None
        )
        self._place.on_update(lambda event: form.do(self._pick, step=False) if event.client_id is not None else None)
        self._forget()
        form.command("Auto-tune", self._start)

    def draw(self, picture: Picture) -> None:
        """What is on the page now, which may be something else than what was searched for."""
        self._picture = picture
        self._say()

    def _start(self) -> None:
        with self._section.catching():
            began, steadiness = effective(self._page.read()), self._steadiness.value
            runs = _whole("seeds", self._runs.read(), MAX_RUNS)
            evaluations = _whole("gains to try", self._evaluations.read(), MAX_EVALUATIONS)
            require(0 <= steadiness <= 1, f"{WEIGHT} must lie between 0 and 1, got {steadiness}")

        def work(progress: Progress, cancelled: Cancelled) -> Tuned:
            return tune.tune(
                began,
                runs=runs,
                evaluations=evaluations,
                steadiness=steadiness,
                progress=lambda share: progress(SEARCH_SHARE * share),
                cancelled=cancelled,
            )

        def done(found: Tuned) -> None:
            self._show(began, found, runs)

        self._jobs.start(f"auto-tune, {evaluations} gains", work, done, self._section.complaint.say)

    def _show(self, began: Preset, found: Tuned, runs: int) -> None:
        self._found, self._picked, self._held_out = (began, found), found.after, runs
        self._judged = {one.gains: one for one in (found.held_out_before, found.held_out_after)}
        self._summary = words.summary(found, runs)
        self._curve.value = next(iter(CURVES))
        self._offer()
        self._visible(True)
        self._say()
        self._plot()

    def _offer(self) -> None:
        """The points of the chosen curve, and the slider at the one with the least J on it. Points with equal figures,
        as position has whatever the attitude's gains, are told apart by J."""
        if self._found is None:
            return
        found, curve = self._found[1], self._curve.value
        by_objective = sorted(found.seen, key=lambda point: point.objective(found.steadiness))
        self._walk = tradeoff.front(tuple(by_objective), *CURVES[curve])
        best = min(range(len(self._walk)), key=lambda k: self._walk[k].objective(found.steadiness))
        self._place.value = 1
        self._place.max = max(len(self._walk), 2)
        self._place.value = best + 1

    def _walk_along(self) -> None:
        """Another curve was chosen; the browser may have sent one that was not offered."""
        with self._section.catching():
            require(self._curve.value in CURVES, f"pick along must be one of: {', '.join(CURVES)}")
        self._offer()
        self._pick()

    def _pick(self) -> None:
        with self._section.catching():
            place = _whole("place", self._place.value, len(self._walk))
        self._picked = self._walk[place - 1]
        self._judge(self._picked)
        self._say()
        self._plot()

    def _judge(self, picked: Point) -> None:
        """Hold picked gains against the held-out seeds, as those that were found have been: some tens of ms."""
        if self._found is None or picked.gains in self._judged:
            return
        began, count = self._found[0], self._held_out

        def work(_: Progress, cancelled: Cancelled) -> Point:
            return tradeoff.score(
                picked.gains, tradeoff.runs(began, began.seed, count), preset=began, cancelled=cancelled
            )

        def done(point: Point) -> None:
            self._judged[point.gains] = point
            self._say()

        self._judging.start("held-out seeds", work, done, self._section.complaint.say)

    def _say(self) -> None:
        """Bring the words up to date."""
        if self._found is not None and self._picked is not None:
            began, found = self._found
            _assign(self._said, NOTE.format(self._summary + words.differs(began, self._picture)))
            held_out = self._judged.get(self._picked.gains)
            _assign(self._told, NOTE.format(words.picked(self._picked, held_out, found, self._picture)))

    def _plot(self) -> None:
        """Draw the curves; not for every picture, since what was found does not depend on it."""
        if self._found is not None and self._picked is not None:
            found = self._found[1]
            marked = Marked(start=found.before, found=found.after, picked=self._picked, walk=self._walk)
            plots = "".join(tradeoff_plot.plot(plane, found.seen, marked) for plane in (POSITION, ATTITUDE))
            _assign(self._plots, NOTE.format(plots + tradeoff_plot.signs()))

    def _take(self) -> None:
        if self._picked is not None:
            settings = self._page.read()
            preset = msgspec.structs.replace(settings.preset, gains=self._picked.gains)
            self._page.write(msgspec.structs.replace(settings, preset=preset))

    def _forget(self) -> None:
        self._judging.cancel()
        self._found = self._picked = None
        self._walk = ()
        self._visible(False)

    def _visible(self, visible: bool) -> None:
        for part in (self._said, self._plots, self._told, self._curve, self._use, self._leave):
            part.visible = visible
        self._place.visible = visible and len(self._walk) > 1


def _whole(name: str, value: float, most: int) -> int:
    whole = math.isfinite(value) and value == int(value) and 1 <= value <= most
    require(whole, f"{name} must be a whole number between 1 and {most}, got {value:g}")
    return int(value)


def _assign(handle: Shown, content: str) -> None:
    if content != handle.content:  # a message to the browser only if there is news
        handle.content = content
