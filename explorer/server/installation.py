"""Whether this installation works: each part is tried, and what fails says what to do.

✓ kernels       compiled, and right: a hover leaves 5 of 13 quantities, the paper's motion all 13
✗ work folder   /home/…/rangenav cannot be written: No space left on device → free some space, or set RANGENAV_STATE
"""

import secrets
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import resources
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from explorer.lessons import course
from explorer.storage.library import DATA, data_folder
from explorer.storage.work_files import STATE, state_folder
from explorer.web.door import FOLDER
from explorer.web.security import CHECKED_AGAINST
from rangenav import analysis, certificate, preset

EXPECTED_RANKS = {"hover": 5, "paper": 13}
"""Presets whose rank is known from the mathematics."""
SCRIPTS = (
    *("page.js", "page.css", "accessibility.js", "cells.js", "inputs.js", "keys.js", "labels.js", "menus.js"),
    *("places.js", "without_webgl.js", "access/door.html"),
)
REINSTALL = "install rangenav anew"


@dataclass(frozen=True)
class Check:
    """What came of one part."""

    part: str
    works: bool
    text: str

    def __str__(self) -> str:
        return f"{'✓' if self.works else '✗'} {self.part:<16}{self.text}"


def checks() -> Iterator[Check]:
    """Try every part, one after the other."""
    for part, tried, cure in (
        ("viser", _viser, f"install viser {CHECKED_AGAINST}"),
        ("page", _assets, REINSTALL),
        ("kernels", _kernels, "remove the folder that NUMBA_CACHE_DIR names, or __pycache__ beside the kernels"),
        ("presets", _presets, REINSTALL),
        ("lessons", _lessons, "mend the lesson, or unset RANGENAV_LESSONS"),
        ("work folder", lambda: _writable(state_folder()), f"free some space, or set {STATE} to another folder"),
        ("preset folder", lambda: _writable(data_folder()), f"free some space, or set {DATA} to another folder"),
    ):
        yield _check(part, tried, cure)


def _check(part: str, tried: Callable[[], str], cure: str) -> Check:
    try:
        return Check(part, True, tried())
    except (OSError, ValueError, ImportError, PackageNotFoundError) as error:
        return Check(part, False, f"{error} → {cure}")


def _viser() -> str:
    installed = version("viser")
    if installed != CHECKED_AGAINST:
        raise ValueError(f"{installed} is installed, and the page was checked against {CHECKED_AGAINST}")
    return installed


def _assets() -> str:
    page = resources.files("viser") / "client" / "build" / "index.html"
    size = len(page.read_bytes())
    for script in SCRIPTS:
        if not (FOLDER / script).read_text(encoding="utf-8").strip():
            raise ValueError(f"{script} is empty")
    return f"viser's {size / 1e6:.1f} MB, and {len(SCRIPTS)} files of our own"


def _kernels() -> str:
    for name, expected in EXPECTED_RANKS.items():
        rank = analysis.analyse(preset.load(name)).rank
        if rank != expected:
            raise ValueError(f"{name} has rank {rank} in place of {expected}")
    ranks = " and ".join(f"{rank} of {name}" for name, rank in EXPECTED_RANKS.items())
    return f"compiled, and right: {ranks}"


def _presets() -> str:
    shipped = preset.shipped()
    failures = [sentence for name in shipped for sentence in certificate.verify_file(name)]
    if failures:
        raise ValueError("; ".join(failures))
    return f"{len(shipped)}, each with its certificate"


def _lessons() -> str:
    taught = course()
    if taught.complaints:
        raise ValueError("; ".join(taught.complaints))
    return f"{len(taught.lessons)} can be read"


def _writable(folder: Path) -> str:
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    probe = folder / f".check-{secrets.token_hex(4)}"
    try:
        probe.write_bytes(b"rangenav")
    except OSError as error:
        raise OSError(f"{folder} cannot be written: {error.strerror}") from None
    finally:
        probe.unlink(missing_ok=True)
    return str(folder)
