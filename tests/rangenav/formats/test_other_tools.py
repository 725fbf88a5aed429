"""Every file that is written, read by a tool nobody here wrote: evo, GTSAM, cflib, mcap, scipy."""

import json
import os
import struct
import subprocess
import sys
from pathlib import Path
from subprocess import PIPE
from typing import Any

import numpy as np
import pytest
import scipy.io

from rangenav import formats, motion, preset, record
from rangenav.axes import upright
from rangenav.formats import crazyflie, exported_run, frames, hover_ramps
from rangenav.observability import excitation
from rangenav.signals import polynomials
from tests.support.present import present
from tests.support.signal_examples import eight

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("default")]  # other people's warnings are theirs


RUN_EACH = """
import contextlib, io, json, runpy, sys
for line in sys.stdin:
    sys.argv, code, said = json.loads(line), 0, io.StringIO()
    with contextlib.redirect_stdout(said):
        try:
            runpy.run_path(sys.argv[0], run_name="__main__")
        except SystemExit as stop:
            code = stop.code or 0
    print(json.dumps([code, said.getvalue()]), flush=True)
"""
"""Runs the scripts that it is sent, one after the other: each alone would import pandas for half a second."""


@pytest.fixture(scope="module")
def evo(tmp_path_factory):
    """evo(tool, arguments) -> what it printed, after success; its settings go to a folder of their own."""
    pytest.importorskip("evo", reason="evo is not installed (the extra interop has it)")
    environment = {**os.environ, "HOME": str(tmp_path_factory.mktemp("home")), "MPLBACKEND": "agg"}
    command = [sys.executable, "-c", RUN_EACH]
    with subprocess.Popen(command, env=environment, stdin=PIPE, stdout=PIPE, text=True) as tools:

        def call(tool, *arguments):
            script = Path(sys.executable).parent / tool
            print(json.dumps([str(script), *map(str, arguments)]), file=tools.stdin, flush=True)
            code, said = json.loads(present(tools.stdout).readline())
            assert code == 0, said
            return said

        yield call


EVO = {
    "tum": ("tum", "x.tum", ()),
    "euroc": ("euroc", "x/mav0/state_groundtruth_estimate0/data.csv", ()),
    "bag": ("bag2", "x.bag", ("/ground_truth",)),
    "mcap": ("mcap", "x.mcap", ("/ground_truth",)),
}
NAMES = {"tum": "x.tum", "euroc": "x", "bag": "x.bag", "mcap": "x.mcap"}


@pytest.mark.parametrize("format", EVO)
def test_evo_finds_the_trajectory_whole_and_its_quaternions_and_stamps_right(evo, format, tmp_path):
    p = preset.load("soft")
    formats.export(p, format, tmp_path / NAMES[format])
    kind, name, topic = EVO[format]
    said = evo("evo_traj", kind, tmp_path / name, *topic, "--full_check")
    checks = [line.split() for line in said.splitlines()]
    for what in ("quaternions", "timestamps", "SE(3)"):
        answers = [words[-1] for words in checks if words and words[0].startswith(what)]
        assert all(answer in ("ok", "yes") for answer in answers), said
    assert any(words[:2] == ["timestamps", "ok"] for words in checks), said
    truth = record.run(p).truth.motion
    top = [float(w[-1]) for w in checks if w[:2] == ["v_max", "(m/s)"]]
    assert top == [pytest.approx(np.linalg.norm(truth.velocity, axis=-1).max(), rel=1e-3)], said


