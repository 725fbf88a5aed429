"""A record is checked before it is judged: each fault is made in a simulated record, asked about, and corrected."""

import dataclasses
from collections.abc import Callable
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from rangenav import formats, logs, preset, record, record_checks
from rangenav.commands.log_answers import KEYS, Answers
from rangenav.formats import frames, recorded_flight
from rangenav.formats.import_result import ImportResult
from rangenav.formats.recorded_flight import Flight
from rangenav.motion import to_body
from rangenav.record_checks import anchors, axes, clock, outliers
from rangenav.sensors import Noise
from tests.support.real_files import shared

pytestmark = pytest.mark.slow

SECONDS = 16.0
QUIET = Noise(gyro=0.003, accel=0.03, mag=0.01, range=0.05)
KEEP = {
    "gyro": "rad/s",
    "time": "s",
    "accel": "m/s2",
    "range": "m",
    "frame": "z-down",
    "body-axes": axes.AS_IT_IS,
    "gyro-axes": axes.AS_IT_IS,
    "accel-axes": axes.AS_IT_IS,
    "mag-axes": axes.AS_IT_IS,
    "accel-scale": "1",
    "mag-offset": "0 0 0",
    "range-delay": "0",
    "attitude": "keep",
    "gaps": "bridge",
    "gyro-offset": "0 0 0",
    "accel-offset": "0 0 0",
    "range-offset": "0",
    "range-outliers": "keep",
    "poses": "keep",
    "range-values": "keep",
    "held-ranges": "each",
    "anchor": "5 5 5",
}
"""The answer to each question that takes the record as it is."""


def recorded(name: str, *, noise: Noise = QUIET, duration: float = SECONDS) -> Flight:
    """The record of a preset's run."""
    p = preset.load(name)
    sensors = msgspec.structs.replace(p.sensors, noise=noise, imu_rate=100.0, mag_rate=100.0, range_rate=25.0)
    p = msgspec.structs.replace(p, sensors=sensors, duration=duration)
    run = record.run(p)
    z, truth = run.measurements, run.truth.motion
    down = p.world.gravity[2] > 0
    return Flight(
        time=z.time, gyro=z.gyro, accel=z.accel, mag=z.mag, range_time=z.range_time, range=z.range,
        rotation=truth.rotation, position=truth.position, frame="z-down" if down else "z-up",
        magnetic=p.world.magnetic, anchor=p.world.anchor,
    )  # fmt: skip


@pytest.fixture(scope="module")
def hand_held() -> Flight:
    """A record that turns and is accelerated along all axes."""
    return recorded("hand-held")


def without_truth(flight: Flight) -> Flight:
    return replace(flight, rotation=None, position=None)


def turned(*sensors: str, into: str) -> Callable[[Flight], Flight]:
    """Sensors whose readings are in other axes: `into` is the answer that corrects them."""
    matrix = axes.matrix(into)
    return lambda f: replace(f, **{name: getattr(f, name) @ matrix for name in sensors})


def late(seconds: float) -> Callable[[Flight], Flight]:
    def delayed(flight: Flight) -> Flight:
        kept = flight.range_time + seconds <= flight.time[-1]
        return replace(flight, range_time=flight.range_time[kept] + seconds, range=flight.range[kept])

    return delayed


def anchor_moved(metres: float) -> Callable[[Flight], Flight]:
    def moved(flight: Flight) -> Flight:
        assert flight.anchor is not None
        x, y, z = flight.anchor
        return replace(flight, anchor=(x + metres, y, z))

    return moved


def in_ms(flight: Flight) -> Flight:
    return replace(flight, time=1e3 * flight.time, range_time=1e3 * flight.range_time)


def without_gravity(flight: Flight) -> Flight:
    assert flight.rotation is not None
    up = np.array([0.0, 0.0, 9.81 if flight.frame == "z-up" else -9.81])
    return replace(flight, accel=flight.accel - to_body(flight.rotation, np.broadcast_to(up, flight.accel.shape)))


def inverted(flight: Flight) -> Flight:
    assert flight.rotation is not None
    return replace(flight, rotation=np.swapaxes(flight.rotation, -1, -2))


