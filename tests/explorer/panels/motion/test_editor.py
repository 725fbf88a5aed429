"""Editing motion through viser's messages: every family, typed or dragged, drafts, and what bad input is answered."""

import math
import time
from collections.abc import Callable, Iterator

import msgspec
import numpy as np
import pytest

from explorer.model.history import MOMENT
from explorer.server import SessionServer
from rangenav import preset
from rangenav.signals import Formula, MinimumSnap, Multisine, Polynomials, Sum, Waypoints
from tests.support.waiting_visitor import Editing, arrived

pytestmark = pytest.mark.slow


LONGEST_ANSWER = 1.0
"""s in which a complaint about bad input must appear, beyond the time that a picture takes on this machine."""


@pytest.fixture(scope="module")
def opened(sessions: tuple[int, SessionServer]) -> Iterator[Callable[[str], Editing]]:
    """opened(family) -> one visitor with a path of this family, for many mistakes: each of them is corrected."""
    visitors: dict[str, Editing] = {}

    def visitor(family: str) -> Editing:
        if family not in visitors:
            visitors[family] = arrived(sessions)
            visitors[family].set("path made of", family)
        return visitors[family]

    yield visitor
    for one in visitors.values():
        one.tab.close()


def test_each_family_starts_from_what_was_there_and_keeps_what_was_entered(editing: Editing):
    start = editing.settings.preset.path
    places = start(np.linspace(0, 3, 50))
    for label, kind in (
        ("formulas", Formula),
        ("waypoints", Waypoints),
        ("minimum snap", MinimumSnap),
        ("polynomials", Polynomials),
    ):
        editing.set("path made of", label)
        path = editing.settings.preset.path
        assert isinstance(path, kind)
        assert np.abs(path(np.linspace(0, 3, 50)) - places).max() < 0.05
    editing.set("path made of", "formulas")
    editing.set("x(t) =", "cos(3*t)")
    editing.set("path made of", "sines")
    assert editing.settings.preset.path == start
    editing.set("path made of", "formulas")
    path = editing.settings.preset.path
    assert isinstance(path, Formula)
    assert path.x == "cos(3*t)"


def test_a_mistake_in_a_formula_is_pointed_at_and_undone(editing: Editing):
    editing.set("path made of", "formulas")
    good = editing.settings
    editing.set("y(t) =", "sin(2*t")
    assert any("column 8" in text and "sin(2*t\n       ^" in text for text in editing.refusals())
    assert editing.settings == good
    editing.command("Undo")
    editing.wait_until_accepted()
    assert editing.tab.value("y(t) =") == good.preset.path.y  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("1/(t-1)", "no finite value at t = 1 s"),
        ("1/0", "divides by zero"),
        ("exp(exp(t))", "exceeds"),
        ("__import__('os').system('true')", "__import__ is not known"),
        ("sin(t)*" * 2000 + "1", "1000 characters"),
        ("(" * 900, "nested too deeply"),
        ("t" * 10_000_000, "20000 characters"),
        ("", "the formula is empty"),
        ("\x00<script>", "has no meaning"),
        ("sin(1e4*t)", "faster than the IMU can sample"),
    ],
)
def test_a_hostile_formula_gets_a_sentence_within_a_second_and_the_picture_stays(
    opened: Callable[[str], Editing], text: str, sentence: str
):
    editing = opened("formulas")
    good = editing.settings
    began = time.monotonic()
    editing.tab.set("z(t) =", text)
    editing.tab.wait_for(lambda: any(sentence in complaint for complaint in editing.refusals()), sentence)
    assert time.monotonic() - began < LONGEST_ANSWER + 4  # a shared machine may be busy
    assert editing.settings == good
    editing.set("z(t) =", good.preset.path.z)  # type: ignore[union-attr]
    editing.wait_until_accepted()


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("0 0 0 0\n0 1 1 1", "waypoint 2 at 0 s must come"),
        ("0 0 0 0\n2 1 1 1\n1 0 0 0", "waypoint 3 at 1 s must come"),
        ("0 0 0 0", "2 to 2000 waypoints"),
        ("", "2 to 2000 waypoints"),
        ("\n".join(f"{k} 0 0 {k % 3}" for k in range(10_000)), "at most 5000 lines"),
        ("\n".join(f"{k * 0.01:.2f} 0 0 {k % 3}" for k in range(3000)), "2 to 2000 waypoints"),
        ("0 0 0\n1 1 1 1", "line 1: expected 4 numbers"),
        ("0 0 0 0\n1 nan 1 1", "line 2: “nan” is not a number"),
        ("0 0 0 0\n1 1e300 1 1", "line 2: value must lie between"),
        ("0 0 0 0\n1 x 1 1", "line 2: “x” is not a number"),
        ("7" * 1_000_000, "250000 characters"),
    ],
)
def test_bad_waypoints_get_a_sentence_and_the_picture_stays(opened: Callable[[str], Editing], text: str, sentence: str):
    editing = opened("waypoints")
    good = editing.settings
    editing.set("ends of the curve", "open: at rest at both ends")
    editing.tab.set("points, a line t x y z each", text)
    editing.tab.wait_for(lambda: any(sentence in complaint for complaint in editing.refusals()), sentence)
    editing.command("Undo")
    editing.wait_until_accepted()
    assert editing.settings.preset.path.points == good.preset.path.points  # type: ignore[union-attr]


