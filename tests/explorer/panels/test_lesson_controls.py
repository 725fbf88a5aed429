"""Every control that a lesson names is one on the page, with the start of the lesson or with its solution."""

import pytest
import viser

from explorer.lessons import Lesson, State, course, measures
from explorer.panels.dock import Dock
from explorer.web.elements import Step, place_of
from explorer.widgets.controls import CHANGED

pytestmark = pytest.mark.slow

LESSONS = course().lessons


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda one: one.name)
def test_each_control_of_a_lesson_is_one_control_of_the_page(lesson: Lesson, dock: Dock, client: viser.ClientHandle):
    missing = set(lesson.header.places)
    assert missing
    for state in (lesson.start, lesson.solved):
        shown = _shown(state, dock, client)
        for place in lesson.header.places:
            fitting = [control for control in shown if place.holds(*control)]
            assert len(fitting) <= 1, fitting  # the page would lead to the first
            missing -= {place} if fitting else set()
    assert missing == set()


@pytest.mark.parametrize("lesson", [one for one in LESSONS if one.start.settings.drafts.path], ids=lambda one: one.name)
def test_the_draft_of_a_lesson_is_the_path_once_its_family_is_chosen(lesson: Lesson, dock: Dock):
    (draft,) = lesson.start.settings.drafts.path
    dock.write(lesson.start.settings)
    dock.motion.path.base_editor.family_menu.show(str(draft.__struct_config__.tag))
    dock.refresh()
    assert dock.read().preset.path == draft


def _shown(state: State, dock: Dock, client: viser.ClientHandle) -> list[tuple[list[Step], str]]:
    """Every control in sight: the tabs and folders around it, and its label."""
    dock.write(state.settings)
    twin = measures.twin(state)
    if twin is not None:
        dock.twin.draw(twin)
    handles = client.gui._gui_input_handle_from_uuid.values()  # viser has no public list of its controls
    return [(steps, handle.label.removesuffix(CHANGED)) for handle in handles if (steps := place_of(handle))]
