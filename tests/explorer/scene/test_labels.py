"""Labels of the scene never lie on each other, whatever the camera sees, and the most important ones stay."""

import itertools

import numpy as np
import pytest

from explorer.scene import labels
from explorer.scene.labels import Item
from tests.support.sent_messages import Camera

TEXTS = ("anchor", "vehicle", "estimate (very uncertain)", "weakest: (1.00, 0.02, 0.02), μ = 733", "g", "m", "m est.")


@pytest.mark.parametrize("spread", [0.0, 5.0, 40.0, 400.0])
def test_no_two_labels_that_are_placed_meet_and_the_first_is_always_placed(spread: float) -> None:
    rng = np.random.default_rng(7)
    places = 300 + spread * rng.standard_normal((len(TEXTS), 2))
    items = [Item(text, float(x), float(y), "bottom-center") for text, (x, y) in zip(TEXTS, places, strict=True)]
    sides = labels.place(items)
    boxes = [labels.box_of(item, side) for item, side in zip(items, sides, strict=True) if side is not None]
    assert sides[0] == "bottom-center"
    assert not any(one.meets(other) for one, other in itertools.combinations(boxes, 2))
    if spread == 0.0:
        assert 2 <= len(boxes) < len(items)  # around one point there is room for some


def test_a_label_keeps_its_side_while_that_is_free() -> None:
    assert labels.place([Item("anchor", 0.0, 0.0, "top-right")]) == ["top-right"]


def test_a_point_ahead_is_seen_in_the_middle_of_the_picture_and_one_behind_nowhere() -> None:
    camera = Camera(position=(3.0, 0.0, 0.0), look_at=(0.0, 0.0, 0.0), up=(0.0, 0.0, 1.0))
    ahead, right, behind = labels.project(np.array([[0.0, 0, 0], [0.0, 1, 0], [6.0, 0, 0]]), camera)  # type: ignore[arg-type]
    assert ahead == pytest.approx([450.0, 500.0])
    assert right[0] - 450.0 == pytest.approx(500.0 / np.tan(0.65) / 3.0)
    assert np.isnan(behind).all()
