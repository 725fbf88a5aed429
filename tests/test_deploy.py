"""The configurations in deploy/: nginx is run with ours on this machine; Caddy's and the container's are read."""

import asyncio
import contextlib
import os
import re
import shutil
import signal
import socket
import ssl
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest
import viser
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus
from websockets.typing import Origin, Subprotocol

from explorer.web.access.codes import Codes
from explorer.web.access.entrance import Entrance
from explorer.web.security import open_server

pytestmark = pytest.mark.slow

DEPLOY = Path(__file__).parents[1] / "deploy"
NAME = "class.example.org"
START_TIMEOUT = 10.0
"""s for nginx to answer."""
FRAME = """
daemon off; worker_processes 1; pid {folder}/pid; error_log {folder}/error.log;
events {{}}
http {{
    client_body_temp_path {folder}; proxy_temp_path {folder}; fastcgi_temp_path {folder};
    uwsgi_temp_path {folder}; scgi_temp_path {folder};
    {ours}
}}
"""
"""What Debian's nginx.conf holds around ours, with every path in a folder of the test."""


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def _nginx() -> str:
    program = shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin")
    if program is None:
        assert not os.environ.get("CI"), "the gate installs nginx"
        pytest.skip("nginx is not installed")
    return program


def _certificate(folder: Path) -> None:
    subprocess.run(
        [
            "openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes",
            "-days", "1",
            "-subj", f"/CN={NAME}", "-addext", f"subjectAltName=DNS:{NAME}",
            "-keyout", str(folder / "privkey.pem"), "-out", str(folder / "fullchain.pem"),
        ],
        check=True,
        capture_output=True,
    )  # fmt: skip


@pytest.fixture(scope="module")
def codes() -> Codes:
    return Codes()


@pytest.fixture(scope="module")
def page(codes: Codes) -> Iterator[viser.ViserServer]:
    entrance = Entrance(codes=codes, places=5, secure=True)
    server = open_server("127.0.0.1", 0, url=f"https://{NAME}", entrance=entrance)
    yield server
    server.stop()


@pytest.fixture(scope="module")
def proxy(page: viser.ViserServer, tmp_path_factory: pytest.TempPathFactory) -> Iterator[int]:
    """nginx with our configuration; only its ports, its certificate and its log lie elsewhere. The port of https."""
    program, folder, port = _nginx(), tmp_path_factory.mktemp("nginx"), _free_port()
    _certificate(folder)
    ours = (DEPLOY / "nginx.conf").read_text(encoding="utf-8")
    for place, here in {
        "listen 80;": f"listen 127.0.0.1:{_free_port()};",
        "listen 443 ssl;": f"listen 127.0.0.1:{port} ssl;",
        f"/etc/ssl/{NAME}": str(folder),
        "/var/log/nginx": str(folder),
        "127.0.0.1:8080": f"127.0.0.1:{page.get_port()}",
    }.items():
        assert place in ours, place
        ours = ours.replace(place, here)
    (folder / "nginx.conf").write_text(FRAME.format(folder=folder, ours=ours), encoding="utf-8")
    process = subprocess.Popen([program, "-p", str(folder), "-c", str(folder / "nginx.conf")], stderr=subprocess.PIPE)
    try:
        deadline = time.monotonic() + START_TIMEOUT
        while time.monotonic() < deadline and process.poll() is None:
            with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=1):
                break
            time.sleep(0.05)
        assert process.poll() is None, process.communicate()[1].decode()
        yield port
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
        process.communicate(timeout=10)


def _context() -> ssl.SSLContext:
    """The test made the certificate a moment ago; it is not what is tested."""
    context = ssl.create_default_context()
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    return context


def _get(port: int, path: str = "/", **headers: str) -> tuple[int, dict[str, str], bytes]:
    sent = {"Host": NAME} | {name.replace("_", "-"): text for name, text in headers.items()}
    request = urllib.request.Request(f"https://127.0.0.1:{port}{path}", headers=sent)
    try:
        with urllib.request.urlopen(request, timeout=10, context=_context()) as answer:
            return answer.status, dict(answer.headers), answer.read()
    except urllib.error.HTTPError as refused:
        with refused:
            return refused.code, dict(refused.headers), refused.read()


def _websocket(port: int, cookie: str, origin: str = f"https://{NAME}") -> str | bytes:
    """What comes first over a new connection.

    In one thread: that of the standard library's ssl must not be read and written by two threads at once, which
    websockets' client with threads does (Python 3.11 then loses what was sent, or ends)."""

    async def first() -> str | bytes:
        async with connect(
            f"wss://{NAME}/",
            sock=socket.create_connection(("127.0.0.1", port)),
            ssl=_context(),
            origin=Origin(origin),
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            additional_headers={"Cookie": cookie} if cookie else {},
        ) as websocket:
            return await asyncio.wait_for(websocket.recv(), timeout=10)

    return asyncio.run(first())


