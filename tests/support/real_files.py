"""Recorded files of other projects. They are not in the repository; a test that needs a missing one is skipped."""

import os
from pathlib import Path

import pytest

FOLDER = "RANGENAV_SHARED_DATA"
"""An environment variable: the folder of MANIFEST.md; by default `shared/data` next to the repository."""


def shared(name: str) -> Path:
    """The path of a file such as `imu/fusion_sensor_data.csv`; skips the test where there is none."""
    path = Path(os.environ.get(FOLDER, Path(__file__).parents[3] / "shared" / "data")) / name
    if not path.is_file():
        pytest.skip(f"{name} is not there; {FOLDER} may name its folder")
    return path
