"""Hostile requests and connections: each gets an answer or an end of its own, one line in the log at most, and disturbs
nobody else."""

import contextlib
import http.client
import logging
import os
import socket
import threading
import time
from collections.abc import Iterator

import msgspec
import pytest
import viser
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin, Subprotocol

from explorer.web import limits, security, values
from explorer.web.access.codes import Codes
from explorer.web.access.entrance import Entrance
from tests.support.wire import CAMERA, Wire

pytestmark = pytest.mark.slow

CYCLES, VISER_THREADS = 200, 32
"""Connections, and the threads of viser's pool, which are made when they are needed and stay. A trace of each
connection would be many more."""
LONG = 4000, 100_000
"""Characters of an address."""


@pytest.fixture(scope="module")
def codes() -> Codes:
    return Codes()


@pytest.fixture(scope="module")
def server(codes: Codes) -> Iterator[viser.ViserServer]:
    opened = security.open_server(
        "127.0.0.1", 0, url="http://class.example.org", entrance=Entrance(codes=codes, places=9)
    )
    opened.on_client_connect(values.accept_values_only)
    yield opened
    opened.stop()


@pytest.fixture(scope="module")
def cookie(server: viser.ViserServer, codes: Codes) -> str:
    """That of a student who has come in."""
    status, headers, _ = _get(server, "/enter", Rangenav_Enter=f"key {codes.key}")
    assert status == 200
    return headers["Set-Cookie"].partition(";")[0]


def _get(server: viser.ViserServer, path: str, **headers: str) -> tuple[int, dict[str, str], bytes]:
    port = server.get_port()
    sent = {"Host": f"127.0.0.1:{port}"} | {name.replace("_", "-"): text for name, text in headers.items()}
    with contextlib.closing(http.client.HTTPConnection("127.0.0.1", port, timeout=10)) as connection:
        connection.putrequest("GET", path, skip_host=True)
        for name, text in sent.items():
            connection.putheader(name, text)
        connection.endheaders()
        answer = connection.getresponse()
        return answer.status, dict(answer.getheaders()), answer.read()


def _raw(port: int, cookie: str) -> ClientConnection:
    return connect(
        f"ws://127.0.0.1:{port}/",
        origin=Origin(f"http://127.0.0.1:{port}"),
        subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
        additional_headers={"Cookie": cookie},
    )


def _until(holds, timeout: float = 10.0) -> bool:
    deadline = time.monotonic() + timeout
    while not holds() and time.monotonic() < deadline:
        time.sleep(0.01)
    return bool(holds())


def _ignored(caplog: pytest.LogCaptureFixture) -> list[str]:
    """The lines of the log that say so of a frame."""
    return [line for line in caplog.messages if line.startswith("a frame was ignored: ")]


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("/" + "a" * 1500, 404),
        ("/" + "a/" * 900, 404),
        ("/" + "a" * LONG[0], 414),
        ("/?" + "a" * LONG[0], 414),
        ("/../../etc/passwd", 404),
        ("/%2e%2e/%2e%2e/etc/passwd", 404),
        ("/..%5c..%5cetc%5cpasswd", 404),
        ("//etc/passwd", 404),
        ("/assets/../../../_viser.py", 404),
        ("/%00", 404),
        ("/%ff%fe", 404),
        ("/index.html%0d%0aSet-Cookie:%20a=b", 404),
        ("http://evil.example/", 404),
    ],
)
def test_an_address_that_is_none_is_refused_with_the_security_headers(
    server: viser.ViserServer, cookie: str, path: str, status: int, caplog: pytest.LogCaptureFixture
) -> None:
    answered, headers, body = _get(server, path, Cookie=cookie)
    assert answered == status
    assert headers["X-Frame-Options"] == "DENY"
    assert headers["Referrer-Policy"] == "no-referrer"
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert "Set-Cookie" not in headers
    assert b"root:" not in body
    assert not caplog.records


def test_a_request_that_cannot_be_read_is_ended_without_an_answer_and_without_a_line_in_the_log(
    server: viser.ViserServer, caplog: pytest.LogCaptureFixture
) -> None:
    for sent in (f"GET /{'a' * LONG[1]} HTTP/1.1\r\n", "POST / HTTP/1.1\r\n\r\n", "\x16\x03\x01\x02", "\r\n" * 300):
        with (
            socket.create_connection(("127.0.0.1", server.get_port()), timeout=10) as raw,
            contextlib.suppress(OSError),
        ):
            raw.sendall(sent.encode("latin-1"))
            raw.shutdown(socket.SHUT_WR)
            assert raw.recv(64) == b""
    assert not caplog.records
    assert _get(server, "/healthz")[0] == 200