@pytest.mark.parametrize("format", EVO)
def test_evo_reads_the_very_poses_of_the_run(evo, format, tmp_path):
    from evo.tools import file_interface

    p = preset.load("paper-slow")
    path = tmp_path / NAMES[format]
    formats.export(p, format, path)
    if format == "tum":
        trajectory = file_interface.read_tum_trajectory_file(str(path))
    elif format == "euroc":
        trajectory = file_interface.read_euroc_csv_trajectory(str(tmp_path / EVO[format][1]))
    else:
        from rosbags.rosbag2 import Reader

        with Reader(path) as reader:
            trajectory = file_interface.read_bag_trajectory(reader, "/ground_truth")
    run = exported_run.upright_run(p)
    np.testing.assert_allclose(trajectory.positions_xyz, run.position, atol=1e-9)
    np.testing.assert_allclose(np.asarray(trajectory.timestamps) - trajectory.timestamps[0], run.time, atol=1e-6)
    turned = frames.to_rotation(np.asarray(trajectory.orientations_quat_wxyz))
    np.testing.assert_allclose(turned, run.rotation, atol=1e-8)


def test_evo_sees_no_error_between_the_same_run_in_two_formats(evo, tmp_path):
    p = preset.load("soft")
    formats.export(p, "tum", tmp_path / "x.tum")
    formats.export(p, "euroc", tmp_path / "x")
    made = tmp_path / "x" / "mav0" / "state_groundtruth_estimate0" / "data.csv"
    said = evo("evo_ape", "euroc", made, tmp_path / "x.tum", "--t_offset", "1")
    assert float(next(line.split()[1] for line in said.splitlines() if "rmse" in line)) < 1e-6


# --- GTSAM


@pytest.fixture(scope="module")
def gtsam():
    installed = pytest.importorskip("gtsam", reason="gtsam is not installed (the extra interop has it)")
    if not hasattr(installed, "DiscreteScenario"):
        pytest.skip("this gtsam has no DiscreteScenario: 4.3 is the first")
    return installed


@pytest.mark.parametrize("name", ["paper-slow", "soft"])
@pytest.mark.parametrize("attitude", ["flown", "preset"])
def test_gtsam_flies_the_reference_file_and_feels_the_specific_force_with_gravity_down(gtsam, name, attitude, tmp_path):
    p = upright(preset.load(name))
    formats.export(preset.load(name), "reference", tmp_path / "x.csv", attitude=attitude)
    scenario = gtsam.DiscreteScenario.FromCSV(str(tmp_path / "x.csv"))
    params = gtsam.PreintegrationParams.MakeSharedU(9.81)  # z up: gravity (0, 0, −9.81)
    runner = gtsam.ScenarioRunner(scenario, params, 0.01, gtsam.imuBias.ConstantBias())
    t = np.arange(25, 1950, 61) / 100  # on the file's own stamps: GTSAM interpolates between them
    if attitude == "flown":
        course = hover_ramps.with_ramps(p.path, p.duration, window=p.requirement.window)
        body = hover_ramps.attitude(course, p.angular_velocity, p.world.gravity, t)
    else:
        course = p.path
        truth = record.simulated(record.truth_inputs(p)).motion
        k = np.rint(t * p.sensors.imu_rate).astype(int)
        body = hover_ramps.Attitude(
            rotation=truth.rotation[k],
            angular_velocity=truth.angular_velocity[k],
            angular_acceleration=truth.angular_acceleration[k],
        )
    felt = motion.apparent(body.rotation, course(t, 2), gravity=np.array([0.0, 0.0, -9.81]))
    assert felt[:, 2].mean() > 0 or attitude == "preset"
    poses = [scenario.pose(s) for s in t]
    np.testing.assert_allclose([pose.translation() for pose in poses], course(t), atol=1e-9)
    np.testing.assert_allclose([pose.rotation().matrix() for pose in poses], body.rotation, atol=1e-9)
    np.testing.assert_allclose([scenario.velocity_n(s) for s in t], course(t, 1), atol=1e-9)
    np.testing.assert_allclose([scenario.omega_b(s) for s in t], body.angular_velocity, atol=1e-9)
    np.testing.assert_allclose([np.ravel(runner.actualSpecificForce(s)) for s in t], felt, atol=1e-9)