def other_heading(flight: Flight) -> Flight:
    """The attitude of an estimate that is 60° off in heading."""
    assert flight.rotation is not None
    c, s = 0.5, np.sqrt(0.75)
    return replace(flight, rotation=np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ flight.rotation)


def with_iron(flight: Flight) -> Flight:
    assert flight.mag is not None
    mag = 47.0 * flight.mag + np.array([120.0, -160.0, 250.0])
    length = float(np.median(np.linalg.norm(mag, axis=-1)))
    return replace(flight, mag=mag / length, field_length=length)


def with_gap(flight: Flight) -> Flight:
    """A record in which the IMU is silent for 3 s, after more than half of it."""
    kept = (flight.time < 9.0) | (flight.time > 12.0)
    parts = {name: getattr(flight, name)[kept] for name in ("time", "gyro", "accel", "mag", "rotation", "position")}
    return replace(flight, **parts)


def in_order(named: tuple[int, int, int, int]) -> Callable[[Flight], Flight]:
    """The attitude that is read where w, x, y, z stand in another order: `named` says which of them each name holds."""

    def reordered(flight: Flight) -> Flight:
        assert flight.rotation is not None
        quaternion = frames.from_rotation(flight.rotation)[:, list(named)]
        return replace(flight, rotation=frames.to_rotation(quaternion))

    return reordered


FAULTS: dict[str, tuple[Callable[[Flight], Flight], str, str | None]] = {
    "degrees, against the attitude": (lambda f: replace(f, gyro=np.degrees(f.gyro)), "gyro", "deg/s"),
    "degrees, against the field": (lambda f: without_truth(replace(f, gyro=np.degrees(f.gyro))), "gyro", "deg/s"),
    "degrees, against gravity": (
        lambda f: replace(without_truth(f), gyro=np.degrees(f.gyro), mag=None), "gyro", "deg/s",
    ),
    "milliseconds": (in_ms, "time", "ms"),
    "forward-right-down": (turned("gyro", "accel", "mag", into="+x-y-z"), "body-axes", "+x-y-z"),
    "axes of the gyro": (turned("gyro", into="-y+x+z"), "gyro-axes", "-y+x+z"),
    "left-handed gyro": (lambda f: without_truth(turned("gyro", into="+x-y+z")(f)), "gyro-axes", "+x-y+z"),
    "swapped accelerometer": (turned("accel", into="+y+x+z"), "accel-axes", "+y+x+z"),
    "accelerometer upside down": (turned("accel", into="+x-y-z"), "accel-axes", "+x-y-z"),
    "axes of the magnetometer": (lambda f: without_truth(turned("mag", into="+y-x+z")(f)), "mag-axes", "+y-x+z"),
    "hard iron": (lambda f: without_truth(with_iron(f)), "mag-offset", "120 -160 250"),
    "in g": (lambda f: replace(f, accel=f.accel / 9.80665), "accel", "g"),
    "half scale": (lambda f: replace(f, accel=f.accel / 2), "accel-scale", "2"),
    "linear acceleration": (without_gravity, "accel-scale", None),
    "inverse attitude": (inverted, "attitude", "inverse"),
    "an estimate's heading": (other_heading, "attitude", "ignore"),
    "unconfirmed truth": (lambda f: replace(f, unconfirmed=("orientation_w",)), "truth", None),
    "an estimate by name": (lambda f: replace(other_heading(f), unconfirmed=("orientation_w",)), "truth", "no"),
    "the other frame": (lambda f: replace(f, frame="z-down" if f.frame == "z-up" else "z-up"), "frame", "z-down"),
    "ranges in mm, against the truth": (lambda f: replace(f, range=1e3 * f.range), "range", "mm"),
    "ranges in mm, against an unknown anchor": (lambda f: replace(f, range=1e3 * f.range, anchor=None), "range", "mm"),
    "ranges in mm, against the IMU": (lambda f: without_truth(replace(f, range=1e3 * f.range)), "range", "mm"),
    "late, against the truth": (late(0.4), "range-delay", "0.40"),
    "late, against the IMU": (lambda f: without_truth(late(0.4)(f)), "range-delay", "0.40"),
    "a frame against its gravity": (lambda f: replace(without_truth(f), frame="z-down" if f.frame == "z-up" else "z-up",
        gravity=(0.0, 0.0, -9.81 if f.frame == "z-up" else 9.81)), "frame", "z-up"),
    "an anchor 1 m away": (anchor_moved(1.0), "anchor", None),
    "ranges 0.8 m long": (lambda f: replace(f, range=f.range + 0.8), "range-offset", None),
    "x y z w under the names w x y z": (in_order((1, 2, 3, 0)), "attitude", "xyzw"),
    "w x y z under the names x y z w": (in_order((3, 0, 1, 2)), "attitude", "wxyz"),
    "a gap of the IMU": (with_gap, "gaps", "longest"),
    "biased gyro": (lambda f: replace(f, gyro=f.gyro + np.array([0.0, 0.1, 0.2])), "gyro-offset", "0 0.1 0.2"),
    "biased accelerometer": (lambda f: replace(f, accel=f.accel + np.array([0.5, 0, 1])), "accel-offset", "0.5 0 1"),
    "ranges in cm, against the IMU": (lambda f: without_truth(replace(f, range=100 * f.range)), "range", "cm"),
    "another anchor": (lambda f: replace(f, anchor=(5.0, 5.0, 5.0)), "anchor", None),
}  # fmt: skip


