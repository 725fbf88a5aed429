"""Only a browser on this machine, at the page's own address, may talk to the page. Checked against viser 1.1.1.

viser as shipped answers any Host and any Origin (DNS rebinding, cross-site websockets), and lets any client open a
public tunnel, upload files and overwrite the inner fields of a control. It has no setting for any of this. This module
wraps `websockets.asyncio.server.serve`, which viser calls, and removes or replaces the message handlers in question.
All of this depends on viser's internals: check it again whenever the pinned version changes.
"""

import asyncio
import contextlib
import io
import logging
import math
import socket
from collections.abc import Callable
from typing import Any

import viser
import websockets.asyncio.server
from viser import _messages
from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

from explorer.model import palette
from explorer.web import array_types
from explorer.web.without_webgl import add_script

CHECKED_AGAINST = "1.1.1"
NAMES = ("127.0.0.1", "localhost")
ADDRESS = "127.0.0.1"
MAX_MESSAGE = 2**24
"""Bytes of one message from a browser; viser allows 50 MB. The page's own largest message is that of a text
box: a visitor who pastes ten megabytes should see a complaint, and not lose the connection."""
RECEIVE, RECEIVE_TIMEOUT = 0.05, 2.0
"""s in which the event loop takes in the messages that have arrived, and s after which it is not waited for."""
UNUSED_MESSAGES = (
    _messages.FileTransferStartUpload,
    _messages.FileTransferPart,
    _messages.GuiFormDirtyMessage,
    _messages.GuiFormSubmitMessage,
)
REFUSAL_LOG_LINES = ("opening handshake failed", "connection rejected (403 Forbidden)")
"""Lines that websockets logs, with a traceback, when a request is refused; they are suppressed."""

log = logging.getLogger(__name__)


def open_server(host: str, port: int) -> viser.ViserServer:
    """A server that answers on this machine only. Raises ValueError with one sentence; port 0 takes any free port."""
    if host not in NAMES:
        raise ValueError(f"--host {host}: only 127.0.0.1 and localhost are served until the page has access control")
    if not 0 <= port < 2**16:
        raise ValueError(f"--port {port}: must lie between 0 and 65535")
    _refuse_busy(port)
    array_types.build_once()
    with (
        _guarded_serve(),
        contextlib.redirect_stdout(io.StringIO()),
    ):  # viser prints a table; the program prints one line instead
        server = viser.ViserServer(host=ADDRESS, port=port, verbose=False)
    if port not in (0, server.get_port()):  # another program was faster, and viser has silently taken the next port
        server.stop()
        raise ValueError(_busy(port))
    for message in (_messages.ShareUrlRequest, _messages.ShareUrlDisconnect):
        server._websock_server.unregister_handler(message)
    _drop_unused(server.gui)
    return server


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


def accept_values_only(client: viser.ClientHandle) -> None:
    """Let this client set only the values of its own controls and the poses of its own gizmos.

    The client is notified when it sends anything else for a control."""
    connection = client.gui._websock_interface
    (update,) = connection._incoming_handlers[_messages.GuiUpdateMessage]

    async def checked(client_id: Any, message: _messages.GuiUpdateMessage) -> None:
        try:
            if set(message.updates) != {"value"}:
                raise ValueError(f"only a control's value may be set, not {sorted(message.updates)}")
            await update(client_id, message)  # type: ignore[misc]
        except (ValueError, TypeError, AssertionError, OverflowError) as error:
            log.warning("client %s sent an invalid value for a control: %s", client_id, error)
            client.add_notification(
                "⚠ Not a value", "That control takes another kind of value.", color=palette.NOTIFY_ERROR
            )

    connection.unregister_handler(_messages.GuiUpdateMessage)
    connection.register_handler(_messages.GuiUpdateMessage, checked)  # type: ignore[arg-type]
    _accept_finite_poses_only(client)
    _drop_unused(client.gui)


