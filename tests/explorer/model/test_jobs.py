"""Jobs: the result arrives in the loop that asks for it, unless the job was stopped or replaced."""

import gc
import threading
import time
import weakref
from functools import partial

import pytest

from explorer.model.jobs import Jobs
from rangenav.progress import CancelledError


def _until(holds, timeout: float = 5.0) -> None:
    deadline = time.monotonic() + timeout
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.005)


def _delivered(jobs: Jobs) -> None:
    job = jobs.running
    assert job is not None
    _until(lambda: job.finished)
    jobs.deliver()


def test_a_result_is_handed_over_in_the_thread_that_asks_for_it():
    got, woken = [], threading.Event()
    jobs = Jobs(woken.set)
    jobs.start(
        "sum", lambda progress, cancelled: sum(range(10)), lambda r: got.append((r, threading.get_ident())), got.append
    )
    assert woken.wait(5)
    _delivered(jobs)
    assert got == [(45, threading.get_ident())]
    assert jobs.running is None


def test_progress_is_seen_while_the_work_goes_on():
    go = threading.Event()

    def work(progress, cancelled):
        progress(0.25)
        go.wait(5)
        progress(7.0)

    jobs = Jobs(lambda: None)
    jobs.start("wait", work, lambda _: None, lambda _: None)
    job = jobs.running
    assert job is not None
    _until(lambda: job.fraction == 0.25)
    jobs.deliver()
    assert jobs.running is job
    go.set()
    _delivered(jobs)
    assert job.fraction == 1.0


def test_a_cancelled_job_hears_of_it_and_reports_nothing():
    calls, got = threading.Event(), []

    def work(progress, cancelled):
        _until(cancelled)
        calls.set()
        raise CancelledError

    jobs = Jobs(lambda: None)
    jobs.start("long", work, got.append, got.append)
    jobs.cancel()
    assert calls.wait(5)
    jobs.deliver()
    assert got == []
    assert jobs.running is None


def test_a_job_that_is_started_overtakes_the_one_before():
    got = []
    jobs = Jobs(lambda: None)
    jobs.start("first", lambda progress, cancelled: _until(cancelled), lambda _: got.append("first"), got.append)
    jobs.start("second", lambda progress, cancelled: 2, got.append, got.append)
    _delivered(jobs)
    assert got == [2]


def test_bad_input_is_a_sentence_and_a_fault_is_raised_where_it_is_logged():
    got = []
    jobs = Jobs(lambda: None)

    def refuse(progress, cancelled):
        raise ValueError("the window is too long")

    jobs.start("refuse", refuse, got.append, lambda sentence: got.append(sentence.upper()))
    _delivered(jobs)
    assert got == ["THE WINDOW IS TOO LONG"]
    jobs.start("fault", lambda progress, cancelled: 1 / 0, got.append, got.append)
    job = jobs.running
    assert job is not None
    _until(lambda: job.finished)
    with pytest.raises(ZeroDivisionError):
        jobs.deliver()
    assert jobs.running is None


class Material:
    """Something large that a job works on."""


def _refuse(_material: Material) -> None:
    raise ValueError("no")


@pytest.mark.parametrize("ending", ["done", "refused", "cancelled"])
def test_what_a_job_has_worked_on_is_freed_with_its_last_user(ending: str):
    """Without waiting for the garbage collector: the pictures of thirty visitors would fill the memory meanwhile."""
    jobs, material = Jobs(lambda: None), Material()
    alive, go = weakref.ref(material), threading.Event()

    def work(material, _progress, cancelled):
        go.wait(5)
        if cancelled():
            raise CancelledError
        if ending == "refused":
            _refuse(material)

    gc.disable()
    try:
        jobs.start("work", partial(work, material), lambda _: None, lambda _: None)
        del material
        if ending == "cancelled":
            jobs.cancel()
        go.set()
        if ending != "cancelled":
            _delivered(jobs)
        _until(lambda: alive() is None)
    finally:
        gc.enable()
