"""What an array may be that a caller gives: converted where it holds numbers, else refused in one sentence."""

# pyright: reportArgumentType=false
# Values of the wrong type are what this file is about.

import numpy as np
import pytest

from rangenav import arguments
from tests.support.refusals import exactly

READ_ONLY = np.arange(3.0)
READ_ONLY.flags.writeable = False


@pytest.mark.parametrize(
    "value",
    [
        [0, 1, 2],
        (0.0, 1.0, 2.0),
        range(3),
        np.arange(3),
        np.arange(3, dtype=np.float32),
        np.arange(3, dtype=np.uint8),
        np.arange(3, dtype=">f8"),
        np.arange(3, dtype=np.longdouble),
        np.arange(6.0)[::2] / 2,
        READ_ONLY,
        [np.float64(0), np.int32(1), 2],
    ],
)
def test_numbers_in_any_container_become_float64_in_c_order(value):
    computed = arguments.array("gyro", value, (3,))
    np.testing.assert_array_equal(computed, [0.0, 1.0, 2.0])
    assert type(computed) is np.ndarray
    assert computed.dtype == np.float64
    assert computed.flags.carray


def test_what_is_right_already_is_not_copied():
    given = np.zeros((4, 3))
    assert arguments.array("gyro", given, (4, 3)) is given
    assert arguments.array("gyro", given, ("n", 3)) is given


@pytest.mark.parametrize(
    ("value", "sentence"),
    [
        (np.zeros((3, 4)), "gyro must have shape (n, 3), got (3, 4)"),
        (np.zeros(3), "gyro must have shape (n, 3), got (3,)"),
        (1.0, "gyro must have shape (n, 3), got ()"),
        ([[1, 2, 3], [4, 5]], "gyro must have shape (n, 3), got rows of different lengths"),
        (None, "gyro must hold numbers, got None"),
        ([[1, None, 3]], "gyro must hold numbers, got None"),
        ([["1", "2", "3"]], "gyro must hold numbers, got text"),
        ([[b"1", b"2", b"3"]], "gyro must hold numbers, got bytes"),
        (np.ones((1, 3), dtype=bool), "gyro must hold numbers, got booleans"),
        (np.ones((1, 3), dtype=complex), "gyro must hold numbers, got complex numbers"),
        (np.zeros((1, 3), dtype="M8[s]"), "gyro must hold numbers, got datetime64[s]"),
        (np.ones((1, 3), dtype=object), "gyro must hold numbers, got objects of type int"),
        ({"x": 1}, "gyro must hold numbers, got objects of type dict"),
        (
            np.ma.masked_array(np.ones((1, 3)), True),
            "gyro must not be a masked array: what its mask hides would be read",
        ),
    ],
)
def test_anything_else_is_refused_with_the_shape_or_the_type_that_was_given(value, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        arguments.array("gyro", value, ("n", 3))


def test_none_may_be_explained():
    with pytest.raises(ValueError, match=exactly("mag must hold numbers, got None: write NaN")):
        arguments.array("mag", None, (3,), none=": write NaN")


def test_numbers_that_are_not_finite_are_named_by_their_place():
    with pytest.raises(ValueError, match=exactly("gyro must be finite, got inf at [1, 2]")):
        arguments.finite_array("gyro", [[0, 0, 0], [0, 0, np.inf]], ("n", 3))
    with pytest.raises(ValueError, match=exactly("gyro must be finite, got nan at [0]")):
        arguments.finite_array("gyro", [np.nan, 0, 0], (3,))


def test_stamps_that_do_not_increase_are_named_by_their_place():
    np.testing.assert_array_equal(arguments.increasing_array("time", [1, 2, 4], ("n",)), [1.0, 2.0, 4.0])
    with pytest.raises(ValueError, match=exactly("time must increase: broken at [2], 2 after 2")):
        arguments.increasing_array("time", [1, 2, 2, 1], ("n",))


@pytest.mark.parametrize("value", [2, 2.0, np.float32(2), np.int8(2), np.float64(2)])
def test_real_numbers_become_floats(value):
    computed = arguments.number("rate", value)
    assert type(computed) is float
    assert computed == 2.0


@pytest.mark.parametrize(
    ("value", "sentence"),
    [
        (True, "rate must be a number, got True"),
        (np.True_, "rate must be a number, got True"),
        (None, "rate must be a number, got None"),
        ("2", "rate must be a number, got '2'"),
        (np.ones(1), "rate must be a number, got an array of shape (1,)"),
        (1j, "rate must be a number, got complex"),
        (np.nan, "rate must be a finite number, got nan"),
        (10**400, "rate must be a finite number, got inf"),
    ],
)
def test_what_is_no_finite_number_is_refused(value, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        arguments.number("rate", value)
