"""How little is sent for one picture: only what has changed, and never less than what has changed."""

from collections.abc import Iterator

import numpy as np
import pytest
from msgspec.structs import replace

from explorer.charts import Charts, plot_list
from explorer.charts.plot_size import PlotSize
from explorer.model.compute import Picture, compute
from explorer.model.settings import Settings
from explorer.panels.timeline import REDRAW
from explorer.scene import Scene
from explorer.server import SessionServer
from explorer.session import Session
from explorer.shared import Compilation
from explorer.web.security import open_server
from explorer.widgets.form import Action
from rangenav import preset
from tests.support.pictures import picture
from tests.support.sent_messages import Page
from tests.support.shared_server import shared
from tests.support.waiting_visitor import Editing
from tests.support.wire import Wire

pytestmark = pytest.mark.slow

OF_THE_ESTIMATE = ("/estimate", "/ellipsoid", "/trail", "/compass/")
"""The nodes that a gain may move."""
MOST_MESSAGES = 12
"""For a gain: four errors, the predicted σ, the innovation and the cursor."""


def opened(name: str) -> Picture:
    """A picture of a preset, computed now: no cache holds the stages of one that another test file has made."""
    return compute(Settings(preset=preset.load(name)))


def with_more_weight(name: str) -> Picture:
    """A picture of a preset that trusts the ranges twice as much."""
    chosen = preset.load(name)
    riccati = replace(chosen.gains.riccati, q=2 * chosen.gains.riccati.q)
    return compute(Settings(preset=replace(chosen, gains=replace(chosen.gains, riccati=riccati))))


def test_a_gain_sends_the_plots_of_the_estimate_and_no_other(page: Page) -> None:
    charts = Charts(page.client, PlotSize(two_panels=True))
    charts.draw(opened("paper-slow"))
    page.messages.clear()
    charts.draw(with_more_weight("paper-slow"))
    assert len(page.updates("data")) == len(plot_list.ERRORS.plots) + 2
    assert len(page.messages) <= MOST_MESSAGES


def test_a_gain_touches_no_node_of_the_path_or_of_the_world(page: Page) -> None:
    scene = Scene(page.client, lambda: None)
    scene.draw(opened("paper-slow"))
    scene.move(opened("paper-slow"), 5.0)
    page.messages.clear()
    assert scene.shows_path_of(with_more_weight("paper-slow"))
    scene.draw(with_more_weight("paper-slow"))
    names = {vars(message)["name"] for message in page.messages if "name" in vars(message)}
    assert names
    assert {name for name in names if not name.startswith(OF_THE_ESTIMATE)} == set()


def test_a_time_at_which_the_picture_stands_already_sends_nothing(page: Page) -> None:
    scene, charts, example = Scene(page.client, lambda: None), Charts(page.client, PlotSize()), picture("paper-slow")
    scene.draw(example)
    charts.draw(example)
    page.messages.clear()
    scene.move(example, 0.0)
    charts.cursor(example, 0.0)
    assert page.messages == []


@pytest.fixture(scope="module")
def served() -> Iterator[tuple[SessionServer, int]]:
    server, compilation = open_server("127.0.0.1", 0), Compilation()
    sessions = SessionServer(server, shared(server, compilation))
    compilation.start()
    yield sessions, server.get_port()
    server.stop()


def test_a_gain_and_a_path_moved_together_are_both_in_the_next_picture(served: tuple[SessionServer, int]) -> None:
    sessions, port = served
    tab = Wire(port)
    tab.wait_for_text("13 of 13")
    session: Session = sessions.sessions[-1]
    for k in range(5):
        weight, amplitude = 1.0 + 0.1 * k, 0.5 + 0.1 * k
        tab.set("range weight q (1/(m⁴ s))", weight)
        tab.set("amplitude x (m)", amplitude)
        tab.set("range weight q (1/(m⁴ s))", weight + 0.05)

        def shown(amplitude: float = amplitude, weight: float = weight) -> bool:
            chosen = session.picture.settings.preset if session.picture is not None else None
            tones = chosen.path.tones if chosen is not None else ()  # pyright: ignore[reportAttributeAccessIssue]
            q = chosen.gains.riccati.q if chosen is not None else 0.0
            return (
                any(abs(tone.amplitude - amplitude) < 1e-9 for tone in tones)
                and abs(q / 10 ** (weight + 0.05) - 1) < 1e-3
            )

        tab.wait_for(shown, "a picture of both")
    tab.close()


def test_a_run_plays_in_frames_of_its_own_and_stands_exactly_when_it_is_paused(
    served: tuple[SessionServer, int],
) -> None:
    sessions, port = served
    tab = Wire(port)
    tab.wait_for_text("13 of 13")
    session: Session = sessions.sessions[-1]
    picture = session.picture
    assert picture is not None
    home = tuple(tab.nodes["/vehicle"]["position"])
    tab.command("Play or pause")
    tab.wait_for(lambda: tuple(tab.nodes["/vehicle"]["position"]) != home, "the vehicle to move")
    tab.set("page", "width=1366&height=768&hidden=1")
    tab.wait_for(lambda: not session.plays, "the session to know")
    tab.wait_until_quiet(0.4)  # the layout of the new width, and the frame before; frames would come all the time
    hidden = dict(tab.counts)
    tab.set("page", "width=1366&height=768")
    tab.wait_for(lambda: tab.counts["SetPositionMessage"] > hidden["SetPositionMessage"] + 4, "more frames")
    tab.command("Play or pause")
    tab.wait_for_text("paused")
    moment = session._playback.time
    tab.wait_for(lambda: abs(tab.value("t (s)") - moment) < 0.006, "the slider")
    sample = int(np.abs(picture.motion.time - moment).argmin())
    for node in ("/vehicle", "/compass"):
        assert np.array_equal(tab.nodes[node]["position"], picture.motion.position[sample])
    distance = np.linalg.norm(picture.motion.position[sample] - picture.preset.world.anchor)
    assert tab.nodes["/anchor/range"]["scale"] == pytest.approx(float(distance))
    assert f"<b>{moment:.2f} s</b>" in tab.text()
    tab.close()


@pytest.mark.parametrize(("control", "moved"), [("t (s)", 7.5), ("t (s): number", "7.5")])
def test_a_moment_that_the_visitor_chooses_while_the_run_plays_is_not_written_over(
    editing: Editing, monkeypatch: pytest.MonkeyPatch, control: str, moved: object
) -> None:
    """Between the move and the moment when the session hears of it, the run goes on for five updates of the slider."""
    tab, form, playback = editing.tab, editing.session.form, editing.session._playback
    do = form.do

    def do_late(action: Action, **how: bool) -> None:
        began = playback.time
        tab.wait_for(lambda: playback.time > began + 5 * REDRAW, "the run to go on")
        do(action, **how)

    tab.command("Play or pause")
    tab.wait_for(lambda: tab.value("t (s)") > 0, "the slider to move")
    monkeypatch.setattr(form, "do", do_late)
    tab.set(control, moved)
    tab.wait_for(lambda: not playback.playing, "the session to hear of it")
    assert playback.time == 7.5
    slider = form.gui._gui_input_handle_from_uuid[tab.find("t (s)")]
    tab.wait_for(lambda: slider.value == 7.5, "the slider")
