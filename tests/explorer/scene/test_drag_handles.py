"""Drag handles: they are at the positions of the settings or of the pointer, and accept only valid positions."""

import itertools
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
import viser

from explorer.scene import drag_handles, labels
from explorer.scene.bounds import SceneBounds
from explorer.scene.drag_handles import DragHandles
from explorer.scene.handle_position import HandleMove
from explorer.scene.labels import Item, Labels
from explorer.web import security, values
from rangenav.inputs import Vec3
from tests.support import wire
from tests.support.wire import Wire

pytestmark = pytest.mark.slow


ANCHOR = (0.5, -0.25, 1.0)
POSITIONS = ((1.0, 2.0, 3.0), (1 / 3, 0.0, -1.0), (0.0, -2.0, 0.125))
FIRST, SECOND, ANCHOR_HANDLE, GIZMO = (f"/handles/{name}" for name in ("waypoint1", "waypoint2", "anchor", "gizmo"))
LAST = "/last"
"""A node of the tests' own: when its message has arrived, so have all earlier messages to the handles."""


def bounds_of(radius: float) -> SceneBounds:
    zero, up = np.zeros(3), np.array([0.0, 0.0, -1.0])
    return SceneBounds(
        centre=zero,
        radius=radius,
        unit=0.1 * radius,
        up=up,
        ground=zero,
        cell=0.5,
        view_centre=zero,
        view_radius=radius,
    )


@dataclass
class Tab:
    """A visitor's connection, and the server's handles for it."""

    wire: Wire
    handles: DragHandles
    woken: list[None]
    requests: int = 0
    answered: list[None] = field(default_factory=list)

    def take(self) -> list[HandleMove]:
        """Take the moves once every message has arrived: viser handles messages in their order."""
        self.requests += 1
        self.wire.drag_message(LAST, "start", POSITIONS[0], POSITIONS[0])
        self.wire.wait_for(lambda: len(self.answered) == self.requests, "the last message")
        return self.handles.take_moves()

    def wait_for_position(self, name: str, position: Vec3) -> None:
        self.wire.wait_for(
            lambda: self.wire.nodes[name]["position"] == pytest.approx(position, abs=1e-9), f"{name} there"
        )


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    opened = security.open_server("127.0.0.1", 0)
    yield opened
    security.close_server(opened)


@pytest.fixture
def tab(server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch) -> Iterator[Tab]:
    monkeypatch.setattr(wire, "NO_DOCK", 0.05)
    known = set(server.get_clients())
    visitor = Wire(server.get_port())
    visitor.wait_for(lambda: set(server.get_clients()) - known, "the connection")
    client = server.get_clients()[max(server.get_clients())]
    values.accept_values_only(client)
    woken: list[None] = []
    tab = Tab(
        visitor, DragHandles(client.scene, Labels(client.scene, client.camera), lambda: woken.append(None)), woken
    )

    async def answer(_: object) -> None:
        tab.answered.append(None)

    client.scene.add_icosphere(LAST).on_drag(answer)
    tab.handles.draw(ANCHOR, POSITIONS, bounds_of(2.0))
    visitor.wait_for(lambda: visitor.nodes.get("/handles/waypoint3", {}).get("bindings"), "the handles")
    tab.wait_for_position("/handles/waypoint3", POSITIONS[2])  # the last that draw() sends
    yield tab
    visitor.close()


def test_handles_stand_where_the_settings_say(tab: Tab):
    for name, position in zip((ANCHOR_HANDLE, FIRST, SECOND), (ANCHOR, *POSITIONS), strict=False):
        tab.wait_for_position(name, position)
    assert tab.wire.nodes[f"{SECOND}/label"]["text"] == "2"
    assert not tab.handles.dragging
    assert tab.handles.take_moves() == []


