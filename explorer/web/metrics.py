"""What the page says of itself to a monitoring program, at /metrics in the text format of Prometheus: numbers of all
visitors together, and nothing of one."""

from collections.abc import Callable

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, ProcessCollector, generate_latest
from prometheus_client.exposition import CONTENT_TYPE_LATEST

CONTENT_TYPE = CONTENT_TYPE_LATEST
PICTURE_BUCKETS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
"""s"""


class Metrics:
    """The counts of one server. Safe for threads."""

    def __init__(self) -> None:
        self._registry = registry = CollectorRegistry()
        ProcessCollector(registry=registry)
        self._visitors = Gauge("rangenav_visitors", "Connected tabs.", registry=registry)
        self._jobs = Gauge("rangenav_jobs", "Tabs for which a search or an export runs.", registry=registry)
        self._waiting = Gauge("rangenav_jobs_waiting", "Jobs that wait for a place.", registry=registry)
        self._pictures = Histogram(
            "rangenav_picture_seconds",
            "From reading a change to having sent its picture.",
            buckets=PICTURE_BUCKETS,
            registry=registry,
        )
        said = "Unforeseen errors; each has a traceback in the log."
        self._errors = Counter("rangenav_errors", said, registry=registry)
        self._refused = Counter("rangenav_refused", "Requests that were refused.", ["status"], registry=registry)

    def watch(self, *, visitors: Callable[[], float], jobs: Callable[[], float], waiting: Callable[[], float]) -> None:
        """Have numbers read whenever somebody asks."""
        self._visitors.set_function(visitors)
        self._jobs.set_function(jobs)
        self._waiting.set_function(waiting)

    def picture(self, seconds: float) -> None:
        """A picture was computed and sent."""
        self._pictures.observe(seconds)

    def error(self) -> None:
        """An unforeseen error was reported to a visitor."""
        self._errors.inc()

    def refused(self, status: int) -> None:
        """A request was refused."""
        self._refused.labels(status=str(status)).inc()

    def text(self) -> str:
        """All numbers."""
        return generate_latest(self._registry).decode()
