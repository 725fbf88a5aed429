"""A returning visitor has the same session key: one id for a browser, one slot for a tab; invalid keys are refused."""

import base64
import os
import socket
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import pytest
import viser

from explorer.storage.work_files import StorageError
from explorer.web import identity, security, values
from explorer.web.identity import KEY, SLOT_KEY, Slots
from tests.support import wire
from tests.support.wire import Storage, Wire

pytestmark = pytest.mark.slow


BROWSER, OTHER = "a" * 32, "b" * 32


@dataclass
class Page:
    """A guarded server that asks every connecting tab for its session key."""

    server: viser.ViserServer
    slots: Slots
    session_keys: dict[int, str | None] = field(default_factory=dict)

    @property
    def port(self) -> int:
        return self.server.get_port()

    def join(self, storage: Storage) -> tuple[Wire, str | None]:
        """Connect a tab. Returns the tab and its session key."""
        before = set(self.session_keys)
        tab = Wire(self.port, storage=storage)
        tab.wait_for(lambda: set(self.session_keys) - before, "a session key")
        (new,) = set(self.session_keys) - before
        return tab, self.session_keys[new]

    def leave(self, tab: Wire) -> None:
        """Close a tab, and wait until the server has noticed."""
        count = len(self.server.get_clients())
        tab.close()
        tab.wait_for(lambda: len(self.server.get_clients()) < count, "the tab to be gone")
        time.sleep(0.1)  # the callback runs in a thread of viser's


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    server = security.open_server("127.0.0.1", 0)
    running = Page(server, Slots(lambda tab: identity.connected(server, tab)))

    def welcome(client: viser.ClientHandle) -> None:
        values.accept_values_only(client)
        running.session_keys[client.client_id] = identity.session_key(client, running.slots)

    server.on_client_disconnect(lambda client: running.slots.free(client.client_id))
    server.on_client_connect(welcome)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(wire, "NO_DOCK", 0.05)  # there is none to wait for
        yield running
    security.close_server(server)


def test_a_browser_is_given_an_id_and_known_by_it_again(page: Page):
    storage = Storage()
    tab, session_key = page.join(storage)
    assert session_key == f"{storage.shared[KEY]}-1"
    page.leave(tab)
    again, key_again = page.join(storage)
    assert key_again == session_key
    again.wait_for(lambda: set(storage.shared) == {KEY}, "the copy of the slot to be taken away again")
    page.leave(again)


def test_two_tabs_of_a_browser_have_their_own_slots_and_each_gets_its_own_back(page: Page):
    shared: dict[str, str] = {}
    first, second = Storage(shared=shared), Storage(shared=shared)
    one, key_one = page.join(first)
    two, key_two = page.join(second)
    assert (key_one, key_two) == (f"{shared[KEY]}-1", f"{shared[KEY]}-2")
    page.leave(one)
    page.leave(two)
    two, key_two = page.join(second)  # the second is back before the first
    one, key_one = page.join(first)
    assert (key_one, key_two) == (f"{shared[KEY]}-1", f"{shared[KEY]}-2")
    three, key_three = page.join(Storage(shared=shared, tab=dict(first.tab)))  # a tab that was duplicated
    assert key_three == f"{shared[KEY]}-3"
    for tab in (one, two, three):
        page.leave(tab)


def test_a_new_tab_takes_the_lowest_slot_that_nobody_has(page: Page):
    shared: dict[str, str] = {}
    one, _ = page.join(Storage(shared=shared))
    two, _ = page.join(Storage(shared=shared))
    page.leave(one)
    new, session_key = page.join(Storage(shared=shared))
    assert session_key == f"{shared[KEY]}-1"
    page.leave(new)
    page.leave(two)


