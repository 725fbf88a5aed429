"""One number of some settings by its path: what is read is what was put there, and no other value is taken."""

import pytest

from explorer.model import field_path
from explorer.model.settings import Settings
from rangenav import preset

SLOW = Settings(origin="paper-slow", preset=preset.load("paper-slow"))
PATHS = ("gains.attitude.k1", "gains.riccati.v.xi", "path.tones.3.amplitude", "world.anchor.z", "time_scale", "seed")


@pytest.mark.parametrize("path", PATHS)
def test_a_number_is_put_and_read_back_and_nothing_else_changes(path: str):
    changed = field_path.replaced(SLOW, path, 2.0)
    assert field_path.value(changed, path) == 2.0
    assert field_path.replaced(changed, path, field_path.value(SLOW, path)) == SLOW


@pytest.mark.parametrize(
    ("path", "says"),
    [
        ("gains.k9", "there is no k9"),
        ("path", "names no number"),
        ("title", "names no number"),
        ("gains.attitude.k1.x", "nothing lies below x"),
        ("path.tones.4.amplitude", "must lie between 1 and 3"),
        ("path.tones.0.amplitude", "must lie between 1 and 3"),
        ("", "there is no"),
    ],
)
def test_a_path_that_names_no_number_is_refused_with_its_reason(path: str, says: str):
    with pytest.raises(ValueError, match=says):
        field_path.value(SLOW, path)


def test_a_number_that_does_not_fit_is_refused_with_the_rule():
    with pytest.raises(ValueError, match=r"time_scale = 100: .*between 0.1 and 10"):
        field_path.replaced(SLOW, "time_scale", 100.0)
