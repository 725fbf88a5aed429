"""A page that other machines can reach: nobody gets it, or its websocket, without having come in."""

import contextlib
import http.client
from collections.abc import Iterator

import pytest
import viser
from prometheus_client.parser import text_string_to_metric_families
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin, Subprotocol

from explorer.web.access.codes import Codes
from explorer.web.access.entrance import Entrance
from explorer.web.addresses import Addresses
from explorer.web.security import SENT_OUT, open_server

PAGE_BYTES = 100_000
"""viser's page is larger than this; no refusal is."""


@pytest.fixture(scope="module")
def codes() -> Codes:
    return Codes()


@pytest.fixture(scope="module")
def entrance(codes: Codes) -> Entrance:
    return Entrance(codes=codes, places=5)


@pytest.fixture(scope="module")
def server(entrance: Entrance) -> Iterator[viser.ViserServer]:
    opened = open_server("0.0.0.0", 0, entrance=entrance)
    yield opened
    opened.stop()


def _get(server: viser.ViserServer, path: str = "/", **headers: str) -> tuple[int, dict[str, str], bytes]:
    port = server.get_port()
    sent = {"Host": f"127.0.0.1:{port}"} | {name.replace("_", "-"): text for name, text in headers.items()}
    with contextlib.closing(http.client.HTTPConnection("127.0.0.1", port, timeout=10)) as connection:
        connection.request("GET", path, headers=sent)
        answer = connection.getresponse()
        return answer.status, dict(answer.getheaders()), answer.read()


def _websocket(server: viser.ViserServer, cookie: str, origin: str | None = None) -> ClientConnection:
    port = server.get_port()
    return connect(
        f"ws://127.0.0.1:{port}/",
        origin=Origin(origin or f"http://127.0.0.1:{port}"),
        subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
        additional_headers={"Cookie": cookie} if cookie else {},
    )


def _refused(server: viser.ViserServer, cookie: str, origin: str | None = None) -> int:
    with pytest.raises(InvalidStatus) as refusal:
        _websocket(server, cookie, origin)
    return refusal.value.response.status_code


def _come_in(server: viser.ViserServer, codes: Codes) -> str:
    status, headers, _ = _get(server, "/enter", Rangenav_Enter=f"key {codes.key}")
    assert status == 200
    return headers["Set-Cookie"].partition(";")[0]


def test_without_a_cookie_there_is_a_door_and_no_page(server: viser.ViserServer) -> None:
    status, headers, body = _get(server)
    assert status == 401
    assert b"Code that your teacher shows" in body
    assert "script-src 'unsafe-inline'" in headers["Content-Security-Policy"]
    assert headers["Cache-Control"] == "no-store"
    assert headers["Referrer-Policy"] == "no-referrer"
    assert _refused(server, "") == 401
    assert _refused(server, f"rangenav-{server.get_port()}=forged") == 401


def test_who_has_come_in_gets_the_page_and_a_websocket_from_the_page_alone(
    server: viser.ViserServer, codes: Codes
) -> None:
    cookie = _come_in(server, codes)
    status, _, body = _get(server, Cookie=cookie)
    assert status == 200
    assert len(body) > PAGE_BYTES
    assert _refused(server, cookie, origin="http://evil.example") == 403
    with _websocket(server, cookie) as socket:
        assert socket.recv(timeout=10)


def test_a_visitor_who_is_sent_out_loses_the_connection_and_is_not_let_in_again(
    server: viser.ViserServer, codes: Codes, entrance: Entrance
) -> None:
    cookie = _come_in(server, codes)
    with _websocket(server, cookie) as socket:
        socket.recv(timeout=10)
        (number,) = entrance.inside
        entrance.remove(number)
        with contextlib.suppress(ConnectionClosed):
            while True:
                socket.recv(timeout=10)
        assert socket.close_code == SENT_OUT
    assert _refused(server, cookie) == 401


@pytest.mark.parametrize("host", ["evil.example", "0.0.0.0", "localhost", "127.0.0.1:1"])
def test_a_page_for_all_addresses_answers_only_to_the_one_at_which_a_request_arrived(
    server: viser.ViserServer, host: str
) -> None:
    named = host if ":" in host else f"{host}:{server.get_port()}"
    status, _, body = _get(server, Host=named)
    assert status == 403
    assert b"answers only to its own address" in body


def test_health_is_told_to_anybody_and_nothing_else_is(server: viser.ViserServer) -> None:
    status, headers, body = _get(server, "/healthz")
    assert (status, body) == (200, b"ok\n")
    assert "Set-Cookie" not in headers


def test_numbers_for_a_monitor_are_for_the_teacher_and_a_program_with_the_token(
    server: viser.ViserServer, codes: Codes
) -> None:
    student = _come_in(server, codes)
    for headers in ({}, {"Cookie": student}, {"Authorization": f"Bearer {codes.key}"}, {"Authorization": codes.token}):
        assert _get(server, "/metrics", **headers)[0] == 401
    status, headers, body = _get(server, "/metrics", Authorization=f"Bearer {codes.token}")
    families = {one.name: one for one in text_string_to_metric_families(body.decode())}
    assert status == 200
    assert headers["Content-Type"].startswith("text/plain")
    assert {"rangenav_visitors", "rangenav_picture_seconds", "rangenav_errors", "rangenav_refused"} <= set(families)
    refused = {
        sample.labels["status"]: sample.value for sample in families["rangenav_refused"].samples if sample.labels
    }
    assert refused["401"] >= 4


def test_a_page_for_others_without_an_entrance_is_not_served() -> None:
    for host, url in [("0.0.0.0", ""), ("127.0.0.1", "https://class.example.org")]:
        with pytest.raises(ValueError, match="nothing decides who may come in"):
            open_server(host, 0, url=url)


@pytest.mark.parametrize("host", ["192.0.2.77", "no-such-machine.invalid"])
def test_a_host_that_is_not_this_machine_is_refused_with_a_sentence(entrance: Entrance, host: str) -> None:
    with pytest.raises(ValueError, match=rf"--host {host}: no address of this machine"):
        open_server(host, 0, entrance=entrance)


@pytest.mark.parametrize(
    ("host", "url", "link"),
    [
        ("127.0.0.1", "", "http://127.0.0.1:8080/"),
        ("::1", "", "http://[::1]:8080/"),
        ("10.0.0.7", "", "http://10.0.0.7:8080/"),
        ("127.0.0.1", "https://class.example.org", "https://class.example.org/"),
        ("0.0.0.0", "http://class.example.org:81/", "http://class.example.org:81/"),
    ],
)
def test_links_are_what_visitors_type(host: str, url: str, link: str) -> None:
    assert Addresses(host, url).link(8080) == link


@pytest.mark.parametrize(
    "url", ["class.example.org", "ftp://class.example.org", "https://", "https://a/b", "https://a?b"]
)
def test_an_address_of_a_proxy_is_a_scheme_and_a_name(url: str) -> None:
    with pytest.raises(ValueError, match="must be a scheme and a name"):
        Addresses("127.0.0.1", url)
