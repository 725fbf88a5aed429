"""A number that is written for people says the number, to the digits that were asked for, and no more characters."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rangenav import number_format

REAL = st.floats(allow_nan=False, allow_infinity=False, min_value=-1e300, max_value=1e300)
NORMAL = REAL.filter(lambda x: x == 0 or abs(x) > 1e-300)


@given(NORMAL, st.integers(min_value=1, max_value=8))
def test_the_text_reads_back_as_the_number_to_half_a_unit_of_its_last_digit(value: float, digits: int) -> None:
    read = float(number_format.significant(value, digits))
    assert abs(read - value) <= 0.5 * 10.0 ** (1 - digits) * abs(value) * (1 + 1e-9)


@given(NORMAL)
def test_three_digits_need_at_most_nine_characters_and_a_sign(value: float) -> None:
    text = number_format.significant(value)
    assert len(text.removeprefix("-")) <= 9
    assert "+" not in text
    assert "e0" not in text
    assert "e-0" not in text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (-0.0, "0"),
        (0.0123456, "0.0123"),
        (0.00012345, "1.23e-4"),
        (0.00099999, "0.001"),
        (12.0, "12"),
        (1234.5678, "1235"),
        (9999.9, "1e4"),
        (123456.0, "1.23e5"),
        (-1.5e-7, "-1.5e-7"),
        (math.nan, "–"),
        (math.inf, "∞"),
        (-math.inf, "−∞"),
    ],
)
def test_numbers_of_every_size_are_written_as_a_reader_expects(value: float, text: str) -> None:
    assert number_format.significant(value) == text


@pytest.mark.parametrize("missing", [None, math.nan, math.inf, -math.inf])
def test_a_quantity_that_is_no_number_says_a_word_and_no_unit(missing: float | None) -> None:
    assert number_format.quantity(missing, "m") == "not determined"
    assert number_format.quantity(missing, "s", otherwise=number_format.NEVER) == "never"


def test_units_stand_after_a_space_but_for_degrees_and_percent() -> None:
    assert number_format.quantity(0.25, "m/s²") == "0.25 m/s²"
    assert number_format.quantity(12.34, "°") == "12.3°"
    assert number_format.quantity(3.0) == "3"
    assert number_format.percent(0.256) == "26%"
    assert number_format.percent(math.nan) == "–"


def test_vectors_exponents_and_indices_are_written_as_in_a_formula() -> None:
    assert number_format.vector((1.0, 2.5, -0.3)) == "(1, 2.5, -0.3)"
    assert number_format.power_of_ten(-13) == "10⁻¹³"
    assert number_format.subscript(13) == "₁₃"
    assert number_format.signed(-0.5) == "−0.500"


@given(st.floats(min_value=-2, max_value=2), st.integers(min_value=0, max_value=4))
def test_no_text_has_a_negative_zero(value: float, decimals: int) -> None:
    written = (
        number_format.fixed(value, decimals),
        number_format.signed(value, decimals).replace(number_format.MINUS, "-"),
        number_format.percent(value).removesuffix("%"),
        number_format.significant(value),
        *number_format.vector((value, -0.0)).strip("()").split(", "),
    )
    for text in written:
        assert float(text) != 0 or not text.startswith("-")


def test_numbers_of_a_sentence_are_rounded_and_whole_numbers_stay() -> None:
    sentence = "added a tone of 0.0624 m at 3.14159 rad/s, μ = 4.07e+03, 16384 runs along (1.00, -0.04)"
    assert number_format.shortened(sentence) == (
        "added a tone of 0.0624 m at 3.14 rad/s, μ = 4070, 16384 runs along (1, -0.04)"
    )
    assert number_format.shortened("over the 14.5664 s", 4) == "over the 14.57 s"


@pytest.mark.parametrize("unit", ["m", "s", "Hz", "rad/s", "m/s²", "m²/s⁷", "mm", "%", "times the weight"])
def test_a_unit_stays_on_the_line_of_its_number(unit: str) -> None:
    blank = number_format.UNBROKEN
    assert number_format.unbroken(f"at 0.12 {unit}, or 3 {unit}") == f"at 0.12{blank}{unit}, or 3{blank}{unit}"
    assert number_format.unbroken(f"16 384 {unit}") == f"16{blank}384{blank}{unit}"
    assert number_format.unbroken("3 motions in 5 seconds, 2 runs") == "3 motions in 5 seconds, 2 runs"
