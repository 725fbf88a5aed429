"""Autosaves, libraries, presets, certificates and bundles written by version 0.1.0 open unchanged."""

import hashlib
import json
import math
import os
import shutil
import tarfile
import zipfile
from pathlib import Path
from typing import Any

import msgspec
import pytest

from explorer.model.settings import effective
from explorer.storage.autosave import Autosave
from explorer.storage.catalog import Catalog
from explorer.storage.certifier import Certifier
from explorer.storage.import_file import ImportFile, preset_in
from explorer.storage.library import Library, edition
from explorer.storage.work_files import WorkFiles
from rangenav import certificate, formats, preset, provenance
from rangenav.certificate import exports
from rangenav.signals import Waypoints

pytestmark = pytest.mark.slow


ARCHIVE = Path(__file__).parent / "old_work" / "0.1.0.tar.xz"
FIRST = "paper-slow"
EXPORTS = {
    "preset": "short.toml",
    "reference": "short.reference.csv",
    "polynomial": "short.polynomial.csv",
    "bag": "short.bag",
    "mcap": "short.mcap",
    "tum": "short.tum.txt",
    "euroc": "short.euroc",
    "mat": "short.mat",
    "npz": "short.npz",
    "csv": "short.csv",
    "log": "short.log.csv",
}


@pytest.fixture(scope="module")
def old(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The archive, unpacked; autosaves are as if written today, for they are forgotten after ninety days."""
    folder = tmp_path_factory.mktemp("old")
    with tarfile.open(ARCHIVE) as archive:
        archive.extractall(folder, filter="data")
    shutil.unpack_archive(folder / "exports.tar.xz", folder / "exports", filter="data")
    for file in folder.rglob("*.json"):
        os.utime(file)
    return folder


@pytest.fixture(scope="module")
def expected(old: Path) -> dict[str, Any]:
    return json.loads((old / "EXPECTED.json").read_text(encoding="utf-8"))


def values(value: object) -> Any:
    """A value as JSON has it; numbers that are not finite as text."""
    return json.loads(json.dumps(_finite(msgspec.to_builtins(value, builtin_types=()))))


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(entry) for entry in value]
    return repr(value) if isinstance(value, float) and not math.isfinite(value) else value


def sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def contains(now: Any, before: Any) -> bool:
    """Whether every key and value of before is in now; a later version may have added keys."""
    if isinstance(before, dict):
        return isinstance(now, dict) and all(key in now and contains(now[key], before[key]) for key in before)
    if isinstance(before, list):
        return isinstance(now, list) and len(now) == len(before) and all(map(contains, now, before))
    return now == before


def test_every_part_of_the_archive_is_compared(expected: dict[str, Any]):
    assert set(expected) == {"read_by", "state", "library", "presets", "bundle", "exports", "reopened"}
    assert set(expected["exports"]) == set(EXPORTS.values())


def test_the_work_of_each_tab_is_found_again(old: Path, expected: dict[str, Any]):
    folder = old / "state" / "work"
    assert {file.name for file in folder.iterdir()} == set(expected["state"])
    for name, before in expected["state"].items():
        complaints: list[str] = []
        work = Autosave(WorkFiles(folder), FIRST, complaints.append).restore(Path(name).stem)
        assert work is not None
        assert complaints == before["told"] == []
        assert contains(values(work), before["kept"])
        assert sha256(preset.dumps(effective(work.settings)).encode()) == before["effective_sha256"]


def test_the_library_offers_the_same_presets_under_the_same_titles(old: Path, expected: dict[str, Any]):
    library, before = Library(old / "data" / "presets"), expected["library"]
    catalog = Catalog(preset.shipped(), library, Certifier())
    labels = {name: label for name, label in catalog.labels(FIRST).items() if name.startswith("mine:")}
    assert labels == before["words"]
    for name, one in before["presets"].items():
        assert edition(library.read(name)) == one["edition"]
        assert contains(values(catalog.open(f"mine:{name}").preset), one["preset"])
        assert (library.read_certificate(name) is None) == (one["certificate"] is None)
    assert library.deleted() == before["deleted"]
    for name, one in before["trash"].items():
        assert contains(values(preset.load(library.folder / ".trash" / name)), one)


def test_what_was_deleted_can_be_restored(old: Path, expected: dict[str, Any], tmp_path: Path):
    shutil.copytree(old / "data" / "presets", tmp_path / "presets")
    library = Library(tmp_path / "presets")
    for mark in expected["library"]["deleted"]:
        assert library.restore(mark) in library.stamps()


def test_presets_of_every_family_and_effect_load_and_their_certificates_say_the_same(
    old: Path, expected: dict[str, Any]
):
    for name, before in expected["presets"].items():
        assert contains(values(preset.load(old / "presets" / name)), before["preset"])
        judge(old / "presets" / name, before)


def judge(path: Path, before: dict[str, Any]) -> None:
    """The certificate is read without loss, and verification finds as many faults as version 0.1.0 found."""
    stored = certificate.loads(certificate.path_for(path).read_bytes(), source=path.name)
    assert contains(values(certificate.to_builtins(stored)), before["says"])
    assert sha256(certificate.dumps(stored)) == before["dumped_sha256"]
    assert len(certificate.verify_file(path, readers=exports.readers())) == len(before["verify"])


def test_the_pages_bundle_is_taken_for_the_preset_in_it_and_every_file_verifies(
    old: Path, expected: dict[str, Any], tmp_path: Path
):
    ((name, before),) = [(name, one) for name, one in expected["bundle"].items() if name.endswith(".zip")]
    content = (old / "bundle" / name).read_bytes()
    assert contains(values(preset_in(ImportFile(name, content))), before["preset"])
    with zipfile.ZipFile(old / "bundle" / name) as bundle:
        bundle.extractall(tmp_path)
    assert before["verify"]
    for part, one in before["verify"].items():
        judge(tmp_path / part, one)


def test_a_downloaded_preset_loads(old: Path, expected: dict[str, Any]):
    for name, before in expected["bundle"].items():
        if name.endswith(".toml"):
            assert contains(values(preset.load(old / "bundle" / name)), before)


@pytest.mark.parametrize("form", list(EXPORTS))
def test_an_exported_file_verifies_and_is_imported_as_before(form: str, old: Path, expected: dict[str, Any]):
    path, before = old / "exports" / EXPORTS[form], expected["exports"][EXPORTS[form]]
    judge(path, before)
    understood = before["import"]
    if understood is None or "refused" in understood:
        return
    read = formats.read(path, form, confirm={"frame": "z-up"} if form == "tum" else None)
    assert (read.rows, read.rate, read.duration) == tuple(understood[key] for key in ("rows", "rate", "duration"))
    fingerprint = None if read.path is None else provenance.fingerprint(read.path)
    if form == "tum":  # a curve near positions, which 0.1.0 forced to rest at its ends
        assert isinstance(read.path, Waypoints)
        assert read.path.free_ends
    else:
        assert fingerprint == understood["path_fingerprint"]
    assert (read.unjudged is None) == (understood["unjudged"] is None)
