"""Make it observable: the smallest change of a chosen kind that meets the requirement, shown before it is accepted.

The motion before is A, as in the Compare tab, the changed one B: drawings and figures of both at first, and once it is
accepted, both in every plot and in 3-D.
"""

import math
from functools import partial

import msgspec

from explorer.model.jobs import Jobs
from explorer.model.settings import Settings, effective
from explorer.panels.presets.card import drawings
from explorer.widgets.controls import Choice
from explorer.widgets.form import Action, Form, Section
from explorer.widgets.html import NOTE, bullets, table
from explorer.widgets.page import Page
from rangenav import repair
from rangenav.certificate.figures import Figures
from rangenav.progress import Cancelled, Progress
from rangenav.repair import ChangeKind, Repair

BY: dict[ChangeKind, str] = {
    "tones": "adding tones",
    "amplitude": "its size",
    "frequency": "its frequencies",
    "timescale": "its speed",
    "waypoints": "moving waypoints",
}
ROUNDING = 1e-12
"""m²/s⁷: what no motion is asked for, and less than which is rounding."""
KIND = "What may be changed about the motion. The vehicle's limits are kept."
REPAIR = "Looks for the smallest change that meets the required μ, rank 13 and σ; certified before it is shown."
IMPROVE = "Looks for a change that lowers the predicted σ of a motion that is observable already."
TAKE = "Puts B on the page and pins A beside it, in plots and in 3-D. Ctrl+Z takes it back."
ACCEPTED = (
    "on the page now, and not saved yet: “save as” keeps it. The motion before is pinned as A, purple in plots and in "
    "3-D (Compare tab: Unpin); Ctrl+Z takes the change back"
)
SAME = "on the page now, as it was: there was nothing to change about the motion"
SIDE_BY_SIDE = "display:flex;gap:0.8em;align-items:center;padding:0.3em 0"
DRAWINGS = f'<div style="{SIDE_BY_SIDE}"><b>{{}}</b>{{}}</div>'
LEAVE = "Forgets the change; what is on the page stays as it is."


class RepairPanel:
    """A kind of change, two buttons, and the change that was found."""

    def __init__(self, form: Form, page: Page, jobs: Jobs, pin: Action) -> None:
        """`pin` keeps the run on view as A."""
        self._page, self._jobs, self._pin = page, jobs, pin
        self._section = section = Section(form, "Repair", expanded=False)
        self._found: Repair | None = None
        with section:
            self._kind = Choice(section, "by changing", BY, hint=KIND)
            form.button("Make it observable", self._repair, hint=REPAIR)
            form.button("Improve it", self._improve, hint=IMPROVE, quiet=True)
            self._said = form.gui.add_html("", visible=False)
            self._accept = form.button("Accept the motion", self._take, hint=TAKE)
            self._discard = form.button("Discard the motion", self._forget, hint=LEAVE, quiet=True)
        self._forget()
        form.command("Make it observable", self._repair)

    def _repair(self) -> None:
        self._start(improve=False)

    def _improve(self) -> None:
        self._start(improve=True)

    def _start(self, *, improve: bool) -> None:
        with self._section.answering():
            shown, by = effective(self._page.read()), self._kind.read()
        self._forget()
        search = repair.improve if improve else repair.repair

        def work(progress: Progress, cancelled: Cancelled) -> Repair:
            return search(shown, by=by, progress=progress, cancelled=cancelled)

        name = "improving the motion" if improve else "making it observable"
        self._jobs.start(f"{name} by {BY[by]}", work, self._show, partial(self._refuse, by))

    def _refuse(self, by: ChangeKind, reason: str) -> None:
        """Say why in the menu's own words."""
        self._section.answer(reason.replace(f"{by}: ", f"{BY[by]}: ", 1))

    def _show(self, found: Repair) -> None:
        self._found = found
        pictures = "".join(
            DRAWINGS.format(*side) for side in (("A", drawings(found.before)), ("B", drawings(found.after)))
        )
        self._said.content = NOTE.format(bullets(words(found)) + pictures + figures(found))
        self._said.visible = self._accept.visible = self._discard.visible = True

    def _take(self) -> None:
        found = self._found
        if found is None:
            return
        settings = self._page.read()
        with self._section.answering():
            if effective(settings).path != found.before.path:
                raise ValueError("the motion on the page is another one by now: look for a change of that one")
            chosen = accepted(settings, found)
        if found.after.path != found.before.path:
            self._pin()
        self._page.write(chosen)
        self._forget()
        self._said.content = NOTE.format(bullets((ACCEPTED if found.after.path != found.before.path else SAME,)))
        self._said.visible = True

    def _forget(self) -> None:
        self._found = None
        self._said.visible = self._accept.visible = self._discard.visible = False


def accepted(settings: Settings, found: Repair) -> Settings:
    """The settings with what was changed in them, and with what the visitor has chosen otherwise meanwhile; time scale
    and printed start are in the path."""
    changed = {
        name: getattr(found.after, name)
        for name in found.after.__struct_fields__
        if getattr(found.after, name) != getattr(found.before, name)
    }
    printed = msgspec.structs.replace(settings.printed, initial_values=False)
    preset = msgspec.structs.replace(effective(settings), **changed)
    return msgspec.structs.replace(settings, preset=preset, time_scale=1.0, printed=printed)


def words(found: Repair) -> tuple[str, ...]:
    """What was changed, and what the certificate of the result says."""
    stated = found.certificate
    held = "certified" if stated.certified else f"not certified: {'; '.join(stated.failures)}"
    broken = stated.vehicle.broken
    flown = "within the vehicle's limits" if not broken else f"too much for the vehicle: {'; '.join(broken)}"
    return found.words, f"after {found.evaluations} looks: {held}; {flown}"


def figures(found: Repair) -> str:
    """Before and after, side by side."""
    before, after = found.figures_before, found.figures_after
    return table(
        ("", "before (A)", "after (B)"),
        (
            ("μ (m²/s⁷)", _mu(before), _mu(after)),
            ("predicted σ", _sigma(before), _sigma(after)),
            ("required", "", f"μ ≥ {found.after.requirement.mu:.3g}, σ ≤ {found.after.requirement.position_sigma:g} m"),
        ),
    )


def _mu(figure: Figures) -> str:
    return f"{figure.mu:.3g}" if figure.mu > ROUNDING else "nothing"


def _sigma(figure: Figures) -> str:
    return f"{figure.sigma:.3g} m" if math.isfinite(figure.sigma) else "blind"
