"""Who is connected: a session for each tab, from the moment it comes until it has gone."""

import viser

from explorer.session import Session
from explorer.shared import Shared


class SessionServer:
    """One session for each connected tab."""

    def __init__(self, server: viser.ViserServer, shared: Shared) -> None:
        self._server, self._shared = server, shared
        self._of: dict[int, Session] = {}
        server.on_client_disconnect(self._leave)
        server.on_client_connect(self._join)

    def _join(self, client: viser.ClientHandle) -> None:
        session = self._of[client.client_id] = Session(client, self._shared)
        session.start()
        if client.client_id not in self._server.get_clients():  # gone while it was being greeted
            self._leave(client)

    def _leave(self, client: viser.ClientHandle) -> None:
        session = self._of.pop(client.client_id, None)
        if session is not None:
            session.stop()