def test_coincident_points_and_repeated_places_are_a_path(editing: Editing):
    editing.set("path made of", "waypoints")
    editing.set("ends of the curve", "open: at rest at both ends")
    editing.set("points, a line t x y z each", "0 1 1 1\n5 1 1 1\n10 2 1 1\n15 2 1 1\n20 1 1 1")
    editing.wait_until_accepted()
    path = editing.settings.preset.path
    assert isinstance(path, Waypoints)
    assert [point.time for point in path.points] == [0, 5, 10, 15, 20]


def test_an_open_curve_may_be_in_motion_at_its_ends(editing: Editing):
    editing.set("path made of", "waypoints")
    editing.set("ends of the curve", "open: in motion at both ends")
    editing.wait_until_accepted()
    path = editing.settings.preset.path
    assert isinstance(path, Waypoints)
    assert (path.free_ends, path.period) == (True, None)
    assert abs(path(np.zeros(1) + path.points[0].time, 1)).max() > 0.01
    editing.set("ends of the curve", "open: at rest at both ends")
    editing.wait_until_accepted()
    assert not editing.settings.preset.path.free_ends  # type: ignore[union-attr]


def test_a_waypoint_is_moved_retimed_inserted_and_deleted_by_numbers(editing: Editing):
    editing.set("path made of", "waypoints")
    before = editing.settings.preset.path
    assert isinstance(before, Waypoints)
    editing.set("chosen point", "3")
    editing.set("position of the point (m)", (0.5, 0.25, -0.125))
    path = editing.settings.preset.path
    assert isinstance(path, Waypoints)
    assert path.points[2].value == (0.5, 0.25, -0.125)
    assert path.points[3] == before.points[3]
    assert "0.5  0.25  -0.125" in editing.tab.value("points, a line t x y z each")
    editing.set("time of the point (s)", 0.6)
    assert editing.settings.preset.path.points[2].time == 0.6  # type: ignore[union-attr]
    editing.press("", "+ after it")
    assert len(editing.settings.preset.path.points) == len(before.points) + 1  # type: ignore[union-attr]
    assert editing.tab.value("chosen point") == "4"
    editing.press("", "− delete it")
    assert len(editing.settings.preset.path.points) == len(before.points)  # type: ignore[union-attr]
    editing.set("time of the point (s)", 0.1)
    assert any("must come at least" in complaint for complaint in editing.refusals())


def test_the_table_and_the_boxes_show_the_same_point(editing: Editing):
    editing.set("path made of", "waypoints")
    lines = editing.tab.value("points, a line t x y z each").split("\n")
    lines[0] = "0  0.7  0.6  0.5"
    editing.set("points, a line t x y z each", "\n".join(lines))
    assert editing.tab.value("position of the point (m)") == ("0.7", "0.6", "0.5")


def test_polynomials_are_typed_as_in_their_files_and_jumps_are_named(editing: Editing):
    editing.set("path made of", "polynomials")
    header = "duration,x^0,x^1,…"
    row = "5,0,1,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,"
    editing.set("pieces", f"{header}\n{row}\n{row}")
    path = editing.settings.preset.path
    assert isinstance(path, Polynomials)
    assert len(path.pieces) == 2
    assert "position jumps by 5 m along x at t = 5.00 s" in editing.tab.text()
    assert "not flyable</b> by any vehicle" in editing.tab.text()
    editing.set("pieces", f"{row}\n1,2,3")
    assert any("line 2: expected 33 numbers" in complaint for complaint in editing.refusals())


