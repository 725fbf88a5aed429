"""Markdown, equations and figures become HTML, and nothing else does."""

import pytest

from explorer.lessons import judging, text
from explorer.lessons.course import OURS
from explorer.lessons.reading import read

HOVER = read(OURS / "01-one-range").start


def test_a_script_in_a_lesson_is_shown_and_not_run():
    shown = text.to_html('<script>alert(1)</script> <img src=x onerror="alert(1)"> [a](javascript:alert(1))', {})
    assert "<script" not in shown
    assert "<img" not in shown
    assert 'href="javascript' not in shown


def test_a_script_in_an_equation_is_shown_and_not_run():
    shown = text.to_html(r'$a<script>alert(1)</script>"b$', {})
    assert "<script" not in shown


def test_a_figure_is_filled_from_the_state_that_it_names():
    shown = text.to_html("{window} and {start.rank} and {pinned.mu}", {"": HOVER, "start": HOVER, "pinned": None})
    assert shown == f"<p>6 s and 5 and {text.MISSING}</p>\n"


def test_a_figure_in_a_table_and_in_bold_is_filled():
    shown = text.to_html("| a | b |\n|---|---|\n| {rank} | **{rank}** |", {"": HOVER})
    assert "<td>5</td>" in shown
    assert "<strong>5</strong>" in shown


def test_the_letters_of_an_equation_are_no_figures():
    text.refuse(r"$\hat{p}$ and $$\mathbf{mu}_{rang}$$", ("",))


def test_an_equation_keeps_its_source_for_a_reader_of_the_screen():
    assert r'alttext="\lVert p \rVert"' in text.to_html(r"$\lVert p \rVert$", {})


@pytest.mark.parametrize(
    ("markdown", "count"), [("One two {mu}.", 3), ("a $x + y$ b $$z$$", 4), ("| a | b |\n|---|---|\n| c | d |", 0)]
)
def test_words_are_counted_as_a_reader_meets_them(markdown: str, count: int):
    assert judging.words(markdown) == count
