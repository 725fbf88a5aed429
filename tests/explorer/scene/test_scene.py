"""The 3-D picture: it shows the truth where it is, and sends nothing that a page could not draw."""

import time as clock

import numpy as np
import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st
from numpy import ndarray as Array
from viser.transforms import SO3

from explorer.model.comparison import Comparison
from explorer.scene import Scene, view
from explorer.scene.bounds import (
    MAX_STRAY,
    dashes_along,
    ellipsoid_axes,
    last_known,
    near_truth,
    path_segments,
    rotation_from_x,
    scene_bounds,
)
from explorer.scene.view import IDLE_TIME
from rangenav import preset
from tests.support.pictures import astronomic, picture
from tests.support.sent_messages import Page

pytestmark = pytest.mark.slow


def test_before_the_first_picture_no_vehicle_estimate_or_anchor_is_shown(page: Page) -> None:
    scene, names = Scene(page.client, lambda: None), ("/vehicle", "/estimate", "/ellipsoid", "/anchor")
    assert not any(page.node(name).visible for name in names)
    scene.draw(picture("paper-slow"))
    assert page.node("/vehicle").visible
    assert page.node("/anchor").visible


@pytest.mark.parametrize("time", [0.0, 3.2149, 1e9])
def test_vehicle_and_range_sphere_are_those_of_the_nearest_sample(page: Page, time: float) -> None:
    scene, example = Scene(page.client, lambda: None), picture("circle")
    scene.draw(example)
    scene.move(example, time)
    k = int(np.argmin(np.abs(example.motion.time - time)))
    vehicle = page.node("/vehicle")
    assert vehicle.position == pytest.approx(example.motion.position[k])
    assert SO3(vehicle.wxyz).as_matrix() == pytest.approx(example.motion.rotation[k])
    distance = np.linalg.norm(example.motion.position[k] - example.preset.world.anchor)
    assert page.node("/anchor/range").scale == pytest.approx(distance)  # type: ignore[attr-defined]


def test_ghost_stands_at_the_estimate_once_that_has_settled(page: Page) -> None:
    scene, example = Scene(page.client, lambda: None), picture("paper")
    scene.draw(example)
    scene.move(example, example.preset.duration)
    assert page.node("/estimate").visible
    assert page.node("/estimate").position == pytest.approx(example.position_estimate[-1])
    turned = example.estimate.rotation[-1] @ example.estimate.state[-1, 10:13]
    arrow = SO3(page.node("/compass/gravity_estimate").wxyz).as_matrix()[:, 0]
    assert arrow == pytest.approx(turned / np.linalg.norm(turned))


@pytest.mark.parametrize("name", ["hover", "line", "wiggle"])
def test_an_astronomic_estimate_is_neither_sent_nor_an_error(page: Page, name: str) -> None:
    scene, example = Scene(page.client, lambda: None), astronomic(name)
    scene.draw(example)
    for time in np.linspace(0.0, example.preset.duration, 33):
        scene.move(example, float(time))
    numbers = np.array(list(page.numbers()))
    assert np.isfinite(numbers).all()
    assert not page.node("/estimate").visible
    far = page.scene.get_handle_by_name("/compass/far/label")
    assert isinstance(far, viser.LabelHandle)
    assert "not a number" in far.text
    scene.move(example, 0.9 * example.preset.duration)
    assert "this way" in far.text
    assert "e1" in far.text


def test_nodes_are_made_once(page: Page) -> None:
    scene, first, second = Scene(page.client, lambda: None), picture("circle"), picture("hover")
    before = len(page.messages)
    scene.draw(first)
    scene.draw(second)
    scene.move(second, 2.0)
    created = [message for message in page.messages[before:] if hasattr(message, "props")]
    assert created == []


def test_a_move_is_small(page: Page) -> None:
    scene, example = Scene(page.client, lambda: None), picture("soft")
    scene.draw(example)
    before = len(page.messages)
    scene.move(example, 4.0)
    sent = page.messages[before:]
    assert len(sent) < 20
    page.messages[:] = sent
    assert len(list(page.numbers())) < 400  # 240 of them are the tail


def test_blind_directions_have_arrows_with_a_word_and_observable_paths_have_none(page: Page) -> None:
    scene = Scene(page.client, lambda: None)
    scene.draw(picture("circle"))
    assert page.node("/blind0").visible
    label = page.scene.get_handle_by_name("/blind0/label")
    assert isinstance(label, viser.LabelHandle)
    assert label.text == "blind along z: position, velocity"
    assert not page.node("/blind1").visible
    scene.draw(picture("paper-slow"))
    assert not page.node("/blind0").visible


