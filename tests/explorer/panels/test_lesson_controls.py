"""Every control that a lesson names is on the page, with the start of the lesson or with its solution."""

import pytest
import viser

from explorer.lessons import Lesson, State, measures
from explorer.lessons.course import OURS, lessons_in
from explorer.panels.dock import Dock
from explorer.web.elements import Step, place_of
from explorer.widgets.controls import CHANGED

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("lesson", lessons_in(OURS).lessons, ids=lambda one: one.name)
def test_the_controls_of_a_lesson_are_on_the_page(lesson: Lesson, dock: Dock, client: viser.ClientHandle):
    shown = [*_shown(lesson.start, dock, client), *_shown(lesson.solved, dock, client)]
    missing = [place for place in lesson.header.places if not any(place.holds(*control) for control in shown)]
    assert missing == []
    assert lesson.header.places


def _shown(state: State, dock: Dock, client: viser.ClientHandle) -> list[tuple[list[Step], str]]:
    """Every control in sight: the tabs and folders around it, and its label."""
    dock.write(state.settings)
    twin = measures.twin(state)
    if twin is not None:
        dock.twin.draw(twin)
    handles = client.gui._gui_input_handle_from_uuid.values()  # viser has no public list of its controls
    return [(steps, handle.label.removesuffix(CHANGED)) for handle in handles if (steps := place_of(handle))]
