"""Files as they come: what is understood, what is asked before it is assumed, what is refused with line and column."""

import math
import struct
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.io import savemat

from rangenav import formats, preset
from rangenav.formats import euroc, mat5, text, units
from rangenav.formats.path_preset import as_preset
from rangenav.observability import excitation
from rangenav.signals import Multisine, Polynomials, Tone
from rangenav.signals.multisine import LETTERS
from tests.support.present import present
from tests.support.refusals import exactly

pytestmark = pytest.mark.slow


RATE = 100.0
MANGLED = "spreadsheets mangle stamps into times of day"
TURN = np.array([0.4, -0.7, 0.9])


def spun(count=400, *, gyro=1.0, accel=1.0, mag=1.0):
    """A body turning steadily in place: t, gyro, accel, mag; factors from SI to the units wanted."""
    from scipy.spatial.transform import Rotation

    t = np.arange(count) / RATE
    turned = Rotation.from_rotvec(t[:, None] * TURN).as_matrix().transpose(0, 2, 1)
    felt, field = turned @ np.array([0.0, 0.0, 9.81]), turned @ np.array([0.4, 0.0, -0.9165])
    return t, np.tile(TURN, (count, 1)) * gyro, felt * accel, field * mag


def csv(names, *columns):
    table = np.column_stack(columns)
    rows = [",".join("" if math.isnan(v) else repr(v) for v in row) for row in table.tolist()]
    return "\n".join([",".join(names), *rows, ""]).encode()


def axes(*names):
    return [name.replace("*", axis) for name in names for axis in "xyz"]


PLAIN = ["t", *axes("gyro_*", "accel_*", "mag_*")]
STATED = ["t [s]", *axes("gyro_* [rad/s]", "accel_* [m/s2]", "mag_* [1]")]


def read(data, format="log", **confirm):
    return formats.parse(data, format, source="x.csv", confirm=confirm)


def asked(imported):
    return {question.key: question.suggestion for question in imported.questions}


def test_what_is_stated_in_si_is_not_asked_and_not_changed():
    columns = spun()
    imported = formats.settled(read(csv(STATED, *columns), frame="z-up"))
    flight = present(imported.flight)
    np.testing.assert_array_equal(flight.gyro, columns[1])
    np.testing.assert_array_equal(flight.accel, columns[2])
    np.testing.assert_allclose(present(flight.mag), columns[3] / np.median(np.linalg.norm(columns[3], axis=-1)))
    assert imported.rate == pytest.approx(RATE)
    assert imported.duration == pytest.approx(3.99)


@pytest.mark.parametrize(
    ("gyro", "accel", "mag"),
    [("rad/s", "m/s2", "1"), ("deg/s", "g", "uT"), ("deg/s", "m/s2", "G"), ("rad/s", "mg", "nT")],
)
def test_units_that_nobody_states_are_asked_with_the_right_suggestion(gyro, accel, mag):
    """The witness is the motion itself: a field fixed in inertia turns as fast as a gyro in the right unit says."""
    field = {"1": 1.0, "uT": 48.0, "G": 0.48, "nT": 48_000.0}[mag]
    columns = spun(gyro=1 / units.UNITS["gyro"][gyro], accel=1 / units.UNITS["accel"][accel], mag=field)
    data = csv(PLAIN, *columns)
    imported = read(data)
    assert asked(imported) == {"time": "s", "gyro": gyro, "accel": accel, "mag": mag, "frame": "z-up"}
    assert imported.flight is None
    with pytest.raises(ValueError, match=rf"not used before this is answered: .*--gyro-unit {gyro}"):
        formats.settled(imported)
    answered = present(read(data, time="s", gyro=gyro, accel=accel, mag=mag, frame="z-up").flight)
    np.testing.assert_allclose(answered.gyro[0], TURN, rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(answered.accel, axis=-1), 9.81, rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(present(answered.mag), axis=-1), 1.0, rtol=1e-12)


def test_a_header_that_says_si_is_doubted_where_gravity_and_the_field_say_otherwise():
    t, gyro, accel, mag = spun(gyro=180 / math.pi, accel=1 / 9.80665)
    imported = read(csv(STATED, t, gyro, accel, mag), frame="z-up")
    assert asked(imported) == {"gyro": "deg/s", "accel": "g"}