def test_the_numbers_of_waypoints_that_are_seen_at_one_place_never_lie_on_each_other(tab: Tab):
    ahead = (3.0, 3.0, 9.0)  # of the camera that the visitor reports
    tab.handles.draw(ANCHOR, (ahead,) * 12, bounds_of(2.0))
    names = [f"/handles/waypoint{k + 1}/label" for k in range(12)]
    tab.wire.wait_for(lambda: names[-1] in tab.wire.nodes, "the last label")
    tab.take()

    def seen() -> list:
        return [tab.wire.nodes[name] for name in names if tab.wire.nodes[name].get("visible", True)]

    def apart() -> bool:
        boxes = [labels.box_of(Item(one["text"], 0.0, 0.0, one["anchor"]), one["anchor"]) for one in seen()]
        return not any(one.meets(other) for one, other in itertools.combinations(boxes, 2))

    # each that comes or goes is a message of its own
    tab.wire.wait_for(lambda: seen() and apart(), "labels that do not lie on each other")
    assert 0 < len(seen()) < 12
    tab.handles.draw(ANCHOR, POSITIONS[:2], bounds_of(2.0))


def test_a_drag_is_taken_once_at_its_latest_place_and_the_handle_is_there_at_once(tab: Tab):
    tab.wire.drag(FIRST, (1.5, 2.0, 2.5), steps=7, done=False)
    tab.wire.wait_for(lambda: len(tab.woken) == 8, "a wake-up for the press and for each step")
    assert tab.take() == [HandleMove(kind="waypoint", index=0, position=(1.5, 2.0, 2.5), done=False)]
    tab.wait_for_position(FIRST, (1.5, 2.0, 2.5))
    assert tab.handles.dragging
    assert tab.handles.take_moves() == []
    tab.wire.drag_message(FIRST, "end", POSITIONS[0], (0.5, 2.0, 2.5))
    assert tab.take() == [HandleMove(kind="waypoint", index=0, position=(0.5, 2.0, 2.5), done=True)]
    assert not tab.handles.dragging
    tab.wire.drag(ANCHOR_HANDLE, (0.0, 0.0, 0.0))
    assert tab.take() == [HandleMove(kind="anchor", index=0, position=(0.0, 0.0, 0.0), done=True)]


def test_where_on_the_sphere_it_was_pressed_makes_no_difference(tab: Tab):
    pressed = (1.05, 2.0, 3.03)
    tab.wire.drag_message(FIRST, "start", pressed, pressed)
    tab.wire.drag_message(FIRST, "end", pressed, (2.05, 2.0, 4.03))
    assert tab.take()[0].position == (2.0, 2.0, 4.0)


def test_a_coordinate_that_was_not_moved_stays_to_the_last_digit_and_a_moved_one_is_readable(tab: Tab):
    tab.wire.drag(SECOND, (POSITIONS[1][0] + 1e-5, 0.1234567, -1.0))
    assert tab.take()[0].position == (1 / 3, 0.123, -1.0)
    tab.handles.draw(ANCHOR, POSITIONS, bounds_of(2000.0))
    tab.wait_for_position(SECOND, POSITIONS[1])
    tab.wire.drag(SECOND, (1234.567, 0.0, -1.0))
    assert tab.take()[0].position == (1235.0, 0.0, -1.0)


def test_drawing_moves_all_but_what_is_held(tab: Tab):
    tab.wire.drag(FIRST, (0.0, 2.0, 3.0), done=False)
    tab.take()
    elsewhere = ((9.0, 9.0, 9.0), (0.0, 0.0, 9.0), POSITIONS[2])
    tab.handles.draw((3.0, 3.0, 3.0), elsewhere, bounds_of(2.0))
    tab.wait_for_position(ANCHOR_HANDLE, (3.0, 3.0, 3.0))
    tab.wait_for_position(SECOND, elsewhere[1])
    assert tab.wire.nodes[FIRST]["position"] == pytest.approx((0.0, 2.0, 3.0))
    tab.wire.drag_message(FIRST, "end", POSITIONS[0], (0.0, 2.0, 3.0))
    tab.take()
    tab.handles.draw(ANCHOR, elsewhere, bounds_of(2.0))
    tab.wait_for_position(FIRST, elsewhere[0])


NONSENSE = [
    (math.nan, 0.0, 0.0),
    (0.0, math.inf, 0.0),
    (1e300, 0.0, 0.0),
    (0.0, 0.0, -1.1e5),
    (-1e308, 1e308, 1e308),
]


