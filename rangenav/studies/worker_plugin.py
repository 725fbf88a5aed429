"""A worker on this machine does not end by the Ctrl+C of its terminal: the program that started it ends it.

Imported where a cluster is started, because it imports dask.
"""

import signal

from distributed import Worker, WorkerPlugin


class IgnoreInterrupt(WorkerPlugin):
    """Ignores SIGINT in a worker; one that is started again gets it, too."""

    def setup(self, worker: Worker) -> None:
        """Called by dask in the main thread of the worker's process."""
        signal.signal(signal.SIGINT, signal.SIG_IGN)
