"""The slider of the timeline, without a browser: the newest position of the visitor's hand wins over the session's."""

from types import SimpleNamespace
from typing import Any

import pytest

from explorer.model.playback import Playback
from explorer.panels.timeline import TimelinePanel
from explorer.widgets.form import Form


@pytest.fixture
def timeline(client: Any) -> tuple[TimelinePanel, Playback, Form]:
    playback, form = Playback(20.0), Form(client.gui, lambda: None)
    return TimelinePanel(form, playback), playback, form


def test_a_moment_that_the_session_writes_meanwhile_does_not_replace_the_visitors(
    timeline: tuple[TimelinePanel, Playback, Form],
):
    panel, playback, form = timeline
    playback.seek(0.05)
    panel._moved(SimpleNamespace(client_id=1, target=SimpleNamespace(value=1.23)))
    panel._slider.value = 0.05  # the session had looked for waiting actions just before
    form.run_actions()
    assert (playback.time, panel._slider.value) == (1.23, 1.23)
    panel.write(0.0)
    assert panel._slider.value == 1.23


def test_of_several_positions_the_newest_is_shown(timeline: tuple[TimelinePanel, Playback, Form]):
    panel, playback, form = timeline
    for moment in (1.0, 2.0, 3.0):
        panel._slider.value = moment
        panel._moved(SimpleNamespace(client_id=1, target=SimpleNamespace(value=moment)))
    panel._moved(SimpleNamespace(client_id=None, target=SimpleNamespace(value=9.0)))  # an assigned value
    form.run_actions()
    assert (playback.time, panel._slider.value) == (3.0, 3.0)
