"""Repair: what comes out is certified, flyable and small; what cannot be done is refused with the reason."""

import functools
import math

import msgspec
import numpy as np
import pytest

from rangenav import certificate, preset, repair, signals
from rangenav.certificate.figures import figures, shortfall
from rangenav.certificate.tone_search import with_tones
from rangenav.preset import Preset, Requirement
from rangenav.progress import CancelledError
from rangenav.repair import CannotRepairError
from rangenav.sensors import Noise
from rangenav.signals import (
    Flown,
    Formula,
    MinimumSnap,
    Multisine,
    Signal,
    Sum,
    Tone,
    Waypoint,
    Waypoints,
    polynomials,
)
from rangenav.vehicle import CRAZYFLIE, FIVE_INCH, FREE

pytestmark = pytest.mark.slow


replace = msgspec.structs.replace
SOFT = preset.load("soft")
EIGHT = Multisine(
    tones=(Tone(axis="x", amplitude=1.0, frequency=1.5), Tone(axis="y", amplitude=0.5, frequency=3.0)),
    offset=(0.0, 0.0, 1.0),
)
PERIOD = 2 * math.pi / 1.5
POINTS = tuple(
    Waypoint(time=k * PERIOD / 8, value=tuple(EIGHT(np.array(k * PERIOD / 8)).tolist()))  # pyright: ignore
    for k in range(8)
)
LOOP, SNAP = Waypoints(points=POINTS, period=PERIOD), MinimumSnap(points=POINTS, period=PERIOD)
PLANAR: dict[str, Signal] = {
    "multisine": EIGHT,
    "waypoints": LOOP,
    "minimum snap": SNAP,
    "polynomials": polynomials.from_minimum_snap(SNAP),
    "formula": Formula(x="sin(1.5*t)", y="sin(1.5*t)*cos(1.5*t)", z="1"),
}


def flown(path: Signal, **fields: object) -> Preset:
    """A path flown by a Crazyflie, judged as the soft path is: δ = 12 s, μ ≥ 50 m²/s⁷, σ ≤ 0.5 m."""
    fields = {"vehicle": CRAZYFLIE, "angular_velocity": Flown(), "expect": "unobservable", **fields}
    return replace(SOFT, path=path, **fields)


@functools.cache
def repaired_planar(name: str) -> repair.Repair:
    """The repair of one of the planar paths."""
    return repair.repair(flown(PLANAR[name]))


def held(repaired: repair.Repair, limits: Preset) -> None:
    """The new preset meets every requirement, certified from its own bytes, and the vehicle of `limits` can fly it."""
    again = certificate.certify(preset.dumps(repaired.after).encode(), source="after")
    assert again == repaired.certificate
    assert (again.certified, again.meets, again.rank.rank) == (True, True, 13)
    assert again.excitation.lower is not None
    assert again.excitation.lower >= limits.requirement.mu
    assert again.accuracy.lifted.end.position is not None
    assert again.accuracy.lifted.end.position <= limits.requirement.position_sigma
    flying = replace(repaired.after, vehicle=limits.vehicle)
    judged = again if flying == repaired.after else certificate.certify(preset.dumps(flying).encode(), source="after")
    assert judged.vehicle.flyable
    assert repaired.after.story == f"{repaired.description[0].upper()}{repaired.description[1:]}."


@pytest.mark.parametrize("name", PLANAR)
def test_a_planar_figure_eight_of_any_family_is_repaired_by_a_tone(name: str):
    p, repaired = flown(PLANAR[name]), repaired_planar(name)
    held(repaired, p)
    added = repaired.after.path.wiggle if isinstance(repaired.after.path, Sum) else repaired.after.path
    assert isinstance(added, Multisine)
    (tone,) = [tone for tone in added.tones if tone.axis == "z"]
    assert (
        repaired.description
        == f"added a tone of {tone.amplitude:g} m at {tone.frequency:g} rad/s along z with phase {tone.phase:g}"
    )
    assert tone.amplitude < 0.1
    assert repaired.after.path.period is not None  # so the certificate speaks of every t
    assert repaired.certificate.claim.starts == "every t >= 0"


