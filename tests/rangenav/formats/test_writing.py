"""What is written: entered and left from hover, on the path between, refused where a format cannot hold it."""

import re
from typing import cast

import msgspec
import numpy as np
import pytest

from rangenav import formats, motion, preset, record
from rangenav.axes import upright
from rangenav.formats import frames, hermite, hover_ramps, output_files
from rangenav.formats.path_preset import as_preset
from rangenav.formats.polynomial import MAX_SEGMENTS, NAMES
from rangenav.formats.sampled_rows import WHOLE
from rangenav.observability import excitation
from rangenav.signals import Flown, MinimumSnap, Polynomials, Waypoint, polynomials
from rangenav.signals.polynomials import from_minimum_snap
from tests.support.present import present
from tests.support.refusals import exactly
from tests.support.signal_examples import EXAMPLES

pytestmark = pytest.mark.slow


FLYABLE = ("paper-slow", "soft", "lissajous", "helix", "tilted-circle")


def truth_inputs(name):
    p = upright(preset.load(name))
    return p, hover_ramps.with_ramps(p.path, p.duration, window=p.requirement.window)


@pytest.mark.parametrize("name", FLYABLE)
def test_a_ramped_path_starts_and_stops_at_hover_and_is_smooth_where_it_joins(name):
    p, course = truth_inputs(name)
    ends = np.array([0.0, course.end])
    for order in range(1, 5):
        assert np.abs(course(ends, order)).max() < 1e-12
    for joint in course.steady:
        eps = 1e-7
        for order in range(5):
            before, after = course(np.array([joint - eps, joint + eps]), order)
            scale = p.path.bound(order + 1) if order else 10.0
            assert np.abs(after - before).max() < 1e-5 * scale


@pytest.mark.parametrize("name", FLYABLE)
def test_derivatives_of_a_ramped_path_are_those_of_its_positions(name):
    """Each order against central differences of the one below it."""
    _, course = truth_inputs(name)
    t, h = np.linspace(0.05, course.end - 0.05, 701), 1e-4
    for order in range(1, 5):
        difference = (course(t + h, order - 1) - course(t - h, order - 1)) / (2 * h)
        size = np.abs(course(t, order)).max()
        np.testing.assert_allclose(course(t, order), difference, atol=1e-5 * size)  # h² p⁽⁵⁾/6 and rounding


@pytest.mark.parametrize("name", FLYABLE)
def test_between_its_ramps_a_ramped_path_is_the_path_itself_and_nowhere_leaves_it(name):
    p, course = truth_inputs(name)
    begin, end = course.steady
    t = np.linspace(begin, end, 300)
    np.testing.assert_allclose(course(t), p.path(t - course.ramp / 2), atol=1e-12)
    own = course.own_time(np.linspace(0, course.end, 2000))[:, 0]
    assert own[0] == 0.0
    assert own[-1] == pytest.approx(p.duration)
    assert (np.diff(own) >= 0).all()  # forwards only: no place is visited that the path does not visit


def test_a_path_that_rests_at_its_ends_needs_no_ramps_and_one_too_short_for_them_is_refused():
    course = hover_ramps.with_ramps(EXAMPLES["waypoints"], 12.0, window=6.0)
    assert (course.ramp, course.end, course.steady) == (0.0, 12.0, (0.0, 12.0))
    rule = "ramps of 2 s leave 5 s of the path, less than its window of 6 s: fly longer"
    with pytest.raises(ValueError, match=exactly(rule)):
        hover_ramps.with_ramps(preset.load("soft").path, 7.0, window=6.0)