def test_the_callers_word_stands_against_what_the_numbers_suggest():
    t, gyro, accel, mag = spun()
    imported = formats.settled(read(csv(STATED, t, gyro / 1000, accel, mag), frame="z-up", gyro="rad/s"))
    np.testing.assert_array_equal(present(imported.flight).gyro, gyro / 1000)
    with pytest.raises(ValueError, match=r"gyro must be one of rad/s, deg/s, got 'rpm'"):
        read(csv(STATED, t, gyro, accel, mag), gyro="rpm")


def test_other_loggers_names_are_understood():
    t, gyro, accel, mag = spun()
    for names in (
        ["Time (s)", *axes("Gyroscope * (rad/s)", "Accelerometer * (m/s²)", "Magnetometer * (T)")],
        ["#timestamp [ns]", *axes("w_RS_S_* [rad s^-1]", "a_RS_S_* [m s^-2]", "m_*")],
        ["timestamp", *axes("g*", "a*", "m*")],
        ["t_s", *axes("gyr_*_rads", "acc_*_ms2", "mag_*_ut")],
    ):
        stamps = np.rint(t * 1e9) if "ns" in names[0] else t
        imported = read(csv(names, stamps, gyro, accel, mag), time="ns" if "ns" in names[0] else "s", gyro="rad/s",
                     accel="m/s2", mag="1", frame="z-up")  # fmt: skip
        np.testing.assert_allclose(present(formats.settled(imported).flight).time, t, atol=1e-9)
        np.testing.assert_array_equal(present(imported.flight).gyro, gyro)


def test_two_columns_for_one_thing_and_columns_that_are_missing_are_refused():
    t, gyro, accel, _ = spun(20)
    twice = csv(["t", *axes("gyro_*", "accel_*"), "Gyro X"], t, gyro, accel, t)
    with pytest.raises(ValueError, match=exactly("x.csv: two columns could be gyro x: 'Gyro X' is the second")):
        read(twice)
    with pytest.raises(ValueError, match=r"x\.csv: no column for accel z; the file's columns are t, gyro_x"):
        read(csv(["t", *axes("gyro_*"), "accel_x", "accel_y"], t, gyro, accel[:, :2]))


def test_where_two_groups_of_columns_would_do_a_person_chooses_and_all_others_are_named():
    """A phone writes Acceleration and Linear Acceleration, which is without gravity; a logger has two clocks."""
    t, gyro, accel, _ = spun(200)
    names = ["t [s]", "time [s]", *axes("gyro_* [rad/s]", "Acceleration * (m/s^2)", "Linear Acceleration * (m/s^2)")]
    others = [f"battery {k}" for k in range(15)]
    data = csv([*names, "gx", *others], t, t + 1e4, gyro, accel, 0.01 * accel, *np.tile(t, (16, 1)))
    imported = read(data, frame="z-up")
    assert asked(imported) == {"time-columns": None, "accel-columns": None}
    (clock, force) = imported.questions
    assert force.options == ("accel=acceleration", "accel=linear_acceleration")
    assert "acceleration: median length 9.81; linear_acceleration: median length 0.0981" in force.text
    assert clock.flag == force.flag == "--columns"
    chosen = {"time-columns": "time=time", "accel-columns": "accel=linear_acceleration"}
    flight = present(formats.settled(read(data, frame="z-up", accel="m/s2", **chosen)).flight)
    np.testing.assert_allclose(flight.accel, 0.01 * accel)
    assert [name for name, use in imported.columns if not use] == [
        "time [s]", *axes("Linear Acceleration * (m/s^2)"), "gx", *others
    ]  # fmt: skip
    assert any("battery 4 … (20 in all)" in one for one in imported.findings), imported.findings
    with pytest.raises(
        ValueError, match=r"accel=gravity: no columns of that name with x, y, z; the file's columns are"
    ):
        read(data, **{"accel-columns": "accel=gravity"})


NAMELESS = ["stamp of the sensor", "roll rate (deg/s)", "pitch rate (deg/s)", "yaw rate (deg/s)", *axes("body.force.*")]
"""Columns whose names tell no quantity."""


