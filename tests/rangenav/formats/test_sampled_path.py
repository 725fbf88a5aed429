"""From arrays to a path: it follows the samples, it is judged only where its snap is the motion's, and says so."""

from typing import Any

import numpy as np
import pytest

from rangenav import analysis, motion, preset
from rangenav.formats import sampled_path
from rangenav.formats.import_result import ImportResult
from rangenav.formats.path_preset import as_preset
from rangenav.observability import excitation
from rangenav.signals import Flown, Signal
from tests.support.refusals import exactly

pytestmark = pytest.mark.slow


KNOWN = preset.load("barrel")
DURATION = 12.0
TIME = np.arange(0, DURATION + 1e-9, 0.01)
NAMES = ("velocity", "acceleration", "jerk", "snap")


def path_of(imported: ImportResult) -> Signal:
    assert imported.path is not None
    return imported.path


def samples(upto: int) -> dict[str, Any]:
    """The derivatives 1 to `upto` of a known motion."""
    return {name: KNOWN.path(TIME, order) for order, name in enumerate(NAMES[:upto], start=1)}


def test_positions_become_a_curve_near_them_whose_excitation_is_not_judged():
    imported = sampled_path.from_arrays(TIME, KNOWN.path(TIME))
    apart = np.linalg.norm(path_of(imported)(TIME) - KNOWN.path(TIME), axis=-1)
    assert apart.max() == pytest.approx(imported.fit_error, rel=1e-6)
    assert apart[100:-100].max() < 0.02
    assert imported.derivatives == "fit"
    assert "excitation cannot be judged" in (imported.unjudged or "")


def test_with_every_derivative_to_the_snap_the_path_is_the_motion_and_is_judged():
    imported = sampled_path.from_arrays(TIME, KNOWN.path(TIME), **samples(4))
    assert (imported.derivatives, imported.unjudged) == ("file", None)
    for order, size in enumerate((1e-6, 1e-5, 1e-4, 1e-3)):
        np.testing.assert_allclose(path_of(imported)(TIME, order), KNOWN.path(TIME, order), atol=size * 30)
    start = np.linspace(0.0, DURATION - 6.0, 20)
    np.testing.assert_allclose(
        excitation.eigenvalues(path_of(imported), start, 6.0), excitation.eigenvalues(KNOWN.path, start, 6.0), rtol=0.05
    )


def test_velocity_and_acceleration_alone_make_pieces_of_degree_5_that_are_not_judged():
    imported = sampled_path.from_arrays(TIME[::20], KNOWN.path(TIME[::20]), velocity=KNOWN.path(TIME[::20], 1),
                                     acceleration=KNOWN.path(TIME[::20], 2))  # fmt: skip
    np.testing.assert_allclose(path_of(imported)(TIME), KNOWN.path(TIME), atol=1e-4)
    assert "no jerk" in (imported.unjudged or "")


def test_without_the_snap_the_pieces_have_one_of_their_own_and_are_not_judged():
    imported = sampled_path.from_arrays(TIME, KNOWN.path(TIME), **samples(3))
    assert imported.derivatives == "fit"
    assert "no snap" in (imported.unjudged or "")


def test_a_snap_that_does_not_belong_to_the_motion_is_not_believed():
    wrong = samples(4)
    wrong["snap"] = -wrong["snap"]
    imported = sampled_path.from_arrays(TIME, KNOWN.path(TIME), **wrong)
    assert imported.derivatives == "fit"
    assert "miss" in (imported.unjudged or "")


@pytest.mark.parametrize(("upto", "judged"), [(0, False), (4, True)])
def test_the_path_goes_through_simulation_observability_and_a_preset_file(tmp_path, upto, judged):
    imported = sampled_path.from_arrays(TIME, KNOWN.path(TIME), name="my flight", **samples(upto))
    p = as_preset(imported, anchor=(0.0, 0.0, 0.1))
    assert p.source is not None
    assert (p.source.format, p.source.file) == ("arrays", "my flight")
    preset.save(p, tmp_path / "mine.toml")
    again = preset.load(tmp_path / "mine.toml")
    assert again == p
    truth = motion.simulate(
        again.path, Flown(), world=again.world, initial_rotation=(0, 0, 0), duration=again.duration, rate=100.0
    )
    np.testing.assert_allclose(truth.position, path_of(imported)(truth.time))
    assert analysis.analyse(again).verdict.judged == judged


def test_stamps_may_begin_anywhere_and_lists_will_do():
    position = KNOWN.path(TIME)
    shifted, plain = (
        sampled_path.from_arrays((TIME + 1e3).tolist(), position.tolist()),
        sampled_path.from_arrays(TIME, position),
    )
    np.testing.assert_allclose(path_of(shifted)(TIME), path_of(plain)(TIME), atol=1e-6)
    assert "the first sample is at 1000 s, which is t = 0 of the path" in shifted.findings


def test_gaps_are_said():
    there = (TIME < 5.0) | (TIME > 6.0)
    imported = sampled_path.from_arrays(TIME[there], KNOWN.path(TIME)[there], knots=2.0)
    assert any(text.startswith("1 gap, the longest 1.02 s after 4.99 s") for text in imported.findings)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((TIME, KNOWN.path(TIME).T, {}), "position must have shape (1201, 3), got (3, 1201)"),
        ((TIME[::-1], KNOWN.path(TIME), {}), "time must increase: broken at [1], 11.99 after 12"),
        ((TIME[:2], KNOWN.path(TIME[:2]), {}), "2 samples are no path: at least 3"),
        (
            (TIME, KNOWN.path(TIME), {"velocity": KNOWN.path(TIME, 1)}),
            "velocity and acceleration are needed together, got no acceleration and no jerk and no snap",
        ),
        ((TIME, np.where(TIME[:, None] == 2.0, np.nan, 1.0), {}), None),
    ],
)
def test_what_is_no_motion_is_refused(monkeypatch, arguments, sentence):
    time, position, others = arguments
    if sentence is None:
        position = np.broadcast_to(position, (len(TIME), 3))
        sentence = "position must be finite, got nan at [200, 0]"
    with pytest.raises(ValueError, match=exactly(sentence)):
        sampled_path.from_arrays(time, position, **others)
