"""The Presets tab in a real Chromium: presets kept and found again, files handed over and taken away, a repair."""

import io
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from rangenav import certificate, formats, preset
from tests.browser.page import Visitor, until

SHIPPED = preset.shipped()
BLIND = "✕ nothing excites z"
"""What the verdict says of a level circle."""


@pytest.fixture
def visitor(narrow_page: Visitor, request: pytest.FixtureRequest) -> Iterator[Visitor]:
    """The page with the first preset on it, whatever was there before."""
    narrow_page.begin_anew(request.session.testsfailed, tab="Presets")
    yield narrow_page
    assert narrow_page.complaints == []


def _wait_for_preset(visitor: Visitor, ending: str) -> None:
    until(lambda: visitor.typed("preset").endswith(ending), ending)


def _folder(visitor: Visitor, label: str, inside: str) -> None:
    """Open a folder, if it is closed: then what is inside cannot be seen."""
    button = visitor.page.get_by_role("button", name=inside, exact=True)
    if not button.is_visible():
        visitor.folder(label)


def _reload(visitor: Visitor, origin: str) -> None:
    """Reload the page once the work on this preset has been saved."""
    visitor.wait_until_saved(f'"origin":"{origin}"')
    visitor.reload()
    visitor.tab("Presets")


def test_a_preset_is_kept_found_after_a_reload_renamed_deleted_and_brought_back_after_another(visitor: Visitor):
    visitor.type_text("title", "Mein Flug / <b>eins</b>")
    visitor.press("save as")
    visitor.wait_for_text("✓ saved as mein-flug-b-eins-b.toml")
    _reload(visitor, "mine:mein-flug-b-eins-b")
    _wait_for_preset(visitor, "★ Mein Flug / <b>eins</b> (mein-flug-b-eins-b)")
    visitor.wait_for_text("● CERTIFIED OBSERVABLE")
    visitor.press("see all")
    visitor.wait_for_text("● ★ mein-flug-b-eins-b")
    visitor.type_text("title", "Zwei")
    visitor.press("rename")
    visitor.wait_for_text("✓ renamed to zwei.toml")
    visitor.wait_for_text("● ★ zwei")
    visitor.press("delete")
    visitor.wait_for_text("zwei.toml is in the trash")
    visitor.wait_for_no_text("★ zwei")
    _reload(visitor, "mine:zwei")
    _wait_for_preset(visitor, "◌ Zwei, not saved (zwei)")
    visitor.press("undo delete")
    visitor.wait_for_text("✓ zwei.toml is back")


def test_a_tile_opens_its_preset_and_the_neighbours_are_a_button_away(visitor: Visitor):
    visitor.press("see all")
    visitor.page.locator("button.tile", has_text="helix").click()
    visitor.wait_for_text("✕ CERTIFIED UNOBSERVABLE")
    _wait_for_preset(visitor, "(helix)")
    visitor.press("next ›")
    _wait_for_preset(visitor, "(hover)")
    assert visitor.page.get_by_role("button", name="helix", exact=True).count() == 0  # tiles are all that is seen
    visitor.press("see all")


def test_an_uploaded_preset_is_opened_and_a_broken_one_is_a_sentence_that_loses_nothing(visitor: Visitor):
    content = preset.dumps(SHIPPED["barrel"])
    visitor.upload("Upload a preset", "soft.toml", content.replace("duration = 30.0", "duration = -1.0").encode())
    visitor.wait_for_text("soft.toml: ")
    visitor.wait_for_text("⚠")
    assert visitor.typed("preset").endswith("(paper-slow)")
    visitor.upload("Upload a preset", "soft.toml", content.encode())
    visitor.wait_for_text("✓ soft.toml joined your library as barrel-for-a-crazyflie.toml")
    visitor.wait_for_no_text("⚠")
    assert visitor.typed("preset") == "★ Barrel for a Crazyflie (barrel-for-a-crazyflie)"