def test_the_circle_is_repaired_within_a_small_vehicles_limits():
    """Its own vehicle is free, but a repair that a small one can fly is preferred."""
    p = preset.load("circle")
    repaired = repair.repair(p)
    held(repaired, replace(p, vehicle=replace(CRAZYFLIE, body_rate=None)))
    assert repaired.after.vehicle == p.vehicle
    assert repaired.certificate.limits.thrust_to_weight < 1.95 / 1.35


def test_a_repair_is_not_larger_than_it_must_be():
    p, repaired = flown(EIGHT), repaired_planar("multisine")
    tones = repaired.after.path.tones  # pyright: ignore
    smaller = tuple(replace(tone, amplitude=0.85 * tone.amplitude) if tone.axis == "z" else tone for tone in tones)
    assert not certificate.certify(
        preset.dumps(replace(repaired.after, path=Multisine(tones=smaller, offset=EIGHT.offset))).encode(),
        source="less",
    ).meets
    (before, after) = repaired.figures_before, repaired.figures_after
    assert not math.isfinite(before.sigma)
    assert 0.9 * p.requirement.position_sigma < after.sigma <= p.requirement.position_sigma  # as little as will do


def test_nothing_is_changed_about_what_meets_its_requirement():
    repaired = repair.repair(SOFT)
    assert (repaired.before, repaired.after, repaired.description, repaired.effort) == (
        SOFT,
        SOFT,
        "nothing had to be changed",
        0.0,
    )


def test_three_missing_directions_take_three_tones_of_different_frequencies():
    requirement = replace(SOFT.requirement, mu=5.0)
    p = flown(Multisine(offset=(0.0, 0.0, 1.0)), requirement=requirement)
    repaired = repair.repair(p)
    held(repaired, p)
    tones = repaired.after.path.tones  # pyright: ignore
    assert sorted({tone.axis for tone in tones}) == ["x", "y", "z"]
    assert len({tone.frequency for tone in tones}) > 1  # of one frequency they would be an ellipse


@pytest.mark.parametrize("by", ["timescale", "amplitude"])
def test_a_plane_is_not_repaired_by_size_or_speed_and_the_reason_is_said(by: repair.ChangeKind):
    words = r"the path has no snap along z in the 12 s from t = 0 s, and .* it has none either; added tones would"
    with pytest.raises(CannotRepairError, match=f"^{by}: {words}"):
        repair.repair(flown(EIGHT), by=by)


@pytest.mark.parametrize(
    ("path", "by", "words"),
    [
        (EIGHT, "waypoints", "the path has no waypoints that could be moved"),
        (LOOP, "frequency", "the path has no tones whose frequency could be changed"),
        (Sum(base=EIGHT, wiggle=Formula(x="0.1*sin(t)")), "tones", "the path is a sum already, and neither part"),
        (Multisine(), "timescale", "the path does not bend, and stays straight at any size and speed"),
        (signals.slowed(SOFT.path, 0.5), "tones", "the path is too much for Crazyflie 2.1 already: thrust "),
    ],
)
def test_what_a_kind_of_change_cannot_do_is_refused_with_the_reason(path: Signal, by: repair.ChangeKind, words: str):
    with pytest.raises(CannotRepairError, match=f"^{by}: {words}"):
        repair.repair(flown(path), by=by)


def test_a_search_that_finds_nothing_says_how_near_it_came():
    asked = replace(SOFT.requirement, position_sigma=1e-3)  # a millimetre
    with pytest.raises(CannotRepairError) as refused:
        repair.repair(flown(EIGHT, requirement=asked), evaluations=150)
    assert "tones: no change that meets the requirement was found among 150 motions; the nearest has μ = " in str(
        refused.value
    )