@pytest.mark.parametrize("yaw", ["0", "0.7", "sin(t)/2"])
def test_the_attitude_flown_carries_the_thrust_and_turns_as_it_says(yaw):
    p, course = truth_inputs("paper-slow")
    t = np.linspace(0.01, course.end - 0.01, 900)
    body = hover_ramps.attitude(course, Flown(yaw=yaw), p.world.gravity, t)
    felt = motion.apparent(body.rotation, course(t, 2), gravity=np.array(p.world.gravity))
    assert np.abs(felt[:, :2]).max() < 1e-6  # all of it along the body's z; ramps are fitted to 1e-7
    assert felt[:, 2].min() > 0
    h = 1e-4
    after, before = (hover_ramps.attitude(course, Flown(yaw=yaw), p.world.gravity, t + s) for s in (h, -h))
    turned = body.rotation.transpose(0, 2, 1) @ (after.rotation - before.rotation) / (2 * h)
    np.testing.assert_allclose(turned[:, 2, 1], body.angular_velocity[:, 0], atol=1e-3)
    np.testing.assert_allclose(turned[:, 1, 0], body.angular_velocity[:, 2], atol=1e-3)
    rate = (after.angular_velocity - before.angular_velocity) / (2 * h)
    np.testing.assert_allclose(rate, body.angular_acceleration, atol=2e-2)  # on ramps snap is piecewise


def test_pieces_through_a_polynomial_of_degree_seven_are_that_polynomial():
    rng = np.random.default_rng(5)
    c = rng.standard_normal((8, 3))
    t = np.array([0.0, 0.4, 1.7, 2.0])
    given = [np.polynomial.polynomial.polyval(t, np.polynomial.polynomial.polyder(c, k)).T for k in range(4)]
    path = hermite.polynomials(t, np.stack(given, axis=1))
    at = np.linspace(0, 2 - 1e-9, 50)
    for order in range(8):
        wanted = np.polynomial.polynomial.polyval(at, np.polynomial.polynomial.polyder(c, order)).T
        np.testing.assert_allclose(path(at, order), wanted, rtol=1e-9, atol=1e-7 * np.abs(wanted).max())


# --- polynomials


@pytest.mark.parametrize("name", ["paper-slow", "soft", "lissajous", "circle", "hover", "line"])
def test_a_polynomial_file_follows_its_path_and_keeps_its_excitation(name, tmp_path):
    p = preset.load(name)
    written = formats.export(p, "polynomial", tmp_path / "x.csv")
    imported = formats.read(tmp_path / "x.csv", "polynomial", part=WHOLE)
    assert imported.rows <= MAX_SEGMENTS
    assert imported.unjudged is None  # nothing jumps
    assert written.figures["fit_error"] < 3e-4
    begin, end = present(written.steady)
    path, start = preset.load(name).path, np.linspace(0, 5, 20)
    part = polynomials.cut(cast(Polynomials, imported.path), begin, end - begin)
    assert written.loop == (name not in ("hover", "line"))
    if written.loop:
        part = msgspec.structs.replace(part, ends="repeat")
    else:
        assert end - begin >= p.requirement.window - 1e-9
        start = start * (end - begin - p.requirement.window) / 5
    got = excitation.eigenvalues(part, start, p.requirement.window)
    wanted = excitation.eigenvalues(path, start + begin / 2, p.requirement.window)  # turning over does not change them
    np.testing.assert_allclose(got, wanted, rtol=2e-3, atol=1e-9 * max(wanted.max(), 1.0))
    assert written.figures["mu"] == pytest.approx(written.figures["mu_path"], rel=2e-3)


def test_a_path_too_fast_for_31_pieces_is_refused_and_nothing_is_written(tmp_path):
    """The ramps of the wiggle at 50 rad/s are what no pieces follow; the paper's path fits once as a loop only."""
    for name, once in (("wiggle", False), ("paper", True)):
        with pytest.raises(ValueError, match="it turns too fast for the format"):
            formats.export(preset.load(name), "polynomial", tmp_path / "x.csv", once=once)
    assert list(tmp_path.iterdir()) == []