def test_a_proposed_motion_is_a_line_with_its_name_until_it_is_gone(page: Page) -> None:
    scene, example = Scene(page.client, lambda: None), picture("circle")
    proposed = preset.load("tilted-circle")
    scene.draw(example, Comparison(proposed=proposed))
    line, label = page.node("/proposed"), page.node("/proposed/label")
    ends = line.points[:, 0]  # type: ignore[attr-defined]
    assert line.visible
    assert ends[0] == pytest.approx(proposed.path(np.zeros(1))[0], abs=1e-6)
    assert label.visible
    heights = np.abs(ends[:, 2] - example.motion.position[0, 2])
    at = np.argmin(np.linalg.norm(ends - np.asarray(label.position), axis=1))
    assert heights[at] > 0.9 * heights.max()  # far from the true path, which is flat
    scene.draw(example)
    assert not line.visible
    assert not label.visible


def test_camera_frames_the_first_path_and_a_much_larger_one_but_not_while_it_is_moved(page: Page) -> None:
    scene = Scene(page.client, lambda: None)
    scene.draw(picture("circle"))
    first = np.array(page.camera.position)
    scene.draw(picture("soft"))  # about as large, and in the same place
    assert np.array_equal(page.camera.position, first)
    page.camera.position = np.array([90.0, 0.0, 0.0])  # by a visitor
    scene.look("first")
    assert np.allclose(page.camera.position, first)
    page.camera.update_timestamp = clock.time()
    scene.draw(picture("line"))
    assert np.array_equal(page.camera.position, first)
    page.camera.update_timestamp = clock.time() - 2 * IDLE_TIME
    scene.draw(picture("line"))
    bounds = scene_bounds(picture("line"))
    assert np.linalg.norm(page.camera.position - bounds.view_centre) > 10
    assert (page.camera.position - bounds.view_centre) @ bounds.up > 0


def test_camera_stands_still_during_a_drag_and_after_it_unless_the_path_has_left_the_view(page: Page) -> None:
    scene = Scene(page.client, lambda: None)
    scene.draw(picture("circle"))
    placed = np.array(page.camera.position)
    scene.draw(picture("line"), dragging=True)  # 20 m long, and only its start is in view
    assert np.array_equal(page.camera.position, placed)
    scene.draw(picture("circle"))
    assert np.array_equal(page.camera.position, placed)
    scene.draw(picture("circle"), dragging=True)
    scene.draw(picture("line"), dragging=True)
    scene.draw(picture("line"))
    assert np.linalg.norm(page.camera.position - placed) > 5


def test_after_a_drag_a_view_of_a_detail_is_left_to_the_visitor(page: Page) -> None:
    scene = Scene(page.client, lambda: None)
    scene.draw(picture("circle"))
    page.camera.position, page.camera.look_at = (9.0, 9.0, 9.0), (10.0, 10.0, 9.0)
    scene.draw(picture("circle"), dragging=True)
    scene.draw(picture("line"))
    assert page.camera.position == (9.0, 9.0, 9.0)
    scene.draw(picture("line"))  # whatever comes next without a drag
    assert page.camera.position == (9.0, 9.0, 9.0)
    scene.draw(picture("circle"))
    assert np.linalg.norm(np.subtract(page.camera.position, 9.0)) > 1


def test_the_camera_is_moved_by_steps_and_stays_there_when_docks_open(page: Page) -> None:
    scene = Scene(page.client, lambda: None)
    scene.draw(picture("circle"))
    bounds = scene_bounds(picture("circle"))

    def away() -> np.ndarray:
        return np.asarray(page.camera.position) - np.asarray(page.camera.look_at)

    first = away()
    scene.step_camera("closer")
    assert away() == pytest.approx(first / view.CLOSER)
    scene.step_camera("farther")
    scene.step_camera("left")
    assert np.linalg.norm(away()) == pytest.approx(np.linalg.norm(first))
    assert away() @ bounds.up == pytest.approx(first @ bounds.up)
    assert np.degrees(
        np.arccos(
            np.dot(*(np.cross(bounds.up, one) for one in (away(), first)))
            / np.prod([np.linalg.norm(np.cross(bounds.up, one)) for one in (away(), first)])
        )
    ) == pytest.approx(15.0)
    for _ in range(20):
        scene.step_camera("up")
    assert away() @ bounds.up < np.linalg.norm(away())  # never over the top
    scene.look("above")
    assert away() @ bounds.up > 0.99 * np.linalg.norm(away())
    page.camera.image_width //= 2  # docks have opened
    seen = np.array(page.camera.position)
    page.camera.report(page.camera.position)
    scene.move(picture("circle"), 0.0)
    assert np.array_equal(page.camera.position, seen)


@given(
    st.lists(st.floats(-5, 5), min_size=3, max_size=3),
    st.floats(-0.98, 0.98),
    st.floats(-0.98, 0.98),
    st.floats(0.1, 50),
    st.floats(0.5, 2.0),
    st.floats(0.3, 2.0),
)
def test_a_camera_sees_what_is_ahead_of_it_and_inside_its_picture(
    place: list[float], across: float, down: float, far: float, fov: float, shape: float
) -> None:
    turn = SO3.from_rpy_radians(across * 3, down, far % 3)
    top = np.tan(fov / 2)

    def share(across: float, down: float, far: float) -> float:
        there = np.array(place) + turn.as_matrix() @ np.array([across * shape * top, down * top, 1.0]) * far
        return view.visible_share(there[None], np.array(place), turn.wxyz, fov, shape)

    assert share(across, down, far) == 1
    assert share(across, down, -far) == 0
    assert share(1.02 if across > 0 else -1.02, down, far) == 0
    assert share(across, 1.02 if down > 0 else -1.02, far) == 0


