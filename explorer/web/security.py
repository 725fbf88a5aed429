"""The server: which requests are answered, and which are refused. Checked against viser 1.1.1.

viser as shipped answers any Host and any Origin (DNS rebinding, cross-site websockets), knows no visitors, and lets any
client open a public tunnel, upload files and overwrite the inner fields of a control. It has no setting for any of
this. This module wraps `websockets.asyncio.server.serve`, which viser calls, and removes or replaces the message
handlers in question. All of this depends on viser's internals: check it again whenever the pinned version changes.
"""

import asyncio
import contextlib
import errno
import io
import logging
import socket
import threading
from collections.abc import Callable, Iterator
from typing import Any

import viser
import websockets.asyncio.server
from viser import _messages
from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

from explorer.web import array_types
from explorer.web.access.entrance import METRICS_PATH, Answer, Entrance, NoRoomError
from explorer.web.addresses import Addresses
from explorer.web.limits import CLOSE_TIMEOUT, MAX_MESSAGE, PING_PERIOD, PONG_TIMEOUT, MeteredConnection
from explorer.web.metrics import CONTENT_TYPE, Metrics
from explorer.web.values import drop_unused
from explorer.web.without_webgl import add_script

CHECKED_AGAINST = "1.1.1"
HEALTH_PATH, REFUSED = "/healthz", 400
"""Where a monitor asks whether the page answers, and the least status of a refusal."""
MAX_PATH = 2000
"""Characters of an address after the name of the server. What a link carries stands after #, and is not sent."""
RECEIVE, RECEIVE_TIMEOUT = 0.05, 2.0
"""s in which the event loop takes in the messages that have arrived, and s after which it is not waited for."""
REFUSAL_LOG_LINES = ("opening handshake failed", "connection rejected (")
"""Beginnings of lines that websockets logs, with a traceback, when a request is refused; they are suppressed."""
SENT_OUT, SENT_OUT_REASON = 4001, "you were sent out"
"""The code and the reason with which the connection of a removed visitor is closed."""
NO_ROOM, NO_ROOM_REASON = 1013, "all places are taken"
"""The same for a visitor who came in the same moment as many others."""

log = logging.getLogger(__name__)


def open_server(
    host: str,
    port: int,
    *,
    url: str = "",
    entrance: Entrance | None = None,
    metrics: Metrics | None = None,
    visited: threading.Event | None = None,
) -> viser.ViserServer:
    """A server at an address of this machine; port 0 takes any free port. `url`: the address by a proxy. `visited` is
    set when the page is asked for.

    Raises ValueError with one sentence: where other machines can reach the page, `entrance` must decide who comes in.
    """
    addresses = Addresses(host, url)
    if entrance is None and not addresses.only_this_machine:
        raise ValueError(f"--host {host}: other machines could reach the page, and nothing decides who may come in")
    if not 0 <= port < 2**16:
        raise ValueError(f"--port {port}: must lie between 0 and 65535")
    _refuse_busy(addresses.bound, port)
    array_types.build_once()
    with (
        _guarded_serve(addresses, entrance, metrics or Metrics(), visited or threading.Event()),
        contextlib.redirect_stdout(io.StringIO()),
    ):  # viser prints a table; the program prints one line instead
        server = viser.ViserServer(host=addresses.bound, port=port, verbose=False)
    if port not in (0, server.get_port()):  # another program was faster, and viser has silently taken the next port
        server.stop()
        raise ValueError(_busy(port))
    for message in (_messages.ShareUrlRequest, _messages.ShareUrlDisconnect):
        server._websock_server.unregister_handler(message)
    drop_unused(server.gui)
    return server


def request_of(server: viser.ViserServer, tab: int) -> Request | None:
    """The request with which a tab opened its websocket; None for a tab that has left."""
    connection = server._websock_server._live_connections.get(tab)
    return None if connection is None else connection.request


def receive_pending(server: viser.ViserServer) -> None:
    """Wait until the messages that browsers have sent so far are taken in."""
    loop = server._websock_server._background_event_loop
    if loop is not None:
        with contextlib.suppress(TimeoutError, RuntimeError):  # RuntimeError: the loop is closed
            asyncio.run_coroutine_threadsafe(asyncio.sleep(RECEIVE), loop).result(RECEIVE_TIMEOUT)


def close_server(server: viser.ViserServer) -> None:
    """Stop serving, without viser's line about it."""
    with contextlib.redirect_stdout(io.StringIO()):
        server.stop()