def test_gtsam_integrating_the_imu_of_a_reference_file_arrives_where_the_file_does(gtsam, tmp_path):
    """Its own preintegration from its own accelerometer: a wrong sign of g would miss by g t² = 157 m."""
    formats.export(preset.load("soft"), "reference", tmp_path / "x.csv")
    scenario = gtsam.DiscreteScenario.FromCSV(str(tmp_path / "x.csv"))
    still, params = gtsam.imuBias.ConstantBias(), gtsam.PreintegrationParams.MakeSharedU(9.81)
    runner = gtsam.ScenarioRunner(scenario, params, 0.001, still)
    arrived = runner.predict(runner.integrate(4.0, still, False), still)
    np.testing.assert_allclose(arrived.position(), scenario.pose(4.0).translation(), atol=0.02)  # of 1 ms steps


# --- Crazyflie


def test_what_cflib_sends_a_crazyflie_is_the_path_to_the_precision_of_its_floats(tmp_path):
    memory = pytest.importorskip("cflib.crazyflie.mem.trajectory_memory", reason="cflib is not installed")
    p = preset.load("soft")
    written = formats.export(p, "polynomial", tmp_path / "x.csv")
    rows = np.loadtxt(tmp_path / "x.csv", delimiter=",", skiprows=1)  # as Crazyswarm's own uploader reads it
    Poly = memory.Poly4D.Poly
    sent = [memory.Poly4D(row[0], *(Poly(list(row[k : k + 8])) for k in (1, 9, 17, 25))).pack() for row in rows]
    assert sum(map(len, sent)) <= 4096  # the memory of a Crazyflie
    pieces = []
    for data in sent:
        numbers = struct.unpack("<33f", data)
        x, y, z, yaw = (eight(numbers[k : k + 8]) for k in (0, 8, 16, 24))
        pieces.append(polynomials.Piece(duration=numbers[32], x=x, y=y, z=z, yaw=yaw))
    flown = polynomials.Polynomials(pieces=tuple(pieces))
    begin, end = present(written.steady)
    course = hover_ramps.around_loop(upright(p).path, present(p.path.period))
    assert course.steady == pytest.approx((begin, end))
    t = np.linspace(0, course.end, 500)
    assert np.linalg.norm(flown(t) - course(t), axis=-1).max() < 3e-4
    loop = polynomials.loop(flown, written.figures["loop_first"], written.figures["loop_pieces"])
    mu = excitation.eigenvalues(loop, np.linspace(0, end - begin, 101), p.requirement.window)[:, 0]
    np.testing.assert_allclose(mu.min(), written.figures["mu"], rtol=2e-3)


class FakeCrazyflie:
    """As much of a Crazyflie as the program talks to: its trajectory memory, its commander, and the clock."""

    def __init__(self) -> None:
        self.clock, self.defined, self.started, self.trajectory = 0.0, {}, [], []
        self.relative: set[bool] = set()
        self.heights: list[float] = []
        self.mem = self.high_level_commander = self

    def get_mems(self, kind: int):
        assert kind == 18  # cflib's number of the trajectory memory
        return [self]

    def write_data_sync(self) -> bool:
        return True

    def define_trajectory(self, name: int, offset: int, count: int) -> None:
        self.defined[name] = (offset, count)

    def start_trajectory(self, name: int, time_scale: float, relative: bool) -> None:
        assert time_scale == 1.0
        self.relative.add(relative)
        self.started.append((self.clock, name))

    def takeoff(self, height: float, seconds: float) -> None:
        self.heights.append(height)

    land = takeoff

    def stop(self) -> None:
        assert self.heights[-1] == 0.0

    def monotonic(self) -> float:
        return self.clock

    def sleep(self, seconds: float) -> None:
        self.clock += seconds


def run_program(text: str, drone: FakeCrazyflie) -> dict[str, Any]:
    """What a program defines, with the clock of a drone."""
    program: dict[str, Any] = {}
    exec(compile(text, "fly.py", "exec"), program)
    program["time"] = drone
    return program


