"""Real files that nobody here wrote: the right verdict, or the right complaint."""

import numpy as np
import pytest
import scipy.io

from rangenav import analysis, formats
from rangenav.formats import mat5
from rangenav.formats.path_preset import as_preset
from rangenav.observability import excitation
from tests.support.present import present
from tests.support.real_files import shared

pytestmark = pytest.mark.slow


def judged(name, format, **confirm):
    imported = formats.settled(formats.read(shared(name), format, confirm=confirm))
    made = as_preset(imported)
    return imported, made, analysis.analyse(made)


def test_crazyswarms_figure_eight_is_planar_and_excites_nothing_across():
    imported, made, seen = judged("polynomial/cs2_figure8.csv", "polynomial")
    assert (imported.rows, imported.duration) == (10, pytest.approx(7.283185))
    assert (seen.mu, seen.rank, seen.verdict.word) == (0.0, 11, "blind")
    assert made.world.gravity == (0.0, 0.0, -9.81)
    assert not any("jump" in sentence for sentence in imported.findings)


def test_the_jump_of_29_cm_in_crazyswarms_multi_trajectory_is_named():
    imported, _, _ = judged("polynomial/cs2_multi_traj0.csv", "polynomial")
    assert "position jumps by 0.29 m along x at t = 0.96 s" in imported.findings
    assert "32 pieces are more than the 31 a Crazyflie holds" in imported.findings
    assert str(imported.unjudged).startswith("position jumps by 0.35 m at t = 0.9605 s")


def test_a_very_gentle_choreography_is_too_gentle_to_see():
    _, _, seen = judged("polynomial/cs1_seq1_19.csv", "polynomial")
    assert (seen.verdict.word, seen.mu < 1e-6) == ("blind", True)


def test_a_race_with_exact_snap_is_judged_and_agrees_with_its_own_snap_columns():
    path = shared("racing/togt_traj.csv")
    imported, made, seen = judged("racing/togt_traj.csv", "reference")
    assert imported.unjudged is None
    assert present(imported.fit_error) < 2e-3
    assert seen.rank == 13
    table = np.genfromtxt(path, delimiter=",", names=True)
    snap = np.column_stack([table[f"snap_{a}"] for a in "xyz"])
    window = made.requirement.window
    inside = table["t"] <= window
    outer = snap[inside, :, None] * snap[inside, None, :]
    h = np.diff(table["t"][inside])[:, None, None]
    own = np.linalg.eigvalsh(np.sum(h * (outer[1:] + outer[:-1]) / 2, axis=0))
    got = excitation.eigenvalues(made.path, np.array([0.0]), window)[0]
    np.testing.assert_allclose(got, own, rtol=0.05)


def test_a_refined_race_is_read_by_the_names_of_its_columns_and_its_zero_snap_is_not_believed():
    imported, made, _ = judged("racing/togt_refined_traj.csv", "reference")
    for word in ("acceleration", "jerk", "snap"):
        assert f"the {word} columns are all zero: taken as missing" in imported.findings
    assert imported.unjudged is not None
    np.testing.assert_allclose(made.path(np.zeros(1))[0], [-5.0, 4.5, 1.2], atol=present(imported.fit_error))
    assert 8 < np.linalg.norm(made.path(np.linspace(0, 7, 500), 1), axis=-1).max() < 25  # to 19 m/s; not the quaternion


def test_poses_of_a_hand_held_camera_ask_for_their_frame_and_are_not_judged():
    imported = formats.read(shared("tum/freiburg1_xyz-groundtruth.txt"), "tum")
    assert [question.key for question in imported.questions] == ["frame"]
    assert (imported.rows, imported.rate) == (3000, pytest.approx(100, rel=1e-3))
    assert any(sentence.startswith("1 gap, the longest 0.11 s") for sentence in imported.findings)
    assert "leave some 2e+05 m/s⁴ of rounding in the snap" in str(imported.unjudged)


def test_units_that_the_header_states_and_the_data_confirm_are_taken_and_said_with_the_evidence():
    path = shared("imu/fusion_sensor_data.csv")
    imported = formats.read(path, "log")
    assert imported.flight is None
    assert {question.key: question.suggestion for question in imported.questions} == {"frame": "z-up"}
    with pytest.raises(ValueError, match=r"fusion_sensor_data\.csv: not used before this is answered: .*--frame z-up"):
        formats.settled(imported)
    for unit in ("the gyro: deg/s", "the accelerometer: g", "the magnetometer: uT"):
        assert any(one.startswith(f"{unit}, as the file states; ") for one in imported.findings), imported.findings
    flight = present(formats.settled(formats.read(path, "log", confirm={"frame": "z-up"})).flight)
    assert np.median(np.linalg.norm(flight.accel, axis=-1)) == pytest.approx(9.81, rel=0.02)
    assert np.abs(flight.gyro).max() == pytest.approx(365.3081 * np.pi / 180)


