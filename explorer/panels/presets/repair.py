"""Make it observable: a small change of a chosen kind that meets the requirement, shown before it is accepted.

The proposed motion is drawn in the scene, and the panel shows drawings and figures of the motion before and of the
proposed one. Once the change is accepted, the motion before is pinned as A.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from explorer.model.changes import with_changes
from explorer.model.compute import Picture
from explorer.model.jobs import Jobs
from explorer.model.settings import effective
from explorer.model.ways_out import WayOut, ways_out
from explorer.panels.presets import repair_text
from explorer.widgets.answer import AnswerButton
from explorer.widgets.controls import Choice
from explorer.widgets.form import Action, Form
from explorer.widgets.html import NOTE, bullets, upper_first
from explorer.widgets.page import Page
from explorer.widgets.progress import ProgressPanel
from explorer.widgets.section import Section
from rangenav import repair
from rangenav.preset import Preset
from rangenav.progress import Cancelled, Progress
from rangenav.repair import CannotRepairError, ChangeKind, ExportTarget, Repair
from rangenav.signals import Signal

CHANGE_LABELS: dict[ChangeKind, str] = {
    "tones": "adding tones",
    "amplitude": "changing its size",
    "frequency": "changing its frequencies",
    "timescale": "changing its speed",
    "waypoints": "moving waypoints",
}
REPAIRING, IMPROVING = "making it observable", "improving the motion"
"""Beginnings of the names of the jobs."""
KIND_HINT = "What may be changed about the motion. The vehicle's limits are kept."
REPAIR_HINT = (
    "Looks for a small change that meets the required μ, rank 13 and σ; certified before it is shown. The predicted σ "
    "follows the range noise of the Sensors tab: set that first."
)
IMPROVE_HINT = "Looks for a change that lowers the predicted σ of a motion that is observable already."
ACCEPT_HINT = (
    "Puts the proposed motion on the page, and pins the motion before as A, in plots and in 3-D. Ctrl+Z takes it back."
)
ACCEPTED = (
    "on the page now, and not saved yet: “save as” keeps it. The motion before is pinned as A, purple in plots and in "
    "3-D (Compare tab: Unpin); Ctrl+Z takes the change back"
)
UNCHANGED = "on the page now, as it was: there was nothing to change about the motion"
DISCARD_HINT = "Forgets the proposed motion; what is on the page stays as it is."
WAY_HINT = "Makes this change on the page, and looks again. Ctrl+Z takes it back."
MOST_WAYS = 3
ACCEPT = AnswerButton(event="accept", label="Accept the motion", hint=ACCEPT_HINT, main=True)
DISCARD = AnswerButton(event="discard", label="Discard", hint=DISCARD_HINT)


def _no_target(preset: Preset) -> ExportTarget | None:
    return None


def _ignore(format_name: str) -> None:
    """Do nothing: where there is no export."""


class RepairPanel:
    """A kind of change, two buttons, and the proposed change."""

    def __init__(
        self,
        form: Form,
        page: Page,
        jobs: Jobs,
        pin: Action,
        *,
        target: Callable[[Preset], ExportTarget | None] = _no_target,
        choose: Callable[[str], None] = _ignore,
    ) -> None:
        """`pin` pins the run on the page as A. `target` says what a changed motion is to be exported as, and `choose`
        chooses that format for the export."""
        self._form, self._page, self._pin = form, page, pin
        self._target, self._choose = target, choose
        self._section = section = Section(form, "Repair", expanded=False)
        self._result: Repair | None = None
        self.outcome = ""
        """What the last search has found, or why it has found nothing; empty once that was accepted or discarded."""
        self._changed = False
        self._searched_target: ExportTarget | None = None
        self._ways: tuple[WayOut, ...] = ()
        self._ways_section: Section | None = None
        self._accepted: Signal | None = None
        """The path of the change that was accepted last, as long as it is on the page."""
        self._refused: Preset | None = None
        """The preset that the ways out belong to."""
        with section:
            self._kind = Choice(section, "repair by", CHANGE_LABELS, hint=KIND_HINT)
            form.button("Make it observable", self.start, hint=REPAIR_HINT)
            form.button("Improve it", self._improve, hint=IMPROVE_HINT, quiet=True)
            self.progress = ProgressPanel(form, jobs)
            self._description = form.gui.add_html("", visible=False)
            self.accept_button = form.button("Accept the motion", self.accept, hint=ACCEPT_HINT)
            self._discard_button = form.button("Discard the motion", self.discard, hint=DISCARD_HINT, quiet=True)
        self._forget_result()
        form.command("Make it observable", self.start)

    def start(self) -> None:
        """Look for a change that meets the requirement."""
        self._start(improve=False)

    def _improve(self) -> None:
        self._start(improve=True)

    def _start(self, *, improve: bool) -> None:
        with self._section.answering():
            settings, by = self._page.read(), self._kind.read()
            shown = effective(settings)
            target = self._searched_target = None if improve else self._target(shown)
        self._forget_result()

        def work(progress: Progress, cancelled: Cancelled) -> Repair | Refused:
            try:
                if improve:
                    return repair.improve(shown, by=by, progress=progress, cancelled=cancelled)
                return repair.repair(shown, by=by, target=target, progress=progress, cancelled=cancelled)
            except CannotRepairError as refused:
                return Refused(reason=str(refused), ways=ways_out(settings, by, refused))

        def done(found: Repair | Refused) -> None:
            if isinstance(found, Refused):
                self._refuse(by, found.reason)
                self._offer(shown, found.ways)
            else:
                self.show(found)

        name = f"{IMPROVING if improve else REPAIRING} by {CHANGE_LABELS[by]}"
        self.progress.start(name, work, done, partial(self._refuse, by))

    def _refuse(self, by: ChangeKind, reason: str) -> None:
        """Show why there is no such change, with the label of its kind in the menu."""
        self.outcome = reason.replace(f"{by}: ", f"{CHANGE_LABELS[by]}: ", 1)
        self._section.answer(self.outcome)

    def _offer(self, refused: Preset, ways: tuple[WayOut, ...]) -> None:
        """Offer ways out as buttons, until something else is on the page."""
        self._refused, self._ways = refused, ways[:MOST_WAYS]
        if self._ways:
            with self._section:
                self._ways_section = section = Section(self._form, "What may help")
            with section:
                for k, way in enumerate(self._ways):
                    self._form.button(upper_first(way.label), partial(self._take, k), hint=WAY_HINT)

    def _take(self, k: int) -> None:
        """Make the change of a way out on the page, and look again. Its button may have gone since it was pressed."""
        if k < len(self._ways):
            way = self._ways[k]
            self._page.write(way.settings)
            self._kind.show(way.by)
            self.start()

    def draw(self, picture: Picture) -> None:
        """Remove what belongs to another motion: the ways out of a refusal, a proposed change, and the sentence that a
        change was accepted."""
        shown = effective(picture.settings)
        if self._refused is not None and shown != self._refused:
            self._forget_ways()
            self.outcome = ""
        if self._result is not None and shown.path != self._result.before.path:
            self._forget_result()
        if self._accepted is not None and shown.path != self._accepted:
            self._accepted, self._description.visible = None, False

    @property
    def actions(self) -> dict[str, Action]:
        """What the buttons below the verdict do, by the names that they send."""
        ways: dict[str, Action] = {f"way-{k}": partial(self._take, k) for k in range(MOST_WAYS)}
        return {"accept": self.accept, "discard": self.discard} | ways

    @property
    def answers(self) -> tuple[AnswerButton, ...]:
        """The buttons below the verdict."""
        ways = tuple(
            AnswerButton(event=f"way-{k}", label=way.label, hint=WAY_HINT, main=k == 0)
            for k, way in enumerate(self._ways)
        )
        return (*((ACCEPT,) if self.found else ways), DISCARD)

    @property
    def found(self) -> bool:
        """Whether there is a changed motion to accept or to discard."""
        return self._result is not None

    @property
    def changed(self) -> bool:
        """Whether a motion was proposed, or is proposed no more, since the scene was drawn last."""
        return self._changed

    def proposed(self, picture: Picture) -> Preset | None:
        """The proposed motion, to be drawn with a picture of the motion before; None if there is none."""
        self._changed = False
        result = self._result
        if result is None or effective(picture.settings).path != result.before.path:
            return None
        return result.after

    def show(self, result: Repair) -> None:
        """Show a change, to be accepted or discarded."""
        self._result, self.outcome, self._changed = result, repair_text.outcome(result), True
        self._description.content = repair_text.found(result)
        self._description.visible = self.accept_button.visible = self._discard_button.visible = True

    def accept(self) -> None:
        result = self._result
        if result is None:
            return
        settings = self._page.read()
        with self._section.answering():
            if effective(settings).path != result.before.path:
                raise ValueError("the motion on the page is another one by now: look for a change of that one")
            accepted_settings = with_changes(settings, result.before, result.after)
        if result.after.path != result.before.path:
            self._pin()
        self._page.write(accepted_settings)
        if self._searched_target is not None:
            self._choose(self._searched_target.format_name)
        self._forget_result()
        self._description.content = NOTE.format(
            bullets((ACCEPTED if result.after.path != result.before.path else UNCHANGED,))
        )
        self._description.visible, self._accepted = True, effective(accepted_settings).path

    def discard(self) -> None:
        """Forget the change, or why there is none."""
        self._forget_result()

    def forget_preset(self) -> None:
        """Stop the search, and forget what it has found: it belongs to a motion that is not on the page any more."""
        self.progress.stop()
        self._forget_result()

    def _forget_ways(self) -> None:
        self._refused, self._ways = None, ()
        if self._ways_section is not None:
            self._ways_section.remove()
            self._ways_section = None

    def _forget_result(self) -> None:
        self._changed |= self._result is not None
        self._result, self.outcome = None, ""
        self._forget_ways()
        self._description.visible = self.accept_button.visible = self._discard_button.visible = False


@dataclass(frozen=True, kw_only=True)
class Refused:
    """Why there is no change, and what may help."""

    reason: str
    ways: tuple[WayOut, ...]