@pytest.mark.parametrize("place", NONSENSE)
def test_what_is_no_place_is_dropped_and_the_release_counts_all_the_same(tab: Tab, place: Vec3):
    tab.wire.drag(FIRST, (1.5, 2.0, 2.5), done=False)
    tab.take()
    tab.wire.drag_message(FIRST, "update", POSITIONS[0], place)
    assert tab.take() == [HandleMove(kind="waypoint", index=0, position=(1.5, 2.0, 2.5), done=False)]
    tab.wire.drag_message(FIRST, "end", POSITIONS[0], place)
    assert tab.take() == [HandleMove(kind="waypoint", index=0, position=(1.5, 2.0, 2.5), done=True)]
    tab.wire.drag_message(SECOND, "start", place, place)
    tab.wire.drag_message(SECOND, "end", place, (0.0, 0.0, 0.0))
    assert tab.take() == []
    assert not tab.handles.dragging


@pytest.mark.filterwarnings("ignore:.*does not match annotation")
@pytest.mark.parametrize("place", [(), (1.0,), (1.0, 2.0, 3.0, 4.0), "no", {}, [[1.0], [2.0], [3.0], [4.0]]])
def test_what_has_another_shape_is_dropped_too(tab: Tab, place: Any):
    tab.wire.drag_message(FIRST, "start", POSITIONS[0], POSITIONS[0])
    tab.wire.drag_message(FIRST, "update", POSITIONS[0], place)
    assert tab.take() == []
    tab.wire.drag_message(FIRST, "end", POSITIONS[0], (0.0, 0.0, 0.0))
    assert len(tab.take()) == 1


def test_a_drag_that_never_began_is_none_and_a_second_beginning_replaces_the_first(tab: Tab):
    tab.wire.drag_message(FIRST, "update", POSITIONS[0], (0.0, 0.0, 0.0))
    tab.wire.drag_message(FIRST, "end", POSITIONS[0], (0.0, 0.0, 0.0))
    assert tab.take() == []
    tab.wire.drag_message(FIRST, "start", POSITIONS[0], POSITIONS[0])
    tab.wire.drag_message(FIRST, "update", POSITIONS[0], (0.0, 0.0, 0.0))
    tab.wire.drag_message(FIRST, "start", POSITIONS[0], POSITIONS[0])
    tab.wire.drag_message(FIRST, "end", POSITIONS[0], (1.0, 2.0, 4.0))
    assert [move.position for move in tab.take()] == [(1.0, 2.0, 4.0)]