def test_broad_is_read_as_scipy_reads_it_and_its_microtesla_are_taken():
    path = shared("imu/broad_21_undisturbed_fast_combined.mat")
    own, theirs = mat5.arrays(path.read_bytes(), source="x"), scipy.io.loadmat(path)
    for name in ("imu_gyr", "imu_acc", "imu_mag", "opt_quat", "opt_pos", "movement"):
        np.testing.assert_array_equal(own[name], theirs[name].astype(float))
    imported = formats.read(path, "mat")
    flight = present(formats.settled(imported).flight)
    assert any(one.startswith("the magnetometer: uT, as the file states") for one in imported.findings)
    np.testing.assert_array_equal(flight.gyro, theirs["imu_gyr"])
    assert int(np.isnan(present(flight.position)).any(axis=1).sum()) == 219
    assert present(flight.moving).sum() == theirs["movement"].sum()


@pytest.mark.parametrize(
    ("name", "wrong", "said"),
    [
        ("polynomial/cs2_figure8.csv", "reference", "no column named t"),
        ("racing/togt_traj.csv", "polynomial", "a polynomial file has the columns"),
        (
            "tum/freiburg1_xyz-groundtruth.txt",
            "log",
            "no column for gyro x, y, z; the file.s columns are timestamp, tx, ty",
        ),
        ("imu/fusion_sensor_data.csv", "tum", "line 1"),
        ("imu/broad_21_undisturbed_fast_combined.mat", "log", "not UTF-8 text"),
        ("racing/togt_traj.csv", "mat", "not a MATLAB v5 file"),
        ("racing/togt_traj.csv", "log", "column"),
    ],
)
def test_a_file_taken_for_another_format_is_refused_in_one_sentence(name, wrong, said):
    with pytest.raises(ValueError, match=said) as caught:
        formats.settled(formats.read(shared(name), wrong))
    assert "\n" not in str(caught.value)


GOOD = "log_quoted.csv"


@pytest.mark.parametrize(
    ("name", "remark"),
    [
        ("log_quoted.csv", "entries stand in quotes"),
        ("log_semicolon_decimal_comma.csv", "the numbers have decimal commas"),
        ("log_tab.csv", "the entries are separated by tabs"),
        ("log_index_column.csv", "column 1 has no name and is not used"),
        ("public/hash_blank_header.csv", "the names of the columns are in the comment on line 2"),
    ],
)
def test_the_dialects_of_spreadsheets_are_one_flight_and_said(name, remark):
    confirm = {"frame": "z-up", "time": "us", "gyro": "rad/s", "accel": "m/s2"} if "public" in name else {}
    imported = formats.settled(formats.read(shared(f"failing/{name}"), "log", confirm=confirm))
    assert remark in imported.findings
    if not confirm:
        same = present(formats.settled(formats.read(shared(f"failing/{GOOD}"), "log")).flight)
        np.testing.assert_array_equal(present(imported.flight).accel, same.accel)


@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("path_in_motion_at_both_ends.tum", set()),
        ("path_stamps_in_ms.tum", {"time"}),
        ("path_gap_of_1.5s.tum", {"gaps"}),
        ("public/tum_ns_stamps.tum", {"time"}),
        ("public/tum_starts_in_motion.tum", set()),
    ],
)
def test_poses_in_motion_are_followed_to_a_fraction_of_a_millimetre_after_their_questions(name, keys):
    confirm = {"frame": "z-up"}
    asked = formats.read(shared(f"failing/{name}"), "tum", confirm=confirm).questions
    assert {question.key for question in asked} == keys
    answers = confirm | {question.key: present(question.suggestion) for question in asked}
    imported = formats.settled(formats.read(shared(f"failing/{name}"), "tum", confirm=answers))
    assert present(imported.fit_error) < 5e-4
    t = np.linspace(0, imported.duration, 2001)
    path = present(imported.path)
    assert np.linalg.norm(path(t, 1), axis=-1).max() < 3.0
    assert np.linalg.norm(path(t, 2), axis=-1).max() < 4.0


def test_jumps_of_the_acceleration_are_named_and_why_mu_is_0():
    imported = formats.read(shared("failing/path_acceleration_jumps.csv"), "polynomial")
    assert "acceleration jumps at 11 knots, at most by 15 m/s² at t = 2 s" in imported.findings
    assert any("so μ is 0" in sentence for sentence in imported.findings)
    assert str(imported.unjudged).startswith("acceleration jumps by 15 m/s² at t = 2 s, which nothing can follow")


def test_577_steps_are_fitted_as_well_as_600():
    errors = [
        present(formats.read(shared(f"failing/path_reference_{rows}_rows.csv"), "reference").fit_error)
        for rows in (578, 601)
    ]
    assert max(errors) < 1e-6
