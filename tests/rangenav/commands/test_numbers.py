"""A number that no option can mean is refused in one line that names the option, whatever the command."""

import pytest

from rangenav.commands import numbers

COMMANDS = (
    ("log", "x.csv", "--window"),
    ("log", "x.csv", "--anchor"),
    ("import", "x.csv", "--from", "reference", "-o", "x.toml", "--knots"),
    ("tune", "soft", "--runs"),
)


@pytest.mark.parametrize("typed", ["9" * 400, "9" * 5000, "nan", "inf", "1_0", "0x10", "ten", ""])
@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_what_is_no_number_is_named_with_its_option(complaint, command, typed):
    values = (typed, "0", "0") if command[-1] == "--anchor" else (typed,)
    line = complaint(*command, *values)
    assert command[-1] in line
    rules = ("must be a finite number, got '", "must be a whole number of at most 18 digits, got '")
    assert any(rule in line for rule in rules) or command[-1] == "--anchor"  # tyro's own sentence for three numbers


def test_numbers_are_read_as_python_reads_them():
    assert numbers.finite("-1.5e-3") == -0.0015
    assert numbers.whole("-" + "9" * 17) == -(10**17) + 1
    with pytest.raises(ValueError, match="at most 18 digits, got '99999999999999999999…'"):
        numbers.whole("9" * 400)


@pytest.mark.parametrize(
    ("option", "value"),
    [("--window", "1e-320"), ("--window", "-1"), ("--range-sigma", "0"), ("--position-sigma", "-1"), ("--seed", "-1")],
)
def test_limits_of_a_flights_options_name_the_option(complaint, tmp_path, option, value):
    rows = [f"{k / 50},0,0,0.1,0,0,9.81,{k / 50},0,0" for k in range(200)]
    header = (
        "t [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],accel_x [m/s2],accel_y [m/s2],accel_z [m/s2],p_x,p_y,p_z"
    )
    (tmp_path / "x.csv").write_text("\n".join([header, *rows]))
    ranges = ("--synthetic-ranges", "0.1") if option == "--seed" else ()
    line = complaint("log", tmp_path / "x.csv", "--frame", "z-up", "--anchor", "0", "0", "0", *ranges, option, value)
    assert line.startswith(option), line
