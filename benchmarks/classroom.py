"""A class: many visitors who all play their run and now and then drag a gain, on one server.

Each visitor drags the slider of a gain for one second, with ten events, every ten seconds, at moments of its own. The
figures are those of the server's process; the visitors have no browser, share one process, and what they cost is
printed beside. With `--chromium` two real tabs play instead: how often they draw, and how long a slider waits.

Memory is what the process has for itself (private pages). A process loads once what all visitors share: libraries, the
kernels of all estimators, the first picture of the preset. The first visitor therefore plays and drags before the
memory of one visitor is read, and a visitor costs what the process grows by for each further one. While all drag, the
arrays of pictures that are being computed come and go, some MB at each moment: the memory of a minute is the median of
its last ten seconds, in which each visitor drags once. The growth is that from the end of the warm-up to the end.
"""

import argparse
import asyncio
import math
import os
import random
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from timing import Target, report, versions
from visitor import Visitor

ROOT = Path(__file__).parent.parent
EVENTS, DRAG, EVERY = 10, 1.0, 10.0
"""Events of a drag, its length (s), and the time from one drag of a visitor to the next (s)."""
QUIET = 10.0
"""s over which nobody moves, and then over which all play and nobody drags."""
SAMPLE = 0.5
"""s between two readings of the memory."""
SETTLING = 12.0
"""s for the proofs of the first pictures and for the estimators to be compiled."""
WINDOW = 1366, 768
"""px"""
MOVES = """async seconds => {
    const root = getComputedStyle(document.documentElement), moments = [], end = performance.now() + 1000 * seconds;
    for (let shown = ''; performance.now() < end;) {
        await new Promise(done => requestAnimationFrame(done));
        const share = root.getPropertyValue('--tcur');
        if (share !== shown) { shown = share; moments.push(performance.now()); }
    }
    return moments;
}"""
"""When (ms) the cursor was seen at another place, of each frame of the browser."""
PLAYING, RATE, IDLE, LATENCY, PER_VISITOR, GROWTH = 1.5, 15.0, 0.1, 200.0, 5.0, 5.0
"""Bars: % of a core for a visitor who plays, frames a second, % of a core for one who does nothing, ms (p95) from an
event to its picture, MB for a visitor, and MB by which all together may grow after the warm-up."""


@dataclass
class Spent:
    """What a time has cost: shares of a core (%) of the server and of the visitors, and what came."""

    server: float
    visitors: float
    messages: float
    """To one visitor, per second."""
    bytes: float
    """To one visitor, per second."""


class Class:
    """A server and its visitors."""

    def __init__(self, process: subprocess.Popen[str], count: int) -> None:
        assert process.stdout is not None
        self.port = int(process.stdout.readline().rstrip("/\n").rpartition(":")[2])
        self._process = Path("/proc") / str(process.pid)
        self.visitors = [Visitor(self.port) for _ in range(count)]

    @property
    def memory(self) -> float:
        """MB that the server's process has for itself."""
        lines = (self._process / "smaps_rollup").read_text(encoding="ascii").splitlines()
        return sum(int(line.split()[1]) for line in lines if line.startswith("Private_")) / 1024

    def errors(self) -> int:
        """Unforeseen errors that the server has counted."""
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/metrics", timeout=10) as answer:
            lines = answer.read().decode().splitlines()
        return int(float(next(line for line in lines if line.startswith("rangenav_errors_total")).split()[1]))

    async def over(self, seconds: float) -> Spent:
        """Wait, and say what that has cost."""
        began, ours, theirs = time.monotonic(), time.process_time(), self._processor_time()
        messages, taken = (sum(getattr(one, name) for one in self.visitors) for name in ("messages", "bytes"))
        await asyncio.sleep(seconds)
        length, count = time.monotonic() - began, len(self.visitors)
        return Spent(
            server=100 * (self._processor_time() - theirs) / length,
            visitors=100 * (time.process_time() - ours) / length,
            messages=(sum(one.messages for one in self.visitors) - messages) / length / count,
            bytes=(sum(one.bytes for one in self.visitors) - taken) / length / count,
        )

    def _processor_time(self) -> float:
        words = (self._process / "stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        return sum(map(int, words[11:13])) / os.sysconf("SC_CLK_TCK")


@contextmanager
def _served() -> Iterator[subprocess.Popen[str]]:
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"RANGENAV_STATE": f"{folder}/state", "RANGENAV_DATA": f"{folder}/data"}
        command = [sys.executable, "-m", "explorer", "--no-browser", "--port", "0"]
        process = subprocess.Popen(command, env=environment, cwd=ROOT, stdout=subprocess.PIPE, text=True)
        try:
            yield process
        finally:
            process.terminate()
            process.communicate()