def report_camera(page: Page, scene: Scene, position: Array) -> None:
    """The browser reports its camera, and the session's loop comes round."""
    page.camera.report(position)
    scene.move(picture("circle"), 0.0)


def test_camera_that_did_not_arrive_is_sent_again_a_few_times_and_one_that_did_is_left_alone(page: Page) -> None:
    scene = Scene(page.client, lambda: None)
    scene.draw(picture("circle"))
    wanted = np.array(page.camera.position)
    report_camera(page, scene, -wanted)
    assert page.camera.position == pytest.approx(wanted)
    report_camera(page, scene, wanted + 1e-3)
    report_camera(page, scene, -wanted)  # now the visitor turns it
    assert page.camera.position == pytest.approx(-wanted)


def test_sizes_follow_the_path() -> None:
    small, large = scene_bounds(picture("wiggle")), scene_bounds(picture("line"))
    assert small.unit < 0.1 < 1.0 < large.unit
    assert small.cell < large.cell
    assert large.up == pytest.approx([0, 0, -1])


def test_true_path_leaves_the_curve_by_less_than_a_hundredth_of_the_scene() -> None:
    example = picture("paper")
    bounds = scene_bounds(example)
    segments = path_segments(example.motion, bounds)
    assert segments[0, 0] == pytest.approx(example.motion.position[0])
    assert segments[-1, 1] == pytest.approx(example.motion.position[-1])
    middles = segments.mean(axis=1)
    gaps = np.linalg.norm(middles[:, None] - example.motion.position[None], axis=-1).min(axis=1)
    assert gaps.max() < 0.01 * bounds.radius + np.linalg.norm(np.diff(example.motion.position, axis=0), axis=1).max()


def test_dashes_are_half_of_the_curve_and_never_outside_the_scene() -> None:
    bounds = scene_bounds(picture("circle"))
    turn = np.linspace(0, 2 * np.pi, 1000)
    ring = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    dashes, progress = dashes_along(ring, bounds)
    length = np.linalg.norm(dashes[:, 1] - dashes[:, 0], axis=1).sum()
    assert length == pytest.approx(np.pi, rel=0.05)
    assert ((progress >= 0) & (progress <= 1)).all()
    away = np.concatenate([ring, 1e17 * ring, np.full((50, 3), np.nan), ring])
    assert bounds.contains(dashes_along(away, bounds)[0].reshape(-1, 3)).all()
    nothing, _ = dashes_along(np.full((100, 3), 1e17), bounds)
    assert nothing.shape == (0, 2, 3)


@given(st.lists(st.floats(-10, 10), min_size=3, max_size=3).filter(lambda d: np.linalg.norm(d) > 1e-3))
def test_rotation_from_x_turns_x_to_the_direction(direction: list[float]) -> None:
    unit = np.array(direction) / np.linalg.norm(direction)
    wxyz = np.array(rotation_from_x(np.array(direction)))
    assert np.linalg.norm(wxyz) == pytest.approx(1)
    # next to −x the turn is rounded to the half turn: √(2·1e-9) rad
    assert SO3(wxyz).as_matrix()[:, 0] == pytest.approx(unit, abs=1e-4)


def test_ellipsoid_gives_the_covariance_back_and_refuses_what_is_none() -> None:
    rng = np.random.default_rng(1)
    root = rng.standard_normal((3, 3))
    decomposition = ellipsoid_axes(root @ root.T)
    assert decomposition is not None
    semi, axes = decomposition
    assert np.linalg.det(axes) == pytest.approx(1)
    assert axes @ np.diag(semi**2) @ axes.T == pytest.approx(root @ root.T)
    assert ellipsoid_axes(np.diag([1.0, -1.0, 1.0])) is None
    assert ellipsoid_axes(np.full((3, 3), np.nan)) is None


def test_last_known_fills_the_gaps_of_a_slow_magnetometer() -> None:
    samples = np.array([[1.0, 0, 0], [np.nan] * 3, [np.nan] * 3, [0, 1.0, 0]])
    assert last_known(samples) == pytest.approx(samples[[0, 0, 0, 3]])


def test_the_estimated_path_is_left_out_where_it_strays_and_kept_elsewhere():
    example = picture("paper-slow")
    bounds = scene_bounds(example)
    drawn = near_truth(example.position_estimate, example.motion, bounds)
    error = np.linalg.norm(example.position_estimate - example.motion.position, axis=1)
    gone = np.isnan(drawn).any(axis=1)
    np.testing.assert_array_equal(gone, error >= MAX_STRAY * bounds.radius)
    assert 0 < gone.sum() < gone.size
    np.testing.assert_array_equal(drawn[~gone], example.position_estimate[~gone])