@pytest.mark.parametrize("fault", list(FAULTS))
def test_each_fault_is_asked_with_its_evidence_and_the_answer_that_corrects_it(hand_held: Flight, fault: str):
    spoil, key, suggestion = FAULTS[fault]
    after = record_checks.check(spoil(hand_held), {})
    questions = {question.key: question for question in after.questions}
    assert set(questions) == {key}, questions
    question = questions[key]
    if key == "frame":
        suggestion = hand_held.frame
    if suggestion is not None and key == "range-delay":
        assert float(question.suggestion or "nan") == pytest.approx(0.4, abs=0.02)
    elif suggestion is not None and key == "mag-offset":
        offset = [float(part) for part in (question.suggestion or "").split()]
        assert offset == pytest.approx([120.0, -160.0, 250.0], rel=0.02)
    elif key in ("gyro-offset", "accel-offset"):
        constant = [float(part) for part in (question.suggestion or "").split()]
        assert constant == pytest.approx([float(part) for part in (suggestion or "").split()], abs=0.03)
    elif key == "range-offset":
        assert float(question.suggestion or "nan") == pytest.approx(0.8, abs=0.02)
    elif key == "anchor":
        place = [float(part) for part in (question.suggestion or "").split()]
        assert place == pytest.approx(hand_held.anchor, abs=0.1)
    else:
        assert question.suggestion == suggestion
    assert question.evidence
    assert question.flag in question.text


@pytest.mark.parametrize("fault", [name for name, (_, key, _) in FAULTS.items() if key in KEEP])
def test_a_record_that_is_taken_against_its_evidence_is_not_judged(hand_held: Flight, fault: str):
    spoil, key, _ = FAULTS[fault]
    spoilt = spoil(hand_held)
    kept = record_checks.check(spoilt, {key: spoilt.frame if key == "frame" else KEEP[key]})
    assert kept.questions == ()
    assert kept.restriction is not None
    assert record_checks.restriction(kept.flight) is not None


@pytest.mark.parametrize("fault", [name for name, (_, key, _) in FAULTS.items() if key not in ("truth", "anchor")])
def test_the_suggested_answer_leaves_nothing_to_ask(hand_held: Flight, fault: str):
    """Units and frame are corrected by the reader of the file; here by the check's own correction."""
    spoil, key, _ = FAULTS[fault]
    (question,) = record_checks.check(spoil(hand_held), {}).questions
    if question.suggestion is None:
        return
    row = next(row for row in record_checks.CHECKS if row.key == key)
    mended = row.correct(spoil(hand_held), question.suggestion)
    again = record_checks.check(mended, {})
    assert (again.questions, again.doubts) == ((), ())


