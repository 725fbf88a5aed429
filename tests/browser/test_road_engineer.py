"""The engineer's road: a planned path becomes a certified file that a Crazyflie flies, in ten actions at most."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser

from rangenav import certificate
from rangenav.certificate import exports
from rangenav.formats.polynomial import NAMES
from rangenav.signals import MinimumSnap, Waypoint
from rangenav.signals.polynomials import from_minimum_snap
from tests.browser.page import COARSE, Server, Visitor

MOST_ACTIONS = 10
CORNERS = (
    (0.0, 0.0),
    (0.7, 0.5),
    (1.0, 0.0),
    (0.7, -0.5),
    (0.0, 0.0),
    (-0.7, 0.5),
    (-1.0, 0.0),
    (-0.7, -0.5),
    (0.0, 0.0),
)
"""m: a level figure eight, which ends where it begins."""


def figure_eight() -> bytes:
    """Pieces of a planner: from rest to rest in 8 s."""
    points = tuple(Waypoint(time=float(k), value=(x, y, 0.0)) for k, (x, y) in enumerate(CORNERS))
    pieces = from_minimum_snap(MinimumSnap(points=points)).pieces
    rows = [",".join(map(repr, (piece.duration, *piece.x, *piece.y, *piece.z, *piece.yaw))) for piece in pieces]
    return "\n".join([",".join(NAMES), *rows, ""]).encode()


class Counted:
    """A visitor whose actions are counted: what a person clicks, chooses or hands over."""

    def __init__(self, visitor: Visitor) -> None:
        self.visitor, self.actions = visitor, 0

    def do(self, name: str, *arguments: object) -> None:
        """One action of the visitor."""
        self.actions += 1
        getattr(self.visitor, name)(*arguments)


def packed_by(tab: Counted, button: str) -> zipfile.ZipFile:
    """The zip that a button downloads."""
    with tab.visitor.page.expect_download() as coming:
        tab.do("press", button)
    return zipfile.ZipFile(io.BytesIO(Path(coming.value.path()).read_bytes()))


def test_a_planned_path_becomes_a_certified_loop_of_a_crazyflie(server: Server, browser: Browser, tmp_path: Path):
    visitor = Visitor(browser, server.url, density=COARSE)
    visitor.dismiss_notifications()
    tab = Counted(visitor)
    tab.do("tab", "Presets")
    tab.do("folder", "Import a path or a recorded flight")
    tab.do("choose", "to be flown by", "Crazyflie 2.1")
    tab.do("upload", "Upload a file", "eight.csv", figure_eight())
    visitor.wait_for_text("the path ends where it begins, so it repeats: 3 loops of 8 s in the 24 s of flight")
    visitor.wait_for_text("the anchor stands at (0, 0, -1.1) m")
    tab.do("press", "make it observable")
    visitor.wait_for_text("added a tone of ")
    tab.do("press", "Accept the motion")
    visitor.wait_for_node("/pinned_trail")
    tab.do("folder", "Download with certificate")
    packed_by(tab, "Export as a zip").extractall(tmp_path)
    assert tab.actions <= MOST_ACTIONS
    assert visitor.complaints == []
    visitor.close()

    (file,) = tmp_path.glob("*.polynomial.csv")
    assert certificate.verify_file(file, readers=exports.readers()) == ()
    issued = certificate.read_stored(file)
    assert issued.certified
    assert issued.vehicle.name == "Crazyflie 2.1"
    assert issued.claim.starts == "every t >= 0"  # flown again and again
    assert f"pieces 1 to {first_piece(issued, file) - 1} are the ramp in (2 s)" in (tmp_path / "README.txt").read_text()
    compile(next(tmp_path.glob("fly_*.py")).read_text(), "fly.py", "exec")
    memory = pytest.importorskip("cflib.crazyflie.mem.trajectory_memory", reason="cflib is not installed")
    rows = np.loadtxt(file, delimiter=",", skiprows=1)
    sent = b"".join(
        memory.Poly4D(row[0], *(memory.Poly4D.Poly(list(row[k : k + 8])) for k in (1, 9, 17, 25))).pack()
        for row in rows
    )
    assert len(sent) <= 4096  # the trajectory memory of a Crazyflie


def first_piece(issued: certificate.Certificate, file: Path) -> int:
    """The first piece of the loop, from 1, by the certificate's own times."""
    loop = issued.artifact.loop
    assert loop
    ends = np.cumsum(np.loadtxt(file, delimiter=",", skiprows=1)[:, 0])
    return int(np.argmin(np.abs(ends - loop.begin))) + 2


def test_a_refused_export_offers_its_cure_as_a_button_and_no_format_gives_no_zip(server: Server, browser: Browser):
    visitor = Visitor(browser, server.url, density=COARSE)
    visitor.dismiss_notifications()
    tab = Counted(visitor)
    visitor.tab("Presets")
    visitor.choose("preset", "(circle)")
    visitor.wait_for_text("nothing excites z")
    visitor.folder("Download with certificate")
    visitor.press("Export as a zip")
    visitor.wait_for_text("no format is chosen")
    visitor.beside("polynomials").locator("input").check()
    visitor.press("Export as a zip")
    visitor.wait_for_text("What cures it (polynomials)")
    packed = packed_by(tab, "Add for example a tone of 0.064 m at 4 rad/s along z with phase 0")
    assert any(name.endswith(".polynomial.csv.certificate.json") for name in packed.namelist())
    visitor.wait_for_no_text("nothing excites z")
    assert visitor.complaints == []
    visitor.close()
