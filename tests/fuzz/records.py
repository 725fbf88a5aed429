"""Exported records with places damaged, as `rangenav verify` reads them again."""

import tempfile
from collections.abc import Callable
from pathlib import Path
from random import Random

import msgspec
import numpy as np

from rangenav import formats, preset
from rangenav.certificate import files
from rangenav.formats import readback
from tests.fuzz import damage, sentences

NAMES = tuple(row.name for row in formats.writable() if row.certified_as == "run")


def exported_record(name: str) -> Callable[[Random], None]:
    """The reader of the records of one format."""

    def read(random: Random) -> None:
        _read(name, random)

    return read


def _read(name: str, random: Random) -> None:
    """A record with places damaged: positions, or refused in one line."""
    seeds = dict(records()).get(name)
    if seeds is None:  # what writes it is not installed
        return
    damaged = dict(seeds)
    file = random.choice(sorted(seeds))
    damaged[file] = damage.damaged(random, seeds[file], text=name in ("tum", "csv", "log", "euroc"))
    if random.random() < 0.05:
        damaged[random.choice(("../x", "a/b", "metadata.yaml", ".", "y"))] = b"z"
    try:
        time, position = readback.positions(damaged, formats.row(name), "x")
    except ValueError as error:
        sentences.check(str(error), "x", longest=sentences.COLUMNS_NAMED)
        return
    assert position.shape == (len(time), 3)
    assert np.isfinite(position).all()


_RECORDED: list[tuple[str, dict[str, bytes]]] = []


def records() -> list[tuple[str, dict[str, bytes]]]:
    """A short record in every format that one is exported in."""
    if not _RECORDED:
        soft = preset.load("soft")
        slow = msgspec.structs.replace(soft.sensors, imu_rate=50.0, range_rate=10.0, mag_rate=10.0)
        requirement = msgspec.structs.replace(soft.requirement, window=1.5)
        short = msgspec.structs.replace(soft, duration=3.0, sensors=slow, requirement=requirement)
        with tempfile.TemporaryDirectory() as folder:
            for name in NAMES:
                path = Path(folder) / f"x-{name}"
                try:
                    formats.export(short, name, path)
                except ValueError as error:
                    if "rangenav[ros]" in str(error):  # it is not installed
                        continue
                    raise
                content = files.read_bytes(path)
                _RECORDED.append((name, files.unpacked(content, "x") if path.is_dir() else {"": content}))
        for name, seeds in _RECORDED:  # undamaged they are read
            assert len(readback.positions(seeds, formats.row(name), "x")[0]) > 100
    return _RECORDED
