"""A folder becomes a lesson, or one sentence that says what is wrong with it."""

import shutil
from pathlib import Path

import pytest

from explorer.lessons import FOLDERS_VARIABLE, course
from explorer.lessons.__main__ import main
from explorer.lessons.course import OURS, lessons_in
from rangenav.preset import load

PATTERN = OURS / "01-one-range"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A lesson of a teacher's own, 21-own, in a folder of lessons."""
    shutil.copytree(PATTERN, tmp_path / "21-own", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path / "21-own"


def _replace(path: Path, old: str, new: str) -> None:
    content = path.read_text(encoding="utf-8")
    assert old in content
    path.write_text(content.replace(old, new), encoding="utf-8")


def _complaint(folder: Path) -> str:
    found = lessons_in(folder.parent)
    assert found.lessons == ()
    (complaint,) = found.complaints
    assert "\n" not in complaint
    assert complaint.startswith("21-own")
    return complaint


def test_a_teachers_lesson_appears_beside_ours(folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv(FOLDERS_VARIABLE, str(folder.parent))
    found = course()
    assert found.complaints == ()
    own = found.lesson(21)
    assert own is not None
    assert own.check(own.solved).passed
    assert found.lessons[-1] is own
    assert found.lesson(1) is not None


def test_a_folder_that_does_not_exist_leaves_ours(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv(FOLDERS_VARIABLE, "/nowhere")
    found = course()
    assert len(found.lessons) == 14
    assert found.complaints == ("/nowhere: no folder of lessons: No such file or directory",)


def test_one_broken_lesson_does_not_hide_another(folder: Path):
    shutil.copytree(folder, folder.parent / "22-broken")
    (folder.parent / "22-broken" / "check.py").unlink()
    found = lessons_in(folder.parent)
    assert [one.name for one in found.lessons] == ["21-own"]
    assert found.complaints == ("22-broken: check.py cannot be read: No such file or directory",)


@pytest.mark.parametrize("name", ["lesson.md", "start.toml", "solved.toml", "check.py"])
def test_a_missing_file_is_named(folder: Path, name: str):
    (folder / name).unlink()
    assert name in _complaint(folder)


@pytest.mark.parametrize(
    ("file", "old", "new", "sentence"),
    [
        ("lesson.md", 'title = "', "title = ", "lesson.md"),
        ("lesson.md", "minutes = 6", "minutes = 90", "minutes must lie between 0 and 60, got 90"),
        ("lesson.md", "minutes = 6", "hours = 1", "unknown field `hours`"),
        ("lesson.md", "right = 3", "right = 4", "right must name one of the 3 choices"),
        ("lesson.md", "+++\n# Question", "# Question", "front matter in TOML between two lines +++"),
        (
            "lesson.md",
            "# Insight",
            "# Moral",
            "the sections must be Question, Explanation, Task, What you see, Insight",
        ),
        ("lesson.md", "# Task\n", "# Task\n\n---\n", "an empty screen in the section Task"),
        ("lesson.md", "{rank}", "{rang}", "{rang}: no such figure; there are mu"),
        ("lesson.md", "{rank}", "{case-1.rank}", "{case-1.rank}: the lesson has no state case-1"),
        ("lesson.md", "\\|p\\|", "\\foo{p}", "the equation d = \\foo{p}: \\foo is not known"),
        ("start.toml", "preset", "presets", "start.toml: Object contains unknown field `presets`"),
        ("start.toml", "hover", "hoover", "start.toml: hoover: no such preset"),
        ("solved.toml", "twin_turn = [", "twin_turn = [0.0, ", "solved.toml: Expected `array` of length 3"),
        ("solved.toml", "]", "", "solved.toml"),
        ("check.py", "import math", "import maths", "check.py: ModuleNotFoundError: No module named 'maths'"),
        ("check.py", "import math", "raise SystemExit(3)", "check.py: SystemExit: 3"),
        ("check.py", "def check(", "def test(", "check.py: must define a function check(state)"),
        ("check.py", "def check(", "def check(:", "check.py: SyntaxError"),
    ],
)
def test_what_is_wrong_becomes_one_sentence(folder: Path, file: str, old: str, new: str, sentence: str):
    _replace(folder / file, old, new)
    assert sentence in _complaint(folder)


@pytest.mark.parametrize(
    ("new", "sentence"),
    [
        ("    raise RuntimeError('no')\n", "check.py: RuntimeError: no"),
        ("    raise SystemExit\n", "check.py: SystemExit: "),
        ("    return True\n", "check.py: must return an Outcome, got bool"),
    ],
)
def test_a_check_that_fails_while_a_student_works_does_not_pass_and_says_so(folder: Path, new: str, sentence: str):
    _replace(folder / "check.py", '    """The metric is the least distance of the twin (m)."""\n', new)
    (own,) = lessons_in(folder.parent).lessons
    outcome = own.check(own.solved)
    assert (outcome.passed, outcome.hint) == (False, sentence)


def test_cases_are_read_and_their_numbers_can_be_named(folder: Path):
    _replace(folder / "lesson.md", "minutes = 6", 'minutes = 6\ncases = ["first"]')
    _replace(folder / "lesson.md", "{rank}", "{case-1.rank}")
    assert "case-1.toml" in _complaint(folder)
    shutil.copy(folder / "start.toml", folder / "case-1.toml")
    (own,) = lessons_in(folder.parent).lessons
    assert own.states(own.start)["case-1"] is own.cases[0]


def test_a_state_changes_a_table_of_its_preset_and_keeps_the_rest(folder: Path):
    (folder / "start.toml").write_text('preset = "hover"\n[set.world]\nanchor = [1.0, 0.0, 0.0]\n')
    (own,) = lessons_in(folder.parent).lessons
    hover = load("hover")
    assert own.start.preset.world.anchor == (1.0, 0.0, 0.0)
    assert own.start.preset.world.gravity == hover.world.gravity
    assert own.start.preset.path == hover.path


def test_another_kind_of_path_takes_the_place_of_the_whole_path(folder: Path):
    (folder / "start.toml").write_text('preset = "hover"\n[set.path]\nkind = "formula"\nx = "1"\ny = "t"\nz = "0"\n')
    (own,) = lessons_in(folder.parent).lessons
    assert type(own.start.preset.path).__name__ == "Formula"


def test_the_command_prints_what_the_states_of_a_folder_reach(folder: Path, capsys: pytest.CaptureFixture[str]):
    assert main([str(folder.parent)]) == 0
    assert "| 21-own | distance of the twin (m) | ≥ 1 |" in capsys.readouterr().out


def test_the_command_says_which_states_do_not_do_what_they_should(folder: Path, capsys: pytest.CaptureFixture[str]):
    shutil.copy(folder / "solved.toml", folder / "failing-1.toml")
    (folder / "failing-2.toml").unlink()
    assert main([str(folder.parent)]) == 1
    assert "21-own: failing-2.toml: cannot be read" in capsys.readouterr().out
    shutil.copy(folder / "solved.toml", folder / "failing-2.toml")
    assert main([str(folder.parent)]) == 1
    printed = capsys.readouterr().out
    assert "21-own: failing-1 passes: " in printed
    assert "21-own: failing-2 passes: " in printed
