"""The documentation is true: its programs and commands run, its table of presets agrees with the analysis, its
generated parts are up to date, and the drawing knows every room."""

import importlib.util
import math
import re
import runpy
import shutil
from pathlib import Path

import pytest

from rangenav import analysis, preset

pytestmark = pytest.mark.slow


ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = sorted([*DOCS.rglob("*.md"), ROOT / "README.md", ROOT / "CONTRIBUTING.md"])
BLOCK = re.compile(r"```(python|console)\n(.*?)```", re.DOTALL)


def blocks(page: Path) -> list[tuple[str, str]]:
    """The runnable blocks of a page, in their order: Python programs, and console blocks with lines `$ command`."""
    return BLOCK.findall(page.read_text(encoding="utf-8"))


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page)], ids=lambda page: str(page.relative_to(ROOT)))
def test_the_programs_and_commands_of_a_page_run(page: Path, run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": "__main__"}
    for language, text in blocks(page):
        if language == "python":
            exec(compile(text, page.name, "exec"), names)
        else:
            for command in re.findall(r"^\$ rangenav (.*)$", text, flags=re.MULTILINE):
                code, _, err = run(*command.replace("--evaluations 100", "--evaluations 12").split())
                assert not code, f"rangenav {command}\n{err}"


def test_the_observer_of_the_library_page_gives_the_same_numbers_sample_by_sample():
    (program,) = [text for language, text in blocks(DOCS / "library.md") if language == "python"]
    names: dict = {}
    exec(compile(program, "library.md", "exec"), names)
    assert (names["state"].state == names["flight"].estimate.state[-1]).all()


@pytest.mark.parametrize("name", [file.stem for file in preset.shipped_files()])
def test_the_table_of_presets_is_true(name: str):
    text = (DOCS / "presets.md").read_text(encoding="utf-8")
    (row,) = re.findall(rf"^\| `{name}` \|(.*)\|$", text, flags=re.MULTILINE)
    anchor, window, required, reached, expected, rank, sigma, verdict = [cell.strip() for cell in row.split("|")][1:]
    p = preset.load(name)
    analysed = analysis.analyse(p)
    assert tuple(float(number) for number in anchor.strip("()").split(",")) == p.world.anchor
    assert (float(window), float(required)) == (p.requirement.window, p.requirement.mu)
    assert float(reached) == pytest.approx(analysed.mu, rel=0.02, abs=1e-6)
    assert (expected, verdict, rank) == (
        p.expect,
        analysed.verdict.word,
        f"{analysed.rank} / {analysed.nonlinear_rank}",
    )
    if math.isfinite(analysed.lifted_end.position):
        assert float(sigma.removesuffix(" m")) == pytest.approx(analysed.lifted_end.position, rel=0.05)
    else:
        assert sigma == "–"


def test_generated_parts_of_the_pages_are_up_to_date(tmp_path: Path):
    copy = shutil.copytree(DOCS, tmp_path / "docs", ignore=shutil.ignore_patterns("generated", "examples", "*.png"))
    runpy.run_path(str(copy / "generate.py"), run_name="__main__")
    for page in copy.rglob("*.md"):
        written = (DOCS / page.relative_to(copy)).read_text(encoding="utf-8")
        assert page.read_text(encoding="utf-8") == written, f"run `python docs/generate.py`: {page.name} differs"


def test_every_fault_of_the_table_has_a_test_that_exists():
    text = (DOCS / "faults.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (.+) \| (.+) \| `(\S+\.py)::(\w+)` \|$", text, flags=re.MULTILINE)
    assert len(rows) == text.count(".py") > 50
    for fault, _, file, name in rows:
        tests = (ROOT / "tests" / file).read_text(encoding="utf-8")
        assert f"def {name}(" in tests, f"{fault}: no test {name} in {file}"


def test_the_drawing_is_up_to_date_and_knows_every_room_of_the_page():
    specification = importlib.util.spec_from_file_location("draw_architecture", DOCS / "draw_architecture.py")
    assert specification is not None
    assert specification.loader is not None
    drawing = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(drawing)
    assert (DOCS / "architecture.svg").read_text(encoding="utf-8") == drawing.drawing()
    for package, rooms in (("rangenav", drawing.LIBRARY), ("explorer", drawing.PAGE)):
        for name in [name for _, names, _ in rooms for name in names]:
            place = ROOT / package / name
            assert place.is_dir() or place.with_suffix(".py").is_file(), f"{package}/{name} is drawn and does not exist"
    drawn = {name for _, names, _ in drawing.PAGE for name in names}
    there = {
        path.stem for path in (ROOT / "explorer").iterdir() if path.suffix == ".py" or (path / "__init__.py").is_file()
    }
    assert there - {"__init__", "__pycache__"} <= drawn
