"""The course: a folder for each lesson, with its text, its states, and the check that says when it is passed.

    course     every lesson in order, ours and those of a teacher's own folder
    lesson     what a lesson is
    reading    a folder -> a Lesson
    state      what a check judges, and what it answers
    figures    the numbers that a text may name
    measures   what figures and checks compute
    judging    whether a lesson does what it says
    text       Markdown with equations and figures -> HTML

A lesson's folder is `NN-name/` with lesson.md, start.toml, solved.toml, failing-1.toml, failing-2.toml and check.py; a
lesson of several runs adds case-1.toml, case-2.toml, …
No other file of Python knows a lesson by its name.
"""

from explorer.lessons.course import FOLDERS_VARIABLE, course
from explorer.lessons.lesson import Lesson
from explorer.lessons.state import Outcome, State

__all__ = ["FOLDERS_VARIABLE", "Lesson", "Outcome", "State", "course"]