@pytest.mark.parametrize(
    ("gyro", "accel"),
    [
        ("roll rate (deg/s),pitch rate (deg/s),yaw rate (deg/s)", "body.force"),
        ("roll rate,PITCH RATE,yaw_rate", "body_force"),
        ("roll rate,pitch rate,yaw rate", "body.force.x,body.force.y,body.force.z"),
    ],
)
def test_a_person_may_name_any_column_or_what_stands_before_the_axes(gyro, accel):
    t, turning, force, _ = spun(60)
    data = csv([*NAMELESS, "UWB to post 7 (cm)"], t, np.degrees(turning), force, 100 + t)
    chosen = {"time-columns": "time=stamp of the sensor", "gyro-columns": f"gyro={gyro}"}
    chosen |= {"accel-columns": f"accel={accel}", "range-columns": "range=UWB to post 7"}
    imported = read(data, frame="z-up", time="s", accel="m/s2", gyro="deg/s", range="cm", **chosen)
    flight = present(formats.settled(imported).flight)
    np.testing.assert_allclose(flight.gyro, turning)
    np.testing.assert_allclose(flight.accel, force)
    np.testing.assert_allclose(flight.range, 1 + t / 100)
    assert (
        "columns of the gyro: roll rate (deg/s), pitch rate (deg/s), yaw rate (deg/s), as confirmed"
        in imported.findings
    )
    assert not any("not understood" in one for one in imported.findings)


def test_columns_that_no_name_tells_are_asked_for_with_what_the_table_offers():
    """Nothing is asked where the table has too few columns for a flight; what may be absent is asked without a need."""
    t, turning, force, _ = spun(60)
    imported = read(csv([NAMELESS[0], *NAMELESS[1:4], *axes("acc_*")], t, turning, force))
    assert imported.flight is None
    clock, gyro = imported.questions
    assert clock.options[0] == "time=stamp of the sensor"
    assert gyro.options[-1] == "gyro=roll rate (deg/s),pitch rate (deg/s),yaw rate (deg/s)"
    assert "the file's columns are stamp of the sensor, roll rate (deg/s)" in clock.evidence
    whole = read(csv([*STATED[:7], "to post 7"], t, turning, force, t), frame="z-up")
    assert [(one.key, one.suggestion) for one in whole.applied] == [("range-columns", "range=none")]
    assert len(present(whole.flight).range) == 0
    taken = read(
        csv([*STATED[:7], "to post 7"], t, turning, force, t),
        frame="z-up",
        **{"range-columns": whole.applied[0].options[1]},
    )
    assert asked(taken) == {"range": None}


def test_ranges_to_two_anchors_are_asked_about_and_the_other_ones_are_not_used():
    t, turning, force, _ = spun(60)
    data = csv([*STATED[:7], "range_1 [m]", "range_2 [m]"], t, turning, force, 1 + t, 2 + t)
    assert [question.options for question in read(data, frame="z-up").questions] == [("range=range_1", "range=range_2")]
    second = read(data, frame="z-up", **{"range-columns": "range=range_2"})
    np.testing.assert_allclose(present(second.flight).range, 2 + t)
    assert dict(second.columns)["range_1 [m]"] == ""


def test_stamps_of_iso_8601_are_seconds_from_the_first_in_utc():
    t, turning, force, _ = spun(60)
    rows = csv(["when", *STATED[1:7]], t, turning, force).decode().splitlines()
    for zone, shown in (("", "08:00:00 UTC, as they name no zone"), ("Z", "08:00:00 UTC"), ("+02:00", "06:00:00 UTC")):
        dates = [f"2024-05-01T08:00:{k // 100:02d}.{10 * (k % 100):03d}{zone}" for k in range(60)]
        dated = [",".join([date, *row.split(",")[1:]]) for date, row in zip(dates, rows[1:], strict=True)]
        data = "\n".join([rows[0].replace("when", "timestamp"), *dated]).encode()
        imported = read(data, frame="z-up")
        np.testing.assert_allclose(present(formats.settled(imported).flight).time, np.arange(60) / 100, atol=1e-9)
        assert f"column timestamp holds dates: read as seconds from 2024-05-01 {shown}" in imported.findings


