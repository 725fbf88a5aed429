"""The visitor's own work: shown again when the tab opens, saved while it changes, and written once more at the end."""

import time

import viser

from explorer.model.settings import Settings
from explorer.panels import saved_page
from explorer.session.page import VisitorPage
from explorer.shared import Shared
from explorer.storage.autosave import Autosave
from explorer.storage.work_files import StorageError
from explorer.web.access.visitors import Visitor
from explorer.web.identity import session_key


class OwnWork:
    """The saved settings and view of one browser tab."""

    def __init__(self, client: viser.ClientHandle, page: VisitorPage, shared: Shared, visitor: Visitor | None) -> None:
        self._client, self._page, self._shared, self._visitor = client, page, shared, visitor
        self._autosave = Autosave(shared.work_files, shared.first, page.outgoing.notify_about_work)

    def restore(self) -> None:
        """Show the work that this tab's visitor had. A preset that was requested on the command line is shown instead,
        and undo then brings the work back."""
        page, shared = self._page, self._shared
        try:
            key = session_key(self._client, shared.slots)
            if key is not None and not shared.keeps_work_of(self._visitor, key.partition("-")[0]):
                raise StorageError("Your work is not kept: you have come with too many browsers.")
            work = self._autosave.restore(key)
        except StorageError as reason:
            page.outgoing.notify_about_work(str(reason))
            return
        if work is not None:
            requested = shared.requested and work.opened != shared.first
            saved_page.restore(work, page.dock, page.history, page.playback, page.catalog, as_a_step=requested)

    def remember(self, settings: Settings) -> None:
        """Have the settings and the view saved when that is due."""
        page = self._page
        view = saved_page.view_of(page.dock, page.history, page.playback)
        self._autosave.remember(settings, page.dock.gains.units, view)

    def wait(self, now: float) -> float | None:
        """How long (s) until something must be written; None if nothing must."""
        return self._autosave.wait(now)

    def write_if_due(self, now: float) -> None:
        """Write in a thread of its own what is due at a time (s, monotonic)."""
        self._autosave.write_aside(now)

    def write_last(self) -> None:
        """Write what is not saved yet, for a tab that still has its slot."""
        self._autosave.finish()
        if self._shared.slots.has(self._client.client_id):
            self._autosave.write(time.monotonic(), at_once=True)