def test_polynomials_that_were_read_are_written_as_they_are(tmp_path):
    pieces = EXAMPLES["minimum snap"]
    soft = msgspec.structs.replace(
        upright(preset.load("soft")), path=pieces, duration=12.0, requirement=preset.Requirement(window=4.0)
    )
    formats.export(soft, "polynomial", tmp_path / "x.csv")
    imported = formats.read(tmp_path / "x.csv", "polynomial").path
    assert isinstance(imported, Polynomials)
    assert len(imported.pieces) == 6
    at = np.linspace(0, 12, 100)
    np.testing.assert_allclose(imported(at), pieces(at), atol=1e-8)  # ten printed digits
    again = as_preset(formats.read(tmp_path / "x.csv", "polynomial"))
    formats.export(again, "polynomial", tmp_path / "y.csv")
    assert (tmp_path / "y.csv").read_text() == (tmp_path / "x.csv").read_text()


# --- reference


@pytest.mark.parametrize("name", ["paper-slow", "soft"])
def test_a_reference_file_is_read_back_as_the_path_it_came_from(name, tmp_path):
    p, course = truth_inputs(name)
    formats.export(preset.load(name), "reference", tmp_path / "x.csv")
    imported = formats.read(tmp_path / "x.csv", "reference", part=WHOLE)
    assert imported.unjudged is None
    assert imported.duration == pytest.approx(course.end)
    t, path = np.linspace(2.5, 17.5, 200), present(imported.path)
    np.testing.assert_allclose(path(t), course(t), atol=1e-6)
    np.testing.assert_allclose(path(t, 4), course(t, 4), atol=1e-3 * np.abs(course(t, 4)).max())
    begin, end = course.steady
    start = np.linspace(begin, end - p.requirement.window, 10)
    got, wanted = (
        excitation.eigenvalues(one, s, p.requirement.window) for one, s in ((path, start), (p.path, start - 1))
    )
    np.testing.assert_allclose(got, wanted, rtol=1e-3)


@pytest.mark.parametrize(
    ("name", "format"),
    [("paper", "reference"), ("wiggle", "reference"), ("paper-slow", "polynomial"), ("lissajous", "polynomial")],
)
def test_the_ramps_of_an_own_export_are_left_out_and_its_excitation_is_that_of_the_flight(name, format, tmp_path):
    p, course = truth_inputs(name)
    formats.export(preset.load(name), format, tmp_path / "x.csv")
    imported = formats.read(tmp_path / "x.csv", format)
    assert any("are left out" in sentence for sentence in imported.findings)
    begin, end = course.steady
    window, again = p.requirement.window, as_preset(imported)
    assert (again.path.period is None) == (format == "reference")  # a loop is read as one
    last = again.duration if again.path.period else min(imported.duration, end - begin)
    start = np.linspace(0, last - window, 10)
    got = excitation.eigenvalues(again.path, start, window)
    np.testing.assert_allclose(got, excitation.eigenvalues(p.path, start + begin / 2, window), rtol=2e-3)


def test_another_path_from_rest_to_rest_is_read_whole(tmp_path):
    """A minimum-snap curve starts at rest as well, but not with the ramps of an export."""
    rng = np.random.default_rng(5)
    points = tuple(Waypoint(time=float(k), value=tuple(rng.standard_normal(3).tolist())) for k in range(10))
    path = from_minimum_snap(MinimumSnap(points=points))
    rows = [[piece.duration, *piece.x, *piece.y, *piece.z, *piece.yaw] for piece in path.pieces]
    text = "\n".join([",".join(NAMES), *(",".join(map(repr, row)) for row in rows)])
    assert formats.parse(text.encode(), "polynomial", source="x.csv", confirm={}).duration == pytest.approx(9.0)


def test_the_presets_own_attitude_can_be_asked_for(tmp_path):
    p = preset.load("paper-slow")
    formats.export(p, "reference", tmp_path / "x.csv", attitude="preset")
    header, *rows = (tmp_path / "x.csv").read_text().split()
    names, values = header.split(","), np.array([[float(v) for v in row.split(",")] for row in rows])
    q = values[:, [names.index(f"q_{a}") for a in "wxyz"]]
    truth = record.simulated(record.truth_inputs(upright(p))).motion
    np.testing.assert_allclose(frames.to_rotation(q), truth.rotation[::2], atol=1e-9)


# --- runs