@pytest.mark.parametrize(("period", "unit", "factor"), [(2.0**32, "us", 1e6), (604_800.0, "s", 1.0)])
def test_a_clock_that_begins_again_goes_on_once_that_is_confirmed(period, unit, factor):
    t, gyro, accel, mag = spun(200)
    stamps = (t - 1.0) * factor
    stamps[:100] += period
    data = csv([f"t [{unit}]", *STATED[1:]], stamps, gyro, accel, mag)
    confirm = {"frame": "z-up", "time": unit}
    imported = read(data, **confirm)
    assert asked(imported) == {"stamps": "unwrap"}
    assert "goes back once by its period" in imported.questions[0].evidence
    assert "before line 102" in imported.questions[0].evidence
    flight = present(formats.settled(read(data, stamps="unwrap", **confirm)).flight)
    np.testing.assert_allclose(flight.time, t, atol=1e-6)


def test_rows_of_one_sensor_are_no_broken_lines_even_where_broken_lines_are_dropped():
    """A range, a field or a pose may have a row of its own, also with the very stamp of a row of the IMU."""
    t, gyro, accel, mag = spun(60)
    imu = np.column_stack([t, gyro, accel, np.full((60, 7), np.nan)])
    field = np.column_stack([t, np.full((60, 6), np.nan), mag, np.full((60, 4), np.nan)])
    ranges = np.column_stack([t[::2], np.full((30, 9), np.nan), 2.0 + t[::2], np.full((30, 3), np.nan)])
    pose = np.column_stack([t + 0.001, np.full((60, 10), np.nan), np.column_stack([t, t, t])])
    table = np.vstack([imu, field, ranges, pose])
    data = csv([*STATED, "range [m]", *axes("p_* [m]")], table[np.argsort(table[:, 0], kind="stable")])
    for confirm in ({}, {"lines": "drop"}):
        imported = formats.settled(read(data, frame="z-up", **confirm))
        flight = present(imported.flight)
        assert (len(flight.time), len(flight.range)) == (60, 30)
        np.testing.assert_allclose(present(flight.mag), mag, atol=1e-4)  # divided by its length
        np.testing.assert_allclose(present(flight.position)[:, 0], t)
        assert not any("line" in one for one in imported.findings), imported.findings


def test_a_body_upside_down_does_not_tell_the_frame_of_the_world_but_an_attitude_does():
    """A camera looks down its z axis: at rest its accelerometer reads −z in a world whose z points up."""
    t, gyro, accel, mag = spun(200)
    down = csv(STATED, t, gyro, -accel, mag)
    assert asked(read(down)) == {"frame": None}
    assert "upside down in a z-up world" in read(down).questions[0].evidence
    still = np.tile([0.0, 0.0, -9.81], (200, 1))
    turned = np.tile([0.0, 1.0, 0.0, 0.0], (200, 1))  # half a turn about x: body z down, world z up
    known = csv([*STATED, *[f"q_{axis} [1]" for axis in "wxyz"]], t, 0 * gyro, still, mag, turned)
    assert asked(read(known)) == {"frame": "z-up"}


def test_repeated_stamps_gaps_and_missing_numbers_are_told_by_line_and_dropped_only_when_asked():
    t, gyro, accel, mag = spun(60)
    t[10], t[11] = t[9], t[8]  # lines 12 and 13, the header being the first
    gyro[20, 1] = np.nan  # line 22
    data = csv(STATED, np.delete(t, slice(40, 50)), *(np.delete(v, slice(40, 50), axis=0) for v in (gyro, accel, mag)))
    imported = read(data, frame="z-up")
    assert asked(imported) == {"lines": "drop"}
    said = "numbers are missing on line 22 and stamps repeat or go back on lines 12, 13"
    assert said in imported.findings
    kept = formats.settled(read(data, frame="z-up", lines="drop"))
    assert len(present(kept.flight).time) == 47
    assert f"{said}: dropped, as asked" in kept.findings
    assert any(re.startswith("3 gaps, the longest 0.11 s") and "line" in re for re in kept.findings), kept.findings