async def _work(visitor: Visitor, seconds: float, chance: random.Random) -> None:
    """Drag now and then, at moments of one's own."""
    end = time.monotonic() + seconds
    await asyncio.sleep(chance.uniform(0.0, EVERY))
    while time.monotonic() < end - EVERY:
        began = time.monotonic()
        await visitor.drag(EVENTS, DRAG, chance.random())
        await asyncio.sleep(max(0.0, began + EVERY - time.monotonic()))


async def _warm_up(visitor: Visitor) -> None:
    """Have one visitor do all that the others will do, so that the process has loaded what all share."""
    await visitor.join()
    await asyncio.sleep(SETTLING)
    await visitor.play()
    await visitor.drag(EVENTS, DRAG, 0.0)
    await asyncio.sleep(SETTLING)
    await visitor.play()
    await asyncio.sleep(SETTLING)


async def _by_minutes(room: Class, minutes: float) -> list[float]:
    """MB of each minute, the last one included if it is a part of one."""
    began, memory = time.monotonic(), list[float]()
    for minute in range(1, math.ceil(minutes) + 1):
        end, samples = began + 60 * min(minute, minutes), list[float]()
        await asyncio.sleep(max(0.0, end - EVERY - time.monotonic()))
        while time.monotonic() < end or not samples:
            samples.append(room.memory)
            await asyncio.sleep(SAMPLE)
        memory.append(statistics.median(samples))
    return memory


async def _measure(process: subprocess.Popen[str], count: int, minutes: float, warm_up: float) -> None:
    room = Class(process, count)
    await _warm_up(room.visitors[0])
    alone = room.memory
    for visitor in room.visitors[1:]:
        await visitor.join()
    await asyncio.sleep(SETTLING)
    joined, idle = room.memory, await room.over(QUIET)
    for visitor in room.visitors:
        await visitor.play()
    await asyncio.sleep(2.0)
    playing = await room.over(QUIET)
    chance = random.Random(1)
    length = 60 * (minutes + warm_up)
    drags = [asyncio.create_task(_work(visitor, length + EVERY, chance)) for visitor in room.visitors]
    sampler = asyncio.create_task(_by_minutes(room, warm_up + minutes))
    await asyncio.sleep(60 * warm_up)
    for visitor in room.visitors:
        visitor.waits.clear()
    working = await room.over(60 * minutes)
    by_minutes = await sampler
    warm, end = by_minutes[max(round(warm_up) - 1, 0)], by_minutes[-1]
    await asyncio.gather(*drags)
    errors = room.errors()
    for visitor in room.visitors:
        await visitor.leave()
    closed = [visitor.closed for visitor in room.visitors if visitor.closed]
    waits = np.array([wait for visitor in room.visitors for wait in visitor.waits])
    lost = sum(visitor.lost for visitor in room.visitors)
    pictures = sum(visitor.pictures for visitor in room.visitors)
    p50, p95, worst = (float(one) for one in np.percentile(waits, (50, 95, 100)))
    minutes_shown = " ".join(f"{one:.0f}" for one in by_minutes)
    each = (joined - alone) / max(count - 1, 1)
    report(
        "classroom",
        title=f"{count} visitors, all playing; each drags a gain for {DRAG:g} s every {EVERY:g} s, {minutes:g} min",
        columns=("", "server, a core", "visitors, a core", "messages a visitor", "bytes a visitor"),
        rows=[
            _row("nobody moves", idle),
            _row("all play", playing),
            _row("all play, and drag", working),
        ],
        targets=[
            Target(name="errors", value=errors + lost + len(closed), bound=0, at_least=False),
            Target(name="from event to picture, p95", value=p95, bound=LATENCY, at_least=False, unit=" ms"),
            Target(name="a visitor who plays", value=playing.server / count, bound=PLAYING, at_least=False, unit=" %"),
            Target(name="frames of a visitor who plays", value=playing.messages, bound=RATE, at_least=True, unit="/s"),
            Target(name="an idle visitor", value=idle.server / count, bound=IDLE, at_least=False, unit=" %"),
            Target(name="memory of a visitor", value=each, bound=PER_VISITOR, at_least=False, unit=" MB"),
            Target(name="growth after the warm-up", value=end - warm, bound=GROWTH, at_least=False, unit=" MB"),
        ],
        notes=[
            f"from event to picture: p50 {p50:.0f} ms, p95 {p95:.0f} ms, max {worst:.0f} ms of {len(waits)} events",
            f"{pictures} pictures; errors {errors}, events without an answer {lost}, connections closed {closed}",
            f"memory in MB: {alone:.0f} with one visitor, {joined:.0f} with all, {warm:.0f} warm, {end:.0f} at the end",
            f"memory in MB in each minute of dragging, from the warm-up on: {minutes_shown}",
        ],
        figures={
            "visitors": count,
            "milliseconds": {"median": p50, "p95": p95, "worst": worst},
            "megabytes": {"one": alone, "all": joined, "warm": warm, "end": end, "minutes": by_minutes},
            "versions": versions("numpy", "numba", "viser", "websockets"),
        },
    )


