"""Turns: no more jobs at work than places; the visitor who has had the least goes next; nobody waits for ever."""

import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from explorer.model.jobs import Jobs
from explorer.model.turns import SLICE, Places
from rangenav.progress import CancelledError
from tests.explorer.model.test_jobs import _until


class Clock:
    """A clock that the test moves (s)."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def _never() -> bool:
    return False


def _nothing() -> None:
    return None


def _begun(places: Places, share=None, cancelled=_never):
    """A job's turn, and the event that says it has a place."""
    turn, placed = (share or places.share()).turn(cancelled, _nothing), threading.Event()

    def wait() -> None:
        try:
            turn.wait()
            placed.set()
        except CancelledError:
            return

    thread = threading.Thread(target=wait, daemon=True)
    thread.start()
    _until(lambda: placed.is_set() or turn in places.waiting or not thread.is_alive())
    return turn, placed


def test_a_job_beyond_the_places_waits_and_knows_how_many_are_before_it():
    places = Places(2)
    (first, a), (_, b), (third, c), (fourth, _) = [_begun(places) for _ in range(4)]
    assert a.is_set()
    assert b.is_set()
    assert not c.is_set()
    assert (first.ahead, third.ahead, fourth.ahead) == (0, 2, 3)
    first.end()
    assert c.wait(5)
    assert fourth.ahead == 2


def test_a_short_job_waits_for_one_slice_of_a_long_one_and_the_long_one_goes_on():
    clock = Clock()
    places = Places(1, clock)
    long, _ = _begun(places)
    short, placed = _begun(places)
    long.go_on()
    assert not placed.is_set()  # the slice is not over
    clock.now += SLICE
    back = threading.Thread(target=long.go_on, daemon=True)
    back.start()
    assert placed.wait(5)
    assert back.is_alive()
    assert long.ahead == 1
    short.end()
    back.join(5)
    assert not back.is_alive()
    assert long.ahead == 0


def test_of_those_who_wait_the_visitor_with_the_least_time_is_next():
    clock = Clock()
    places = Places(1, clock)
    greedy, modest = places.share(), places.share()
    one, _ = _begun(places, greedy)
    two, second = _begun(places, greedy)
    other, placed = _begun(places, modest)
    clock.now += 0.5 * SLICE
    one.end()
    assert placed.wait(5)
    assert not second.is_set()
    other.end()
    assert second.wait(5)
    two.end()
    assert not places.working
    assert not places.waiting


def test_a_job_whose_visitor_is_alone_keeps_its_place():
    clock = Clock()
    places = Places(1, clock)
    share = places.share()
    first, _ = _begun(places, share)
    _, placed = _begun(places, share)
    clock.now += 10 * SLICE
    first.go_on()
    assert not placed.is_set()
    assert first.ahead == 0


def test_a_job_that_is_cancelled_while_it_waits_leaves_the_queue():
    places, cancelled = Places(1), threading.Event()
    first, _ = _begun(places)
    share = places.share()
    second, placed = _begun(places, share, cancelled.is_set)
    cancelled.set()
    share.wake()
    _until(lambda: second not in places.waiting)
    assert not placed.is_set()
    assert share.jobs == 0
    first.end()
    assert not places.working


@given(jobs=st.lists(st.tuples(st.integers(0, 4), st.integers(1, 6)), min_size=1, max_size=12), count=st.integers(1, 3))
def test_every_job_ends_and_no_more_than_the_places_work_at_once(jobs, count):
    """Each job is a visitor and a number of steps; every step asks whether to go on. A clock that stands a slice
    further at each look makes every step the end of a slice."""
    ticks = iter(range(10**9))
    places = Places(count, lambda: next(ticks) * SLICE)
    shares = [places.share() for _ in range(5)]
    most, ended, lock = [0], [], threading.Lock()

    def work(number: int, visitor: int, steps: int) -> None:
        turn = shares[visitor].turn(_never, _nothing)
        turn.wait()
        for _ in range(steps):
            with lock:
                most[0] = max(most[0], len(places.working))
            turn.go_on()
        turn.end()
        ended.append(number)

    threads = [threading.Thread(target=work, args=(n, *job), daemon=True) for n, job in enumerate(jobs)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(10)
    assert sorted(ended) == list(range(len(jobs)))
    assert most[0] <= count
    assert all(share.jobs == share.working == 0 for share in shares)


def test_a_job_in_the_queue_says_so_and_stopping_it_frees_nothing_of_others():
    places, go = Places(1), threading.Event()
    one, other = Jobs(_nothing, places.share()), Jobs(_nothing, places.share())
    first = one.start("basin", lambda *_: go.wait(5), lambda _: None, pytest.fail)
    second = other.start("seeds", lambda *_: "never", pytest.fail, pytest.fail)
    _until(lambda: second.ahead == 1)
    other.cancel()
    _until(lambda: not places.waiting)
    go.set()
    _until(lambda: first.finished)
    assert first.result is True
    assert not places.working
