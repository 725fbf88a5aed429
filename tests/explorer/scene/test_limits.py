"""The part of a path that exceeds a limit is marked: by its width and by labels as well as by its colour."""

from itertools import pairwise

import numpy as np
import pytest
import viser
from msgspec.structs import replace

from explorer.model.compute import Picture, compute
from explorer.model.settings import Settings
from explorer.scene import Scene, limits
from explorer.scene.bounds import chord_samples, scene_bounds
from rangenav import preset, vehicle
from rangenav.vehicle import CRAZYFLIE, FREE, HAND_HELD, Break, Vehicle
from tests.support.sent_messages import Page

pytestmark = pytest.mark.slow


def picture(name: str, by: Vehicle) -> Picture:
    return compute(Settings(preset=replace(preset.load(name), vehicle=by)))


def line(page: Page) -> viser.LineSegmentsHandle:
    handle = page.scene.get_handle_by_name("/path/broken")
    assert isinstance(handle, viser.LineSegmentsHandle)
    return handle


def label_texts(page: Page) -> list[str]:
    """The texts of the labels that are shown."""
    texts = []
    for k in (1, 2, 3):
        marker, label = (page.scene.get_handle_by_name(f"/path/broken{k}{part}") for part in ("", "/label"))
        assert marker is not None
        assert isinstance(label, viser.LabelHandle)
        texts += [label.text] if marker.visible else []
    return texts


@pytest.mark.parametrize("name", ["paper", "paper-slow", "circle"])
def test_drawn_as_broken_are_the_chords_on_which_a_limit_is_broken_and_no_others(name: str) -> None:
    example = picture(name, CRAZYFLIE)
    bounds = scene_bounds(example)
    where = limits.exceeding_samples(example.breaks, len(example.motion.time))
    ends = chord_samples(example.motion, bounds)
    drawn = {tuple(map(tuple, segment)) for segment in limits.exceeding_segments(example.motion, where, bounds)}
    for first, last in pairwise(ends):
        chord = (tuple(example.motion.position[first]), tuple(example.motion.position[last]))
        assert (chord in drawn) == any(where[first : last + 1])


def test_a_break_of_a_single_sample_is_drawn() -> None:
    example = picture("paper", FREE)
    bounds = scene_bounds(example)
    nowhere = np.zeros(len(example.motion.time), dtype=bool)
    assert len(limits.exceeding_segments(example.motion, nowhere, bounds)) == 0
    for k in (0, 1, 1234, len(nowhere) - 1):
        once = nowhere.copy()
        once[k] = True
        drawn = limits.exceeding_segments(example.motion, once, bounds)
        assert 1 <= len(drawn) <= 2
        lengths = np.linalg.norm(drawn[:, 1] - drawn[:, 0], axis=1)
        nearest = np.linalg.norm(drawn - example.motion.position[k], axis=-1).min()
        assert nearest <= lengths.max() + 1e-12


def test_the_line_over_the_broken_part_is_told_apart_without_colour_and_hidden_for_a_vehicle_that_can(
    page: Page,
) -> None:
    scene = Scene(page.client, lambda: None)
    scene.draw(picture("paper-slow", CRAZYFLIE))
    shown = line(page)
    path = page.scene.get_handle_by_name("/path")
    assert isinstance(path, viser.LineSegmentsHandle)
    assert shown.visible
    assert shown.thickness >= 2 * path.thickness
    assert 0 < len(shown.points) < len(path.points)
    assert not np.array_equal(shown.colors, path.colors)
    scene.draw(picture("paper-slow", FREE))
    assert not shown.visible
    assert label_texts(page) == []


def test_each_worst_place_has_a_marker_there_with_what_is_broken_how_far_and_when(page: Page) -> None:
    scene, example = Scene(page.client, lambda: None), picture("paper", CRAZYFLIE)
    scene.draw(example)
    assert label_texts(page) == [
        "✕ thrust 14.9 × weight at 16.4 s",
        "✕ tilt 171° at 7.2 s",
        "✕ speed 11.4 m/s at 11.2 s",
    ]
    for k, limit_break in enumerate(example.breaks[:3]):
        marker = page.scene.get_handle_by_name(f"/path/broken{k + 1}")
        assert marker is not None
        at = np.interp(limit_break.at, example.motion.time, np.arange(len(example.motion.time)))
        assert marker.position == pytest.approx(example.motion.position[round(at)])


def test_of_many_broken_limits_three_are_said_and_all_are_drawn(page: Page) -> None:
    weak = replace(HAND_HELD, speed=0.1, acceleration=0.1, jerk=0.1, body_rate=0.01, anchor_distance_min=50.0)
    scene, example = Scene(page.client, lambda: None), picture("paper", weak)
    scene.draw(example)
    assert len(example.breaks) == 5
    assert len(label_texts(page)) == limits.MARKS
    path = page.scene.get_handle_by_name("/path")
    assert isinstance(path, viser.LineSegmentsHandle)
    assert len(line(page).points) == len(path.points)


@pytest.mark.parametrize("limit", list(vehicle.WORDS))
def test_every_limit_has_a_short_word(limit: str) -> None:
    limit_break = Break(limit=limit, allowed=1.0, reached=2.0, at=4.06, where=np.ones(3, dtype=bool), summary="")
    assert limits.marker_label(limit_break).startswith("✕ ")
    assert limits.marker_label(limit_break).endswith(" at 4.1 s")
    assert len(limits.marker_label(limit_break)) < 50