@pytest.mark.parametrize("format", ["reference", "log"])
def test_a_last_row_that_is_written_twice_is_dropped_with_a_word_and_other_repeats_are_asked_about(format):
    """Exporters that append the end write it twice; a row within the file that repeats may be a fault of the clock."""
    columns, *_ = reference()
    data = csv(list(columns), *columns.values()) if format == "reference" else csv(STATED, *spun())
    confirm = {} if format == "reference" else {"frame": "z-up"}
    rows = data.splitlines()
    once, twice = read(data, format, **confirm), read(b"\n".join([*rows, rows[-1]]), format, **confirm)
    assert (twice.duration, asked(twice)) == (once.duration, {})
    assert f"the last row repeats the row before it: line {len(rows) + 1} is not used" in twice.findings
    back = read(b"\n".join([*rows[:100], rows[50], *rows[100:]]), format, **confirm)
    assert asked(back) == {"lines": "drop"}
    assert (
        read(b"\n".join([*rows[:100], rows[50], *rows[100:]]), format, lines="drop", **confirm).duration
        == once.duration
    )


def test_stamps_that_a_spreadsheet_has_rounded_are_beyond_mending():
    _, gyro, accel, mag = spun(60)
    mangled = [float(f"{1.3e12 + 10 * k:.6E}") for k in range(60)]
    names = ["t [ms]", *STATED[1:]]
    with pytest.raises(ValueError, match=r"x\.csv: 98% of the stamps repeat or go back: rounded, as spreadsheets do"):
        read(csv(names, mangled, gyro, accel, mag), frame="z-up", time="ms", lines="drop")


def test_a_range_may_have_a_row_of_its_own():
    t, gyro, accel, mag = spun(30)
    table = np.column_stack([t, gyro, accel, mag, np.full(30, np.nan)])
    between = np.full((1, 11), np.nan)
    between[0, 0], between[0, 10] = 0.105, 2.5
    table = np.insert(table, 11, between, axis=0)
    imported = formats.settled(read(csv([*STATED, "range [cm]"], table), frame="z-up", range="cm"))
    flight = present(imported.flight)
    assert len(flight.time) == 30
    assert flight.range_time.tolist() == [0.105]
    assert flight.range.tolist() == [0.025]


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("0.05,1,2", "3 entries where 7 columns are named"),
        ("0.05,1,2,3,4,5,six", "accel_z must be a number, got 'six'"),
        ("00:05.1,1,2,3,4,5,6", "t must be a number, got '00:05.1'; " + MANGLED),
        ("0.05,1,2,3,4,5,1_0", "accel_z must be a number, got '1_0'"),
        ("0.05,1,2,3,4,5,inf", "accel_z must not exceed 1e+20, got inf"),
        ("0.05,1,2,3,4,5,1e999", "accel_z must not exceed 1e+20, got inf"),
        (",".join(["t", *axes("gyro_*", "accel_*")]), "the header once more"),
    ],
)  # fmt: skip
def test_a_line_that_is_no_row_is_asked_about_with_its_number_and_left_out_once_that_is_confirmed(line, said):
    rows = [f"{k / 50},0,0,0,0,0,9.81" for k in range(12)]
    header = ",".join(["t", *axes("gyro_*", "accel_*")])
    data = "\n".join([header, *rows[:2], line, *rows[2:]]).encode()
    imported = read(data)
    assert [(one.key, one.flag, one.suggestion) for one in imported.questions] == [("lines", "--lines", "drop")]
    assert imported.questions[0].evidence == f"line 4: {said}"
    units = {"time": "s", "gyro": "rad/s", "accel": "m/s2", "frame": "z-up"}
    flight = present(formats.settled(read(data, lines="drop", **units)).flight)
    np.testing.assert_allclose(flight.time, np.arange(12) / 50)
    assert f"line 4: {said}: dropped, as asked" in read(data, lines="drop", **units).findings
    most = "\n".join([header, *rows[:9], *[line] * 3]).encode()
    with pytest.raises(ValueError, match=exactly(f"x.csv, line 11: {said} (3 of 12 lines are broken)")):
        read(most)


def test_a_text_of_windows_is_refused_with_the_way_out():
    data = csv(["t [s]", *axes("gyro_* [°/s]", "accel_* [m/s2]")], np.zeros((20, 7))).decode().encode("cp1252")
    said = (
        "x.csv: not UTF-8 text (byte 14); this byte is '°' in Windows-1252: save the file again with the encoding UTF-8"
    )
    with pytest.raises(ValueError, match=exactly(said)):
        read(data)