def test_an_anchor_is_judged_by_the_covariance_of_the_one_that_fits_best(hand_held: Flight):
    """5 cm are within what is usual between a tracked point and a radio; in a plane the height is two-valued."""
    assert record_checks.check(anchor_moved(0.05)(hand_held), {}).questions == ()
    assert hand_held.position is not None
    assert hand_held.anchor is not None
    x, y, z = hand_held.anchor
    flat = hand_held.position * np.array([1.0, 1.0, 0.0]) + np.array([0.0, 0.0, z + 1.0])
    at = np.stack([np.interp(hand_held.range_time, hand_held.time, axis) for axis in flat.T], axis=-1)
    noise = 0.05 * np.random.default_rng(1).standard_normal(len(at))
    planar = replace(hand_held, position=flat, rotation=None, range=np.linalg.norm(at - [x, y, z], axis=-1) + noise)
    for place in ((x, y, z), (x, y, z + 2.0)):
        assert anchors.anchor(replace(planar, anchor=place)) is None
    assert anchors.anchor(replace(planar, anchor=(x + 1.0, y, z))) is not None


def test_what_a_person_gives_instead_of_the_files_statement_is_said(hand_held: Flight):
    assert hand_held.anchor is not None
    read = ImportResult(
        source="x", format="log", rows=1, rate=None, duration=16.0, frame="z-up", findings=(), flight=hand_held
    )
    x, y, z = hand_held.anchor
    (said,) = record_checks.checked(read, {}, anchor=(x + 0.01, y, z)).findings
    assert "given instead of" in said
    assert record_checks.checked(read, {}, anchor=(x, y, z)).findings == ()


def test_ranges_that_are_no_distances_are_not_used_and_named_by_value_count_and_line(hand_held: Flight):
    distance = hand_held.range.copy()
    distance[5::40], distance[15::40], distance[25::40], distance[35::40] = 0.0, 65.535, 100.0, -1.0
    spoilt = replace(hand_held, range=distance, range_lines=np.arange(len(distance)) + 2)
    after = record_checks.check(spoilt, {})
    (said,) = after.findings
    bad = np.isin(distance, [0.0, 65.535, 100.0, -1.0])
    assert said.startswith(f"{bad.sum()} of {len(distance)} ranges are no distances of this motion: ")
    for text in ("10 of 0 m", "10 of 65.535 m", "of 100 m", "10 of -1 m", "lines 7, 17", "--range-values keep"):
        assert text in said
    np.testing.assert_array_equal(after.flight.range, distance[~bad])
    kept = record_checks.check(spoilt, {"range-values": "keep"})
    assert len(kept.flight.range) == len(distance)
    assert kept.restriction is not None
    for one in (after, kept):  # the answer can be changed back
        assert [(q.key, q.suggestion, q.as_it_is) for q in one.applied] == [("range-values", "drop", "keep")]
    assert record_checks.check(hand_held, {}).applied == ()


@pytest.mark.parametrize("value", [0.0, 2.5])
def test_ranges_that_are_all_the_same_are_none(hand_held: Flight, value: float):
    """Zeros look perfect: the variance of ½d² vanishes at d = 0."""
    after = record_checks.check(replace(hand_held, range=np.full_like(hand_held.range, value)), {})
    assert len(after.flight.range) == 0
    assert after.findings[0].startswith(f"all {len(hand_held.range)} ranges are the same, {value:g} m")
    seen = logs.whole(after.flight, range_sigma=0.1, requirement=0.5, noise=None)
    assert (seen.verdict, seen.rank) == ("too few ranges", 0)


