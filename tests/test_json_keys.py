"""The list of JSON keys on the page about the command line is what the commands print: no more, and no less."""

import itertools
import json
import re
from collections.abc import Iterable
from pathlib import Path

import msgspec
import pytest

from rangenav import formats, preset
from rangenav.sensors import Effects

pytestmark = pytest.mark.slow

PAGE = Path(__file__).parent.parent / "docs" / "command-line.md"
replace = msgspec.structs.replace


def listed(commands: tuple[str, ...]) -> dict[re.Pattern[str], str]:
    """Every key that the page lists for commands, as a pattern, with its meaning."""
    text = PAGE.read_text(encoding="utf-8").split("## Every key of `--json`")[1]
    (section,) = (part for part in text.split("\n### ")[1:] if part.startswith(", ".join(f"`{c}`" for c in commands)))
    keys = {}
    for row in re.findall(r"^\| (`.*) \| (.*) \|$", section, flags=re.MULTILINE):
        for cell in re.findall(r"`([^`]*)`", row[0]):
            keys |= {_pattern(one): row[1] for one in _expanded(cell)}
    return keys


def _expanded(cell: str) -> Iterable[str]:
    """`a.{b,c}` → a.b, a.c"""
    parts = re.split(r"\{([^}]*)\}", cell)
    choices = [part.split(",") if k % 2 else [part] for k, part in enumerate(parts)]
    return ("".join(one) for one in itertools.product(*choices))


def _pattern(key: str) -> re.Pattern[str]:
    return re.compile(re.escape(key).replace("NAME", ".+").replace("…", ".+") + "$")


def printed(value: object, at: str = "") -> set[str]:
    """The dotted keys of a JSON object that have no keys below them; [] for the entries of a list."""
    if isinstance(value, dict) and value:
        return set().union(*(printed(entry, f"{at}.{key}".lstrip(".")) for key, entry in value.items()))
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return set().union(*(printed(entry, f"{at}[]") for entry in value))
    return {at}


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the inputs of the commands."""
    folder = tmp_path_factory.mktemp("keys")
    short = replace(preset.load("paper"), duration=8.0)
    preset.save(short, folder / "short.toml")
    (folder / "study.toml").write_text(STUDY)
    soft = preset.load("soft")
    odd = replace(soft.sensors, noise=replace(soft.sensors.noise, range=0.0), unmodelled=Effects(gyro_bias=(0.1, 0, 0)))
    preset.save(replace(soft, sensors=odd), folder / "odd.toml")
    for window in (0.5, 1.2):
        preset.save(preset.with_window(soft, window, source="soft"), folder / f"rounded {window}.toml")
    formats.export(soft, "log", folder / "flight.csv")
    rows = [row.split(",") for row in (folder / "flight.csv").read_text().splitlines() if not row.startswith("#")]
    kept = [k for k, name in enumerate(rows[0]) if name[:2] not in ("p_", "q_") and not name.startswith("range")]
    stated = [row for row in (folder / "flight.csv").read_text().splitlines() if row.startswith("#")]
    bare = [*stated, *(",".join(row[k] for k in kept) for row in rows)]
    (folder / "bare.csv").write_text("\n".join(bare))
    return folder


STUDY = """
title = "keys"
presets = ["short.toml"]
metrics = ["speed", "settled"]
[[parameters]]
kind = "list"
path = "sensors.range_rate"
values = [50.0, -1.0]
"""
"""One valid point and one that is not."""
RUNS: dict[tuple[str, ...], tuple[tuple[object, ...], ...]] = {
    ("presets",): (("presets",),),
    ("analyze",): (
        ("analyze", "paper-slow"),
        ("analyze", "circle"),
        ("analyze", "odd.toml"),
        ("analyze", "rounded 0.5.toml"),
        ("analyze", "rounded 1.2.toml"),
    ),
    ("explain",): (("explain", "soft"), ("explain", "circle")),
    ("simulate",): (
        ("simulate", "short.toml", "--runs", 2),
        ("simulate", "hover"),
        ("simulate", "trefoil"),
        ("simulate", "odd.toml"),
    ),
    ("certify",): (
        ("certify", "soft"),
        ("certify", "circle"),
        ("certify", "odd.toml"),
        ("certify", "rounded 0.5.toml"),
        ("certify", "rounded 1.2.toml"),
    ),
    ("verify",): (("verify", "soft", "short.toml"),),
    ("export", "import", "repair"): (
        ("export", "soft", "--to", "reference", "-o", "soft.csv"),
        ("export", "circle", "--to", "npz", "-o", "x.npz", "--uncertified"),
        ("import", "soft.csv", "--from", "reference", "-o", "again.toml"),
        ("export", "soft", "--to", "polynomial", "-o", "loop.csv"),
        ("repair", "circle", "--export", "polynomial", "-o", "round.toml"),
    ),
    ("log",): (
        ("log", "flight.csv", "--window", 8),
        ("log", "bare.csv", "--window", 8),
        ("log", "flight.csv", "--list-columns"),
    ),
    ("study",): (
        ("study", "plan", "study.toml"),
        ("study", "run", "study.toml", "-o", "s.zarr", "--workers", 1),
        ("study", "show", "s.zarr"),
        ("study", "export", "s.zarr", "--csv", "s.csv"),
        ("study", "copy", "study.toml", "-o", "copy.toml"),
        ("study", "preset", "s.zarr", 0, "-o", "point.toml"),
    ),
    ("tune",): (("tune", "short.toml", "--runs", 2),),
}


@pytest.mark.parametrize("commands", RUNS, ids=lambda commands: "-".join(commands))
def test_every_key_that_is_printed_is_listed_and_every_key_that_is_always_there_is_printed(
    commands, run, files: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(files)
    keys, seen = listed(commands), set()
    for arguments in RUNS[commands]:
        _, out, _ = run(*arguments, "--json")
        seen |= printed(json.loads(out))
    assert {key for key in seen if not any(pattern.match(key) for pattern in keys)} == set()
    always = {pattern for pattern, meaning in keys.items() if "only if" not in meaning.lower()}
    assert {pattern.pattern for pattern in always if not any(pattern.match(key) for key in seen)} == set()


def test_a_key_that_the_page_does_not_list_would_be_found():
    keys = listed(("analyze",))
    assert not any(pattern.match("accuracy.unheard_of") for pattern in keys)
    assert any(pattern.match("accuracy.lifted.end.position") for pattern in keys)