def test_a_file_too_large_is_refused_before_it_is_read(tmp_path, monkeypatch):
    huge = tmp_path / "huge.csv"
    with huge.open("wb") as file:
        file.truncate(10_000_000_000)  # sparse: it takes no room, and reading it would take minutes

    def never(*_):
        raise AssertionError("it was opened")

    monkeypatch.setattr(text.Path, "open", never)
    with pytest.raises(ValueError, match=exactly("huge.csv: 10000 MB, more than the 64 MB that are read")):
        formats.read(huge, "log")


def test_folders_devices_and_files_that_are_not_there_are_refused(tmp_path):
    for path, said in ((tmp_path, "not a file"), (tmp_path / "no.csv", "no such file"), ("/dev/zero", "not a file")):
        with pytest.raises(ValueError, match=said):
            formats.read(path, "tum")
    with pytest.raises(ValueError, match="read are reference, polynomial"):
        formats.read(tmp_path / "x", "word")


def test_long_lines_many_columns_and_text_of_other_kinds_are_refused():
    with pytest.raises(ValueError, match="line 1: longer than 8192 characters"):
        read(b"t," * 10_000)
    with pytest.raises(ValueError, match="line 1: more than 200 columns"):
        read((",".join(f"c{k}" for k in range(201)) + "\n" + "1," * 201).encode())
    with pytest.raises(ValueError, match="not UTF-8 text"):
        read(b"t,\xff\xfe")
    with pytest.raises(ValueError, match="no rows of numbers"):
        read(b"")


# --- MATLAB

NUMBERS = st.sampled_from(["f8", "f4", "i4", "u2", "u1", "i8"])


@given(seed=st.integers(0, 1000), kind=NUMBERS, compressed=st.booleans(), rows=st.integers(1, 40))
def test_arrays_are_read_as_scipy_wrote_them(seed, kind, compressed, rows):
    import io

    rng = np.random.default_rng(seed)
    arrays = {"a": (100 * rng.standard_normal((rows, 3))).astype(kind), "name_of_b": np.array([[2.5]])}
    file = io.BytesIO()
    others = {"text": "hello", "cell": np.array([1, "x"], dtype=object), "deep": {"x": 1.0}, "c": np.array([[1j]])}
    savemat(file, arrays | others, do_compression=compressed)
    arrays = mat5.arrays(file.getvalue(), source="x.mat")
    assert sorted(arrays) == sorted(arrays)
    for name, values in arrays.items():
        np.testing.assert_array_equal(arrays[name], values.astype(float))


def test_a_mat_file_that_unpacks_into_gigabytes_is_stopped(monkeypatch):
    bomb = zlib.compress(struct.pack("<II", 14, 10_000_000) + b"\x00" * 10_000_000)
    data = b" " * 124 + b"\x00\x01IM" + struct.pack("<II", 15, len(bomb)) + bomb
    monkeypatch.setattr(mat5, "MAX_UNPACKED", 1_000_000)
    with pytest.raises(ValueError, match="more than 1 MB of numbers"):
        mat5.arrays(data, source="x.mat")


def test_dimensions_that_do_not_fit_their_numbers_are_refused(tmp_path):
    savemat(tmp_path / "x.mat", {"gyro": np.zeros((4, 3))})
    data = (tmp_path / "x.mat").read_bytes()
    at = data.index(struct.pack("<ii", 4, 3))
    damaged = data[:at] + struct.pack("<ii", 2**30, 3) + data[at + 8 :]
    with pytest.raises(ValueError, match=exactly("x.mat: 'gyro' has 96 bytes for 3221225472 numbers")):
        mat5.arrays(damaged, source="x.mat")
    with pytest.raises(ValueError, match=r"v7\.3 is HDF5"):
        mat5.arrays(b"\x89HDF" + b"\x00" * 200, source="x.mat")


# --- paths