def test_tones_are_added_and_removed_and_come_back(editing: Editing):
    before = editing.settings.preset.path
    assert isinstance(before, Multisine)
    editing.press("add a tone along", "+ z")
    after = editing.settings.preset.path
    assert isinstance(after, Multisine)
    assert after.tones[:-1] == before.tones
    assert after.tones[-1].axis == "z"
    editing.press("", "− remove this tone")
    assert editing.settings.preset.path.tones == after.tones[1:]  # type: ignore[union-attr]
    editing.command("Undo")
    assert editing.settings.preset.path == after
    editing.command("Undo")
    assert editing.settings.preset.path == before


def test_presses_within_a_moment_are_all_taken_in_their_order(editing: Editing):
    before, form, pressed = editing.settings.preset.path, editing.session.form, "zxyyzx"
    assert isinstance(before, Multisine)
    run = form.actions_run
    for axis in pressed:
        editing.tab.press("add a tone along", f"+ {axis}")
    editing.tab.wait_for(lambda: form.actions_run == run + len(pressed), "all presses to be taken")
    editing.settle()
    after = editing.settings.preset.path
    assert isinstance(after, Multisine)
    assert "".join(tone.axis for tone in after.tones[len(before.tones) :]) == pressed
    while editing.settings.preset.path != before:
        editing.command("Undo")


def test_a_wiggle_makes_a_sum_and_is_kept_when_it_is_off(editing: Editing):
    editing.set("preset", f"{preset.load('circle').title} (circle)")
    assert "blind</b>" in editing.tab.text()
    editing.set("add a second motion", True)
    path = editing.settings.preset.path
    assert isinstance(path, Sum)
    assert "blind</b>" not in editing.tab.text()
    editing.set("add a second motion", False)
    assert editing.settings.preset.path == path.base
    editing.set("add a second motion", True)
    assert editing.settings.preset.path == path


def test_the_angular_velocity_changes_neither_gramian_nor_pe_but_the_printed_phi(editing: Editing):
    before = editing.session.picture
    editing.set("initial attitude error (°)", 0.0)
    families = [
        uuid for uuid, p in editing.tab.elements.items() if (p.get("label") or "").startswith("turning made of")
    ]
    editing.tab.send({"type": "GuiUpdateMessage", "uuid": families[-1], "updates": {"value": "formulas"}})
    editing.settle()
    texts = [uuid for uuid, p in editing.tab.elements.items() if (p.get("label") or "").startswith("x(t)")]
    editing.tab.send({"type": "GuiUpdateMessage", "uuid": texts[-1], "updates": {"value": "2*sin(3*t)"}})
    editing.settle()
    after = editing.session.picture
    assert before is not None
    assert after is not None
    assert isinstance(after.preset.angular_velocity, Formula)
    assert np.array_equal(after.analysis.gramian, before.analysis.gramian)
    assert after.analysis.mu == before.analysis.mu
    norms = [np.linalg.norm(picture.phi_printed, axis=1) for picture in (before, after)]
    assert np.abs(norms[1] - norms[0]).max() > 1


def test_a_flown_body_leans_as_its_thrust_does(editing: Editing):
    families = [
        uuid for uuid, p in editing.tab.elements.items() if (p.get("label") or "").startswith("turning made of")
    ]
    label = "flown: as a multirotor must"
    editing.tab.send({"type": "GuiUpdateMessage", "uuid": families[-1], "updates": {"value": label}})
    editing.settle()
    picture = editing.session.picture
    assert picture is not None
    felt = picture.motion.apparent_acceleration
    assert np.abs(felt[:, :2]).max() < 1e-9
    editing.set("yaw(t) =", "t t")
    assert any("column 3" in complaint for complaint in editing.refusals())