@contextlib.contextmanager
def _guarded_serve(
    addresses: Addresses, entrance: Entrance | None, metrics: Metrics, visited: threading.Event
) -> Iterator[None]:
    """Within this context, viser's call of `serve` goes through the checks of this module."""
    serve = websockets.asyncio.server.serve

    def guarded(handler: Any, host: str, port: int, *, process_request: Callable, **options: Any) -> Any:
        options |= {
            "max_size": MAX_MESSAGE,
            "create_connection": MeteredConnection,
            "ping_interval": PING_PERIOD,
            "ping_timeout": PONG_TIMEOUT,
            "close_timeout": CLOSE_TIMEOUT,
        }
        inner = handler if entrance is None else _counted(handler, entrance)
        checked = _checked(process_request, addresses, entrance, metrics, visited)
        return serve(inner, host, port, process_request=checked, **options)

    websockets.asyncio.server.serve = guarded  # type: ignore[assignment]
    try:
        yield
    finally:
        websockets.asyncio.server.serve = serve


def _checked(
    process_request: Callable,
    addresses: Addresses,
    entrance: Entrance | None,
    metrics: Metrics,
    visited: threading.Event,
) -> Callable[[ServerConnection, Request], Response | None]:
    """viser's HTTP answers, with refusals before them and with security headers."""
    logging.getLogger("websockets.server").addFilter(
        lambda record: not record.getMessage().startswith(REFUSAL_LOG_LINES)
    )

    def decided(connection: ServerConnection, request: Request) -> Response | None:
        arrived_at, port = connection.local_address[:2]
        sentence = addresses.refusal(request, arrived_at, port)
        if sentence:
            return connection.respond(403, sentence + "\n")
        if len(request.path) > MAX_PATH:
            return connection.respond(414, f"An address of this page has at most {MAX_PATH} characters.\n")
        if request.path == HEALTH_PATH:
            return connection.respond(200, "ok\n")
        answer = None if entrance is None else entrance.answer(request, port)
        if answer is None and request.path == METRICS_PATH:
            answer = Answer(200, metrics.text(), content_type=CONTENT_TYPE)
        if answer is not None:
            return _response(connection, answer)
        if request.path.partition("?")[0] == "/":
            visited.set()
        try:
            return process_request(connection, request)
        except OSError:  # a name that no file can have
            return connection.respond(404, "There is no such page here.\n")

    def answer(connection: ServerConnection, request: Request) -> Response | None:
        try:
            response = decided(connection, request)
        except Exception:
            log.exception("a request could not be answered")
            metrics.error()
            response = connection.respond(500, "Something went wrong on the server; its log has the details.\n")
        if response is not None:
            if response.status_code >= REFUSED:
                metrics.refused(response.status_code)
            add_script(response)
            addresses.add_headers(response, *connection.local_address[:2])
        return response

    return answer


def _counted(handler: Callable, entrance: Entrance) -> Callable:
    """viser's handler of a connection, of which the entrance knows."""

    async def counted(connection: ServerConnection) -> None:
        request = connection.request
        visitor = None if request is None else entrance.visitor(request, connection.local_address[1])
        if visitor is None:  # sent out between the request and this moment
            await connection.close(SENT_OUT, SENT_OUT_REASON)
            return
        loop = asyncio.get_running_loop()

        def close() -> None:
            asyncio.run_coroutine_threadsafe(connection.close(SENT_OUT, SENT_OUT_REASON), loop)

        try:
            with entrance.stay(visitor, close):
                await handler(connection)
        except NoRoomError:
            await connection.close(NO_ROOM, NO_ROOM_REASON)

    return counted


def _response(connection: ServerConnection, answer: Answer) -> Response:
    response = connection.respond(answer.status, f"{answer.text.rstrip()}\n")
    del response.headers["Content-Type"]
    response.headers["Content-Type"] = answer.content_type
    response.headers["Cache-Control"] = "no-store"
    for name, value in answer.headers:
        response.headers[name] = value
    return response


def _refuse_busy(host: str, port: int) -> None:
    """Try the port before viser does, with SO_REUSEADDR as servers set it: otherwise a port just freed looks busy."""
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    except socket.gaierror:
        raise ValueError(f"--host {host}: no address of this machine") from None
    with socket.socket(family, kind, protocol) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(address)
        except OSError as error:
            if error.errno == errno.EADDRNOTAVAIL:
                raise ValueError(f"--host {host}: no address of this machine") from None
            raise ValueError(_busy(port)) from None


def _busy(port: int) -> str:
    return f"--port {port}: in use or not allowed; stop the other program or choose another port"
