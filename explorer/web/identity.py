"""The session key `<id>-<slot>` of a tab: the id of its browser and the slot of the tab. Checked against viser 1.1.1.

The id is in the browser's localStorage, which all its tabs share. The slot is in the tab's sessionStorage, which
survives a reload of the page and a restart of the server. The work of a tab is saved under its session key, so no tab
overwrites the work of another, and each gets its own work back, in whatever order they reconnect. A new tab takes the
lowest slot that no connected tab has, and the work saved there.

viser reads localStorage only, so a script copies the slot there for as long as it takes to read it.
"""

import asyncio
import itertools
import re
import threading
from collections.abc import Callable

import viser
from websockets.exceptions import ConnectionClosed

from explorer.storage.work_files import StorageError, new_browser_id
from explorer.web.connection import run_script

KEY, SLOT_KEY, PREFIX = "rangenav-visitor", "rangenav-slot", "viser-user:"
"""Names in the browser's storages, and the prefix that viser adds in localStorage."""
BROWSER, SLOT = re.compile(r"[0-9a-f]{32}"), re.compile(r"[1-9][0-9]?")
MAX_SLOTS = 99
COPIES = 16
"""How many names the copied slot may have: tabs that reconnect at the same moment use different ones."""
ANSWER_TIMEOUT = 20.0
"""s for a browser to answer. A browser that refuses storage answers at once. A browser that renders in software draws
its first picture before it answers, and needed six seconds."""
PONG_TIMEOUT = 2.0
"""s; a browser answers a ping at once, also for a tab in the background."""
LEAVE_TIMEOUT = 2.0
"""s for a tab that has left to write its work, before another tab may take its slot."""


class Slots:
    """Which connected tab has which slot of which browser; all sessions share it."""

    def __init__(self, alive: Callable[[int], bool]) -> None:
        """`alive` returns whether the tab of a client id is still connected; it may take seconds."""
        self._alive = alive
        self._tabs: dict[tuple[str, int], int] = {}
        self._changed = threading.Condition()

    def take(self, browser: str, tab: int, wanted: int | None = None) -> int:
        """Take the `wanted` slot if it is free, else the lowest free one. Raises StorageError if there is none."""
        order = range(1, MAX_SLOTS + 1)
        for slot in order if wanted is None else itertools.chain([wanted], order):
            if self._claim(browser, slot, tab):
                return slot
        raise StorageError(f"your work is not kept: this browser already has {MAX_SLOTS} tabs on this page")

    def free(self, tab: int) -> None:
        """Free the slot of a tab that has left and has written its work."""
        with self._changed:
            self._tabs = {key: holder for key, holder in self._tabs.items() if holder != tab}
            self._changed.notify_all()

    def has(self, tab: int) -> bool:
        """Whether the tab has a slot; a tab that did not answer a ping may have lost its slot to another."""
        with self._changed:
            return tab in self._tabs.values()

    def _claim(self, browser: str, slot: int, tab: int) -> bool:
        key = browser, slot
        holder = self._tabs.get(key)
        if holder is not None:
            if self._alive(holder):
                return False
            with self._changed:
                self._changed.wait_for(lambda: self._tabs.get(key) != holder, LEAVE_TIMEOUT)
        with self._changed:
            if self._tabs.get(key) not in (None, holder):
                return False
            self._tabs[key] = tab
            return True


def session_key(client: viser.ClientHandle, slots: Slots) -> str | None:
    """The session key of a tab, None if its browser stores nothing. Free the slot when the tab has left.

    This waits for the browser until a time-out: do not call it on the event loop, and call it before there is much to
    draw. Raises StorageError with one sentence if the browser has too many tabs.
    """
    browser = browser_id(client)
    if browser is None:
        return None
    slot = slots.take(browser, client.client_id, stored_slot(client))
    run_script(client, f"sessionStorage.setItem('{SLOT_KEY}', '{slot}')")
    return f"{browser}-{slot}"


def browser_id(client: viser.ClientHandle) -> str | None:
    """The id of the browser, which is stored there at the first visit.

    None if the browser refuses storage, does not answer in time, or stores nothing."""
    storage = client.local_storage
    try:
        answer = storage.get_item(KEY, timeout=ANSWER_TIMEOUT)
        if not _matches(BROWSER, answer):
            storage.set_item(KEY, new_browser_id())
            answer = storage.get_item(KEY, timeout=ANSWER_TIMEOUT)  # another tab may have been faster
    except (RuntimeError, TimeoutError):
        return None
    return answer if _matches(BROWSER, answer) else None


def stored_slot(client: viser.ClientHandle) -> int | None:
    """The slot that this tab had before a reload or a lost connection; None for a new tab."""
    name = f"{SLOT_KEY}-{client.client_id % COPIES}"
    run_script(client, f"localStorage.setItem('{PREFIX}{name}', sessionStorage.getItem('{SLOT_KEY}') ?? '')")
    try:
        answer = client.local_storage.get_item(name, timeout=ANSWER_TIMEOUT)
        client.local_storage.remove_item(name)
    except (RuntimeError, TimeoutError):
        return None
    return int(answer) if answer is not None and _matches(SLOT, answer) else None


def connected(server: viser.ViserServer, tab: int) -> bool:
    """Whether the tab of a client id answers a ping: viser closes a dead connection only after 45 s."""
    websocket = server._websock_server
    connection, loop = websocket._live_connections.get(tab), websocket._background_event_loop
    if connection is None or loop is None:
        return False

    async def ping() -> None:
        async with asyncio.timeout(PONG_TIMEOUT):
            await (await connection.ping())

    try:
        asyncio.run_coroutine_threadsafe(ping(), loop).result(PONG_TIMEOUT + LEAVE_TIMEOUT)
    except (ConnectionClosed, TimeoutError, RuntimeError):  # RuntimeError: the loop has just been closed
        return False
    return True


def _matches(pattern: re.Pattern[str], answer: object) -> bool:
    """Whether the answer of a browser, which may be anything, is text of the expected form."""
    return isinstance(answer, str) and pattern.fullmatch(answer) is not None
