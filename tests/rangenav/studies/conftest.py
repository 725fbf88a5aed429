"""A small study, which takes a tenth of a second, and its file."""

from pathlib import Path

import pytest

from rangenav.studies import study

SMALL = """
title = "a small study"
presets = ["short.toml"]
metrics = ["sigma_lifted", "flyable", "steady_position", "settled"]
runs = 4
seed = 3

[[parameters]]
kind = "linear"
path = "world.anchor.x"
low = -2.0
high = 2.0
count = 4

[[parameters]]
kind = "log"
path = "time_scale"
low = 0.5
high = 2.0
count = 3
"""
"""Two parameters, and metrics of the point and of the runs."""


@pytest.fixture(scope="session")
def small_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a small study, beside the file of its preset."""
    from msgspec.structs import replace

    from rangenav import preset

    folder = tmp_path_factory.mktemp("study")
    slow = preset.load("paper-slow")
    preset.save(replace(slow, duration=4.0, requirement=replace(slow.requirement, window=2.0)), folder / "short.toml")
    (folder / "small.toml").write_text(SMALL)
    return folder / "small.toml"


@pytest.fixture(scope="session")
def small(small_file: Path) -> study.Study:
    """That study."""
    return study.load(small_file)
