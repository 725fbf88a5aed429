"""Each example runs from any folder, leaves nothing behind in it, and prints what is true."""

import re
import runpy
from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.slow


EXAMPLES = Path(__file__).parent.parent / "examples"
NUMBER = r"(-?\d+(?:\.\d+)?)"


def own_arrays(text: str) -> None:
    """A fit is not judged; the motion itself needs a longer window for the accuracy than for the rank."""
    assert "not judged: the path's snap was not in my flight but comes from fitting" in text
    assert "6 s: weak, rank 13" in text
    assert "10 s: observable, rank 13" in text


def observer(text: str) -> None:
    """Near the truth at the end, from nothing at the start."""
    rows = re.findall(rf"{NUMBER} s: position +{NUMBER} m off .*attitude +{NUMBER}° off", text)
    position, attitude = (np.array([float(row[k]) for row in rows]) for k in (1, 2))
    assert position.max() > 1.0
    assert position[-3:].max() < 0.5
    assert attitude[-3:].max() < 3.0 < attitude[0]


def one_step(text: str) -> None:
    """A loop over samples is the whole record, and what is no sample is refused in one sentence."""
    assert "refused: gyro must have shape (3,), got (2,)" in text
    assert text.rstrip().endswith("equal to observe(): True")


def tuned(text: str) -> None:
    """Figures for both, and gains of the kind that were searched."""
    assert re.search(rf"before: position settled after {NUMBER} s", text)
    assert re.search(rf"after : position settled after {NUMBER} s", text)
    assert "RiccatiGains(q=" in text


def certified(text: str) -> None:
    """The file verifies as it was written, and not with one digit changed."""
    assert "certified: True" in text
    assert "wrong with the file: nothing" in text
    assert "after a change: mine.csv" in text


def judged(text: str) -> None:
    """Long windows see what short ones do not, and the observer converges."""
    assert "observable: 51 observable of 51 windows of 12 s" in text
    assert re.search(r"partly: .* blind of 51 windows of 6 s", text)
    error = [float(value) for value in re.findall(rf"position error {NUMBER} m \(rms\)", text)]
    assert len(error) == 4
    assert error[-1] < 0.1 * error[0]


def connected(text: str) -> None:
    """Without noise the continuous observer ends at the truth."""
    rows = re.findall(rf"position +{NUMBER} m off, attitude +{NUMBER}° off", text)
    assert float(rows[-1][0]) < 0.1
    assert float(rows[-1][1]) < 2.0 < float(rows[0][1])


def mapped(text: str) -> None:
    """Every point is valid, the best anchor meets the requirement of 0.15 m, and the picture is there."""
    assert "points: 49 in" in text
    assert "computed: 49 points, 0 of them invalid" in text
    (sigma,) = re.findall(rf"best anchor .*, {NUMBER} m", text)
    assert 0 < float(sigma) <= 0.15
    assert "drawn: True" in text


TRUE_OF = {
    "01_observability_of_my_own_arrays.py": own_arrays,
    "02_run_the_observer.py": observer,
    "03_one_step_at_a_time.py": one_step,
    "04_tune.py": tuned,
    "05_certify_and_export.py": certified,
    "06_judge_a_log.py": judged,
    "07_observer_in_python_control.py": connected,
    "08_a_map_from_a_study.py": mapped,
}


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_the_example_prints_what_is_true_and_leaves_the_folder_as_it_was(path, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(path), run_name="__main__")
    text = capsys.readouterr().out
    TRUE_OF[path.name](text)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_an_example_is_short_and_begins_with_a_title(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 75
    assert lines[0] == '"""'
    assert set(lines[2]) == {"="}
    assert len(lines[2]) >= len(lines[1])
    assert lines.count("# %%") >= 2