def _row(name: str, spent: Spent) -> tuple[str, ...]:
    figures = (
        f"{spent.server:.1f} %",
        f"{spent.visitors:.1f} %",
        f"{spent.messages:.1f}/s",
        f"{spent.bytes / 1e3:.1f} kB/s",
    )
    return name, *figures


def _in_browsers() -> None:
    """Two real tabs that play, on one server: moves of the cursor that each has shown, and the longest pause."""
    from tests.browser import page

    reason = page.why_not()
    rows: list[tuple[str, ...]] = []
    if not reason:
        with page.served() as server, page.chromium() as browser:
            width, height = WINDOW
            tabs = [browser.new_context(viewport={"width": width, "height": height}).new_page() for _ in range(2)]
            for tab in tabs:
                tab.set_default_timeout(1000 * page.PATIENCE)
                tab.add_init_script(page.WELCOMED)
                tab.goto(server.url)
                tab.wait_for_function(page.READY)
                tab.wait_for_function(f"() => document.body.innerText.includes('{page.VERDICT}')")
                tab.keyboard.press(" ")
            for number, tab in enumerate(tabs, 1):
                moments = np.array(tab.evaluate(MOVES, QUIET))
                rows.append((f"tab {number}", f"{len(moments) / QUIET:.1f}/s", f"{np.diff(moments).max():.0f} ms"))
    report(
        "classroom in Chromium",
        title="Two tabs that play, rendered in software",
        columns=("", "moves of the cursor", "longest pause"),
        rows=rows,
        targets=[],
        notes=[reason] if reason else [],
        figures={"tabs": rows},
    )


def main(visitors: int, minutes: float, warm_up: float, chromium: bool) -> None:
    """Measure, print."""
    if chromium:
        _in_browsers()
        return
    with _served() as process:
        asyncio.run(_measure(process, visitors, minutes, warm_up))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--visitors", type=int, default=30)
    parser.add_argument("--minutes", type=float, default=10.0, help="of dragging after the warm-up")
    parser.add_argument("--warm-up", type=float, default=2.0, help="minutes of dragging before")
    parser.add_argument("--chromium", action="store_true", help="two real tabs instead")
    arguments = parser.parse_args()
    main(arguments.visitors, arguments.minutes, arguments.warm_up, arguments.chromium)