@pytest.mark.parametrize(
    "storage",
    [Storage(refused=True), Storage(forgetful=True), Storage(silent=True)],
    ids=["refuses", "keeps nothing", "does not answer"],
)
def test_a_browser_that_keeps_nothing_has_no_key_and_nobody_waits_for_ever(
    page: Page, storage: Storage, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(identity, "ANSWER_TIMEOUT", 0.5)
    tab, session_key = page.join(storage)
    assert session_key is None
    page.leave(tab)


@pytest.mark.parametrize("lie", ["../../etc/passwd", "A" * 32, "a" * 31, "", "a" * 100_000])
def test_an_id_that_is_not_of_our_making_is_replaced(page: Page, lie: str):
    storage = Storage(shared={KEY: lie})
    tab, session_key = page.join(storage)
    assert identity.BROWSER.fullmatch(storage.shared[KEY])
    assert session_key == f"{storage.shared[KEY]}-1"
    page.leave(tab)


@pytest.mark.parametrize("lie", ["0", "-1", "100", "1e9", "1\n", "", "../1", "１"])
def test_a_slot_that_is_none_of_ours_is_not_believed(page: Page, lie: str):
    tab, session_key = page.join(Storage(shared={KEY: BROWSER}, tab={SLOT_KEY: lie}))
    assert session_key == f"{BROWSER}-1"
    page.leave(tab)


def test_a_tab_that_goes_away_while_it_is_asked_is_no_error(page: Page):
    before = set(page.session_keys)
    tab = Wire(page.port, storage=Storage(silent=True))
    tab.wait_for(lambda: "LocalStorageGetItemRequestMessage" in tab.counts, "the question")
    tab.close()
    tab.wait_for(lambda: set(page.session_keys) - before, "an end of the waiting", timeout=5.0)
    assert page.session_keys.popitem()[1] is None


def test_a_connection_that_answers_is_alive_and_one_that_is_stuck_or_gone_is_not(
    page: Page, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(identity, "PONG_TIMEOUT", 0.5)
    tab, _ = page.join(Storage())
    alive = max(page.server.get_clients())
    assert identity.connected(page.server, alive)
    stuck = socket.create_connection(("127.0.0.1", page.port))
    key = base64.b64encode(os.urandom(16)).decode()
    address = f"127.0.0.1:{page.port}"
    lines = ["GET / HTTP/1.1", f"Host: {address}", f"Origin: http://{address}", "Upgrade: websocket"]
    lines += ["Connection: Upgrade", "Sec-WebSocket-Version: 13", f"Sec-WebSocket-Key: {key}"]
    stuck.sendall("\r\n".join([*lines, f"Sec-WebSocket-Protocol: viser-v{viser.__version__}", "", ""]).encode())
    assert b" 101 " in stuck.recv(64)
    tab.wait_for(lambda: alive + 1 in page.server._websock_server._live_connections, "the connection")
    assert not identity.connected(page.server, alive + 1)
    stuck.close()
    page.leave(tab)
    assert not identity.connected(page.server, alive)
    assert not identity.connected(page.server, 10**9)


def test_the_slot_of_a_tab_that_is_dead_but_not_yet_dropped_goes_to_its_successor():
    alive = {1: False, 2: True, 3: True}
    slots = Slots(lambda tab: alive[tab])
    assert slots.take(BROWSER, 1) == 1
    began = time.monotonic()
    assert slots.take(BROWSER, 2, wanted=1) == 1
    assert time.monotonic() - began >= identity.LEAVE_TIMEOUT, "the old tab had no time to write its last work"
    assert not slots.has(1)
    assert slots.has(2)
    slots.free(1)  # dropped at last
    assert slots.has(2)
    assert slots.take(BROWSER, 3, wanted=1) == 2


def test_a_successor_waits_until_the_last_work_is_written_and_no_longer():
    slots = Slots(lambda _: False)
    slots.take(BROWSER, 1)
    threading.Timer(0.2, slots.free, [1]).start()
    began = time.monotonic()
    assert slots.take(BROWSER, 2) == 1
    assert 0.1 < time.monotonic() - began < identity.LEAVE_TIMEOUT


def test_browsers_do_not_share_slots_and_a_browser_has_not_endlessly_many():
    slots = Slots(lambda _: True)
    assert slots.take(OTHER, -1) == 1
    assert [slots.take(BROWSER, tab) for tab in range(identity.MAX_SLOTS)] == list(range(1, identity.MAX_SLOTS + 1))
    with pytest.raises(StorageError, match="99 tabs"):
        slots.take(BROWSER, 1000)
    slots.free(7)
    assert slots.take(BROWSER, 1000, wanted=3) == 8


def test_tabs_that_come_at_once_never_get_the_same_slot():
    slots, taken = Slots(lambda _: True), []
    start = threading.Barrier(20)

    def take(tab: int) -> None:
        start.wait()
        taken.append(slots.take(BROWSER, tab, wanted=1))

    tabs = [threading.Thread(target=take, args=(tab,)) for tab in range(20)]
    for tab in tabs:
        tab.start()
    for tab in tabs:
        tab.join()
    assert sorted(taken) == list(range(1, 21))
