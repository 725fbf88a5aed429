"""Pages of a browser that one visitor has left and another one takes, with nothing of the first on them.

A new page begins a process and compiles viser's scripts there: that takes as long as to load and draw the page. In a
page that has been used both are there.
"""

from typing import NamedTuple

from playwright.sync_api import Browser, Error, Page, ViewportSize

EMPTY = "/healthz"
"""A page of the same server without scripts."""
FORGET = "() => { localStorage.clear(); sessionStorage.clear(); }"


class Kind(NamedTuple):
    """What cannot be changed about a page."""

    browser: Browser
    density: float
    """Pixels of the screen for each pixel of the page."""
    scripts: tuple[str, ...]
    """What runs before the page's own scripts."""


_left: dict[Kind, list[Page]] = {}


def take(kind: Kind, size: ViewportSize) -> Page:
    """A page in a window of this size (px), with nothing stored."""
    if _left.get(kind):
        page = _left[kind].pop()
        page.set_viewport_size(size)
        return page
    context = kind.browser.new_context(viewport=size, device_scale_factor=kind.density)
    for script in kind.scripts:
        context.add_init_script(script)
    return context.new_page()


def leave(kind: Kind, page: Page) -> None:
    """End the visit, and forget what was stored; where the server has ended, the page is closed."""
    context = page.context
    try:
        page.goto(page.evaluate("location.origin") + EMPTY)
        page.evaluate(FORGET)
    except Error:
        context.close()
        return
    for other in context.pages[1:]:
        other.close()
    context.clear_cookies()
    context.clear_permissions()
    page.emulate_media(color_scheme="light", reduced_motion="no-preference")
    _left.setdefault(kind, []).append(page)
