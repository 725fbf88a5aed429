"""Drag handles and session keys in a real Chromium: what a hand on a mouse does, and what a browser remembers."""

import math
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest
import viser
from playwright.sync_api import Browser

from explorer.scene.bounds import SceneBounds
from explorer.scene.drag_handles import GIZMO_SHARE, DragHandles
from explorer.scene.labels import Labels
from explorer.web import identity, security, values
from explorer.web.identity import Slots
from rangenav.inputs import Vec3
from tests.browser.page import COARSE, Visitor, until, until_still

PLACES = {"anchor": (0.5, 0.0, 0.8), "waypoint1": (1.5, 0.0, -0.5), "waypoint2": (-1.0, 1.0, 0.25)}
UP, UNIT, GIZMO = np.array([0.0, 0.0, -1.0]), 0.4, "/handles/gizmo"
READY_WORD = "ready for hands"
PIXELS = 2.0
"""A place is rounded to a thousandth of the stage, which is about a pixel."""
STAGE = SceneBounds(
    centre=np.zeros(3),
    radius=2.0,
    unit=UNIT,
    up=UP,
    ground=-UP,
    cell=0.5,
    view_centre=np.zeros(3),
    view_radius=2.0,
)


class Room:
    """Handles and nothing else, moved as the session would."""

    def __init__(self, client: viser.ClientHandle) -> None:
        values.accept_values_only(client)
        client.scene.set_up_direction(UP)
        client.camera.position, client.camera.look_at = (1.0, 6.0, -3.0), (0.0, 0.0, 0.0)
        self._wake, self._places = threading.Event(), dict(PLACES)
        self.handles = DragHandles(client.scene, Labels(client.scene, client.camera), self._wake.set)
        client.gui.add_command("Put the gizmo away", hotkey="escape").on_trigger(lambda _: self.handles.deselect())
        self._draw()
        client.gui.add_markdown(READY_WORD)
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        while True:
            self._wake.wait()
            self._wake.clear()
            for move in self.handles.take_moves():
                self._places["anchor" if move.kind == "anchor" else f"waypoint{move.index + 1}"] = move.position
            self._draw()

    def _draw(self) -> None:
        anchor, *waypoints = self._places.values()
        self.handles.draw(anchor, tuple(waypoints), STAGE)


@pytest.fixture(scope="module")
def tab(browser: Browser) -> Iterator[Visitor]:
    server = security.open_server("127.0.0.1", 0)
    server.on_client_connect(lambda client: Room(client) and None)
    url = f"http://127.0.0.1:{server.get_port()}/"
    opened = Visitor(browser, url, width=900, height=700, density=COARSE, says=READY_WORD)
    opened.wait_for_node("/handles/waypoint2")
    until_still(opened.camera_position)
    opened.dismiss_notifications()
    yield opened
    assert opened.complaints == []
    opened.close()
    security.close_server(server)


def places(tab: Visitor) -> dict[str, list[float]]:
    """Where the handles are."""
    return {name: tab.node_position(f"/handles/{name}") for name in PLACES}


@pytest.mark.parametrize("name", PLACES)
def test_a_handle_follows_the_mouse_while_the_others_and_the_camera_stand_still(tab: Visitor, name: str):
    node, camera, before = f"/handles/{name}", tab.camera_position(), places(tab)
    x, y = tab.screen_position(node)
    tab.drag_node(node, (70.0, -50.0))
    until(lambda: math.dist(tab.screen_position(node), (x + 70, y - 50)) < PIXELS, "the handle under the mouse")
    assert tab.camera_position() == camera
    assert [other for other, place in places(tab).items() if place != before[other]] == [name]


def test_a_drag_beside_the_handles_turns_the_camera_and_moves_nothing(tab: Visitor):
    camera, before = tab.camera_position(), places(tab)
    tab.drag((60.0, 620.0), (40.0, 0.0))
    until(lambda: tab.camera_position() != camera, "the camera to turn")
    assert places(tab) == before


@pytest.mark.parametrize("axis", range(3))
def test_the_gizmo_of_the_handle_clicked_moves_it_along_one_axis_exactly(tab: Visitor, axis: int):
    node, camera, before = "/handles/waypoint2", tab.camera_position(), places(tab)["waypoint2"]
    tab.click_node(node)
    tab.wait_for_node(GIZMO)
    until(lambda: tab.node_position(GIZMO) == pytest.approx(before), "the gizmo at its handle")
    offset = [0.0, 0.0, 0.0]
    offset[axis] = 0.75 * GIZMO_SHARE * UNIT
    tip, root = tab.screen_position(GIZMO, _three(offset)), tab.screen_position(GIZMO)
    along = np.subtract(tip, root)
    tab.drag(tip, tuple(60 * along / np.linalg.norm(along)))
    until(lambda: tab.node_position(node)[axis] > before[axis] + 0.1, "the handle to move")
    moved = np.subtract(tab.node_position(node), before)
    assert [k for k in range(3) if moved[k] != 0] == [axis]
    assert tab.camera_position() == pytest.approx(camera, rel=1e-5)  # it comes to rest by and by


def test_escape_or_a_click_elsewhere_puts_the_gizmo_away(tab: Visitor):
    def shown() -> bool:
        return tab.page.evaluate("name => Boolean(window.__viserMutable.nodeRefFromName[name]?.visible)", GIZMO)

    for away in (lambda: tab.page.keyboard.press("Escape"), lambda: tab.page.mouse.click(60, 620)):
        tab.click_node("/handles/waypoint1")
        until(shown, "the gizmo")
        time.sleep(1)
        away()
        until(lambda: not shown(), "the gizmo to go")


def test_each_tab_gets_its_own_session_key_back_after_a_reload_and_from_a_new_server(browser: Browser):
    session_keys: list[str | None] = []

    def serve(port: int) -> viser.ViserServer:
        server = security.open_server("127.0.0.1", port)
        slots = Slots(lambda tab: identity.connected(server, tab))

        def greet(client: viser.ClientHandle) -> None:
            values.accept_values_only(client)
            client.scene.add_frame("/path")
            session_keys.append(identity.session_key(client, slots))
            client.gui.add_markdown(f"You are {session_keys[-1]}")

        server.on_client_disconnect(lambda client: slots.free(client.client_id))
        server.on_client_connect(greet)
        return server

    server = serve(0)
    port = server.get_port()
    first = Visitor(browser, f"http://127.0.0.1:{port}/", width=500, height=400, says="You are")
    second = Visitor(browser, f"http://127.0.0.1:{port}/", width=500, height=400, says="You are", beside=first)
    one, two = session_keys
    assert one is not None
    assert two == one.removesuffix("1") + "2"
    for tab, session_key in ((second, two), (first, one)):
        tab.page.bring_to_front()
        tab.reload()
        assert session_keys[-1] == session_key
    with second.reconnecting(), first.reconnecting():
        security.close_server(server)
        session_keys.clear()
        server = serve(port)
    for tab, session_key in ((second, two), (first, one)):
        tab.wait_for_text(f"You are {session_key}")
    assert len(session_keys) == 2
    second.close()
    first.close()
    security.close_server(server)


def _three(offset: list[float]) -> Vec3:
    return offset[0], offset[1], offset[2]