def test_the_handle_touched_last_has_the_gizmo_until_a_click_elsewhere_or_escape(
    tab: Tab, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(drag_handles, "SAME_CLICK", 0.1)
    gizmo = tab.wire.nodes[GIZMO]
    assert not gizmo["visible"]
    tab.wire.click(SECOND)  # which also is a click on the scene
    tab.take()
    tab.wire.wait_for(lambda: gizmo["visible"], "the gizmo")
    tab.wait_for_position(GIZMO, POSITIONS[1])
    tab.wire.click(FIRST)
    tab.take()
    tab.wait_for_position(GIZMO, POSITIONS[0])
    time.sleep(2 * drag_handles.SAME_CLICK)
    assert tab.take() == []
    tab.wire.wait_for(lambda: gizmo["visible"], "the gizmo to stay")
    ray: dict[str, Any] = {"ray_origin": (0.0, 0.0, 9.0), "ray_direction": (0.0, 0.0, -1.0), "modifier": None}
    tab.wire.send({"type": "ScenePointerMessage", "event_type": "click", "screen_pos": ((0.1, 0.1),), **ray})
    tab.wire.wait_for(lambda: tab.take() == [] and not gizmo["visible"], "the gizmo to go")
    tab.wire.drag(SECOND, (0.0, 0.0, 0.0))
    tab.take()
    tab.wait_for_position(GIZMO, (0.0, 0.0, 0.0))
    tab.wire.wait_for(lambda: gizmo["visible"], "the gizmo")
    tab.handles.deselect()
    tab.wire.wait_for(lambda: not gizmo["visible"], "the gizmo to go")


def test_the_gizmo_moves_its_handle_and_is_not_moved_itself_meanwhile(tab: Tab):
    tab.wire.click(SECOND)
    tab.take()
    tab.wait_for_position(GIZMO, POSITIONS[1])
    moves = tab.wire.counts["SetPositionMessage"]
    tab.wire.move_gizmo(GIZMO, (POSITIONS[1][0], 0.5, -1.0), done=False)
    assert tab.take() == [HandleMove(kind="waypoint", index=1, position=(1 / 3, 0.5, -1.0), done=False)]
    assert tab.handles.dragging
    tab.handles.draw(ANCHOR, POSITIONS, bounds_of(2.0))
    tab.wait_for_position(SECOND, (1 / 3, 0.5, -1.0))
    assert tab.wire.counts["SetPositionMessage"] == moves + 1  # the sphere's
    tab.wire.move_gizmo(GIZMO, (POSITIONS[1][0], 0.75, -1.0))
    assert tab.take() == [HandleMove(kind="waypoint", index=1, position=(1 / 3, 0.75, -1.0), done=True)]
    assert not tab.handles.dragging


def test_a_handle_is_not_held_for_ever_when_its_gizmo_is_put_away(tab: Tab):
    tab.wire.click(SECOND)
    tab.take()
    tab.wire.move_gizmo(GIZMO, (0.0, 0.5, -1.0), done=False)
    tab.take()
    tab.handles.deselect()
    assert [move.done for move in tab.handles.take_moves()] == [True]
    assert not tab.handles.dragging


@pytest.mark.filterwarnings("ignore:.*does not match annotation")
@pytest.mark.parametrize("place", [*NONSENSE, (), (1.0,), "no", {}])
def test_a_gizmo_is_not_moved_to_what_is_no_place_and_still_moves(tab: Tab, place: Any):
    tab.wire.click(SECOND)
    tab.take()
    tab.wire.move_gizmo(GIZMO, place, done=False)
    tab.wire.move_gizmo(GIZMO, (POSITIONS[1][0], 0.5, -1.0))
    assert tab.take() == [HandleMove(kind="waypoint", index=1, position=(1 / 3, 0.5, -1.0), done=True)]
    tab.wire.click(FIRST)
    tab.take()
    tab.wait_for_position(GIZMO, POSITIONS[0])


def test_of_very_many_waypoints_the_first_sixty_are_drawn_and_the_last_of_them_says_so(tab: Tab):
    many = tuple((0.1 * k, 0.0, 0.0) for k in range(100))
    tab.handles.draw(ANCHOR, many, bounds_of(2.0))
    tab.wire.wait_for(lambda: "/handles/waypoint60/label" in tab.wire.nodes, "the last")
    assert "/handles/waypoint61" not in tab.wire.nodes
    label = tab.wire.nodes["/handles/waypoint60/label"]
    tab.wire.wait_for(lambda: label["text"] == "60 (drag the first 60, the others by numbers)", "the label")
    tab.handles.draw(ANCHOR, many[:60], bounds_of(2.0))
    tab.wire.wait_for(lambda: label["text"] == "60", "the usual label")


def test_nodes_are_made_once_and_those_too_many_are_hidden_and_let_go(tab: Tab):
    created = tab.wire.counts["IcosphereMessage"]
    tab.wire.drag("/handles/waypoint3", (0.0, 0.0, 0.0), done=False)
    tab.take()
    tab.handles.draw(ANCHOR, POSITIONS[:1], bounds_of(2.0))
    assert not tab.handles.dragging
    tab.wire.wait_for(lambda: not tab.wire.nodes["/handles/waypoint3"]["visible"], "it to be hidden")
    tab.wire.wait_for(lambda: not tab.wire.nodes[GIZMO]["visible"], "its gizmo to be hidden")
    tab.handles.draw(ANCHOR, POSITIONS, bounds_of(2.0))
    tab.wait_for_position("/handles/waypoint3", POSITIONS[2])
    assert tab.wire.nodes["/handles/waypoint3"]["visible"]
    assert tab.wire.counts["IcosphereMessage"] == created
