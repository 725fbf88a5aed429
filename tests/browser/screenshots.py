"""Takes the pictures of the page for README and docs: `python -m tests.browser.screenshots [FOLDER]`."""

import sys
import time
from pathlib import Path

from playwright.sync_api import Browser

from tests.browser.page import Visitor, chromium, served

SIZES = ((1920, 1080), (1366, 768))
MOMENT = "12.4"
"""s: the estimate has converged, and vehicle and estimate can still be told apart."""
BESIDE = "side-by-side-1366x768.png"
"""The printed condition beside the derived one, in big type."""
CLASS = ("class-teacher-1366x768.png", "class-student-1366x768.png")
"""A page that is presented, and one that follows it."""
SETTLE = 3.0
"""s: a software renderer needs them for the last frame."""


def take(folder: Path) -> list[Path]:
    """One picture for each size of window, and one of two runs side by side; the paths of the files written."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    with served() as server, chromium() as browser:
        for width, height in SIZES:
            visitor = Visitor(browser, server.url, width=width, height=height, drawn=True)
            visitor.dismiss_notifications()
            visitor.type_number("t (s)", MOMENT)
            visitor.page.mouse.move(width / 2, height / 3)
            time.sleep(SETTLE)
            written.append(folder / f"page-{width}x{height}.png")
            visitor.page.screenshot(path=written[-1])
            visitor.close()
        visitor = Visitor(browser, f"{server.url}?present", drawn=True)
        visitor.dismiss_notifications()
        visitor.tab("Presets")
        visitor.folder("As printed in the paper")
        visitor.press("Printed against derived, on a hover")
        visitor.wait_for_text("✓ holds: printed μ 16")
        visitor.page.mouse.move(300, 600)
        time.sleep(SETTLE)
        written.append(folder / BESIDE)
        visitor.page.screenshot(path=written[-1])
        visitor.close()
        written += take_class(folder, browser)
    return written


def take_class(folder: Path, browser: Browser) -> list[Path]:
    """The pictures of a teacher's page and of a student's; the paths of the files written."""
    with served("--host", "0.0.0.0") as server:
        links = server.url.split()[-1], server.next_line().split()[-1]
        teacher, student = (Visitor(browser, link, drawn=True) for link in links)
        for tab in (teacher, student):
            tab.dismiss_notifications()
        teacher.type_number("t (s)", MOMENT)
        teacher.press("Present my page")
        student.wait_for_text("You follow the teacher")
        student.tab("Motion")
        time.sleep(SETTLE)
        written = [folder / name for name in CLASS]
        for tab, path in zip((teacher, student), written, strict=True):
            tab.page.mouse.move(700, 400)
            tab.page.screenshot(path=path)
        for tab in (student, teacher):  # whoever presents leaves last
            tab.close()
    return written


if __name__ == "__main__":
    for path in take(Path(sys.argv[1] if len(sys.argv) > 1 else "docs")):
        print(path)
