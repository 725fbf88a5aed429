"""What a session sends to the browser beside the page itself: files and notices."""

import viser

from explorer.model import palette
from explorer.model.settings import Settings, effective
from explorer.panels.dock import Dock
from explorer.storage import preset_file
from explorer.storage.catalog import Catalog

NOTICE, WORK_NOTICE, ERROR_NOTICE = 4.0, 12.0, 10.0
"""s for which a notice, one about the visitor's work and one about an error stay."""


class Outgoing:
    """Files and notices for one visitor."""

    def __init__(self, client: viser.ClientHandle, catalog: Catalog) -> None:
        self._client, self._catalog = client, catalog

    def download(self, name: str, content: bytes) -> None:
        """Have the browser save a file."""
        self._client.send_file_download(name, content, save_immediately=True)

    def download_preset(self, dock: Dock) -> None:
        """Have the browser save the chosen settings as a preset."""
        name, settings = self.named_settings(dock)
        self.download(name, preset_file.document(settings))

    def named_settings(self, dock: Dock) -> tuple[str, Settings]:
        """A file name for the chosen settings, and the settings."""
        settings = dock.read()
        original = self._catalog.presets[settings.origin]
        return preset_file.file_name(settings.origin, effective(settings), original), settings

    def notify(self, title: str, sentence: str) -> None:
        """Show a title and a sentence for a few seconds."""
        self._client.add_notification(title, sentence, auto_close_seconds=NOTICE)

    def notify_about_work(self, sentence: str) -> None:
        """Say what became of the visitor's saved work."""
        self._client.add_notification(
            "Your work", sentence, color=palette.NOTIFY_WARNING, auto_close_seconds=WORK_NOTICE
        )

    def notify_of_error(self) -> None:
        """Say that something unforeseen went wrong; the log has the traceback."""
        text = "Something went wrong on the server; what you see may be out of date. The log has the details."
        self._client.add_notification(
            "⚠ Internal error", text, color=palette.NOTIFY_ERROR, auto_close_seconds=ERROR_NOTICE
        )
