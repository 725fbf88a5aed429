"""The trade-off curve of a search: gains that none of those tried beats both in settling and in exactness. A slider
walks along it."""

import viser

from explorer.panels.gains.tuning_options import whole
from explorer.widgets.dials import Dial
from explorer.widgets.form import Action, Form
from explorer.widgets.section import Section
from rangenav import tradeoff
from rangenav.inputs import require
from rangenav.tradeoff import Measure, Point
from rangenav.tune import Tuned

CURVES: dict[str, tuple[Measure, Measure]] = {
    "both together": ("settle", "steady"),
    "position": ("settle_position", "steady_position"),
    "attitude": ("settle_attitude", "steady_attitude"),
}
CURVE_HINT = (
    "Whose trade-off curve to walk along: gains that none of those tried beats both in settling and in exactness."
)
PLACE = "place on the curve"
PLACE_HINT = "Left: settles soonest. Right: most exact afterwards."


class CurvePicker:
    """A menu of curves, and the slider along the chosen one."""

    def __init__(self, form: Form, section: Section) -> None:
        self._form = form
        self.choices: tuple[Point, ...] = ()
        """The points of the chosen curve, the soonest first."""
        self._curve: viser.GuiDropdownHandle[str] = form.gui.add_dropdown(
            "curve to pick from", tuple(CURVES), hint=CURVE_HINT
        )
        self._place = Dial(section, PLACE, (1.0, 2.0), step=1.0, hint=PLACE_HINT, ends=False)

    def when_moved(self, *, curve: Action, place: Action) -> None:
        """Run an action when a visitor has chosen another curve, and one when the slider was moved."""
        self._form.when_moved(self._curve, curve)
        for handle in self._place.handles:
            self._form.when_moved(handle, place)

    def begin(self, tuned: Tuned) -> None:
        """Offer the first curve of a search."""
        self._curve.value = next(iter(CURVES))
        self.offer(tuned)

    def offer(self, tuned: Tuned) -> None:
        """Offer the points of the chosen curve, and set the slider to the one with the least J.

        Position does not depend on the attitude gains: of points with equal figures, one with the least J counts.
        """
        by_objective = sorted(tuned.points, key=lambda point: point.objective(tuned.steadiness))
        self.choices = tradeoff.front(tuple(by_objective), *CURVES[self._curve.value])
        best = min(range(len(self.choices)), key=lambda k: self.choices[k].objective(tuned.steadiness))
        self._place.show(1.0)
        self._place.span(float(max(len(self.choices), 2)))
        self._place.show(float(best + 1))

    def check_curve(self) -> None:
        """Raises ValueError if the browser has sent a curve that is not offered."""
        require(self._curve.value in CURVES, f"curve to pick from must be one of: {', '.join(CURVES)}")

    def point(self) -> Point:
        """The point that is picked. Raises ValueError for a place that the curve does not have."""
        return self.choices[whole(PLACE, self._place.read(), len(self.choices)) - 1]

    def check(self) -> None:
        """Check curve and place, if there is a curve. Raises ValueError with the reason."""
        if self.choices:
            self.check_curve()
            self.point()

    def forget(self) -> None:
        """Offer nothing."""
        self.choices = ()

    def show(self, visible: bool) -> None:
        """Show or hide menu and slider; a slider of one point stays hidden."""
        self._curve.visible = visible
        for handle in self._place.handles:
            handle.visible = visible and len(self.choices) > 1
