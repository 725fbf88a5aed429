"""The page's program as a person starts it, in a process of its own, with its own folders; driven through `Wire`."""

import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

import msgspec

from explorer.storage.autosave import SavedWork
from tests.support.wire import Storage, Wire

END_TIMEOUT = 30.0
"""s in which the program must end after a signal."""


def _heed_signals() -> None:
    """What ignores a signal hands that on to the programs it starts: tests that run under nohup ignore SIGHUP."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


class ServerProcess:
    """`python -m explorer` on a free port."""

    def __init__(self, folder: Path) -> None:
        """`folder` holds the state and the data."""
        self.work = folder / "state" / "work"
        environment = os.environ | {"RANGENAV_STATE": str(folder / "state"), "RANGENAV_DATA": str(folder / "data")}
        command = [sys.executable, "-m", "explorer", "--no-browser", "--port", "0"]
        self._process = subprocess.Popen(
            command,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=_heed_signals,
        )
        self.errors = ""
        """What the program had written to its standard error stream when it ended."""
        assert self._process.stdout is not None
        self.port = int(self._process.stdout.readline().rstrip("/\n").rpartition(":")[2])

    def connect(self, storage: Storage) -> Wire:
        """A visitor whose first picture has been drawn."""
        tab = Wire(self.port, storage=storage)
        tab.wait_for_text("of 13</b>, nonlinear")
        return tab

    def end(self, number: signal.Signals) -> int:
        """Send a signal, and wait until the program has ended. Returns its exit code."""
        self._process.send_signal(number)
        try:
            return self._process.wait(END_TIMEOUT)
        finally:
            self._process.kill()
            self.errors = self._process.communicate()[1]

    def fill_disk(self, *, full: bool) -> None:
        """Have the system refuse every byte that the program writes to a file, or take it again."""
        _, most = resource.prlimit(self._process.pid, resource.RLIMIT_FSIZE)
        resource.prlimit(self._process.pid, resource.RLIMIT_FSIZE, (0 if full else most, most))

    def saved(self) -> SavedWork:
        """The saved work of the only tab that there was."""
        (work,) = self.all_saved()
        return work

    def all_saved(self) -> list[SavedWork]:
        """The saved work of every tab."""
        return [msgspec.json.decode(file.read_bytes(), type=SavedWork) for file in self.work.glob("*.json")]