def test_a_log_is_read_back_without_a_question_and_to_the_last_bit(tmp_path):
    p = preset.load("soft")
    formats.export(p, "log", tmp_path / "x.csv")
    flight = present(formats.settled(formats.read(tmp_path / "x.csv", "log")).flight)
    z = record.run(p).measurements
    for name in ("time", "gyro", "accel", "range_time", "range"):
        np.testing.assert_array_equal(getattr(flight, name), getattr(z, name))
    np.testing.assert_allclose(present(flight.rotation), record.run(p).truth.motion.rotation, atol=1e-12)
    assert (flight.gravity, flight.anchor, flight.frame) == (p.world.gravity, p.world.anchor, "z-down")


def test_a_euroc_folder_is_read_back_with_its_ranges_and_field(tmp_path):
    p = preset.load("soft")
    formats.export(p, "euroc", tmp_path / "flight")
    flight = present(formats.settled(formats.read(tmp_path / "flight", "euroc")).flight)
    z = record.run(p).measurements
    np.testing.assert_allclose(flight.time, z.time, atol=1e-9)
    np.testing.assert_array_equal(flight.gyro, z.gyro * [1, -1, -1])
    np.testing.assert_array_equal(flight.range, z.range)
    np.testing.assert_allclose(flight.range_time, z.range_time, atol=1e-9)
    world = upright(p).world
    assert (flight.gravity, flight.magnetic, flight.anchor) == (world.gravity, world.magnetic, world.anchor)
    assert np.isfinite(present(flight.position)).all()
    truth = formats.read(tmp_path / "flight" / "mav0" / "state_groundtruth_estimate0" / "data.csv", "euroc")
    assert present(truth.fit_error) < 1e-3  # the flight begins at speed, and so does the curve
    assert truth.unjudged is not None


@pytest.mark.parametrize("format", ["tum", "csv"])
def test_a_file_that_cannot_be_judged_when_it_is_read_again_says_so(format, tmp_path):
    assert any("not judged" in note for note in formats.export(preset.load("soft"), format, tmp_path / "x").notes)


def test_npz_and_csv_hold_the_arrays_of_the_run(tmp_path):
    p = preset.load("soft")
    truth = record.run(p).truth.motion
    formats.export(p, "npz", tmp_path / "x.npz")
    with np.load(tmp_path / "x.npz") as arrays:
        np.testing.assert_array_equal(arrays["snap"], truth.snap)
    formats.export(p, "csv", tmp_path / "x.csv")
    table = np.loadtxt(tmp_path / "x.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(
        table, np.column_stack([truth.time, truth.position, truth.velocity, truth.acceleration])
    )


@pytest.mark.parametrize("format", ["bezier", "qgc"])
def test_formats_that_cannot_keep_excitation_say_why(format, tmp_path):
    with pytest.raises(ValueError, match="nothing about it can be certified"):
        formats.export(preset.load("soft"), format, tmp_path / "x")


def test_half_a_file_never_stays_and_folders_are_never_written_over(tmp_path, monkeypatch):
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("mine")
    for format in ("euroc", "bag"):
        with pytest.raises(ValueError, match="a folder is never written over"):
            formats.export(preset.load("soft"), format, tmp_path / "full")
    with pytest.raises(ValueError, match="no such folder"):
        formats.export(preset.load("soft"), "tum", tmp_path / "no" / "x.tum")

    def broken(*_):
        raise OSError(28, "No space left on device", "x")

    monkeypatch.setattr(output_files.os, "fdopen", broken)
    with pytest.raises(OSError, match="No space"):
        formats.export(preset.load("soft"), "tum", tmp_path / "x.tum")
    assert sorted(one.name for one in tmp_path.iterdir()) == ["full"]


def test_without_rosbags_the_extra_is_named(tmp_path, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "rosbags.rosbag2", None)
    with pytest.raises(ValueError, match=re.escape('bag and mcap need the extra "ros": pip install "rangenav[ros]"')):
        formats.export(preset.load("soft"), "bag", tmp_path / "bag")