def test_an_unforeseen_error_of_an_answer_is_a_sentence_with_the_security_headers_and_a_traceback_in_the_log(
    server: viser.ViserServer, cookie: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def broken(*_: object) -> None:
        raise RuntimeError("a programmer's error")

    monkeypatch.setattr(Entrance, "answer", broken)
    status, headers, body = _get(server, "/", Cookie=cookie)
    assert (status, headers["X-Frame-Options"]) == (500, "DENY")
    assert b"Something went wrong on the server" in body
    assert b"programmer" not in body
    (record,) = caplog.records
    assert record.exc_info


def test_no_secret_of_an_address_a_header_or_a_referer_is_sent_on_or_logged(
    server: viser.ViserServer, codes: Codes, cookie: str, caplog: pytest.LogCaptureFixture
) -> None:
    secrets = (codes.key, codes.token, codes.code, cookie.partition("=")[2])
    with caplog.at_level(logging.INFO):
        for path in ("/", "/enter", "/no-such-page", "/metrics"):
            for secret in secrets:
                _, headers, body = _get(
                    server, f"{path}?token={secret}", Referer=f"http://127.0.0.1/?token={secret}", X_Token=secret
                )
                assert headers["Referrer-Policy"] == "no-referrer"
                assert secret not in body.decode() + str(headers)
        with _raw(server.get_port(), cookie) as tab:
            tab.send(f"token={codes.token}")
            tab.send(msgspec.msgpack.encode({"type": codes.token}))
            assert _until(lambda: len(_ignored(caplog)) == 2)
    assert not [secret for secret in secrets if secret in caplog.text]


@pytest.mark.parametrize("place", [0, -1])
def test_a_cookie_of_which_one_character_was_changed_is_worth_nothing(
    server: viser.ViserServer, cookie: str, place: int
) -> None:
    name, _, secret = cookie.partition("=")
    other = "A" if secret[place] != "A" else "Q"
    forged = other + secret[1:] if place == 0 else secret[:-1] + other
    assert _get(server, "/", Cookie=f"{name}={forged}")[0] == 401
    assert _get(server, "/", Cookie=cookie)[0] == 200


def test_malformed_frames_are_ignored_with_a_line_each_and_end_a_connection_that_sends_many(
    server: viser.ViserServer, cookie: str, caplog: pytest.LogCaptureFixture
) -> None:
    honest = Wire(server.get_port(), cookie=cookie)
    sent = ["text", b"\xc1", b"", msgspec.msgpack.encode({"type": "Nothing"}), b"\x91" * 10_000]
    with _raw(server.get_port(), cookie) as tab:
        for k in range(limits.MAX_MALFORMED):
            tab.send(sent[k % len(sent)])
        with contextlib.suppress(ConnectionClosed):
            while True:
                tab.recv(timeout=10)
        assert tab.close_code == limits.MALFORMED
    assert len(_ignored(caplog)) == limits.MAX_MALFORMED
    assert not any(record.exc_info for record in caplog.records)
    honest.send(CAMERA)
    assert honest.closed_with is None
    honest.close()


def test_a_connection_that_sends_too_much_is_read_slowly_and_holds_nobody_up(
    server: viser.ViserServer, cookie: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    at_once, rate, sent = 3, 5.0, 9
    monkeypatch.setattr(limits, "MESSAGES", (float(at_once), rate))
    with _raw(server.get_port(), cookie) as tab:
        began = time.monotonic()
        for _ in range(sent):
            tab.send("each of these is a line in the log")
        assert _get(server, "/healthz")[0] == 200
        assert len(_ignored(caplog)) < sent, "the answer did not wait for the messages"
        assert _until(lambda: len(_ignored(caplog)) == sent)
        assert time.monotonic() - began > (sent - at_once - 1) / rate


def test_texts_fill_no_more_than_the_room_of_a_tab(
    server: viser.ViserServer, cookie: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(values, "MAX_HELD", 3 * values.LONG)
    known = set(server.get_clients())
    tab = Wire(server.get_port(), cookie=cookie)
    assert _until(lambda: set(server.get_clients()) - known)
    client = server.get_clients()[max(server.get_clients())]
    boxes = [client.gui.add_text(f"box {k}", "") for k in range(3)]
    tab.wait_for(lambda: len(tab.elements) == len(boxes), "the boxes")
    long = "x" * (values.MAX_HELD // 2)
    for k in range(3):
        tab.set(f"box {k}", long)
    tab.wait_for(lambda: tab.notifications, "a notice")
    tab.wait_for(lambda: boxes[1].value == long, "the second text")
    assert [len(box.value) for box in boxes] == [len(long), len(long), 0]
    tab.close()


def test_a_connection_that_answers_no_ping_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("PING_PERIOD", "PONG_TIMEOUT", "CLOSE_TIMEOUT"):
        monkeypatch.setattr(security, name, 0.05)
    half_open = security.open_server("127.0.0.1", 0)
    port, gone = half_open.get_port(), threading.Event()
    half_open._websock_server.on_client_disconnect(lambda _: gone.set())
    request = (
        f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
        f"Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {'A' * 22}==\r\n"
        f"Sec-WebSocket-Protocol: viser-v{viser.__version__}\r\n\r\n"
    )
    with socket.create_connection(("127.0.0.1", port), timeout=10) as silent:
        silent.sendall(request.encode())
        assert b" 101 " in silent.recv(64)
        assert gone.wait(10)
    security.close_server(half_open)


def test_two_hundred_connections_leave_no_thread_no_open_file_and_no_trace(codes: Codes) -> None:
    entrance = Entrance(codes=codes, places=9)
    server = security.open_server("127.0.0.1", 0, url="http://class.example.org", entrance=entrance)
    port = server.get_port()

    def left() -> tuple[int, int, int, int]:
        tabs = len(server._websock_server._client_state_from_id)
        return threading.active_count(), len(os.listdir("/proc/self/fd")), tabs, len(entrance.inside)

    cookies = []
    for _ in range(CYCLES // 10):  # each visitor may open so many at once
        _, headers, _ = _get(server, "/enter", Rangenav_Enter=f"key {codes.key}")
        cookies.append(headers["Set-Cookie"].partition(";")[0])
    counts = []
    for cookie in cookies:
        for _ in range(10):
            with _raw(port, cookie) as tab:
                tab.send(msgspec.msgpack.encode(CAMERA))
        assert _until(lambda: left()[2:] == (0, 0))
        counts.append(left())
    for at_first, at_last in zip(counts[0], counts[-1], strict=True):
        assert at_last <= at_first + VISER_THREADS, f"threads, open files, tabs, visitors: {counts[0]}, {counts[-1]}"
    security.close_server(server)