def test_the_whole_path_is_scaled_turned_mirrored_and_centred_about_the_anchor(editing: Editing):
    before = editing.settings.preset.path
    at = np.linspace(0, 3, 40)
    editing.set("size factor", 2.0)
    editing.press("", "scale")
    assert np.allclose(editing.settings.preset.path(at), 2 * before(at), atol=1e-12)
    editing.command("Undo")
    assert editing.settings.preset.path == before
    editing.set("angle of the turn (°)", 90.0)
    editing.press("", "turn")
    x, y, z = before(at).T
    assert np.allclose(editing.settings.preset.path(at), np.stack([-y, x, z], axis=1), atol=1e-12)
    editing.command("Undo")
    editing.press("", "mirror")
    assert np.allclose(editing.settings.preset.path(at), np.stack([x, y, -z], axis=1), atol=1e-12)
    editing.command("Undo")
    editing.set("anchor position (m)", (1.0, 2.0, 3.0))
    editing.press("", "centre")
    box = editing.settings.preset.path(np.linspace(0, 20, 4001))
    assert np.allclose((box.max(axis=0) + box.min(axis=0)) / 2, (1, 2, 3), atol=1e-3)
    editing.set("size factor", math.nan)
    editing.press("", "scale")
    assert any("size factor: “nan” is not a number" in complaint for complaint in editing.refusals())


def test_relabelling_the_axes_twice_changes_nothing_and_once_nothing_that_can_be_measured(editing: Editing):
    editing.set("anchor position (m)", (0.5, 0.25, -1.0))
    before, picture = editing.settings, editing.session.picture
    editing.press("Relabel the axes: z up ↔ z down")
    once, flipped = editing.settings, editing.session.picture
    assert once.preset.world.gravity == (0.0, 0.0, -9.81)
    assert picture is not None
    assert flipped is not None
    assert np.allclose(flipped.analysis.gramian, picture.analysis.gramian, rtol=1e-9)
    assert flipped.analysis.lifted_end.position == pytest.approx(picture.analysis.lifted_end.position, rel=1e-6)
    assert "z points up" in editing.tab.text()
    editing.press("Relabel the axes: z up ↔ z down")
    assert editing.settings == before


def test_a_vehicle_is_held_against_the_path_and_what_breaks_is_named(editing: Editing):
    editing.set("speed (slower ⟷ faster)", math.log10(2.0))
    editing.set("vehicle", "Crazyflie 2.1")
    picture = editing.session.picture
    assert picture is not None
    assert {one.limit for one in picture.breaks} >= {"thrust_to_weight"}
    assert "not flyable</b> by Crazyflie 2.1" in editing.tab.text()


def test_a_waypoint_is_dragged_and_everything_follows(editing: Editing):
    editing.set("path made of", "waypoints")
    before = editing.settings.preset.path
    assert isinstance(before, Waypoints)
    editing.drag("/handles/waypoint3", (0.2, 0.9, -0.4), steps=5)
    editing.settle()
    path = editing.settings.preset.path
    assert isinstance(path, Waypoints)
    assert path.points[2].value == pytest.approx((0.2, 0.9, -0.4), abs=1e-2)
    assert path.points[:2] == before.points[:2]
    assert editing.tab.value("chosen point") == "3"
    assert tuple(map(float, editing.tab.value("position of the point (m)"))) == path.points[2].value
    editing.command("Undo")
    assert editing.settings.preset.path == before


def test_the_anchor_is_dragged_and_the_gramian_stays(editing: Editing):
    before = editing.session.picture
    editing.drag("/handles/anchor", (0.5, 0.25, -1.0))
    editing.settle()
    after = editing.session.picture
    assert before is not None
    assert after is not None
    assert after.preset.world.anchor == pytest.approx((0.5, 0.25, -1.0), abs=1e-2)
    held, moved = before.at_rest.analysis, after.at_rest.analysis  # a hand that moves has fewer windows
    assert np.array_equal(moved.gramian, held.gramian)
    assert moved.lifted_end.position != held.lifted_end.position


def test_a_waypoint_of_a_sum_is_where_its_handle_is(editing: Editing):
    editing.set("path made of", "waypoints")
    editing.set("add a second motion", True)
    editing.set("offset of the sum (m)", (0.0, 0.0, -2.0))
    path, handle = editing.settings.preset.path, editing.tab.nodes["/handles/waypoint1"]
    assert isinstance(path, Sum)
    place = np.add(path.base.points[0].value, (0, 0, -2))  # type: ignore[union-attr]
    editing.tab.wait_for(lambda: np.allclose(handle["position"], place, atol=1e-9), "the handle where the waypoint is")
    editing.drag("/handles/waypoint1", (1.5, 0.0, -2.0))
    editing.settle()
    path = editing.settings.preset.path
    assert path.base.points[0].value == pytest.approx((1.5, 0.0, 0.0), abs=1e-2)  # type: ignore[union-attr]


