"""The Compare tab: a pinned run A, runs with many seeds, other estimators, and the consistency of P with the errors.

The pinned run and the switches of this tab are no part of the settings, so undo does not include them. The band of the
seeds and the results of other estimators belong to one run: they disappear when the settings change. The pinned run
belongs to a preset, and disappears with it, unless the visitor keeps it in order to compare two presets.
"""

from contextlib import suppress

from explorer.model import comparison, compute, consistency, differences
from explorer.model.comparison import Comparison
from explorer.model.compute import Picture
from explorer.model.jobs import Jobs
from explorer.model.settings import Settings
from explorer.model.view import View
from explorer.panels.compare import text
from explorer.panels.compare.estimators import EstimatorsPanel
from explorer.panels.compare.seeds import SeedsPanel
from explorer.widgets.controls import Switch
from explorer.widgets.form import Action, Form
from explorer.widgets.section import Section
from rangenav.ensemble import Ensemble

PIN_HINT = "Keeps this run as A: every plot draws it in purple beside what you change from here on, and so does 3-D."
KEEP_HINT = "Keeps A when another preset is opened, to compare two presets; otherwise A goes with its preset."
BESIDE_HINT = "Shows both runs in numbers and in one plot each, on the same axes, over the whole page."


class ComparePanel:
    """What the run on the page is compared with."""

    def __init__(self, form: Form, jobs: Jobs, show_side_by_side: Action) -> None:
        self._picture: Picture | None = None
        self.pinned: Picture | None = None
        self._to_pin: Settings | None = None
        """The settings of the run that was pinned before a reload, until it is computed."""
        self._drawn_seeds: Ensemble | None = None
        self._changed = False
        self._build_pin(form, show_side_by_side)
        self.seeds, self.estimators = SeedsPanel(form, jobs), EstimatorsPanel(form)
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

    def refresh(self) -> None:
        """Take over the switches."""
        self.estimators.refresh()

    @property
    def changed(self) -> bool:
        """Whether the comparison has changed since it was drawn last."""
        return self._changed or self.seeds.changed or self.estimators.changed

    def comparison(self, picture: Picture) -> Comparison:
        """What to draw in comparison with a picture. The EKF runs at once, the refinement in a thread of its own."""
        self._picture = picture
        self._changed = self.seeds.changed = self.estimators.changed = False
        self.seeds.follow(picture)
        self._pin_restored()
        if not (self.pinned or self.seeds.busy or self.estimators.enabled):
            return comparison.NOTHING
        run = comparison.inputs_of(picture)
        baselines, seeds = self.estimators.of_picture(picture, run), self.seeds.of_run(run)
        return Comparison(pinned=self.pinned, baselines=baselines, seeds=seeds)

    def draw(self, picture: Picture, shown: Comparison) -> None:
        """Show the text and the tables for a comparison."""
        self.seeds.draw(picture, shown.seeds)
        self._unpin_button.visible = self._beside_button.visible = shown.pinned is not None
        if shown.pinned is None:
            self._differences.content = text.nothing_pinned()
        else:
            pinned = shown.pinned.judged_on(len(picture.analysis.windows.start))
            choices, figures = differences.chosen(pinned, picture), differences.figures(pinned, picture)
            self._differences.content = text.differences(pinned, picture, choices, figures)
        self.estimators.draw(picture, shown.baselines)
        self._drawn_seeds = shown.seeds
        self._consistency.content = text.FOLLOWS

    def draw_details(self, picture: Picture) -> None:
        """Say whether P tells the truth about the errors of the picture and of the seeds drawn last."""
        seeds = self._drawn_seeds
        many = consistency.of_seeds(seeds, picture.analysis) if seeds is not None else None
        count = len(seeds.seed) if seeds is not None else 0
        matched = picture.preset.gains.mode == "noise-matched"
        self._consistency.content = text.consistency(consistency.of_run(picture), many, count, matched=matched)

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
        self.seeds.forget_preset()

    def restore(self, view: View, pinned: Settings | None) -> None:
        """Show what an earlier visit had: the estimators, and the pinned run with the next picture."""
        self.estimators.restore(view.estimators)
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
