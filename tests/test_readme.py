"""The README's program runs, and its table of presets says what the analysis says."""

import math
import re
import runpy
from pathlib import Path

import pytest

from rangenav import analysis, preset

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")


def test_the_program_in_the_readme_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    (program,) = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
    file = tmp_path / "program.py"
    file.write_text(program, encoding="utf-8")
    names = runpy.run_path(str(file))
    assert (names["state"].state == names["flight"].estimate.state[-1]).all()
    assert "m, 1-sigma" in capsys.readouterr().out


@pytest.mark.parametrize("name", [file.stem for file in preset.shipped_files()])
def test_the_table_of_presets_is_true(name: str):
    (row,) = re.findall(rf"^\| `{name}` \|(.*)\|$", README, flags=re.MULTILINE)
    anchor, window, required, reached, expected, rank, sigma, verdict = [cell.strip() for cell in row.split("|")][1:]
    p = preset.load(name)
    found = analysis.analyse(p)
    assert tuple(float(number) for number in anchor.strip("()").split(",")) == p.world.anchor
    assert (float(window), float(required)) == (p.requirement.window, p.requirement.mu)
    assert float(reached) == pytest.approx(found.mu, rel=0.02, abs=1e-6)
    assert (expected, verdict, rank) == (p.expect, found.verdict, f"{found.rank} / {found.nonlinear_rank}")
    if math.isfinite(found.lifted_end.position):
        assert float(sigma.removesuffix(" m")) == pytest.approx(found.lifted_end.position, rel=0.05)
    else:
        assert sigma == "–"
