"""Only this machine's own browser, on the page's own address, is served; the rest is refused."""

import contextlib
import http.client
import logging
import socket
import time
from collections.abc import Iterator
from email.message import Message

import pytest
import viser
from viser import _messages
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin, Subprotocol

from explorer.web import security, values
from tests.support.wire import Wire

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    opened = security.open_server("127.0.0.1", 0)
    opened.on_client_connect(values.accept_values_only)
    yield opened
    opened.stop()


def _get(port: int, *, host: str) -> tuple[int, Message]:
    """Status and headers of the page."""
    with contextlib.closing(http.client.HTTPConnection("127.0.0.1", port, timeout=10)) as connection:
        connection.request("GET", "/", headers={"Host": host})
        answer = connection.getresponse()
        return answer.status, answer.headers


def _websocket_status(port: int, *, origin: str | None) -> int:
    """The HTTP status with which a websocket is answered."""
    spoken = [Subprotocol(f"viser-v{viser.__version__}")]
    try:
        connect(f"ws://127.0.0.1:{port}/", origin=Origin(origin) if origin else None, subprotocols=spoken).close()
    except InvalidStatus as refused:
        return refused.response.status_code
    return 101


def _status_line(port: int, *headers: str) -> str:
    """The first line of the answer to a request with these header lines."""
    with socket.create_connection(("127.0.0.1", port), timeout=10) as raw:
        raw.sendall("\r\n".join(["GET / HTTP/1.1", *headers, "", ""]).encode())
        return raw.recv(64).decode().partition("\r\n")[0]


def test_this_file_was_read_for_the_viser_that_is_installed():
    assert viser.__version__ == security.CHECKED_AGAINST


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost", "LOCALHOST"])
def test_the_page_is_served_under_its_own_names_with_headers_that_keep_it_to_itself(
    server: viser.ViserServer, name: str
):
    status, headers = _get(server.get_port(), host=f"{name}:{server.get_port()}")
    assert status == 200
    assert headers["X-Frame-Options"] == "DENY"
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert headers["Referrer-Policy"] == "no-referrer"


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:{port}", "127.0.0.1", "localhost:1", "127.0.0.1.evil:{port}"]
)
def test_a_foreign_host_is_refused_so_that_dns_rebinding_fails(server: viser.ViserServer, host: str):
    assert _get(server.get_port(), host=host.format(port=server.get_port()))[0] == 403


def test_two_hosts_in_one_request_are_refused(server: viser.ViserServer):
    port = server.get_port()
    assert " 403 " in _status_line(port, f"Host: 127.0.0.1:{port}", "Host: evil.example")


def test_a_websocket_to_a_foreign_host_is_refused_even_from_an_origin_that_looks_right(server: viser.ViserServer):
    port = server.get_port()
    spoken = f"Sec-WebSocket-Protocol: viser-v{viser.__version__}"
    upgrade = (
        spoken,
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: " + "A" * 22 + "==",
    )
    origin = f"Origin: http://127.0.0.1:{port}"
    assert " 403 " in _status_line(port, f"Host: evil.example:{port}", origin, *upgrade)
    assert " 101 " in _status_line(port, f"Host: 127.0.0.1:{port}", origin, *upgrade)


@pytest.mark.parametrize(
    "origin", ["https://evil.example", "http://127.0.0.1:1", "null", "http://localhost:{port}.evil", None]
)
def test_a_websocket_from_a_foreign_page_or_from_none_is_refused(server: viser.ViserServer, origin: str | None):
    port = server.get_port()
    assert _websocket_status(port, origin=origin and origin.format(port=port)) == 403


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost"])
def test_a_websocket_from_the_page_itself_is_accepted(server: viser.ViserServer, name: str):
    assert _websocket_status(server.get_port(), origin=f"http://{name}:{server.get_port()}") == 101


