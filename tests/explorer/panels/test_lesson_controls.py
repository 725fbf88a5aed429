"""Every control that a lesson names is on the page, with the start of the lesson or with its solution."""

import pytest
import viser

from explorer.lessons import Lesson, State, measures
from explorer.lessons.course import OURS, lessons_in
from explorer.panels.dock import Dock
from explorer.web.elements import place_of


@pytest.mark.parametrize("lesson", lessons_in(OURS).lessons, ids=lambda one: one.name)
def test_the_controls_of_a_lesson_are_on_the_page(lesson: Lesson, dock: Dock, client: viser.ClientHandle):
    shown = _shown(lesson.start, dock, client) | _shown(lesson.solved, dock, client)
    assert set(lesson.header.controls) <= shown


def _shown(state: State, dock: Dock, client: viser.ClientHandle) -> set[str]:
    """Every control in sight, as a lesson names it: tab / label."""
    dock.write(state.settings)
    twin = measures.twin(state)
    if twin is not None:
        dock.twin.draw(twin)
    found = set()
    for handle in client.gui._gui_input_handle_from_uuid.values():  # viser has no public list of its controls
        place = place_of(handle)
        if place and place[0][0] == "tab":
            found.add(f"{place[0][1]} / {handle.label.removesuffix(' •')}")
    return found