@pytest.mark.slow
def test_a_refusal_names_no_window_whose_certificate_misses_something_and_no_limit_of_a_vehicle_not_chosen():
    """One range a second along a path of 1 s: every range is taken at the same place, of windows of any length."""
    tones = (
        Tone(axis="x", amplitude=1.0, frequency=2 * math.pi),
        Tone(axis="y", amplitude=0.8, frequency=4 * math.pi),
        Tone(axis="z", amplitude=0.7, frequency=6 * math.pi),
    )
    aliased = replace(
        SOFT,
        path=Multisine(tones=tones),
        duration=60.0,
        sensors=replace(SOFT.sensors, range_rate=1.0),
        requirement=Requirement(window=20.0, mu=1e-3, position_sigma=1.0),
    )
    with pytest.raises(CannotRepairError) as refused:
        repair.repair(aliased)
    assert "would do" not in str(refused.value)
    assert "Crazyflie" not in str(refused.value)


def slow(path: Signal, window: float, *, rate: float, noise: float, **asked: float) -> Preset:
    """A slow motion in still air or water, which no vehicle's limits bound."""
    sensors = replace(SOFT.sensors, imu_rate=20.0, mag_rate=20.0, range_rate=rate, noise=Noise(range=noise))
    requirement = Requirement(window=window, mu=1e-12, **asked)
    return replace(
        SOFT,
        path=path,
        duration=2 * window,
        sensors=sensors,
        requirement=requirement,
        vehicle=FREE,
        expect="observable",
    )


def test_a_slow_eight_at_constant_depth_is_mended_by_a_yo_yo():
    """Over 300 s the fall in D is 441 km, which hid the motions of metres that this repair adds."""
    eight = Multisine(
        tones=(Tone(axis="x", amplitude=60.0, frequency=0.02), Tone(axis="y", amplitude=40.0, frequency=0.04)),
        offset=(0.0, 0.0, -20.0),
    )
    planar = slow(eight, 300.0, rate=1.0, noise=0.5, position_sigma=5.0)
    repaired = repair.repair(planar, evaluations=400)
    held(repaired, planar)
    assert "along z" in repaired.description


def test_what_a_certificate_refuses_is_corrected_in_the_same_search():
    """24 windows miss the worst one by 9 %: its certificate says so, and the next change is large enough."""
    drifting = Multisine(
        tones=(
            Tone(axis="x", amplitude=0.4, frequency=0.1),
            Tone(axis="y", amplitude=0.3, frequency=0.2),
            Tone(axis="z", amplitude=0.1, frequency=0.25),
        ),
        offset=(0.0, 0.0, 1.0),
    )
    weak = slow(drifting, 60.0, rate=20.0, noise=0.05, position_sigma=0.45)
    weak = replace(weak, duration=240.0)
    held(repair.repair(weak, evaluations=333), weak)


def test_a_path_that_is_too_small_is_made_larger():
    p = flown(signals.scaled(SOFT.path, 0.5, about=(0.0, 0.0, 0.0)), expect="observable")
    repaired = repair.repair(p, by="amplitude")
    held(repaired, p)
    assert repaired.description.startswith("scaled x by ")
    size = np.ptp(repaired.after.path(np.linspace(0, 20, 500)), axis=0) / np.ptp(
        p.path(np.linspace(0, 20, 500)), axis=0
    )
    assert size.max() < 1 / 0.5 * 1.1  # no larger than the path that is known to do, and a little


def test_a_path_that_is_too_slow_is_run_faster_as_little_as_will_do():
    p = flown(signals.slowed(SOFT.path, 1.4), expect="observable", vehicle=FIVE_INCH)
    repaired = repair.repair(p, by="timescale")
    held(repaired, p)
    factor = math.exp(repaired.effort)
    assert repaired.description == f"run {factor:.3g} times faster"
    slower = replace(p, path=signals.slowed(p.path, 0.97 / factor * 1.06))
    assert max(shortfall(figures(slower), slower).values()) > 0


def test_frequencies_that_coincide_are_told_apart():
    """A circle and a z-sine of its own frequency lie in a plane; they need not stay at one frequency."""
    tones = (*EIGHT.tones, Tone(axis="z", amplitude=0.3, frequency=1.5))
    p = flown(Multisine(tones=(tones[0], replace(tones[0], axis="y", phase=1.5), replace(tones[2], frequency=1.6))))
    repaired = repair.repair(p, by="frequency")
    held(repaired, p)
    assert repaired.description.startswith("changed ")


