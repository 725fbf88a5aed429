"""Evil twins: the same IMU record and the same range from somewhere else, and why an observable motion has none."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from scipy.spatial.transform import Rotation

from rangenav import preset, record
from rangenav.observability import ambiguity, rows, symmetry
from rangenav.preset import Preset
from rangenav.signals import Formula, MinimumSnap, Multisine, Signal, Tone, Waypoint, Waypoints, mirrored
from rangenav.twin import APART, TOLERANCE, Refusal, Twin, turn_towards, twin
from tests.support.motion_examples import circle, tilted
from tests.support.records import SILENT
from tests.support.refusals import exactly

pytestmark = pytest.mark.slow


KINDS = {
    "hover": "turned",
    "turning-hover": "turned",
    "line": "turned",
    "circle": "mirrored",
    "helix": "mirrored",
    "tilted-circle": "mirrored",
    "vertical-circle": "mirrored",
    "wiggle": "nearby",
    "paper-implied": "locally blind",
    "paper": "observable",
    "paper-slow": "observable",
    "lissajous": "observable",
    "soft": "observable",
    "barrel": "observable",
    "trefoil": "observable",
    "torus": "observable",
    "hand-held": "observable",
    "eight-repaired": "observable",
    "figure-eight": "mirrored",
    "minimum-snap": "observable",  # over its three pieces together, of which no single one is
}
HOVER, CIRCLE, LINE = preset.load("hover"), preset.load("circle"), preset.load("line")
EXACT = 1e-9
"""m, m/s²: rounding of places of some metres, through sines of some hundred radians, is 1e-13."""

metres = st.floats(-5.0, 5.0)
points = st.tuples(metres, metres, metres)
turns = st.tuples(*[st.floats(-3.0, 3.0)] * 3)
laws = settings(max_examples=40)


def flying(path: Signal, *, anchor: tuple = (0.0, 0.0, 0.0), base: Preset = CIRCLE) -> Preset:
    return replace(base, path=path, world=replace(base.world, anchor=anchor))


def twin_of(p: Preset, **chosen) -> Twin:
    answer = twin(p, **chosen)
    assert isinstance(answer, Twin), answer
    return answer


def refused(p: Preset, **chosen) -> Refusal:
    answer = twin(p, **chosen)
    assert isinstance(answer, Refusal), answer
    return answer


def recorded(p: Preset):
    """What its sensors measure without noise."""
    silent = replace(p.sensors, noise=SILENT)
    return record.measured(record.truth_inputs(p), silent, 0)


@pytest.mark.parametrize("name", [file.stem for file in preset.shipped_files()])
def test_every_shipped_preset_has_its_twin_or_its_reason(name: str):
    assert twin(preset.load(name)).kind == KINDS[name]


@pytest.mark.parametrize("name", [name for name, kind in KINDS.items() if kind in ("turned", "mirrored")])
def test_a_twin_flown_through_the_simulator_gives_the_same_imu_record_and_the_same_range(name: str):
    p = preset.load(name)
    other = twin_of(p)
    true, false = recorded(p), recorded(replace(p, path=other.path))
    for sensor in ("gyro", "accel", "mag", "range"):
        np.testing.assert_allclose(getattr(false, sensor), getattr(true, sensor), atol=EXACT, rtol=0)
    distance = np.linalg.norm(other.path(true.time) - p.path(true.time), axis=1)
    assert distance.min() > 1.0
    assert (other.nearest, other.farthest) == pytest.approx((distance.min(), distance.max()), abs=1e-6)


@pytest.mark.parametrize("tolerance", [0.0, 1e-6, 1e-3, TOLERANCE, 0.5])
def test_whatever_the_tolerance_a_twin_keeps_it_on_moments_it_did_not_look_at(tolerance: float):
    for name in KINDS:
        p = preset.load(name)
        other = twin(p, tolerance=tolerance)
        if isinstance(other, Refusal):
            assert other.mismatch > tolerance
            continue
        time = np.linspace(0.0, p.duration, 30_011)
        anchor = np.asarray(p.world.anchor)
        difference = np.linalg.norm(other.path(time) - anchor, axis=1) - np.linalg.norm(p.path(time) - anchor, axis=1)
        # between moments 10 ms apart at most, a range difference of 1 m/s² curvature rises by (0.01)²/8 m
        assert np.abs(difference).max() <= tolerance + 2e-5
        assert ambiguity.rms(other.shift, other.drift, p.duration) >= APART * (1 - 1e-9)


@laws
@given(place=points, turn=turns)
def test_a_hover_has_a_twin_wherever_it_is_turned_to_about_the_anchor(place: tuple, turn: tuple):
    p = flying(Multisine(offset=place), anchor=(0.3, -0.2, 0.1), base=HOVER)
    q = np.asarray(place) - p.world.anchor
    other = twin_of(p, turn=turn)
    expected = np.asarray(p.world.anchor) + Rotation.from_rotvec(turn).apply(q)
    np.testing.assert_allclose(other.path(np.array([0.0, 7.0, 20.0])), [expected] * 3, atol=EXACT)
    assert other.mismatch < EXACT
    assert other.nearest == pytest.approx(np.linalg.norm(expected - place), abs=EXACT)


@laws
@given(start=points, velocity=points, turn=turns)
def test_a_twin_of_a_line_keeps_the_three_numbers_that_its_range_knows(start: tuple, velocity: tuple, turn: tuple):
    """d² = |p₀|² + 2 p₀·v t + |v|² t²."""
    other = twin_of(flying(Multisine(offset=start, drift=velocity), base=LINE), turn=turn)
    p, v = other.path(np.zeros(())), other.path(np.zeros(()), 1)
    true = [np.dot(start, start), np.dot(start, velocity), np.dot(velocity, velocity)]
    np.testing.assert_allclose([p @ p, p @ v, v @ v], true, atol=1e-9)
    assert other.mismatch < EXACT


@laws
@given(
    radius=st.floats(0.3, 3.0),
    w=st.floats(1.0, 4.0),
    phase=st.floats(0.0, 6.0),
    tilt=st.floats(0.0, math.pi / 2),
    heading=st.floats(0.0, 6.0),
    height=st.floats(0.5, 3.0),
    climb=st.floats(0.0, 1.0),
)
def test_a_planar_path_whose_anchor_is_off_its_plane_has_its_mirror_image(
    radius, w, phase, tilt, heading, height, climb
):
    """p − 2(c + d t) n: also if it climbs along n away from the anchor."""
    orientation = tilted(tilt, heading)
    normal = orientation.as_matrix()[:, 2]
    path = replace(circle(radius, w, phase, orientation), drift=tuple((climb * normal).tolist()))
    p = flying(path, anchor=tuple((-height * normal).tolist()))
    other = twin_of(p)
    assert other.kind == "mirrored"
    assert other.mismatch < EXACT
    assert other.nearest == pytest.approx(2 * height, abs=1e-6)
    time = np.array([0.0, 3.0, 11.0])
    image = mirrored(path, tuple(normal.tolist()), about=p.world.anchor)
    np.testing.assert_allclose(other.path(time), image(time), atol=1e-8)


@laws
@given(
    radius=st.floats(0.5, 3.0),
    w=st.floats(1.0, 4.0),
    tilt=st.floats(0.0, 1.5),
    place=st.tuples(*[st.floats(-1, 1)] * 2),
)
def test_a_plane_through_the_anchor_has_none_and_is_called_locally_blind(radius, w, tilt, place):
    orientation = tilted(tilt, 0.7)
    e1, e2, _ = orientation.as_matrix().T
    anchor = tuple((radius * (place[0] * e1 + place[1] * e2)).tolist())
    answer = refused(flying(circle(radius, w, 0.3, orientation), anchor=anchor))
    assert answer.kind == "locally blind"
    assert answer.sensitivity < ambiguity.BLIND
    assert answer.mismatch > TOLERANCE
    assert answer.reason.startswith("locally blind, no twin: ")
    assert "the anchor lies in its plane, so its mirror image is the motion itself" in answer.reason


def test_an_observable_motion_is_refused_with_the_singular_value_and_the_most_similar_range():
    answer = refused(preset.load("lissajous"))
    assert answer.kind == "observable"
    assert answer.reason == (
        "no twin: to first order, every offset and constant velocity of 1 m (RMS) changes the range by "
        f"{answer.sensitivity:.2g} m (RMS) or more; of the motions 1 m (RMS) away, the range of the most similar one "
        f"differs by {answer.mismatch:.2g} m, more than the tolerance of 0.02 m"
    )
    assert answer.sensitivity > 0.1
    assert answer.mismatch > 0.3


def test_a_mirror_image_too_near_to_be_evil_is_told_and_refused():
    answer = refused(flying(CIRCLE.path, anchor=(0.2, 0.1, 0.2)))
    assert answer.kind == "too near"
    assert "the mirror image in the plane through the anchor with normal z: 0.4 m away throughout" in answer.reason
    assert twin_of(flying(CIRCLE.path, anchor=(0.2, 0.1, 0.2)), apart=0.3).nearest == pytest.approx(0.4)


def test_a_hover_at_its_anchor_and_a_line_of_motion_through_it_have_none():
    at_anchor = refused(flying(Multisine(offset=(1.0, 2.0, 3.0)), anchor=(1.0, 2.0, 3.0)))
    assert at_anchor.kind == "locally blind"
    to_and_fro = Multisine(tones=(Tone(axis="x", amplitude=1.0, frequency=2.0),))
    assert refused(flying(to_and_fro, anchor=(3.0, 0.0, 0.0))).kind == "locally blind"


def test_motion_along_a_line_may_be_turned_about_that_line_only():
    p = flying(Multisine(tones=(Tone(axis="x", amplitude=1.0, frequency=2.0),), offset=(0.0, 2.0, 0.0)))
    other = twin_of(p, turn=(0.4, 0.5, 0.6))
    assert other.axis is not None
    np.testing.assert_allclose(np.abs(other.axis), [1.0, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(other.turn, [0.4, 0.0, 0.0], atol=1e-12)
    assert other.mismatch < EXACT
    assert twin_of(p).nearest == pytest.approx(2 * math.sqrt(2))


def test_planar_waypoints_and_formulas_have_mirror_images_like_any_planar_path():
    square = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (1.0, 1.0))
    points = tuple(Waypoint(time=5.0 * k, value=(x, y, -1.0)) for k, (x, y) in enumerate(square))
    formula = Formula(x="t/10 + sin(t)", y="cos(t)**2", z="0", offset=(0.0, 0.0, 2.0))
    for path in (Waypoints(points=points), MinimumSnap(points=points), formula):
        other = twin_of(flying(path))
        assert other.kind == "mirrored"
        assert other.mismatch < EXACT


@laws
@given(target=points, time=st.floats(0.0, 20.0))
def test_dragging_brings_a_twin_as_near_to_the_pointer_as_any_allowed_turn_does(target: tuple, time: float):
    lengthwise = Multisine(tones=(Tone(axis="x", amplitude=1.0, frequency=2.0),), offset=(0.0, 2.0, 0.0))
    for p in (HOVER, LINE, flying(lengthwise)):
        other = twin_of(p, turn=turn_towards(p, target, time=time))
        reached = np.linalg.norm(other.path(np.array(time)) - target)
        if len(symmetry.unaccelerated(p.path, p.duration)) == 3:
            q = p.path(np.array(time)) - np.asarray(p.world.anchor)
            aim = np.asarray(target) - p.world.anchor
            assert reached == pytest.approx(abs(np.linalg.norm(aim) - np.linalg.norm(q)), abs=1e-6)
        else:
            others = [twin_of(p, turn=(a, 0.0, 0.0)).path(np.array(time)) for a in np.linspace(0, 2 * math.pi, 25)]
            assert reached <= min(np.linalg.norm(place - target) for place in others) + 1e-9


def test_what_has_no_family_is_not_dragged():
    assert turn_towards(CIRCLE, (1.0, 2.0, 3.0), time=0.0) == (0.0, 0.0, 0.0)
    assert not twin_of(CIRCLE).draggable
    assert twin_of(CIRCLE, turn=(1.0, 2.0, 3.0)).turn == (0.0, 0.0, 0.0)
    assert twin_of(HOVER).draggable


def test_a_twin_beyond_the_numbers_a_path_may_have_is_refused_and_no_error():
    far = Multisine(offset=(1e6, 1e6, 1e6))
    answer = refused(flying(far), turn=(0.0, 0.0, 0.5))
    assert answer.kind == "too large"
    assert answer.reason.startswith("no twin: its offset must lie between -1e+06 and 1e+06")


@pytest.mark.parametrize(
    ("chosen", "sentence"),
    [
        ({"tolerance": -1.0}, "tolerance must lie between 0 and 100 m, got -1"),
        ({"tolerance": math.nan}, "tolerance must lie between 0 and 100 m, got nan"),
        ({"apart": 0.0}, "apart must lie between 0.01 and 10000 m, got 0"),
        ({"turn": (0.0, math.inf, 0.0)}, "turn must be a finite number, got inf"),
    ],
)
def test_senseless_wishes_are_refused_in_one_sentence(chosen: dict, sentence: str):
    with pytest.raises(ValueError, match=exactly(sentence)):
        twin(HOVER, **chosen)


def test_a_lever_arm_that_is_left_out_is_told():
    sensors = replace(HOVER.sensors, unmodelled=replace(HOVER.sensors.unmodelled, lever_arm=(0.0, 0.3, 0.4)))
    note = "; so it is for an antenna at the body's origin, and here a lever arm of 0.5 m is left out"
    assert twin_of(replace(HOVER, sensors=sensors)).summary == twin_of(HOVER).summary + note
    paper = preset.load("paper")
    assert refused(replace(paper, sensors=sensors)).reason == refused(paper).reason + note


def test_the_sensitivity_is_that_of_the_nonlinear_rows_and_of_finite_differences():
    p = preset.load("soft")
    time = symmetry.moments(p.duration)
    q = p.path(time) - np.asarray(p.world.anchor)
    felt = ambiguity.sensitivity(q, time, p.duration)
    distance = np.linalg.norm(q, axis=1)
    nonlinear = rows.nonlinear(p.path, p.world.anchor, np.array([0.0]), time)[0, :, :6] / distance[:, None]
    first = nonlinear @ np.concatenate([felt.shift, felt.drift])
    assert np.sqrt(np.mean(first**2)) == pytest.approx(felt.singular[-1], rel=1e-9)
    step = 1e-5
    moved = np.linalg.norm(q + step * (felt.shift + time[:, None] * felt.drift), axis=1)
    np.testing.assert_allclose((moved - distance) / step, first, atol=1e-4)  # step · curvature 1/d
    assert ambiguity.rms(felt.shift, felt.drift, p.duration) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("name", ["lissajous", "soft", "paper-slow", "wiggle"])
def test_no_random_difference_is_a_much_better_lookalike_than_what_the_search_found(name: str):
    """By 3%: where valleys are flat the search stops a little above their bottom."""
    p = preset.load(name)
    time = symmetry.moments(p.duration)
    q = p.path(time) - np.asarray(p.world.anchor)
    best = ambiguity.search(q, p.path(time, 2), time, p.duration, apart=APART)
    assert (np.diff(best.mismatch) >= 0).all()
    rng = np.random.default_rng(3)
    for _ in range(3000):
        shift, drift = rng.normal(size=3), rng.normal(size=3) * rng.choice([0.0, 0.1, 1.0]) / p.duration
        scale = APART * rng.choice([1.0, 1.0, 2.0, 4.0]) / ambiguity.rms(shift, drift, p.duration)
        moved = np.linalg.norm(q + scale * (shift + time[:, None] * drift), axis=1) - np.linalg.norm(q, axis=1)
        assert np.sqrt(np.mean(moved**2)) >= 0.97 * best.mismatch[0]


def test_the_rms_distance_of_a_straight_difference_is_that_of_its_samples():
    rng = np.random.default_rng(5)
    shift, drift, time = rng.normal(size=3), rng.normal(size=3), np.linspace(0.0, 7.0, 100_001)
    sampled = np.sqrt(np.mean(np.sum((shift + time[:, None] * drift) ** 2, axis=1)))
    assert ambiguity.rms(shift, drift, 7.0) == pytest.approx(sampled, rel=1e-4)


@pytest.mark.parametrize(
    ("path", "count"),
    [
        (Multisine(offset=(1.0, 2.0, 3.0), drift=(1.0, 0.0, 0.0)), 3),
        (Multisine(tones=(Tone(axis="y", amplitude=1e-3, frequency=3.0),)), 2),
        (CIRCLE.path, 1),
        (preset.load("paper-implied").path, 1),
        (preset.load("paper").path, 0),
        (preset.load("wiggle").path, 0),
    ],
)
def test_directions_along_which_nothing_accelerates_are_counted(path: Signal, count: int):
    directions = symmetry.unaccelerated(path, 20.0)
    assert directions.shape == (count, 3)
    assert np.abs(path(np.linspace(0, 20, 999), 2) @ directions.T).max(initial=0.0) < 1e-9