def test_nobody_can_open_a_public_tunnel(server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch):
    asked = []
    monkeypatch.setattr(server, "request_share_url", lambda *_, **__: asked.append(True))
    visitor = Wire(server.get_port())
    visitor.send({"type": "ShareUrlRequest"})
    visitor.send({"type": "ShareUrlDisconnect"})
    time.sleep(0.3)
    visitor.close()
    assert not asked


def _with_slider(server: viser.ViserServer) -> tuple[Wire, viser.GuiSliderHandle[float]]:
    known = set(server.get_clients())
    visitor = Wire(server.get_port())
    visitor.wait_for(lambda: set(server.get_clients()) - known, "the connection")
    (new,) = set(server.get_clients()) - known
    time.sleep(0.2)  # the connect callback runs in a thread of viser's
    slider = server.get_clients()[new].gui.add_slider("gain", 0.0, 1.0, 0.1, 0.5)
    visitor.wait_for(lambda: visitor.elements, "the slider")
    return visitor, slider


def test_a_control_takes_values_and_nothing_else(server: viser.ViserServer, caplog: pytest.LogCaptureFixture):
    visitor, slider = _with_slider(server)
    visitor.set("gain", 0.7)
    visitor.wait_for(lambda: slider.value == 0.7, "an honest value")
    with caplog.at_level(logging.ERROR):
        visitor.send({"type": "GuiUpdateMessage", "uuid": slider._impl.uuid, "updates": {"removed": True}})
        visitor.send({"type": "GuiUpdateMessage", "uuid": slider._impl.uuid, "updates": {"update_cb": []}})
        for nonsense in ("fast", None, [1.0, 2.0], {"a": 1}):
            visitor.send({"type": "GuiUpdateMessage", "uuid": slider._impl.uuid, "updates": {"value": nonsense}})
        visitor.wait_for(lambda: len(visitor.notifications) == 6, "a notification for each")
        caplog.clear()
    assert slider.value == 0.7
    assert not slider._impl.removed
    visitor.close()


def test_an_upload_is_not_collected_and_does_not_become_a_value(server: viser.ViserServer):
    visitor, slider = _with_slider(server)
    upload = {"source_component_uuid": slider._impl.uuid, "transfer_uuid": "u", "filename": "f", "mime_type": "x"}
    visitor.send({"type": "FileTransferStartUpload", **upload, "part_count": 0, "size_bytes": 0})
    visitor.send({"type": "FileTransferStartUpload", **upload, "part_count": 2, "size_bytes": 9})
    time.sleep(0.3)
    (client,) = (c for c in server.get_clients().values() if c.gui is slider._impl.gui_api)
    visitor.close()
    assert slider.value == 0.5
    assert not client.gui._current_file_upload_states
    assert not server.gui._current_file_upload_states


def test_a_huge_message_ends_the_connection(server: viser.ViserServer):
    visitor = Wire(server.get_port())
    visitor.send({"type": "GuiUpdateMessage", "uuid": "x", "updates": {"value": "x" * (security.MAX_MESSAGE + 1)}})
    visitor.wait_for(lambda: visitor.closed_with is not None, "the end of the connection")
    assert visitor.closed_with == 1009  # message too big


def test_a_form_message_is_not_passed_on_to_other_visitors(server: viser.ViserServer):
    assert _messages.GuiFormDirtyMessage not in server._websock_server._incoming_handlers


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.1.7", "::", "evil.example"])
def test_a_page_that_others_could_reach_is_not_served_without_an_entrance(host: str):
    with pytest.raises(ValueError, match=rf"--host {host}: other machines could reach the page"):
        security.open_server(host, 0)


def test_a_busy_port_is_refused_with_a_sentence_instead_of_taking_the_next(server: viser.ViserServer):
    with pytest.raises(ValueError, match=f"--port {server.get_port()}: in use"):
        security.open_server("127.0.0.1", server.get_port())


@pytest.mark.parametrize("port", [-1, 65536])
def test_a_port_that_is_none_is_refused(port: int):
    with pytest.raises(ValueError, match="must lie between 0 and 65535"):
        security.open_server("127.0.0.1", port)
