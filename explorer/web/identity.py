"""Who is back: the id of a visitor's browser and the slot of each of its tabs. Checked against viser 1.1.1.

The browser keeps the id in its localStorage, which all its tabs share; the tab keeps its slot in its sessionStorage,
which a reload and a restarted server leave alone. Work is kept under `<id>-<slot>`: no tab overwrites another's, and
each gets its own work back, in whatever order they reconnect. A new tab takes the lowest slot that no connected tab
has, and with it what was left there.

viser offers localStorage only; the slot is copied there for as long as it takes to read it.
"""

import asyncio
import itertools
import re
import threading
from collections.abc import Callable

import viser
from viser import _messages
from websockets.exceptions import ConnectionClosed

from explorer.storage.work_files import StorageError, new_browser_id

KEY, SLOT_KEY, PREFIX = "rangenav-visitor", "rangenav-slot", "viser-user:"
"""Our names in the browser's storages, and what viser puts before its own in localStorage."""
BROWSER, SLOT = re.compile(r"[0-9a-f]{32}"), re.compile(r"[1-9][0-9]?")
MAX_SLOTS = 99
COPIES = 16
"""Names for a copied slot, so that tabs which reconnect at the same moment do not read each other's."""
PATIENCE = 20.0
"""s for a browser to answer. One that refuses says so at once; a busy one that renders in software, and draws its first
picture before it answers, was seen to need six."""
PONG_PATIENCE = 2.0
"""s; a tab's browser answers a ping at once, also when the tab is in the background."""
LEAVING = 2.0
"""s that a tab which has gone is given to write its last work, before its slot goes to another."""


class Slots:
    """Which connected tab has which slot of which browser. Shared by all sessions."""

    def __init__(self, alive: Callable[[int], bool]) -> None:
        """`alive` tells of a tab's number whether it is still connected; it may take its time."""
        self._alive = alive
        self._tabs: dict[tuple[str, int], int] = {}
        self._changed = threading.Condition()

    def take(self, browser: str, tab: int, wanted: int | None = None) -> int:
        """The wanted slot if no living tab has it, else the lowest free one. Raises StorageError if there is none."""
        order = range(1, MAX_SLOTS + 1)
        for slot in order if wanted is None else itertools.chain([wanted], order):
            if self._claim(browser, slot, tab):
                return slot
        raise StorageError(f"your work is not kept: this browser already has {MAX_SLOTS} tabs on this page")

    def free(self, tab: int) -> None:
        """The tab has gone, and has written what it had to write."""
        with self._changed:
            self._tabs = {place: holder for place, holder in self._tabs.items() if holder != tab}
            self._changed.notify_all()

    def has(self, tab: int) -> bool:
        """Whether the tab still has a slot to write to; one that was thought dead may have lost it."""
        with self._changed:
            return tab in self._tabs.values()

    def _claim(self, browser: str, slot: int, tab: int) -> bool:
        place = browser, slot
        holder = self._tabs.get(place)
        if holder is not None:
            if self._alive(holder):
                return False
            with self._changed:
                self._changed.wait_for(lambda: self._tabs.get(place) != holder, LEAVING)
        with self._changed:
            if self._tabs.get(place) not in (None, holder):
                return False
            self._tabs[place] = tab
            return True


def session_key(client: viser.ClientHandle, slots: Slots) -> str | None:
    """The name `<id>-<slot>` under which this tab's work is kept, None if its browser keeps nothing.

    Waits for the browser, but not for ever: never call it on the event loop, and best before there is much to draw.
    Free the slot when the tab has gone.
    Raises StorageError with one sentence if this browser has too many tabs.
    """
    browser = visitor_of(client)
    if browser is None:
        return None
    slot = slots.take(browser, client.client_id, slot_of(client))
    _run(client, f"sessionStorage.setItem('{SLOT_KEY}', '{slot}')")
    return f"{browser}-{slot}"


def visitor_of(client: viser.ClientHandle) -> str | None:
    """The id of the visitor's browser, left there at the first visit.

    None if the browser refuses storage, does not answer in time, or does not keep what it is given."""
    storage = client.local_storage
    try:
        found = storage.get_item(KEY, timeout=PATIENCE)
        if not _fits(BROWSER, found):
            storage.set_item(KEY, new_browser_id())
            found = storage.get_item(KEY, timeout=PATIENCE)  # also when another tab was first
    except (RuntimeError, TimeoutError):
        return None
    return found if _fits(BROWSER, found) else None


def slot_of(client: viser.ClientHandle) -> int | None:
    """The slot this tab had before it was reloaded or lost its connection, None for a new tab."""
    name = f"{SLOT_KEY}-{client.client_id % COPIES}"
    _run(client, f"localStorage.setItem('{PREFIX}{name}', sessionStorage.getItem('{SLOT_KEY}') ?? '')")
    try:
        found = client.local_storage.get_item(name, timeout=PATIENCE)
        client.local_storage.remove_item(name)
    except (RuntimeError, TimeoutError):
        return None
    return int(found) if found is not None and _fits(SLOT, found) else None


def connected(server: viser.ViserServer, tab: int) -> bool:
    """Whether the tab of this number still answers: its connection may be dead for 45 s before viser gives it up."""
    websocket = server._websock_server
    connection, loop = websocket._live_connections.get(tab), websocket._background_event_loop
    if connection is None or loop is None:
        return False

    async def ping() -> None:
        async with asyncio.timeout(PONG_PATIENCE):
            await (await connection.ping())

    try:
        asyncio.run_coroutine_threadsafe(ping(), loop).result(PONG_PATIENCE + LEAVING)
    except (ConnectionClosed, TimeoutError, RuntimeError):  # RuntimeError: the loop has just been closed
        return False
    return True


def _run(client: viser.ClientHandle, script: str) -> None:
    """Have the browser run one statement of ours; it may fail where storage is refused."""
    source = f"try {{ {script} }} catch (refused) {{ console.info(String(refused)) }}"
    client._websock_connection.queue_message(_messages.RunJavascriptMessage(source))


def _fits(pattern: re.Pattern[str], found: object) -> bool:
    """Whether a browser's answer, which may be anything, is of our making."""
    return isinstance(found, str) and pattern.fullmatch(found) is not None
