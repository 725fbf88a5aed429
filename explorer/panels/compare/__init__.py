"""The Compare tab: a pinned run A, runs with many seeds, other estimators, and the consistency of P with the errors.

The pinned run and the switches of this tab are no part of the settings, so undo does not include them. The band of the
seeds and the results of other estimators belong to one run: they disappear when the settings change. The pinned run
belongs to a preset, and disappears with it, unless the visitor keeps it in order to compare two presets.
"""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field

import viser

from explorer.model import comparison, compute, consistency, differences
from explorer.model.comparison import NAMES, Baseline, Comparison, Name, RunInputs
from explorer.model.compute import Picture
from explorer.model.glossary import COMPARE
from explorer.model.jobs import Jobs
from explorer.model.settings import Settings
from explorer.model.view import View
from explorer.panels.compare import text
from explorer.widgets.controls import Number, Switch
from explorer.widgets.form import Action, Form
from explorer.widgets.progress import ProgressPanel
from explorer.widgets.section import Section
from rangenav import ensemble
from rangenav.comparison import Candidate
from rangenav.ensemble import Ensemble
from rangenav.inputs import require

MAX_SEEDS, SEEDS = 100, 20
PIN_HINT = "Keeps this run as A: every plot draws it in purple beside what you change from here on, and so does 3-D."
KEEP_HINT = "Keeps A when another preset is opened, to compare two presets; otherwise A goes with its preset."
BESIDE_HINT = "Shows both runs in numbers and in one plot each, on the same axes, over the whole page."
SEEDS_HINT = "Runs these settings with other noise: the plots then show the median and the band from 10 to 90 %."
OUTDATED = "The settings have changed: the band belonged to others and is gone."
STOPPED = "The settings changed while the seeds ran, so these were stopped."


@dataclass(eq=False)
class _BaselineResults:
    """For each estimator its newest result, or the reason why there is none, with the run that it belongs to."""

    results: dict[Name, tuple[RunInputs, Candidate]] = field(default_factory=dict)
    refusals: dict[Name, tuple[RunInputs, str]] = field(default_factory=dict)

    def result(self, name: Name, run: RunInputs) -> Candidate | None:
        stored = self.results.get(name)
        return stored[1] if stored is not None and stored[0] == run else None

    def refusal(self, name: Name, run: RunInputs) -> str:
        stored = self.refusals.get(name)
        return stored[1] if stored is not None and stored[0] == run else ""

    def store(self, name: Name, run: RunInputs, result: Candidate | str) -> None:
        if isinstance(result, str):
            self.refusals[name] = run, result
        else:
            self.results[name] = run, result


