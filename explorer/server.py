"""Which tabs are connected: each has a session from the moment it connects until it has left."""

import viser

from explorer.scene.lights import light
from explorer.session import Session
from explorer.shared import Shared


class SessionServer:
    """Makes a session for every tab that connects, and stops it when the tab leaves."""

    def __init__(self, server: viser.ViserServer, shared: Shared) -> None:
        self._server, self.shared = server, shared
        self._by_client: dict[int, Session] = {}
        light(server.scene)
        server.on_client_disconnect(self._leave)
        server.on_client_connect(self._join)

    @property
    def sessions(self) -> tuple[Session, ...]:
        """The sessions of the connected tabs, in the order in which they connected."""
        return tuple(self._by_client.values())

    def _join(self, client: viser.ClientHandle) -> None:
        session = self._by_client[client.client_id] = Session(client, self.shared)
        session.start()
        if client.client_id not in self._server.get_clients():  # the tab left before its session was created
            self._leave(client)

    def _leave(self, client: viser.ClientHandle) -> None:
        session = self._by_client.pop(client.client_id, None)
        if session is not None:
            session.stop()