def test_the_program_of_a_loop_flies_the_path_through_its_ramps_and_three_loops(tmp_path):
    """What a Crazyflie holds after cflib's upload, played from each start command on as its firmware does."""
    pytest.importorskip("cflib.crazyflie.mem", reason="cflib is not installed")
    p = preset.load("eight-repaired")
    written = formats.export(p, "polynomial", tmp_path / "x.csv")
    (begin, end), figures, drone = present(written.steady), written.figures, FakeCrazyflie()
    loop = crazyflie.Loop(
        ramp=begin,
        period=end - begin,
        first=figures["loop_first"],
        count=figures["loop_pieces"],
        window=p.requirement.window,
    )
    program = run_program(crazyflie.script(str(tmp_path / "x.csv"), loop, present(written.place)), drone)
    program["upload"](drone)
    program["fly"](drone, 3, relative=False)
    assert drone.relative == {False}
    held = b"".join(bytes(piece.pack()) for piece in drone.trajectory)
    course = hover_ramps.HoverRamps(path=upright(p).path, duration=begin + 3 * (end - begin), ramp=begin)
    at = 0.0
    for moment, name in drone.started:
        assert moment == pytest.approx(at, abs=1e-6)
        offset, count = drone.defined[name]
        for k in range(count):
            numbers = struct.unpack("<33f", held[offset + 132 * k : offset + 132 * (k + 1)])
            local = np.linspace(0, numbers[32], 9)
            place = [np.polynomial.polynomial.polyval(local, numbers[first : first + 8]) for first in (0, 8, 16)]
            np.testing.assert_allclose(np.transpose(place), course(at + local), atol=3e-4)
            at += numbers[32]
    assert at == pytest.approx(course.end, abs=1e-5)  # and nothing of the path is left


def test_a_path_near_the_floor_is_flown_only_from_a_hover_above_it_and_its_anchor_is_named(tmp_path):
    pytest.importorskip("cflib.crazyflie.mem", reason="cflib is not installed")
    p = preset.load("soft")  # heights from -0.3 to 0.3 m, and the anchor 1.5 m below
    written = formats.export(p, "polynomial", tmp_path / "x.csv")
    place, figures, drone = present(written.place), written.figures, FakeCrazyflie()
    heights = upright(p).path(np.linspace(0, present(p.path.period), 4001))[:, 2]
    assert (place.lowest, place.highest) == pytest.approx((heights.min(), heights.max()), abs=1e-5)
    assert place.anchor == upright(p).world.anchor
    assert "the anchor must stand at (0, 0, -1.5) m" in " ".join(written.notes)
    assert place.room == pytest.approx(np.ptp(upright(p).path(np.linspace(0, 8, 4001)), axis=0), abs=1e-5)
    loop = crazyflie.Loop(
        ramp=2.0, period=8.0, first=figures["loop_first"], count=figures["loop_pieces"], window=p.requirement.window
    )
    program = run_program(crazyflie.script(str(tmp_path / "x.csv"), loop, place), drone)
    with pytest.raises(ValueError, match="hover higher up and fly it with relative=True"):
        program["fly"](drone, 2, relative=False)
    with pytest.raises(ValueError, match="1 loops are shorter than the certified window: fly at least 2"):
        program["fly"](drone, 1, relative=True)
    assert drone.started == []
    assert program["ANCHOR"] == pytest.approx(place.anchor)
    program["flight"](drone, 2, True, program["HOVER"])
    assert program["HOVER"] == pytest.approx(place.first[2] - place.anchor[2])  # the anchor stands on the floor
    assert drone.heights == [program["HOVER"], 0.0]
    assert drone.relative == {True}
    assert [name for _, name in drone.started] == [1, 2, 2, 3]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["radio://0", "--loops", "1"], "fly at least as many"),
        (["radio://0", "--absolute"], "comes down to z = -0.3 m"),
        (["radio://0", "--height", "0.2"], "hover higher"),
        ([], "uri"),
    ],
)
def test_the_program_of_a_loop_is_a_command_that_refuses_a_flight_into_the_floor(tmp_path, capsys, arguments, sentence):
    pytest.importorskip("cflib.crazyflie.mem", reason="cflib is not installed")
    loop = crazyflie.Loop(ramp=2.0, period=8.0, first=4, count=8, window=12.0)
    place = hover_ramps.Place(
        first=(0.0, 0.0, 0.0), last=(1.0, 0.0, 0.1), lowest=-0.3, highest=0.3, room=(2.0, 1.0, 0.6), anchor=(0, 0, -1.5)
    )
    drone = FakeCrazyflie()
    program = run_program(crazyflie.script("x.csv", loop, place), drone)
    with pytest.raises(SystemExit):
        program["main"](arguments)
    assert sentence in capsys.readouterr().err
    assert drone.heights == []


