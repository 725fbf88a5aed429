"""Takes the pictures of the page for README and docs: `python -m tests.browser.screenshots [FOLDER]`."""

import sys
import time
from pathlib import Path

from tests.browser.page import Visitor, chromium, served

SIZES = ((1920, 1080), (1366, 768))
MOMENT = "12.4"
"""s: the estimate has converged, and vehicle and estimate can still be told apart."""
BESIDE = "side-by-side-1366x768.png"
"""The printed condition beside the derived one, in big type."""
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
    return written


if __name__ == "__main__":
    for path in take(Path(sys.argv[1] if len(sys.argv) > 1 else "docs")):
        print(path)