def test_a_polynomial_file_keeps_every_coefficient_whatever_the_case_of_its_header():
    rng = np.random.default_rng(4)
    rows = np.column_stack([rng.uniform(0.5, 2, 3), rng.standard_normal((3, 32))])
    names = ["Duration", *(f"{a}^{k}" for a in ("X", "y", "z", "Yaw") for k in range(8))]
    data = csv(names, rows).replace(b"\n", b",\n")  # the trailing commas that planners write
    path = read(data, "polynomial").path
    assert isinstance(path, Polynomials)
    for piece, row in zip(path.pieces, rows, strict=True):
        np.testing.assert_array_equal([piece.duration, *piece.x, *piece.y, *piece.z, *piece.yaw], row)


def test_position_that_jumps_at_a_knot_is_named_and_not_judged():
    row = [1.0] + [0.0] * 32
    second = row.copy()
    second[9] = 0.25
    names = ["duration", *(f"{a}^{k}" for a in ("x", "y", "z", "yaw") for k in range(8))]
    imported = read(csv(names, np.array([row, second])), "polynomial")
    assert "position jumps by 0.25 m along y at t = 1.00 s" in imported.findings
    assert imported.unjudged is not None


def test_a_polynomial_file_with_a_column_too_few_or_a_number_missing_is_refused():
    names = ["duration", *(f"{a}^{k}" for a in ("x", "y", "z", "yaw") for k in range(8))]
    with pytest.raises(ValueError, match="a polynomial file has the columns"):
        read(csv(names[:-1], np.ones((1, 32))), "polynomial")
    rows = np.ones((2, 33))
    rows[1, 5] = np.nan
    said = "x.csv, line 3: a coefficient or duration is missing or not a number (1 row in all)"
    with pytest.raises(ValueError, match=exactly(said)):
        read(csv(names, rows), "polynomial")


def reference(duration=8.0, rate=100.0, digits=None):
    """A smooth flight as a reference file's columns, by formula."""
    t = np.arange(int(duration * rate) + 1) / rate
    w, a = np.array([1.3, 2.1, 2.9]), np.array([2.0, 1.0, 0.5])
    columns = {"t": t}
    for order, name in enumerate(("p", "v", "a_lin", "jerk", "snap")):
        values = a * w**order * np.sin(w * t[:, None] + order * np.pi / 2)
        for k, axis in enumerate("xyz"):
            rounded = values[:, k] if digits is None else np.array([float(f"{v:.{digits}g}") for v in values[:, k]])
            columns[f"{name}_{axis}"] = rounded
    return columns, w, a


@pytest.mark.parametrize(("digits", "within"), [(None, 1e-3), (5, 0.03)])
def test_exact_derivatives_become_a_path_with_their_snap_in_any_order_of_columns(digits, within):
    """∫snap snapᵀ of the path against that of the formula: five printed digits still hold it to a few percent."""
    columns, w, a = reference(digits=digits)
    names = list(columns)
    np.random.default_rng(3).shuffle(names)
    imported = read(csv(names, *(columns[name] for name in names)), "reference")
    assert imported.unjudged is None
    assert present(imported.fit_error) < 1e-3
    own = Multisine(
        tones=tuple(Tone(axis=x, amplitude=float(a[k]), frequency=float(w[k])) for k, x in enumerate(LETTERS))
    )
    start = np.linspace(0, 2, 5)
    got, wanted = (excitation.eigenvalues(path, start, 6.0) for path in (present(imported.path), own))
    np.testing.assert_allclose(got, wanted, rtol=within)


def test_derivative_columns_of_nothing_but_zeros_are_missing_and_said():
    columns, *_ = reference()
    for name in axes("snap_*"):
        columns[name] = 0 * columns[name]
    imported = read(csv(list(columns), *columns.values()), "reference")
    assert "the snap columns are all zero: taken as missing" in imported.findings
    assert imported.derivatives == "fit"
    assert str(imported.unjudged).startswith("the file holds jerk and no snap")
    for name in axes("jerk_*", "a_lin_*"):
        columns[name] = 0 * columns[name]
    imported = read(csv(list(columns), *columns.values()), "reference")
    assert imported.unjudged is not None
    assert imported.fit_error is not None


