"""Takes the pictures of the page for README and docs: `python -m tests.browser.screenshots [FOLDER]`."""

import sys
import time
from pathlib import Path

from tests.browser.page import Visitor, chromium, served

SIZES = ((1920, 1080), (1366, 768))
MOMENT = "12.4"
"""s: the estimate has converged, and vehicle and estimate can still be told apart."""
SETTLE = 3.0
"""s: a software renderer needs them for the last frame."""


def take(folder: Path) -> list[Path]:
    """One picture for each size of window; the paths of the files written."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    with served() as server, chromium() as browser:
        for width, height in SIZES:
            visitor = Visitor(browser, server.url, width=width, height=height)
            visitor.dismiss_notifications()
            visitor.type_number("t (s)", MOMENT)
            visitor.page.mouse.move(width / 2, height / 3)
            time.sleep(SETTLE)
            written.append(folder / f"page-{width}x{height}.png")
            visitor.page.screenshot(path=written[-1])
            visitor.close()
    return written


if __name__ == "__main__":
    for path in take(Path(sys.argv[1] if len(sys.argv) > 1 else "docs")):
        print(path)
