"""How much may be uploaded: so much by one visitor of a class, so much by all of them, and any amount on one's own
machine."""

import time

import pytest

from explorer.web import uploads
from explorer.web.uploads import MAX_BYTES, PER_CLASS, PER_VISITOR, Traffic


def _uploaded(traffic: Traffic, visitor: int, most: int = 100) -> tuple[int, str]:
    """How many of the largest files a visitor may upload one after the other, and why not one more."""
    for count in range(most):
        reason = traffic.enter(1, visitor, MAX_BYTES)
        if reason:
            return count, reason
        traffic.leave(1)
    return most, ""


def test_a_visitor_who_uploads_very_much_waits_and_another_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    traffic = Traffic()
    count, reason = _uploaded(traffic, visitor=1)
    assert count == PER_VISITOR[0] // MAX_BYTES
    assert reason.startswith("you have uploaded very much: try again in ")
    assert _uploaded(traffic, visitor=2)[0] == count
    later = time.monotonic() + MAX_BYTES / PER_VISITOR[1]
    monkeypatch.setattr(uploads.time, "monotonic", lambda: later)
    assert _uploaded(traffic, visitor=1)[0] == 1


def test_a_class_that_uploads_very_much_waits_and_no_file_is_counted_that_was_refused() -> None:
    traffic = Traffic()
    counts = [_uploaded(traffic, visitor) for visitor in range(1, 20)]
    assert sum(count for count, _ in counts) == PER_CLASS[0] // MAX_BYTES
    assert counts[-1][1].startswith("the class has uploaded very much")


def test_at_ones_own_machine_there_is_no_such_limit() -> None:
    assert _uploaded(Traffic(), visitor=0) == (100, "")
