"""Other estimators on the record of the run on the page: a switch for each, and a table of their errors.

The EKF runs within the picture, the refinement in a thread of its own. A result belongs to one run.
"""

from dataclasses import dataclass, field

from explorer.model import comparison
from explorer.model.comparison import NAMES, Baseline, Name, RunInputs
from explorer.model.compute import Picture
from explorer.model.glossary import COMPARE
from explorer.panels.compare import text
from explorer.widgets.controls import Switch
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from rangenav.comparison import Candidate


@dataclass(eq=False)
class Results:
    """For each estimator its newest result, or the reason why there is none, with the run that it belongs to."""

    results: dict[Name, tuple[RunInputs, Candidate]] = field(default_factory=dict)
    refusals: dict[Name, tuple[RunInputs, str]] = field(default_factory=dict)

    def result(self, name: Name, run: RunInputs) -> Candidate | None:
        """The result of an estimator on a run; None if it has none."""
        stored = self.results.get(name)
        return stored[1] if stored is not None and stored[0] == run else None

    def refusal(self, name: Name, run: RunInputs) -> str:
        """Why an estimator has no result on a run; empty if that is not known."""
        stored = self.refusals.get(name)
        return stored[1] if stored is not None and stored[0] == run else ""

    def is_missing(self, name: Name, run: RunInputs) -> bool:
        """Whether an estimator has neither a result on a run nor a reason why there is none."""
        return self.result(name, run) is None and not self.refusal(name, run)

    def store(self, name: Name, run: RunInputs, result: Candidate | str) -> None:
        """Keep a result, or the reason why there is none."""
        if isinstance(result, str):
            self.refusals[name] = run, result
        else:
            self.results[name] = run, result


class EstimatorsPanel:
    """The switches of the estimators, and the table of their errors."""

    def __init__(self, form: Form) -> None:
        self._background = form.new_jobs()
        self.known, self.enabled = Results(), frozenset[Name]()
        self.changed = False
        """Whether a switch or a result has changed since the results were drawn last."""
        self._compiled = False
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
        self.changed |= enabled != self.enabled
        self.enabled = enabled

    def restore(self, enabled: tuple[Name, ...]) -> None:
        """Show the switches as an earlier visit had them."""
        for name, switch in self._switches.items():
            switch.show(name in enabled)

    def of_picture(self, picture: Picture, run: RunInputs) -> tuple[Baseline, ...]:
        """The results on a picture's run of the estimators that are switched on; what is missing is computed."""
        if "EKF" in self.enabled and self._compiled and self.known.is_missing("EKF", run):
            self.known.store("EKF", run, _run_baseline("EKF", picture))
        self._compute_missing(picture, run)
        return tuple(Baseline(name, self.known.result(name, run)) for name in NAMES if name in self.enabled)

    def draw(self, picture: Picture, baselines: tuple[Baseline, ...]) -> None:
        """Show the table of errors, and why an estimator has none."""
        refusals: list[str] = []
        if self.enabled:
            run = comparison.inputs_of(picture)
            refusals = [self.known.refusal(name, run) for name in NAMES if name in self.enabled]
        self._table.content = text.baselines(picture, baselines, [refusal for refusal in refusals if refusal])

    def _compute_missing(self, picture: Picture, run: RunInputs) -> None:
        """Run one estimator that is switched on and has no result: one at a time, for the newest picture."""
        if self._background.running is not None:
            return
        for name in NAMES:
            if name in self.enabled and self.known.is_missing(name, run):
                self._compute(name, picture, run)
                return

    def _compute(self, name: Name, picture: Picture, run: RunInputs) -> None:
        def done(result: Candidate | str) -> None:
            self.known.store(name, run, result)
            self._compiled = self.changed = True

        self._background.start(name, lambda _progress, _cancelled: _run_baseline(name, picture), done, lambda _: None)


def _run_baseline(name: Name, picture: Picture) -> Candidate | str:
    """The result of an estimator on the record, or the reason why it has none."""
    try:
        return comparison.run_baseline(name, picture)
    except ValueError as error:
        return f"{name}: {error}"