def test_behind_nginx_a_link_lets_in_and_the_page_and_its_websocket_work(proxy: int, codes: Codes) -> None:
    status, headers, body = _get(proxy)
    assert (status, b"Code that your teacher shows" in body) == (401, True)
    status, headers, _ = _get(proxy, "/enter", Rangenav_Enter=f"key {codes.key}")
    assert status == 200
    assert "Secure" in headers["Set-Cookie"]
    cookie = headers["Set-Cookie"].partition(";")[0]
    status, headers, body = _get(proxy, Cookie=cookie)
    assert (status, len(body) > 100_000) == (200, True)
    assert f"wss://{NAME}" in headers["Content-Security-Policy"]
    assert "Strict-Transport-Security" in headers
    assert _websocket(proxy, cookie)


def test_behind_nginx_nobody_comes_in_without_a_cookie_or_from_another_site(proxy: int, codes: Codes) -> None:
    _, headers, _ = _get(proxy, "/enter", Rangenav_Enter=f"key {codes.key}")
    cookie = headers["Set-Cookie"].partition(";")[0]
    for sent, origin, expected in [("", f"https://{NAME}", 401), (cookie, "https://evil.example", 403)]:
        with pytest.raises(InvalidStatus) as refused:
            _websocket(proxy, sent, origin)
        assert refused.value.response.status_code == expected
    assert _get(proxy, Host="evil.example")[0] == 403
    assert _get(proxy, "/../../../etc/passwd", Cookie=cookie)[0] in (400, 404)
    assert _get(proxy, "/%2e%2e/%2e%2e/etc/passwd", Cookie=cookie)[0] in (400, 404)


@pytest.mark.parametrize(
    "smuggled",
    [
        "Content-Length: 5\r\nTransfer-Encoding: chunked",
        "Transfer-Encoding : chunked",
        "Transfer-Encoding: chunked, identity",
        "Content-Length: 5\r\nContent-Length: 6",
    ],
)
def test_a_request_that_hides_a_second_one_gets_no_second_answer(proxy: int, smuggled: str) -> None:
    hidden = f"GET /healthz HTTP/1.1\r\nHost: {NAME}\r\n\r\n"
    sent = f"GET / HTTP/1.1\r\nHost: {NAME}\r\n{smuggled}\r\n\r\n0\r\n\r\n{hidden}"
    with (
        socket.create_connection(("127.0.0.1", proxy)) as raw,
        _context().wrap_socket(raw, server_hostname=NAME) as said,
    ):
        said.settimeout(2)
        said.sendall(sent.encode())
        answer = b""
        with contextlib.suppress(OSError):
            while part := said.recv(65536):
                answer += part
    assert not answer.rstrip().endswith(b"ok"), "the hidden request was answered with what the first was refused"


def test_no_secret_and_no_visitor_stands_in_the_log_of_nginx(proxy: int, codes: Codes, tmp_path_factory) -> None:
    _get(proxy, "/enter?x=secret-in-a-query", Rangenav_Enter=f"key {codes.key}")
    (log,) = tmp_path_factory.getbasetemp().glob("nginx0/explorer.log")
    text = log.read_text(encoding="utf-8")
    assert "GET /enter 200" in text
    for secret in (codes.key, codes.token, codes.code, "secret-in-a-query", "127.0.0.1"):
        assert secret not in text


def test_the_container_runs_as_nobody_from_the_wheel_and_needs_no_file_but_tmp() -> None:
    text = (DEPLOY / "Containerfile").read_text(encoding="utf-8")
    commands = [line for line in text.splitlines() if line and not line.startswith("#")]
    last = commands[max(i for i, line in enumerate(commands) if line.startswith("FROM")) :]
    assert "USER nobody" in last
    assert not any(line.startswith(("RUN", "ADD")) for line in last), "nothing is installed as root in the last stage"
    assert re.search(r"COPY dist/rangenav-\*\.whl", text)
    assert "--read-only" in text
    assert all("/tmp" in word for word in re.findall(r"(?:HOME|STATE_HOME|DATA_HOME)=(\S+)", text))


def test_caddy_forwards_to_where_the_page_answers_behind_a_proxy() -> None:
    text = (DEPLOY / "Caddyfile").read_text(encoding="utf-8")
    assert "reverse_proxy 127.0.0.1:8080" in text
    assert f"rangenav-explorer --url https://{NAME}" in text
    assert text.count("{") == text.count("}")
