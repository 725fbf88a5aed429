"""`rangenav-explorer --check`: what works is said, and what does not names the part and the way out."""

from pathlib import Path

import pytest

from explorer.server import installation
from explorer.server.installation import checks
from explorer.web.door import FOLDER
from rangenav import preset

pytestmark = pytest.mark.slow


def test_every_part_of_this_installation_works(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the presets two: the certificates of all are verified by tests of their own."""
    some = {name: preset.load(name) for name in ("hover", "circle")}
    monkeypatch.setattr(installation.preset, "shipped", lambda: some)
    tried = list(checks())
    assert [str(one) for one in tried if not one.works] == []
    assert [one.part for one in tried] == [
        "viser", "page", "kernels", "presets", "lessons", "work folder", "preset folder"
    ]  # fmt: skip


def test_every_file_that_the_page_is_made_of_is_looked_for() -> None:
    there = {
        path.relative_to(FOLDER).as_posix() for path in FOLDER.rglob("*") if path.suffix in {".js", ".css", ".html"}
    }
    assert set(installation.SCRIPTS) == there


def test_what_does_not_work_is_named_with_the_way_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "a-file"
    file.write_text("in the way", encoding="utf-8")
    monkeypatch.setenv("RANGENAV_STATE", str(file))
    monkeypatch.setattr(installation, "CHECKED_AGAINST", "9.9.9")
    monkeypatch.setattr(installation, "EXPECTED_RANKS", {"hover": 13})
    monkeypatch.setattr(installation.preset, "shipped", dict)
    failed = {one.part: str(one) for one in checks() if not one.works}
    assert set(failed) == {"viser", "kernels", "work folder"}
    assert failed["viser"].startswith("✗ viser")
    assert "checked against 9.9.9 → install viser 9.9.9" in failed["viser"]
    assert "hover has rank 5 in place of 13" in failed["kernels"]
    assert "a-file" in failed["work folder"]
    assert "set RANGENAV_STATE to another folder" in failed["work folder"]
