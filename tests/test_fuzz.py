"""The fuzzing targets run, a little of each; `python -m tests.fuzz` runs them for as long as asked."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.fuzz.targets import TARGETS

pytestmark = pytest.mark.slow


SOURCE = Path(__file__).parent.parent


def test_sixty_cases_of_every_target_are_survived():
    """In its own process: it listens for anything that Python is asked to run, which test runners do all the time."""
    command = [sys.executable, "-m", "tests.fuzz", "--target", "all", "--cases", "60", "--seconds", "300"]
    finished = subprocess.run(command, cwd=SOURCE, capture_output=True, text=True, timeout=300, check=False)
    assert finished.returncode == 0, finished.stderr
    assert finished.stdout.count("60 cases") == len(TARGETS)