def test_a_handle_dragged_to_nonsense_changes_nothing(editing: Editing):
    before = editing.settings
    editing.drag("/handles/anchor", (math.nan, math.inf, 1e300))
    editing.settle()
    assert editing.settings == before


def test_the_evil_twin_follows_its_numbers_and_a_drag_and_undo_brings_it_back(editing: Editing):
    hover = preset.load("hover")
    editing.set("preset", f"{hover.title} (hover)")
    editing.tab.wait_for(lambda: editing.tab.nodes["/twin"]["visible"], "the twin")
    usual = editing.tab.nodes["/twin"]["position"]
    editing.set("turn of the twin (°)", 35.0)
    turn = editing.settings.twin_turn
    assert turn is not None
    assert math.hypot(*turn) == pytest.approx(math.radians(35.0))
    editing.tab.wait_for(lambda: editing.tab.nodes["/twin"]["position"] != usual, "the twin, elsewhere")
    turned = editing.tab.nodes["/twin"]["position"]
    time.sleep(1.1 * MOMENT)  # what moves the same thing sooner is the same step
    editing.tab.drag("/twin/frame", usual, steps=3)
    editing.tab.wait_for(lambda: np.allclose(editing.tab.nodes["/twin"]["position"], usual, atol=1e-3), "it, dragged")
    assert editing.tab.nodes["/twin"]["visible"]
    editing.settle()
    anchor, true = np.asarray(hover.world.anchor), hover.path(np.zeros(()))
    apart = np.linalg.norm(usual - true) / np.linalg.norm(true - anchor)
    shortest = math.degrees(2 * math.asin(apart / 2))  # a drag takes the shortest of all turns that lead there
    assert editing.tab.value("turn of the twin (°)") == pytest.approx(shortest, abs=0.1)
    editing.tab.press_own("undo")
    editing.tab.wait_for(lambda: np.allclose(editing.tab.nodes["/twin"]["position"], turned), "it, where it was")
    editing.press("The usual twin")
    assert editing.settings.twin_turn is None


def test_a_drag_across_a_plot_draws_the_window_and_a_click_goes_to_its_moment(editing: Editing):
    duration = editing.settings.preset.duration
    editing.tab.set("pointer", "0.4500 100:0.2000-0.4500")
    editing.tab.wait_for(lambda: editing.settings.preset.requirement.window == pytest.approx(0.25 * duration), "window")
    editing.tab.wait_for_text(f"<b>{0.2 * duration:.2f} s</b>")
    editing.tab.set("pointer", "0.7000 101:0.7000-0.7010")
    editing.tab.wait_for_text(f"<b>{0.7 * duration:.2f} s</b>")
    assert editing.settings.preset.requirement.window == pytest.approx(0.25 * duration)


def test_an_angular_velocity_that_has_no_editor_is_kept_as_it_is_and_can_be_left_and_taken_up_again(editing: Editing):
    wobble = Sum(base=Multisine(offset=(0.0, 0.0, 0.4)), wiggle=Formula(x="0.2*sin(3*t)", y="0", z="0"))
    brought = msgspec.structs.replace(preset.load("paper-slow"), angular_velocity=wobble)
    editing.tab.upload("Upload a preset", "wobble.toml", preset.dumps(brought).encode())
    editing.tab.wait_for(lambda: editing.settings.preset.angular_velocity == wobble, "the preset")
    assert "sines plus formulas" in editing.tab.text()
    turning = [key for key, p in editing.tab.elements.items() if "as in the file" in (p.get("options") or ())]
    assert len(turning) == 1
    for label, kind in (("sines", Multisine), ("keyframes", Waypoints), ("as in the file", Sum)):
        editing.tab.send({"type": "GuiUpdateMessage", "uuid": turning[0], "updates": {"value": label}})
        editing.settle()
        assert isinstance(editing.settings.preset.angular_velocity, kind)
    assert editing.settings.preset.angular_velocity == wobble
    editing.command("Undo")
    assert isinstance(editing.settings.preset.angular_velocity, Waypoints)
    assert editing.refusals() == []