@pytest.mark.parametrize("every", [10, 97])
@pytest.mark.parametrize("truth", [True, False])
def test_single_ranges_that_are_far_off_are_not_used_and_named_by_count_size_and_line(
    hand_held: Flight, every: int, truth: bool
):
    """By the truth, or by neighbours; either knows nothing of the σ of the ranges."""
    distance = hand_held.range.copy()
    distance[7::every] += 3.0
    spoilt = replace(hand_held, range=distance, range_lines=np.arange(len(distance)) + 2)
    after = record_checks.check(spoilt if truth else without_truth(spoilt), {})
    bad = distance != hand_held.range
    assert (after.questions, after.doubts) == ((), ())
    np.testing.assert_array_equal(after.flight.range, distance[~bad])
    (said,) = after.findings
    assert said.startswith(f"{bad.sum()} of {len(distance)} ranges are ")
    assert "on lines 9, " in said
    assert "--range-outliers keep" in said
    assert record_checks.restriction(after.flight) is None
    kept = record_checks.check(spoilt, {"range-outliers": "keep"})
    assert len(kept.flight.range) == len(distance)
    assert kept.restriction is not None


def test_ranges_with_errors_of_every_size_are_not_doubted_once_the_outliers_are_left_out(hand_held: Flight):
    """The rest of what was off is no outlier among the rest, so that the record stays as it was judged."""
    errors = np.random.default_rng(2).standard_cauchy(len(hand_held.range))
    spoilt = replace(hand_held, range=hand_held.range + np.clip(np.abs(0.1 * errors), 0.0, 9.0))
    left = outliers.off(spoilt) == 0
    assert 0 < (~left).sum() < 0.2 * len(left)
    assert not outliers.is_outlier(recorded_flight.with_some_ranges(spoilt, left)).any()


def test_a_fast_pass_of_the_anchor_has_no_outliers():
    """Distances of a line through the anchor turn within a sample, at any speed."""
    time = np.arange(0.0, 10.0, 0.05)
    for speed in (1.0, 30.0, 300.0):
        distance = np.abs(speed * (time - 5.01)) + 0.02 * np.random.default_rng(3).standard_normal(len(time))
        flight = Flight(
            time=time, gyro=np.zeros((len(time), 3)), accel=np.tile([0.0, 0.0, 9.81], (len(time), 1)), mag=None,
            range_time=time, range=distance,
        )  # fmt: skip
        assert outliers.outliers(flight) is None


def test_ranges_that_fit_the_truth_nowhere_are_not_judged(hand_held: Flight):
    """Distances to an anchor that moves about: no unit, delay, offset or place explains them."""
    spoilt = replace(hand_held, range=hand_held.range + 0.8 * (1 + np.sin(5 * hand_held.range_time)))
    after = record_checks.check(spoilt, {})
    assert after.questions == ()
    assert after.restriction is not None
    assert "disagree with the true positions by" in after.restriction
    assert "for any anchor" in str(record_checks.check(replace(spoilt, anchor=None), {}).restriction)


def test_an_imu_that_is_sampled_too_rarely_for_its_turns_is_not_judged(hand_held: Flight):
    """The rule is about the turn per step: the same record at a quarter of its turns is not doubted."""
    names = ("time", "gyro", "accel", "mag", "rotation", "position")
    slow = replace(hand_held, **{name: getattr(hand_held, name)[::100] for name in names})
    assert "rate of 1 Hz is too low for this motion" in str(record_checks.check(slow, {}).restriction)
    assert clock.rate(replace(slow, gyro=slow.gyro / 10)) is None


def test_with_a_gap_the_part_without_it_is_used_and_nothing_else_is_asked(hand_held: Flight):
    after = record_checks.check(with_gap(hand_held), {"gaps": "longest"})
    assert (after.questions, after.doubts) == ((), ())
    assert after.flight.time[-1] < 9.0
    assert after.flight.range_time[-1] < 9.0
    whole = record_checks.corrected(with_gap(hand_held), {"gaps": "longest"})
    assert whole.time[-1] == hand_held.time[-1]
    (question,) = record_checks.check(replace(with_gap(hand_held), lines=np.arange(1300) + 2), {}).questions
    assert "no rows of the IMU for 3.02 s between line 901 at 8.99 s and line 902 at 12.01 s" in question.evidence


def test_sensors_are_not_turned_by_an_attitude_that_is_in_doubt_itself(hand_held: Flight):
    """An attitude in axes of its own: it follows the gyro in other axes, and turns gravity and field away."""
    assert hand_held.rotation is not None
    turn = axes.matrix("+z+x+y")
    spoilt = replace(hand_held, rotation=turn @ hand_held.rotation @ axes.matrix("+x-z+y"))
    (question,) = record_checks.check(spoilt, {}).questions
    assert (question.key, question.suggestion) == ("attitude", "ignore")