def tum(t, position, decimals=9):
    rows = [
        " ".join([f"{s:.4f}", *(f"{v:.{decimals}f}" for v in p), "0", "0", "0", "1"])
        for s, p in zip(t, position, strict=True)
    ]
    return "\n".join(["# t x y z qx qy qz qw", *rows, ""]).encode()


def test_poses_become_a_curve_near_them_whose_snap_is_not_believed_and_whose_frame_is_asked():
    columns, *_ = reference(duration=20.0)
    position = np.column_stack([columns[name] for name in axes("p_*")])
    t = columns["t"]
    position = position * np.sin(np.pi * t / 20)[:, None] ** 4  # from rest to rest
    data = tum(1305031098 + t, position, decimals=4)
    imported = read(data, "tum")
    assert asked(imported) == {"frame": "z-up"}
    assert present(imported.fit_error) < 0.01
    assert "positions in steps of 0.0001 m every 10 ms" in present(imported.unjudged)
    for frame, z in (("z-up", -9.81), ("z-down", 9.81)):
        assert as_preset(read(data, "tum", frame=frame)).world.gravity == (0.0, 0.0, z)
    with pytest.raises(ValueError, match="which way does z point"):
        as_preset(imported)


def test_a_preset_of_a_path_plays_all_of_it_or_as_much_as_asked():
    columns, *_ = reference()
    imported = read(csv(list(columns), *columns.values()), "reference")
    p = as_preset(imported, anchor=(1.0, 2.0, 3.0))
    assert (p.duration, p.world.anchor, p.requirement.window) == (8.0, (1.0, 2.0, 3.0), 4.0)
    assert as_preset(imported, duration=5.0).duration == 5.0
    assert preset.loads(preset.dumps(p), source="x.toml") == p
    with pytest.raises(ValueError, match="holds a recorded flight and no path"):
        as_preset(formats.parse(csv(STATED, *spun()), "log", source="x.csv", confirm={"frame": "z-up"}))


def test_a_euroc_truth_in_nanoseconds_since_1970_keeps_its_microseconds():
    t = np.arange(200) * 5e-3
    stamps = 1403636579758555392 + np.rint(t * 1e9).astype(np.int64)
    p = np.column_stack([np.sin(t), t, t**2])
    header = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []"
    rows = [f"{s},{x},{y},{z},1,0,0,0" for s, (x, y, z) in zip(stamps.tolist(), p.tolist(), strict=True)]
    imported = euroc.parse_truth("\n".join([header, *rows]).encode(), source="data.csv", confirm={}, knots=0.1)
    assert imported.duration == pytest.approx(t[-1], abs=1e-6)
    assert imported.rate == pytest.approx(200, rel=1e-4)


@pytest.mark.parametrize(
    ("order", "said"),
    [
        (lambda n: np.arange(n)[::-1], "the rows run backwards in time"),
        (lambda n: np.random.default_rng(5).permutation(n), "the rows are out of order"),
        (lambda n: np.zeros(n, dtype=int), "rounded, as spreadsheets do, or no clock"),
    ],
)
def test_rows_that_run_backwards_or_are_out_of_order_are_told_from_rounded_stamps(order, said):
    rows = [f"{k / 50},0,0,0,0,0,9.81" for k in order(300)]
    data = "\n".join(
        ["t [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],accel_x [m/s2],accel_y [m/s2],accel_z [m/s2]", *rows]
    )
    with pytest.raises(ValueError, match=said):
        formats.parse(data.encode(), "log", source="x.csv", confirm={"frame": "z-up"})


@pytest.mark.parametrize(("step", "asked"), [(0.02, False), (1.0, False), (20.0, True)])
def test_a_slow_imu_in_stated_seconds_is_none_in_milliseconds(step, asked):
    """1 Hz is slow and possible; 0.05 Hz is no rate of an IMU, and in ms it is 50 Hz."""
    rows = [f"{step * k:g},0,0,0,0,0,9.81" for k in range(40)]
    data = "\n".join(
        ["t [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],accel_x [m/s2],accel_y [m/s2],accel_z [m/s2]", *rows]
    )
    imported = formats.parse(data.encode(), "log", source="x.csv", confirm={"frame": "z-up"})
    assert [(one.key, one.suggestion) for one in imported.questions] == ([("time", "ms")] if asked else [])