def test_the_zip_holds_the_preset_its_certificate_and_the_format_chosen(visitor: Visitor, tmp_path: Path):
    _folder(visitor, "Download with certificate", "Export as a zip")
    visitor.beside("TUM").locator("input").check()
    with visitor.page.expect_download() as coming:
        visitor.press("Export as a zip")
    assert coming.value.suggested_filename == "paper-slow.zip"
    with zipfile.ZipFile(coming.value.path()) as packed:
        packed.extractall(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {
        *("paper-slow.toml", "paper-slow.certificate.json", "README.txt"),
        *("paper-slow.tum.txt", "paper-slow.tum.txt.certificate.json"),
    }
    assert certificate.verify_file(tmp_path / "paper-slow.toml") == ()
    assert formats.read(tmp_path / "paper-slow.tum.txt", "tum").rows > 1000
    altered = (tmp_path / "paper-slow.toml").read_text().replace("seed = 1", "seed = 2", 1)
    (tmp_path / "paper-slow.toml").write_text(altered)
    assert certificate.verify_file(tmp_path / "paper-slow.toml") != ()


def test_a_blind_motion_is_not_exported_but_repaired_accepted_and_certified(visitor: Visitor, tmp_path: Path):
    visitor.choose("preset", "(circle)")
    visitor.wait_for_text(BLIND)
    _folder(visitor, "Download with certificate", "Export as a zip")
    visitor.press("none")
    until(lambda: not visitor.beside("TUM").locator("input").is_checked(), "no format")
    visitor.beside("polynomials").locator("input").check()
    _folder(visitor, "Repair", "Make it observable")
    visitor.press("Export as a zip")
    visitor.wait_for_text("• the rank is 11 of 13")
    visitor.wait_for_text("add for example a tone of")
    visitor.press("Make it observable")
    visitor.wait_for_text("Proposed, green in the scene")
    visitor.wait_for_text(BLIND)
    visitor.press("Accept the motion")
    visitor.wait_for_no_text(BLIND)
    visitor.wait_for_no_text("add for example a tone of")  # said of what is no longer on the page
    visitor.wait_for_node("/pinned_trail")
    visitor.press("save as")
    visitor.wait_for_text("● CERTIFIED OBSERVABLE")
    with visitor.page.expect_download() as coming:
        visitor.press("Export as a zip")
    with zipfile.ZipFile(coming.value.path()) as packed:
        packed.extractall(tmp_path)
    (kept,) = tmp_path.glob("*.toml")
    assert len(list(tmp_path.glob("*.polynomial.csv"))) == 1
    assert kept.stem == "horizontal-circle-anchor-1-5-m-off-its-plane-repaired"
    assert certificate.verify_file(kept) == ()


def _reference(rows: int = 400) -> bytes:
    """A small reference file: columns in an order of their own, and exact derivatives of an eight that also rises."""
    time = np.arange(rows) / 100
    table = {"t": time}
    for axis, (size, rate) in {"z": (0.2, 3.0), "x": (1.0, 1.5), "y": (0.5, 3.0)}.items():
        for name, order in (("p", 0), ("v", 1), ("a_lin", 2), ("jerk", 3), ("snap", 4)):
            table[f"{name}_{axis}"] = size * rate**order * np.sin(rate * time + order * np.pi / 2)
    text = io.StringIO()
    np.savetxt(text, np.column_stack(list(table.values())), delimiter=",", header=",".join(table), comments="")
    return text.getvalue().encode()


@pytest.mark.parametrize("asks", [False, True], ids=["reference", "TUM"])
def test_a_path_is_understood_asked_about_if_need_be_and_opened(visitor: Visitor, tmp_path: Path, asks: bool):
    _folder(visitor, "Import a path or a recorded flight", "Upload a file")
    if asks:
        formats.export(SHIPPED["paper-slow"], "tum", tmp_path / "x.txt")
        poses = [line for line in (tmp_path / "x.txt").read_text().splitlines() if not line.startswith("#")]
        visitor.upload("Upload a file", "my_poses.txt", "\n".join(poses).encode())
        visitor.wait_for_text("which way does z point?")
        assert visitor.typed("preset").endswith("(paper-slow)")  # nothing is used before that is answered
        visitor.press("Confirm the answers")
    else:
        visitor.upload("Upload a file", "my_tour.csv", _reference())
    visitor.wait_for_text("opened as a preset that is not saved yet")
    _wait_for_preset(visitor, "◌ my_poses, not saved (my-poses)" if asks else "◌ my_tour, not saved (my-tour)")
    assert f"• my_{'poses' if asks else 'tour'}." in visitor.text()
    visitor.page.mouse.click(5, 5)
    visitor.page.keyboard.press("Control+z")
    _wait_for_preset(visitor, "(paper-slow)")