def test_a_range_that_is_held_over_rows_counts_once(hand_held: Flight):
    """A logger writes the last range on every row: predicted errors must not shrink with the rate of the rows."""
    rows = np.repeat(hand_held.range, 4)[: len(hand_held.time)]
    repeated = replace(hand_held, range_time=hand_held.time[: len(rows)], range=rows)
    after = record_checks.check(repeated, {})
    np.testing.assert_array_equal(after.flight.range, hand_held.range)
    np.testing.assert_allclose(after.flight.range_time, hand_held.range_time, atol=1e-9)
    assert (
        f"each range stands on 4 rows, held until the next one: {len(rows)} rows are {len(hand_held.range)}"
        in (after.findings[0])
    )
    each = record_checks.check(repeated, {"held-ranges": "each"})
    assert len(each.flight.range) == len(rows)
    assert each.restriction is not None


def test_poses_that_a_tracker_has_lost_are_missing(hand_held: Flight):
    assert hand_held.position is not None
    assert hand_held.rotation is not None
    position = hand_held.position + np.array([3.0, 0.0, 0.0])
    position[100:110] = 0.0
    assert hand_held.anchor is not None
    x, y, z = hand_held.anchor
    spoilt = replace(hand_held, position=position, anchor=(x + 3.0, y, z), lines=np.arange(len(position)) + 2)
    after = record_checks.check(spoilt, {})
    assert after.questions == ()
    assert "10 of 1601 positions are 0 0 0 and far from their neighbours, on lines 102, 103" in after.findings[0]
    assert np.isnan(after.flight.position[100:110]).all()  # pyright: ignore[reportOptionalSubscript]
    at_origin = replace(hand_held, position=np.zeros_like(hand_held.position), rotation=None, range=hand_held.range[:0],
                        range_time=hand_held.range_time[:0])  # fmt: skip
    assert record_checks.check(at_origin, {}).findings == ()


@pytest.mark.parametrize("name", sorted(preset.shipped()))
def test_good_records_are_not_asked_about(name: str):
    """Every shipped preset as it is, with its own noise: also hovers, lines, spins and passes close to the anchor."""
    p = preset.load(name)
    run = record.run(p)
    z, truth = run.measurements, run.truth.motion
    flight = Flight(
        time=z.time, gyro=z.gyro, accel=z.accel, mag=z.mag, range_time=z.range_time, range=z.range,
        rotation=truth.rotation, position=truth.position, gravity=p.world.gravity, magnetic=p.world.magnetic,
        anchor=p.world.anchor, frame="z-down" if p.world.gravity[2] > 0 else "z-up",
    )  # fmt: skip
    short = recorded_flight.between(flight, 0.0, 3.0)  # it gains speed, and hardly determines the anchor
    for one in (flight, short, replace(without_truth(flight), anchor=None, gravity=None, magnetic=None)):
        after = record_checks.check(one, {})
        assert (after.findings, after.questions, after.doubts) == ((), (), ())


def test_a_real_record_is_not_asked_about():
    path = shared("imu/broad_21_undisturbed_fast_combined.mat")
    read = formats.settled(formats.read(path, "mat", confirm={"mag": "uT"}))
    checked = record_checks.checked(read, {})
    assert (checked.questions, checked.unjudged) == ((), None)


def test_every_check_has_a_flag_of_the_command_line_with_all_its_answers():
    flags = {f"--{field.name.replace('_', '-')}": field for field in dataclasses.fields(Answers)}
    keys = {KEYS.get(field.name, field.name.replace("_", "-")) for field in flags.values()}
    for row in record_checks.CHECKS:
        if row.key in ("anchor", ""):
            continue
        assert row.flag in flags, row.flag
        assert row.key in keys, row.key
        assert not row.default or row.default == row.options[0]
    for first in record_checks.CHECKS:
        for second in record_checks.CHECKS:
            if first.key == second.key:
                same = (first.flag, first.correct.__name__, first.at_reading)
                assert same == (second.flag, second.correct.__name__, second.at_reading)