@pytest.mark.parametrize("path", [LOOP, SNAP])
def test_a_planar_loop_is_repaired_by_moving_its_waypoints(path: Signal):
    p = flown(path)
    repaired = repair.repair(p, by="waypoints", evaluations=250)
    held(repaired, p)
    moved = np.array([new.value for new in repaired.after.path.points]) - [old.value for old in POINTS]  # pyright: ignore
    np.testing.assert_allclose(moved[:, :2], 0.0, atol=1e-12)  # out of the plane, and nowhere else
    assert 0.01 < np.abs(moved[:, 2]).max() < 0.2
    assert (
        repaired.description
        == f"moved {np.sum(np.abs(moved[:, 2]) > 0)} waypoints by up to {np.abs(moved).max():.3g} m"
    )


def test_a_search_can_be_cancelled_at_any_look():
    looks = iter(range(1000))
    with pytest.raises(CancelledError):
        repair.repair(flown(EIGHT), cancelled=lambda: next(looks) >= 5)
    assert next(looks) == 6  # it stopped at once


def test_a_budget_is_kept_and_progress_rises_to_its_end():
    told: list[float] = []
    asked = replace(SOFT.requirement, position_sigma=1e-3)
    with pytest.raises(CannotRepairError):
        repair.repair(flown(EIGHT, requirement=asked), evaluations=80, progress=told.append)
    assert told == sorted(told)
    assert 0 < told[0] <= told[-1] <= 1
    assert len(told) <= 80


@pytest.mark.parametrize("by", ["tones", "amplitude", "timescale"])
def test_a_motion_is_improved_within_its_limits(by: repair.ChangeKind):
    p = replace(SOFT, vehicle=CRAZYFLIE, angular_velocity=Flown())
    repaired = repair.improve(p, by=by)
    assert repaired.figures_after.sigma < 0.9 * repaired.figures_before.sigma
    assert repaired.certificate.meets
    assert repaired.certificate.vehicle.flyable
    assert repaired.after.title == "Soft three-tone path, improved"


def test_what_cannot_be_improved_is_refused():
    with pytest.raises(CannotRepairError, match="the motion is blind, so there is no predicted error to improve"):
        repair.improve(flown(EIGHT))
    with pytest.raises(CannotRepairError, match="no change of effort 1e-06 or less"):
        repair.improve(replace(SOFT, vehicle=CRAZYFLIE), by="amplitude", most_effort=1e-6)


def test_a_report_says_before_and_after():
    report = repair.report(repaired_planar("multisine"), name="eight")
    assert report["before"]["position_sigma"] is None
    assert report["before"]["reason"] == "position_sigma: null, blind"
    assert report["after"]["certified"]
    assert report["after"]["position_sigma"] <= 0.5


def test_tones_join_what_a_path_has():
    tone = Tone(axis="z", amplitude=0.1, frequency=2.0)
    assert with_tones(EIGHT, (tone,)).tones[-1] == tone  # pyright: ignore
    once = with_tones(LOOP, (tone,))
    assert once == Sum(base=LOOP, wiggle=Multisine(tones=(tone,)))
    assert with_tones(once, (tone,)) == Sum(base=LOOP, wiggle=Multisine(tones=(tone, tone)))


def test_a_pause_in_a_flight_too_long_for_a_search_is_filled_by_tones_that_a_certificate_confirms():
    moving = "(1 - exp(-((t - 305)/4)**32))"
    path = Formula(x=f"{moving}*cos(16*t)", y=f"0.3*{moving}*sin(32*t + 0.3)", z=f"0.4*{moving}*sin(32*t - 0.3)")
    needed = Requirement(window=6.0, mu=1000.0, position_sigma=5.0)
    pausing = replace(preset.load("soft"), path=path, duration=900.0, vehicle=FREE, requirement=needed)
    with pytest.raises(CannotRepairError, match=r"900 s is too long to be tried in hundreds of versions.*by tones"):
        repair.repair(pausing, by="timescale")
    found = repair.repair(pausing)
    assert found.certificate.meets
    assert found.evaluations <= 10
    assert found.figures_before.sigma > 5.0
