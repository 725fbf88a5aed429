"""What a class shares: requests are done once, frozen pages are let go, names and predictions become a table."""

import csv
import io

import pytest
from hypothesis import given
from hypothesis import strategies as st

from explorer.model.classroom import (
    MAX_NAME,
    RETURN,
    Classroom,
    Member,
    Shown,
    as_text,
    chosen_name,
    histogram,
    results,
)
from explorer.model.settings import Settings
from tests.support.page_settings import SHIPPED

LESSONS = {1: "One range, many vehicles", 2: "Planar is not enough"}


def _shown() -> Shown:
    settings = Settings(origin="hover", preset=SHIPPED["hover"])
    return Shown(settings=settings, time=0.0, at=0.0, playing=False, speed=1.0, loop=True, camera=None, control="")


def test_each_page_does_a_request_once_also_one_that_comes_later_and_only_the_newest() -> None:
    classroom = Classroom()
    assert classroom.take_request(1) is None
    classroom.send(lesson=1)
    first = classroom.take_request(1)
    assert first is not None
    assert first.lesson == 1
    assert classroom.take_request(1) is None
    classroom.send(lesson=2)
    late = classroom.take_request(2)
    assert late is not None
    assert late.lesson == 2
    assert classroom.take_request(2) is None


def test_a_presentation_whose_page_was_closed_ends_unless_another_page_goes_on_in_time():
    classroom = Classroom()
    classroom.leave(0.0)
    assert classroom.state.left is None
    classroom.show(_shown())
    classroom.freeze(True)
    classroom.leave(1.0)
    classroom.end_if_left(1.0 + RETURN / 2)
    assert classroom.state.frozen
    classroom.show(_shown())  # the page was loaded again
    classroom.end_if_left(2.0 + RETURN)
    assert classroom.state.frozen
    classroom.leave(30.0)
    classroom.end_if_left(30.0 + RETURN)
    assert classroom.state.shown is None
    assert not classroom.state.frozen


def test_pages_are_frozen_only_while_something_is_shown() -> None:
    classroom = Classroom()
    classroom.freeze(True)
    assert not classroom.state.frozen
    classroom.show(_shown())
    classroom.freeze(True)
    classroom.show(_shown())
    assert classroom.state.frozen
    classroom.show(None)
    assert not classroom.state.frozen


def test_whoever_listens_hears_of_changes_and_of_nothing_else() -> None:
    classroom, heard = Classroom(), []
    end = classroom.listen(lambda: heard.append(1))
    classroom.report(1, Member(name="Otter"))
    classroom.report(1, Member(name="Otter"))
    assert len(heard) == 1
    classroom.report(1, Member(name="Otter", screen=2))
    assert len(heard) == 2
    end()
    classroom.send(lesson=1)
    assert len(heard) == 2


def test_nothing_of_a_class_is_left_after_its_end() -> None:
    classroom = Classroom()
    classroom.report(1, Member(name="Otter"))
    classroom.send(lesson=1)
    classroom.show(_shown())
    classroom.clear()
    assert classroom.members == {}
    assert classroom.state.shown is None
    assert classroom.take_request(2) is None


def test_the_histogram_counts_the_predictions_of_one_lesson_the_most_frequent_first() -> None:
    said = ["two", "three", "two", ""]
    members = {k: Member(name=str(k), predictions={LESSONS[1]: text} if text else {}) for k, text in enumerate(said)}
    assert histogram(members, LESSONS[1]) == {"two": 2, "three": 1}
    assert list(histogram(members, LESSONS[1])) == ["two", "three"]
    assert histogram(members, LESSONS[2]) == {}


def test_the_results_are_a_table_that_python_reads_back() -> None:
    members = {
        1: Member(name="Otter", predictions={LESSONS[1]: 'two, "mirror" images'}, passed=frozenset({LESSONS[1]})),
        2: Member(name="=1+1"),
    }
    rows = list(csv.reader(io.StringIO(results(members, LESSONS).decode())))
    assert rows == [
        ["student", "1 prediction", "1 passed", "2 prediction", "2 passed"],
        ["Otter", 'two, "mirror" images', "yes", "", ""],
        ["'=1+1", "", "", "", ""],
    ]


@given(st.text(max_size=MAX_NAME))
def test_no_cell_is_a_formula_and_a_name_is_one_short_line(text: str) -> None:
    assert not as_text(text).startswith(("=", "+", "-", "@", "\t"))
    name = chosen_name(text)
    assert name.isprintable()
    assert len(name) <= MAX_NAME
    assert chosen_name(name) == name


def test_a_long_name_is_refused_with_its_length() -> None:
    with pytest.raises(ValueError, match="at most 24 characters, got 30"):
        chosen_name("x" * 30)
