"""Numbers as a visitor types them: the box beside a slider takes the number itself, and keeps what was typed."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from explorer.model.settings import Settings
from explorer.panels.dock import Dock
from explorer.widgets import typed_number
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.controls import Number
from explorer.widgets.dials import Dial, InverseDial, LogDial
from explorer.widgets.section import Section
from explorer.widgets.vector import Vector
from tests.support.page_settings import SHIPPED
from tests.support.refreshed import refreshed


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("5000", 5000.0),
        ("5e3", 5000.0),
        ("5 000", 5000.0),
        ("5\N{NARROW NO-BREAK SPACE}000", 5000.0),
        ("1 234 567.5", 1234567.5),
        (" -.25 ", -0.25),
        ("\N{MINUS SIGN}3", -3.0),
        ("+1E-3", 1e-3),
    ],
)
def test_the_usual_spellings_of_a_number_are_understood(text, value):
    assert typed_number.parse(text) == value


@pytest.mark.parametrize(
    "text", ["", "  ", "1e", "five", "nan", "inf", "1e999", "0x10", "1_000", "50 00", "1.2.3", "--1", "9" * 400]
)
def test_anything_else_is_refused_with_an_example(text):
    with pytest.raises(ValueError, match="number"):
        typed_number.parse(text)


def test_a_decimal_comma_is_not_guessed_at_but_the_point_is_offered():
    with pytest.raises(ValueError, match=r"12\.5 with a point"):
        typed_number.parse("12,5")


@given(st.floats(-1e15, 1e15))
def test_what_a_box_shows_can_be_typed_again_and_is_the_number_to_four_digits(value):
    shown = typed_number.parse(typed_number.text(value, 8))
    assert shown == pytest.approx(value, rel=5e-4)


@pytest.mark.parametrize("text", ["5000", "5e3", "5 000"])
def test_a_logarithmic_dial_takes_the_number_itself_and_its_slider_follows(section: Section, text):
    dial = LogDial(section, "weight", (1e-3, 1e5), hint="")
    dial.show(1.0)
    dial.type(text)
    dial.mark()
    assert dial.read() == 5000.0
    assert dial.text == text  # what was typed stays
    assert dial.handle.value == pytest.approx(math.log10(5000), abs=5e-3)


def test_the_box_of_a_dial_follows_its_slider(section: Section):
    dial = LogDial(section, "weight", (1e-3, 1e5), hint="")
    dial.handle.value = 2.0
    dial.mark()
    assert dial.text == "100"
    assert dial.read() == 100.0


def test_of_slider_and_box_the_one_moved_last_counts_also_after_nonsense(section: Section):
    dial = Dial(section, "angle", (-180.0, 180.0), step=0.1, hint="", scale=math.degrees(1.0))
    dial.type("ninety")
    with pytest.raises(ValueError, match="angle: “ninety” is not a number"):
        dial.read()
    dial.mark()
    assert dial.text == "ninety"
    dial.handle.value = 45.0
    assert dial.read() == pytest.approx(math.pi / 4)
    dial.mark()
    assert dial.text == "45"
    dial.type("90")
    assert dial.read() == pytest.approx(math.pi / 2)


def test_a_number_beyond_the_slider_is_not_cut_to_its_end(section: Section):
    dial = Dial(section, "amplitude", (-3.0, 3.0), step=0.001, hint="")
    dial.type("12.3456")
    dial.mark()
    assert dial.read() == 12.3456
    assert dial.handle.value == dial.handle.max


def test_the_speed_is_the_inverse_of_the_stored_time_scale_to_the_last_bit(section: Section):
    dial = InverseDial(section, "speed", (0.1, 10.0), hint="")
    dial.show(3.0)
    assert dial.read() == 3.0
    dial.type("0.25")
    assert dial.read() == 4.0


def test_a_number_box_keeps_a_text_that_says_the_value(section: Section):
    box = Number(section, "duration", hint="")
    box.show(20.0)
    box.handle.value = "2e1"
    box.show(20.0)
    assert box.handle.value == "2e1"
    box.show(1.5)
    assert (box.handle.value, box.read()) == ("1.5", 1.5)


def test_a_value_out_of_range_is_refused_with_its_label_and_its_range_and_what_was_typed_stays(dock: Dock):
    dock.write(Settings(origin="paper", preset=SHIPPED["paper"]))
    weight = dock.gains.paper_dials.noise.controls[0]
    assert isinstance(weight, LogDial)
    weight.type("1e12")
    with pytest.raises(InvalidInputError):
        refreshed(dock)
    complaint = dock.gains.paper_dials.noise.complaint.content
    assert "range weight q must lie between 0.001 and 100000, got 1e12" in complaint
    assert weight.text == "1e12"


@pytest.mark.parametrize(("typed", "value"), [("5e3", 5000.0), ("5 000", 5000.0), ("−0.2", -0.2), ("1.50", 1.5)])
def test_each_box_of_a_vector_takes_a_number_as_a_person_types_it_and_keeps_it(
    section: Section, typed: str, value: float
):
    vector = Vector(section, "v (m)", hint="")
    vector.show((1.0, 1 / 3, 3.0))
    vector.type("x", typed)
    assert vector.read() == (value, 1 / 3, 3.0)  # what was not typed stays exact
    vector.show((value, 1 / 3, 4.0))
    assert vector.texts == (typed, "0.3333", "4")


def test_a_box_of_a_vector_that_holds_no_number_is_named_by_its_axis(section: Section):
    vector = Vector(section, "v (m)", hint="", scale=2.0)
    vector.show((1.0, 2.0, 3.0))
    assert vector.texts == ("2", "4", "6")
    vector.type("y", "2 m")
    with pytest.raises(ValueError, match=r"v \(m\), y: “2 m” is not a number"):
        vector.read()
    vector.type("y", "8")
    assert vector.read() == (1.0, 4.0, 3.0)
