"""Which tabs are connected: each has a session from the moment it connects until it has left or the server stops."""

import time

import viser

from explorer.scene.lights import light
from explorer.session import Session
from explorer.shared import Shared
from explorer.web.access.visitors import Visitor
from explorer.web.security import receive_pending, request_of

STOP_TIMEOUT = 10.0
"""s for all sessions to end: one that is computing a picture ends after it."""


class SessionServer:
    """Makes a session for every tab that connects, and stops it when the tab leaves."""

    def __init__(self, server: viser.ViserServer, shared: Shared) -> None:
        self._server, self.shared = server, shared
        self._by_client: dict[int, Session] = {}
        self._stopping = False
        light(server.scene)
        shared.metrics.watch(
            visitors=lambda: len(self._by_client),
            jobs=lambda: sum(session.works for session in self.sessions),
            waiting=lambda: len(shared.places.waiting),
        )
        server.on_client_disconnect(self._leave)
        server.on_client_connect(self._join)

    @property
    def sessions(self) -> tuple[Session, ...]:
        """The sessions of the connected tabs, in the order in which they connected."""
        return tuple(self._by_client.values())

    def stop(self) -> None:
        """End all sessions, and wait until each has saved what was changed, also a moment ago."""
        self._stopping = True
        receive_pending(self._server)
        stopped, deadline = self.sessions, time.monotonic() + STOP_TIMEOUT
        for session in stopped:
            session.stop()
        for session in stopped:
            session.thread.join(max(0.0, deadline - time.monotonic()))

    def _join(self, client: viser.ClientHandle) -> None:
        if self._stopping:
            return
        self.shared.compilation.visited.set()
        visitor = self._visitor(client)
        if visitor is None and self.shared.entrance is not None:  # left already, or was sent out
            return
        session = self._by_client[client.client_id] = Session(client, self.shared, visitor)
        session.start()
        if client.client_id not in self._server.get_clients():  # the tab left before its session was created
            self._leave(client)

    def _visitor(self, client: viser.ClientHandle) -> Visitor | None:
        """Who has come in; None where everybody at this machine may."""
        request = request_of(self._server, client.client_id)
        if self.shared.entrance is None or request is None:
            return None
        return self.shared.entrance.visitor(request, self._server.get_port())

    def _leave(self, client: viser.ClientHandle) -> None:
        session = self._by_client.pop(client.client_id, None)
        if session is not None:
            session.stop()