# --- ROS


def test_every_message_of_an_mcap_file_is_decoded_by_its_own_schema(tmp_path):
    pytest.importorskip("mcap", reason="mcap is not installed (the extra interop has it)")
    reader = pytest.importorskip("mcap_ros2.reader", reason="mcap-ros2-support is not installed")
    p = preset.load("soft")
    formats.export(p, "mcap", tmp_path / "x.mcap")
    by_topic: dict[str, list] = {}
    for message in reader.read_ros2_messages(str(tmp_path / "x.mcap")):
        by_topic.setdefault(message.channel.topic, []).append(message.ros_msg)
    run = exported_run.upright_run(p)
    imu = by_topic["/imu/data"]
    assert len(imu) == len(run.time)
    force = np.array([[m.linear_acceleration.x, m.linear_acceleration.y, m.linear_acceleration.z] for m in imu])
    np.testing.assert_array_equal(force, run.accel)
    turning = np.array([[m.angular_velocity.x, m.angular_velocity.y, m.angular_velocity.z] for m in imu])
    np.testing.assert_array_equal(turning, run.gyro)
    assert {m.orientation_covariance[0] for m in imu} == {-1.0}
    stamps = [m.header.stamp.sec + 1e-9 * m.header.stamp.nanosec for m in imu]
    np.testing.assert_allclose(stamps, run.time + 1.0, atol=1e-9)
    field = np.array([[m.magnetic_field.x, m.magnetic_field.y, m.magnetic_field.z] for m in by_topic["/imu/mag"]])
    np.testing.assert_allclose(field, 50e-6 * run.mag, rtol=1e-12)
    np.testing.assert_array_equal([m.range for m in by_topic["/range"]], run.range.astype(np.float32))
    assert len(by_topic["/ground_truth"]) == len(run.time)


def test_rosbags_own_reader_finds_every_message_of_a_bag_in_order(tmp_path):
    rosbag2 = pytest.importorskip("rosbags.rosbag2", reason="rosbags is not installed (the extra ros has it)")
    written = formats.export(preset.load("soft"), "bag", tmp_path / "bag")
    with rosbag2.Reader(tmp_path / "bag") as reader:
        stamps = [stamp for _, stamp, _ in reader.messages()]
        assert set(reader.topics) == {"/imu/data", "/imu/mag", "/range", "/ground_truth"}
    assert len(stamps) == written.figures["messages"]
    assert stamps == sorted(stamps)
    assert stamps[0] == 1_000_000_000


# --- MATLAB


def test_scipy_finds_the_struct_with_its_conventions_said(tmp_path):
    p = preset.load("soft")
    formats.export(p, "mat", tmp_path / "x.mat")
    arrays = scipy.io.loadmat(tmp_path / "x.mat", simplify_cells=True)["rangenav"]
    truth, z = record.run(p).truth.motion, record.run(p).measurements
    for name in ("position", "snap", "rotation"):
        np.testing.assert_array_equal(arrays[name], getattr(truth, name))
    np.testing.assert_array_equal(arrays["gyro"], z.gyro)
    np.testing.assert_array_equal(arrays["range"], z.range)
    np.testing.assert_allclose(frames.to_rotation(arrays["quaternion_wxyz"]), truth.rotation, atol=1e-12)
    assert arrays["meta"]["frame"] == "z-down"
    assert preset.loads(arrays["meta"]["preset"], source="x") == p