def test_every_check_is_made_and_every_key_of_a_question_is_one_of_the_table():
    """A row that no fault above reaches would be a row that nobody has seen work."""
    reached = {key for _, key, _ in FAULTS.values()} | {"poses", "range-values", "held-ranges", "range-outliers"}
    assert reached == {row.key for row in record_checks.CHECKS if row.key}
    assert {row.name for row in record_checks.CHECKS if not row.key} == {"rate of the IMU", "fit of the ranges"}


def test_axes_are_48_signed_permutations_and_anything_else_is_refused():
    assert len({matrix.tobytes() for matrix in axes.MATRICES}) == 48
    for text, matrix in zip(axes.EVERY, axes.MATRICES, strict=True):
        np.testing.assert_array_equal(matrix @ matrix.T, np.eye(3))
        assert bool(axes.handedness(text)) == (round(float(np.linalg.det(matrix))) == -1)
    for wrong in ("xyz", "+x+y", "+x+x+z", "+x +y +z", "+a+b+c"):
        with pytest.raises(ValueError, match="axes must name x, y and z with their signs"):
            axes.matrix(wrong)


STATED = {"mag": "uT", "frame": "z-up"}
JUDGED_WRONGLY: dict[str, tuple[dict[str, str], dict[str, str | None]]] = {
    "log_good.csv": ({}, {}),
    "log_body_frd.csv": ({}, {"body-axes": "+x-y-z"}),
    "log_accel_axes_swapped.csv": ({}, {"accel-axes": "+y+x+z"}),
    "log_gravity_removed.csv": ({}, {"accel-scale": None}),
    "log_accel_half.csv": ({}, {"accel-scale": "2"}),
    "log_ms_called_s.csv": ({}, {"time": "ms"}),
    "log_range_mm_called_m.csv": ({}, {"range": "mm"}),
    "log_range_sentinels.csv": ({}, {}),
    "log_ranges_in_rows_of_their_own.csv": ({"lines": "drop"}, {}),
    "log_orientation_is_an_estimate.csv": ({}, {"truth": "no"}),
    "public/range_all_zero.csv": (STATED, {}),
    "public/range_true_control.csv": (STATED, {}),
    "public/range_held_five_times.csv": (STATED, {}),
    "public/gyro_deg_labelled_rad_ms_stamps.csv": ({**STATED, "time": "ms"}, {"gyro": "deg/s"}),
    "public/gyro_deg_labelled_rad_s_stamps_control.csv": (STATED, {"gyro": "deg/s"}),
    "public/mag_axes_control.csv": (STATED, {}),
    "public/mag_hard_iron.csv": (STATED, {"mag-offset": "120 -160 250"}),
    "public/linear_acceleration_small.csv": (STATED, {"accel": None}),
    "public/linear_acceleration_stated.csv": (STATED, {"accel-scale": None}),
    "public/micros_wrap.csv": ({**STATED, "time": "us"}, {"stamps": "unwrap"}),
}
"""Files that version 0.1.0 judged wrongly: the answers given, and what is asked with which suggestion."""


@pytest.mark.parametrize("name", list(JUDGED_WRONGLY))
def test_what_was_judged_wrongly_is_asked_about(name: str):
    confirm, wanted = JUDGED_WRONGLY[name]
    read = formats.read(shared(f"failing/{name}"), "log", confirm=confirm)
    checked = record_checks.checked(read, confirm)
    assert {question.key: question.suggestion for question in checked.questions} == wanted
    if not wanted:
        assert checked.unjudged is None


def test_a_delay_of_the_ranges_is_estimated_from_the_truth():
    read = formats.read(shared("failing/log_ranges_late_by_0.4s.csv"), "log", confirm={})
    (question,) = record_checks.checked(read, {}).questions
    assert (question.key, float(question.suggestion or "nan")) == ("range-delay", pytest.approx(0.4, abs=0.015))
    corrected = record_checks.checked(read, {"range-delay": "0.4"})
    assert (corrected.questions, corrected.unjudged) == ((), None)
