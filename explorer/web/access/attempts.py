"""How often codes may be tried: a few times per browser, and slowly by all together; and how often a visitor may load
the page.

Addresses are not counted: a class shares one.
"""

from collections import OrderedDict

from explorer.web.bucket import Bucket

PER_BROWSER = (8.0, 0.2)
"""Attempts at once, and attempts per second after that, of one browser."""
TOGETHER = (40.0, 2.0)
"""The same for all browsers together: a class of forty may type at the same moment."""
CONNECTS = (20.0, 0.5)
"""Websockets that one visitor may open at once, and per second after that: each reload of a page opens one."""
MAX_BROWSERS = 4096
"""Browsers that are remembered; beyond that the ones longest ago are forgotten."""


class Attempts:
    """All attempts at codes. Not safe for threads: its owner holds a lock."""

    def __init__(self, now: float) -> None:
        self._together = _full(TOGETHER, now)
        self._browsers: OrderedDict[str, Bucket] = OrderedDict()

    def wait(self, browser: str, now: float) -> float:
        """s until a browser may try a code; 0 if it may now, and then the attempt is counted.

        browser: an identifier; browsers without one share one supply of attempts."""
        own = self._browsers.pop(browser, None) or _full(PER_BROWSER, now)
        self._browsers[browser] = own
        while len(self._browsers) > MAX_BROWSERS:
            self._browsers.popitem(last=False)
        wait = max(own.wait(now), self._together.wait(now))
        if wait == 0:
            own.take()
            self._together.take()
        return wait


class Connects:
    """The websockets that each visitor opens. Not safe for threads: its owner holds a lock."""

    def __init__(self) -> None:
        self._visitors: dict[int, Bucket] = {}

    def wait(self, visitor: int, now: float) -> float:
        """s until a visitor, by number, may open a websocket; 0 if one may be opened now, which is then counted."""
        own = self._visitors.setdefault(visitor, _full(CONNECTS, now))
        wait = own.wait(now)
        if wait == 0:
            own.take()
        return wait


def _full(size_and_rate: tuple[float, float], now: float) -> Bucket:
    size, rate = size_and_rate
    return Bucket(size=size, rate=rate, level=size, at=now)