def refusal(request: Request, port: int) -> str | None:
    """Why a request is refused, or None. Host must name this server; the Origin of a websocket must be the page."""
    hosts, origins = request.headers.get_all("Host"), request.headers.get_all("Origin")
    if len(hosts) != 1 or hosts[0].lower() not in {f"{name}:{port}" for name in NAMES}:
        return "This page answers only to its own address on this machine."
    page_origins = {f"http://{name}:{port}" for name in NAMES}
    if len(origins) > 1 or not page_origins.issuperset(origins):
        return "Requests from other sites are refused."
    if request.headers.get_all("Upgrade") and not origins:
        return "A websocket must say which page it comes from."
    return None


def add_headers(response: Response, port: int) -> None:
    """Add headers that forbid other sites to embed the page, and forbid the page to connect to other servers."""
    sockets = " ".join(f"ws://{name}:{port}" for name in NAMES)
    response.headers["X-Frame-Options"] = "DENY"
    response.headers["Content-Security-Policy"] = (
        # viser's page unpacks itself from an inline script, and starts its decoder from a blob.
        "default-src 'self' data: blob: 'unsafe-inline' 'unsafe-eval'; "
        f"connect-src 'self' data: blob: {sockets}; "
        "frame-ancestors 'none'; object-src 'none'; base-uri 'none'; form-action 'none'"
    )
    response.headers["Referrer-Policy"] = "no-referrer"
    response.headers["X-Content-Type-Options"] = "nosniff"
    response.headers["Cross-Origin-Resource-Policy"] = "same-origin"


@contextlib.contextmanager
def _guarded_serve():
    """Within this context, viser's call of `serve` goes through the checks of this module."""
    serve = websockets.asyncio.server.serve

    def guarded(handler: Any, host: str, port: int, *, process_request: Callable, **options: Any) -> Any:
        options["max_size"] = MAX_MESSAGE
        return serve(handler, host, port, process_request=_checked(process_request), **options)

    websockets.asyncio.server.serve = guarded  # type: ignore[assignment]
    try:
        yield
    finally:
        websockets.asyncio.server.serve = serve


def _checked(process_request: Callable) -> Callable[[ServerConnection, Request], Response | None]:
    """viser's HTTP answers, with refusals before them and with security headers."""
    logging.getLogger("websockets.server").addFilter(lambda record: record.getMessage() not in REFUSAL_LOG_LINES)

    def answer(connection: ServerConnection, request: Request) -> Response | None:
        port = connection.local_address[1]
        sentence = refusal(request, port)
        response = connection.respond(403, sentence + "\n") if sentence else process_request(connection, request)
        if response is not None:
            add_script(response)
            add_headers(response, port)
        return response

    return answer


def _accept_finite_poses_only(client: viser.ClientHandle) -> None:
    """Accept the pose of a gizmo only as finite numbers: viser would store any other, and fail at the next move."""
    connection = client.gui._websock_interface
    (update,) = connection._incoming_handlers[_messages.TransformControlsUpdateMessage]

    async def checked(client_id: Any, message: _messages.TransformControlsUpdateMessage) -> None:
        if _are_finite_numbers(message.position, 3) and _are_finite_numbers(message.wxyz, 4):
            await update(client_id, message)  # type: ignore[misc]
        else:
            log.warning("client %s sent an invalid pose of a gizmo", client_id)

    connection.unregister_handler(_messages.TransformControlsUpdateMessage)
    connection.register_handler(_messages.TransformControlsUpdateMessage, checked)  # type: ignore[arg-type]


def _are_finite_numbers(value: Any, count: int) -> bool:
    """Whether a value from a browser is a tuple of `count` finite numbers."""
    return (
        isinstance(value, tuple)
        and len(value) == count
        and all(isinstance(entry, float) and math.isfinite(entry) for entry in value)
    )


def _refuse_busy(port: int) -> None:
    """Try the port before viser does, with SO_REUSEADDR as servers set it: otherwise a port just freed looks busy."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((ADDRESS, port))
        except OSError:
            raise ValueError(_busy(port)) from None


def _busy(port: int) -> str:
    return f"--port {port}: in use or not allowed; stop the other program or choose another port"


def _drop_unused(gui: viser.GuiApi) -> None:
    """Refuse the messages of viser's forms and uploads.

    The page has no forms, and viser passes their messages on to every other visitor. viser collects uploads without
    limit, as the value of any control; `web.uploads` handles them for its own buttons."""
    for message in UNUSED_MESSAGES:
        gui._websock_interface.unregister_handler(message)