class ComparePanel:
    """What the run on the page is compared with."""

    def __init__(self, form: Form, jobs: Jobs, show_side_by_side: Action) -> None:
        self._form, self._jobs, self._background = form, jobs, form.new_jobs()
        self._picture: Picture | None = None
        self.pinned: Picture | None = None
        self._to_pin: Settings | None = None
        """The settings of the run that was pinned before a reload, until it is computed."""
        self.seeds: tuple[RunInputs, Ensemble] | None = None
        self._running_seeds: tuple[RunInputs, object] | None = None
        self._drawn_seeds: Ensemble | None = None
        self.baseline_results, self.enabled, self._drawn = _BaselineResults(), frozenset[Name](), frozenset[Name]()
        self._changed, self._baselines_compiled, self._message = False, False, ""
        self._build_pin(form, show_side_by_side)
        self._build_seeds(form)
        self._build_baselines(form)
        section = Section(form, "Is the covariance P right?")
        with section:
            self._consistency = form.gui.add_html("")
        form.command("Pin this run as A", self.pin)
        form.command("Unpin A", self._unpin)
        form.command("A and B side by side", show_side_by_side, step=False)

    def _build_pin(self, form: Form, show_side_by_side: Action) -> None:
        section = Section(form)
        with section:
            form.button("Pin this run as A", self.pin, hint=PIN_HINT)
            self._beside_button = form.button("Show A and B side by side", show_side_by_side, hint=BESIDE_HINT)
            self._unpin_button = form.button("Unpin", self._unpin, hint="Takes A off the plots and out of 3-D.")
            self._unpin_button.visible = self._beside_button.visible = False
            self._differences = form.gui.add_html(text.nothing_pinned())
            self.keep_pinned = Switch(section, "keep A with another preset", hint=KEEP_HINT)

    def _build_seeds(self, form: Form) -> None:
        self._seeds_section = section = Section(form, "Many seeds")
        with section:
            self._count = Number(section, COMPARE["runs"].caption, hint=COMPARE["runs"].hint)
            self._count.write(SEEDS, None)
            form.button("Run the noise seeds", self._run_seeds, hint=SEEDS_HINT)
            self._progress = ProgressPanel(form, self._jobs)
            self._clear_button = form.button("Remove the band", self._clear_seeds, hint="Takes it off the plots.")
            self._clear_button.visible = False
            self._seeds_line = form.gui.add_html("")
        section.check(self._seed_count)

    def _build_baselines(self, form: Form) -> None:
        section = Section(form, "Other estimators on this record")
        with section:
            self._switches: dict[Name, Switch] = {
                "EKF": Switch(section, COMPARE["ekf"].caption, hint=COMPARE["ekf"].hint),
                "refined": Switch(section, COMPARE["refinement"].caption, hint=COMPARE["refinement"].hint),
            }
            self._table = form.gui.add_html("")

    def refresh(self) -> None:
        """Take over the switches."""
        enabled = frozenset[Name](name for name in NAMES if self._switches[name].read())
        self._changed |= enabled != self.enabled
        self.enabled = enabled

    @property
    def changed(self) -> bool:
        """Whether the comparison has changed since it was drawn last."""
        return self._changed

    def comparison(self, picture: Picture) -> Comparison:
        """What to draw in comparison with a picture. The EKF runs at once, the refinement in a thread of its own."""
        self._picture, self._changed = picture, False
        self._pin_restored()
        if not (self.pinned or self.seeds or self._running_seeds or self.enabled):
            return comparison.NOTHING
        run = comparison.inputs_of(picture)
        if self._running_seeds is not None and self._running_seeds[0] != run:
            self._stop_seeds()
        if "EKF" in self.enabled and self._baselines_compiled and self._is_missing("EKF", run):
            self.baseline_results.store("EKF", run, _run_baseline("EKF", picture))
        self._compute_missing()
        seeds = self.seeds[1] if self.seeds is not None and self.seeds[0] == run else None
        if self.seeds is not None and seeds is None:
            self.seeds, self._message = None, OUTDATED
        enabled: list[Name] = [name for name in NAMES if name in self.enabled]
        baselines = tuple(Baseline(name, self.baseline_results.result(name, run)) for name in enabled)
        return Comparison(pinned=self.pinned, baselines=baselines, seeds=seeds)

    def draw(self, picture: Picture, shown: Comparison) -> None:
        """Show the text and the tables for a comparison."""
        _assign(self._seeds_line, text.seeds(picture, shown.seeds, self._message))
        for button in (self._unpin_button, self._beside_button):
            _show(button, visible=shown.pinned is not None)
        _show(self._clear_button, visible=shown.seeds is not None)
        if shown.pinned is None:
            _assign(self._differences, text.nothing_pinned())
        else:
            pinned = shown.pinned.judged_on(len(picture.analysis.windows.start))
            choices = differences.chosen(pinned, picture)
            _assign(
                self._differences,
                text.differences(pinned, picture, choices, differences.figures(pinned, picture)),
            )
        run = comparison.inputs_of(picture) if self.enabled else None
        refusals = [self.baseline_results.refusal(name, run) for name in NAMES if name in self.enabled] if run else []
        _assign(
            self._table,
            text.baselines(picture, shown.baselines, [refusal_text for refusal_text in refusals if refusal_text]),
        )
        self._drawn_seeds = shown.seeds
        _assign(self._consistency, text.FOLLOWS)

    def draw_details(self, picture: Picture) -> None:
        """Say whether P tells the truth about the errors of the picture and of the seeds drawn last."""
        seeds = self._drawn_seeds
        many = consistency.of_seeds(seeds, picture.analysis) if seeds is not None else None
        count = len(seeds.seed) if seeds is not None else 0
        matched = picture.preset.gains.mode == "noise-matched"
        _assign(self._consistency, text.consistency(consistency.of_run(picture), many, count, matched=matched))

    def pin(self) -> None:
        """Pin the run on the page as A."""
        self.pinned, self._changed = None if self._picture is None else self._picture.at_rest, True

    def pin_next(self, settings: Settings | None) -> None:
        """Pin the run of these settings as A, with the next picture; None unpins A."""
        self.pinned, self._to_pin, self._changed = None, settings, True

    def forget_preset(self) -> None:
        """Unpin the run, which belongs to a preset that is not on the page any more; forget what was said of seeds."""
        if self.pinned is not None and not self.keep_pinned.read():
            self._unpin()
        if self._running_seeds is not None:
            self._stop_seeds()
        self._changed |= self.seeds is not None
        self.seeds, self._message = None, ""

    def restore(self, view: View, pinned: Settings | None) -> None:
        """Show what an earlier visit had: the estimators, and the pinned run with the next picture."""
        for name, switch in self._switches.items():
            switch.show(name in view.estimators)
        self.keep_pinned.show(view.keep_pinned)
        self._to_pin = pinned
        self.refresh()

    @property
    def pinned_settings(self) -> Settings | None:
        """Of the pinned run; None if none is pinned."""
        return self._to_pin if self.pinned is None else self.pinned.settings

    def _pin_restored(self) -> None:
        if self._to_pin is not None:
            restored, self._to_pin = self._to_pin, None
            with suppress(ValueError):  # computed by another version
                self.pinned = compute.compute(restored).at_rest

    def _unpin(self) -> None:
        self.pinned, self._changed = None, True

    def _run_seeds(self) -> None:
        with self._seeds_section.catching():
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
            self.seeds, self._running_seeds, self._changed = (run, band), None, True

        def failed(sentence: str) -> None:
            self._running_seeds = None
            self._seeds_section.complaint.say(sentence)

        self._progress.start(f"{seed_count} seeds", work, done, failed)
        self._running_seeds, self._message, self._changed = (run, self._jobs.running), "", True

    def _seed_count(self) -> int:
        """Raises ValueError with the reason."""
        count = self._count.read()
        whole = math.isfinite(count) and 1 <= count <= MAX_SEEDS and count == int(count)
        require(whole, f"runs must be a whole number between 1 and {MAX_SEEDS}, got {count:g}")
        return int(count)

    def _stop_seeds(self) -> None:
        """Stop the seeds, because the settings have changed."""
        assert self._running_seeds is not None
        if self._jobs.running is self._running_seeds[1]:
            self._jobs.cancel()
            self._message = STOPPED
        self._running_seeds = None

    def _clear_seeds(self) -> None:
        self.seeds, self._changed = None, True

    def _is_missing(self, name: Name, run: RunInputs) -> bool:
        return self.baseline_results.result(name, run) is None and not self.baseline_results.refusal(name, run)

    def _compute_missing(self) -> None:
        """Run one estimator that is switched on and has no result: one at a time, for the newest picture."""
        picture = self._picture
        if picture is None or self._background.running is not None:
            return
        run = comparison.inputs_of(picture)
        for name in NAMES:
            if name in self.enabled and self._is_missing(name, run):
                self._compute(name, picture, run)
                return

    def _compute(self, name: Name, picture: Picture, run: RunInputs) -> None:
        def done(result: Candidate | str) -> None:
            self.baseline_results.store(name, run, result)
            self._baselines_compiled = self._changed = True

        self._background.start(name, lambda _progress, _cancelled: _run_baseline(name, picture), done, lambda _: None)


def _run_baseline(name: Name, picture: Picture) -> Candidate | str:
    """The result of an estimator on the record, or the reason why it has none."""
    try:
        return comparison.run_baseline(name, picture)
    except ValueError as error:
        return f"{name}: {error}"


def _show(button: viser.GuiButtonHandle, *, visible: bool) -> None:
    if visible != button.visible:
        button.visible = visible


def _assign(handle: viser.GuiHtmlHandle, content: str) -> None:
    if content != handle.content:  # an equal content sends no message to the browser
        handle.content = content
