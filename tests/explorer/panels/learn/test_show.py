"""The playback of "show me": every step once, in its order, the first at once and the others a moment later."""

from explorer.lessons.demonstration import Step
from explorer.model.settings import Settings
from explorer.panels.learn.show import PERIOD, Show
from rangenav import preset

SETTINGS = Settings(origin="hover", preset=preset.load("hover"))
STEPS = tuple(Step(label, SETTINGS) for label in "abc")


def test_each_step_comes_once_when_it_is_due_and_then_nothing_is_waited_for():
    show = Show()
    show.begin(STEPS, 10.0)
    assert show.wait(10.0) == 0.0
    assert show.take(10.0) == STEPS[0]
    assert show.take(10.0 + PERIOD / 2) is None
    assert show.wait(10.0 + PERIOD / 2) == PERIOD / 2
    assert [show.take(100.0), show.take(200.0), show.take(300.0)] == [STEPS[1], STEPS[2], None]
    assert show.ended
    assert show.wait(300.0) is None  # a session that waited for nothing would never sleep


def test_no_steps_and_an_end_wait_for_nothing():
    show = Show()
    show.begin((), 0.0)
    assert (show.wait(0.0), show.take(1.0)) == (None, None)
    show.begin(STEPS, 0.0)
    show.end()
    assert (show.wait(0.0), show.take(1.0)) == (None, None)
