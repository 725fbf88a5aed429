"""The Compare tab: pin a run as A and see what changes, many seeds, other estimators, and whether P can be believed.

What is pinned, drawn and switched on here belongs to this visit: it is not part of the settings, so undo and autosave
do not know it. Bands and other estimators belong to one run; when the settings change they are left out at once.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import viser

from explorer.model import comparison, consistency, differences
from explorer.model.comparison import NAMES, Baseline, Comparison, Name, RunInputs
from explorer.model.compute import Picture
from explorer.model.jobs import Jobs
from explorer.panels.compare import text as words
from explorer.widgets.controls import Number, Switch
from explorer.widgets.form import Form, Section
from rangenav import ensemble
from rangenav.comparison import Candidate
from rangenav.ensemble import Ensemble
from rangenav.inputs import require

MAX_SEEDS, SEEDS = 100, 20
PIN_HINT = "Keeps this run as A: every plot draws it in purple beside what you change from here on, and so does 3-D."
SEEDS_HINT = "Runs these settings with N seeds, counted up from the noise seed: median, and the band from 10 to 90 %."
EKF_HINT = (
    "Extended Kalman filter on position, velocity and attitude with the range itself, from the same start. "
    "Better near the truth, and lost where its start is too wrong."
)
GONE = "The settings have changed: the band belonged to others and is gone."
OVERTAKEN = "The settings changed while the seeds ran, so these were stopped."
REFINED_HINT = (
    "Iterated Kalman smoother of the whole record (Gauss–Newton), started by the cascade: what one gets afterwards, "
    "with all ranges at hand."
)


@dataclass(eq=False)
class _Rivals:
    """What other estimators made of runs: of each the newest, and why there is none."""

    found: dict[Name, tuple[RunInputs, Candidate]] = field(default_factory=dict)
    refused: dict[Name, tuple[RunInputs, str]] = field(default_factory=dict)

    def of(self, name: Name, run: RunInputs) -> Candidate | None:
        known = self.found.get(name)
        return known[1] if known is not None and known[0] == run else None

    def why_not(self, name: Name, run: RunInputs) -> str:
        known = self.refused.get(name)
        return known[1] if known is not None and known[0] == run else ""

    def keep(self, name: Name, run: RunInputs, result: Candidate | str) -> None:
        if isinstance(result, str):
            self.refused[name] = run, result
        else:
            self.found[name] = run, result


class ComparePanel:
    """Everything that stands beside the run on view."""

    def __init__(self, form: Form, jobs: Jobs) -> None:
        self._form, self._jobs, self._background = form, jobs, form.new_jobs()
        self._picture: Picture | None = None
        self._pinned: Picture | None = None
        self._seeds: tuple[RunInputs, Ensemble] | None = None
        self._seeding: tuple[RunInputs, object] | None = None
        self._rivals, self._on, self._drawn = _Rivals(), frozenset[Name](), frozenset[Name]()
        self._changed, self._warm, self._note = False, False, ""
        self._build_pin(form)
        self._build_seeds(form)
        self._build_rivals(form)
        section = Section(form, "Does P tell the truth?")
        with section:
            self._agreement = form.gui.add_html("")
        form.command("Pin this run as A", self.pin)
        form.command("Unpin A", self._unpin)

    def _build_pin(self, form: Form) -> None:
        with Section(form):
            form.button("Pin this run as A", self.pin, hint=PIN_HINT)
            self._unpin_button = form.button("Unpin", self._unpin, hint="Takes A off the plots and out of 3-D.")
            self._unpin_button.visible = False
            self._differences = form.gui.add_html(words.nothing_pinned())

    def _build_seeds(self, form: Form) -> None:
        self._seeds_section = section = Section(form, "Many seeds")
        with section:
            self._count = Number(section, "N", step=1, hint=f"How many seeds, 1 to {MAX_SEEDS}.")
            self._count.write(SEEDS, None)
            form.button("N seeds", self._run_seeds, hint=SEEDS_HINT)
            self._clear_button = form.button("Remove the band", self._clear_seeds, hint="Takes it off the plots.")
            self._clear_button.visible = False
            self._seeds_line = form.gui.add_html("")

    def _build_rivals(self, form: Form) -> None:
        section = Section(form, "Other estimators on this record")
        with section:
            self._switches: dict[Name, Switch] = {
                "EKF": Switch(section, "EKF", hint=EKF_HINT),
                "refined": Switch(section, "refinement", hint=REFINED_HINT),
            }
            self._table = form.gui.add_html("")

    def read(self) -> None:
        """Take in the switches."""
        on = frozenset[Name](name for name in NAMES if self._switches[name].read())
        self._changed |= on != self._on
        self._on = on

    @property
    def changed(self) -> bool:
        """Whether what stands beside the picture has changed since it was drawn last."""
        return self._changed

    def comparison(self, picture: Picture) -> Comparison:
        """What to draw beside a picture. The EKF is worked out here, the refinement in a thread of its own."""
        self._picture, self._changed = picture, False
        if not (self._pinned or self._seeds or self._seeding or self._on):
            return comparison.NOTHING
        run = comparison.run_of(picture)
        if self._seeding is not None and self._seeding[0] != run:
            self._stop_seeding()
        if "EKF" in self._on and self._warm and self._missing("EKF", run):
            self._rivals.keep("EKF", run, _result("EKF", picture))
        self._start_missing()
        seeds = self._seeds[1] if self._seeds is not None and self._seeds[0] == run else None
        if self._seeds is not None and seeds is None:
            self._seeds, self._note = None, GONE
        baselines = tuple(Baseline(name, self._rivals.of(name, run)) for name in NAMES if name in self._on)
        return Comparison(pinned=self._pinned, baselines=baselines, seeds=seeds)

    def draw(self, picture: Picture, shown: Comparison) -> None:
        """Say in words and tables what is drawn."""
        _assign(self._seeds_line, words.seeds(picture, shown.seeds, self._note))
        self._unpin_button.visible = shown.pinned is not None
        self._clear_button.visible = shown.seeds is not None
        if shown.pinned is None:
            _assign(self._differences, words.nothing_pinned())
        else:
            choices = differences.choices(shown.pinned.preset, picture.preset)
            _assign(
                self._differences,
                words.differences(shown.pinned, picture, choices, differences.figures(shown.pinned, picture)),
            )
        run = comparison.run_of(picture) if self._on else None
        refusals = [self._rivals.why_not(name, run) for name in NAMES if name in self._on] if run else []
        _assign(self._table, words.baselines(picture, shown.baselines, [text for text in refusals if text]))
        many = consistency.of_seeds(shown.seeds, picture.analysis) if shown.seeds is not None else None
        count = len(shown.seeds.seed) if shown.seeds is not None else 0
        matched = picture.preset.gains.mode == "noise-matched"
        _assign(self._agreement, words.agreement(consistency.of_run(picture), many, count, matched=matched))

    def pin(self) -> None:
        """Keep the run on view as A."""
        self._pinned, self._changed = self._picture, True

    def _unpin(self) -> None:
        self._pinned, self._changed = None, True

    def _run_seeds(self) -> None:
        with self._seeds_section.catching():
            count = self._count.read()
            require(
                math.isfinite(count) and 1 <= count <= MAX_SEEDS and count == int(count),
                f"N must be a whole number between 1 and {MAX_SEEDS}, got {count:g}",
            )
        picture = self._picture
        if picture is None:
            return
        run, number = comparison.run_of(picture), int(count)

        def work(progress: Callable[[float], None], cancelled: Callable[[], bool]) -> Ensemble:
            return ensemble.seeds(
                picture.preset, number, form=comparison.form_of(picture), progress=progress, cancelled=cancelled
            )

        def done(found: Ensemble) -> None:
            self._seeds, self._seeding, self._changed = (run, found), None, True

        def failed(sentence: str) -> None:
            self._seeding = None
            self._seeds_section.complaint.say(sentence)

        self._jobs.start(f"{number} seeds", work, done, failed)
        self._seeding, self._note, self._changed = (run, self._jobs.running), "", True

    def _stop_seeding(self) -> None:
        """The settings have changed under the job."""
        assert self._seeding is not None
        if self._jobs.running is self._seeding[1]:
            self._jobs.cancel()
            self._note = OVERTAKEN
        self._seeding = None

    def _clear_seeds(self) -> None:
        self._seeds, self._changed = None, True

    def _missing(self, name: Name, run: RunInputs) -> bool:
        return self._rivals.of(name, run) is None and not self._rivals.why_not(name, run)

    def _start_missing(self) -> None:
        """Work out one estimator that is switched on and not known; one at a time, always for the newest picture."""
        picture = self._picture
        if picture is None or self._background.running is not None:
            return
        run = comparison.run_of(picture)
        for name in NAMES:
            if name in self._on and self._missing(name, run):
                self._start(name, picture, run)
                return

    def _start(self, name: Name, picture: Picture, run: RunInputs) -> None:
        def done(result: Candidate | str) -> None:
            self._rivals.keep(name, run, result)
            self._warm = self._changed = True

        self._background.start(name, lambda _progress, _cancelled: _result(name, picture), done, lambda _: None)


def _result(name: Name, picture: Picture) -> Candidate | str:
    """What the estimator made of the record, or why it cannot."""
    try:
        return comparison.run_baseline(name, picture)
    except ValueError as error:
        return f"{name}: {error}"


def _assign(handle: viser.GuiHtmlHandle, content: str) -> None:
    if content != handle.content:  # a message to the browser only if there is news
        handle.content = content
