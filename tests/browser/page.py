"""A visitor's browser, driven from Python: the one file that knows viser's undocumented page (checked against 1.1.1).

A control is found by its label, a plot by the label of one of its curves, a node of the scene by its name. What is read
is what the browser has: chart data, node poses, text on the page.
"""

import json
import math
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from playwright.sync_api import Browser, ConsoleMessage, Error, Locator, Page, Playwright, ViewportSize, sync_playwright

from tests.browser import spare_pages
from tests.browser.page_scripts import FEW_FRAMES, ONE_SAMPLE, UNDRAWN, WELCOMED

CHROMIUM = next((path for path in ("/usr/bin/chromium", "/usr/bin/chromium-browser") if Path(path).exists()), None)
FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-accelerated-2d-canvas",  # without it one plot drops the page to 8 frames per second
    "--disable-gpu-rasterization",  # the emulation of a GPU draws the scene alone: text and panels take twice as long
    "--disable-gpu-compositing",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
INPUT_PAUSE = 0.08
"""s between inputs: viser's page sends at most one per 50 ms and panel."""
PATIENCE = 120.0
"""s: a busy machine that renders in software may need seconds for a frame."""
PERIOD = 0.1
"""s between two looks at a condition: a look at a plot takes a hundredth of a second in the browser and here."""
COARSE = 0.5
"""Pixels of the screen for each pixel of the page: a quarter of the work for a software renderer."""
VERDICT = "from one window of"
FIRST = "(paper-slow)"
"""The preset of a new page."""
AT_START = "[...document.querySelectorAll('b')].some(one => one.textContent === '0.00 s')"
"""Whether the playhead stands at the beginning."""
FIRST_PLOTS = "Errors"
PLOTS_IN_FRONT = f"""[...document.querySelectorAll('[role=tab][aria-selected=true]')]
    .some(tab => tab.textContent.trim() === '{FIRST_PLOTS}')"""
"""Whether the first tab of plots is in front."""
READY = "() => window.__viserMutable && !document.body.innerText.includes('Connecting...')"
CHARTS = "Object.values((window.__viserTestpoints || {}).uplots || {}).map(entry => entry.chart)"
FIND_CHART = f"(label) => {CHARTS}.find(chart => chart.series.some(series => series.label === label))"
WRITTEN = """([...document.body.children].filter(part => part.matches(':not(.rn-unseen, script, style, noscript)'))
    .map(part => part.innerText).join('\\n') + ((document.querySelector('.rn-rows') || {}).textContent || ''))
    .replaceAll('\\u00a0', ' ')"""
"""What a reader sees, and not what is only spoken: a no-break space is a space."""
IS_OPEN = "head => head.querySelector('.tabler-icon-chevron-up') !== null"
"""Of the heading of a folder."""
BLUR = "() => document.activeElement.blur()"
"""What was clicked, such as a dropdown or a tab, keeps the focus, and with it the keys."""
USUAL_COMPLAINT = "Unable to preventDefault inside passive event listener"
"""viser's own, at each press on a node that can be dragged; the drag is none the worse for it."""
TAB = "[role=tab]:visible"
BUTTON = """:is(button, [role=button]):not(.mantine-Paper-root)\
:is(:has-text(NAME):not([aria-label]), [aria-label*=NAME i]):visible"""
"""To look for them by role and name takes three times as long: for that every element's name is computed."""
Read = TypeVar("Read")
ROW = "xpath=ancestor::div[./div[2]][1]/div[2]"
"""From the label of a control to the control itself."""


class Server:
    """The command, as a user starts it."""

    def __init__(self, *arguments: str) -> None:
        self._arguments = arguments
        self._start(0)

    def _start(self, port: int) -> None:
        command = [sys.executable, "-m", "explorer", "--no-browser", "--port", str(port), *self._arguments]
        self._began = time.monotonic()
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        assert self._process.stdout is not None
        self.url = self._process.stdout.readline().strip()
        self.seconds_to_answer = time.monotonic() - self._began

    def next_line(self) -> str:
        """What it prints after the address."""
        assert self._process.stdout is not None
        return self._process.stdout.readline().strip()

    def restart(self) -> None:
        """Ended, and started again at the same address."""
        port = self.port
        self.stop()
        self._start(port)

    @property
    def port(self) -> int:
        """Where it listens."""
        return int(self.url.rstrip("/").rsplit(":", 1)[1])

    def stop(self) -> str:
        """End it as Ctrl+C would; what it has printed beside the address."""
        self._process.send_signal(signal.SIGINT)
        try:
            return self._process.communicate(timeout=10)[0]
        except subprocess.TimeoutExpired:
            self._process.kill()
            return self._process.communicate()[0]


@contextmanager
def served(*arguments: str) -> Iterator[Server]:
    """A server for as long as it is needed."""
    server = Server(*arguments)
    try:
        yield server
    finally:
        server.stop()


@contextmanager
def chromium() -> Iterator[Browser]:
    """A headless Chromium."""
    with sync_playwright() as playwright:
        browser = launch(playwright)
        yield browser
        browser.close()


def launch(playwright: Playwright) -> Browser:
    """A headless Chromium of the system."""
    return playwright.chromium.launch(executable_path=CHROMIUM, headless=True, args=FLAGS)


class Visitor:
    """One tab on the page."""

    def __init__(
        self,
        browser: Browser,
        url: str,
        *,
        width: int = 1366,
        height: int = 768,
        density: float = 1,
        beside: "Visitor | None" = None,
        says: str = VERDICT,
        welcomed: bool = True,
        drawn: bool = False,
        code: str = "",
    ) -> None:
        """`beside` another one it is a second tab of the same browser; the page is drawn when it says `says`.

        `welcomed`: whether the card of the first visit was closed before; `drawn`: whether the pixels of the scene are
        computed; `code`: what is typed at the door of a class."""
        self.complaints: list[str] = []
        """Errors in the browser's console, and uncaught ones."""
        self._says, self._new, self._failures = says, True, 0
        chosen = ((FEW_FRAMES, True), (ONE_SAMPLE, density < 1), (UNDRAWN, not drawn), (WELCOMED, welcomed))
        self._kind = spare_pages.Kind(browser, density, tuple(script for script, wanted in chosen if wanted))
        self._size, self._beside = ViewportSize(width=width, height=height), beside
        self.url, self._code = url, code
        self._open()

    def _open(self) -> None:
        beside = self._beside
        self.page: Page = beside.page.context.new_page() if beside else spare_pages.take(self._kind, self._size)
        self._heard: dict[str, Callable] = {"console": self._listen, "pageerror": self._notice}
        for event, hear in self._heard.items():
            self.page.on(event, hear)  # type: ignore[call-overload]
        self.page.goto(self.url)
        if self._code:
            self.page.get_by_label("Code that your teacher shows").fill(self._code.lower())
            self.page.keyboard.press("Enter")
        self.wait_until_drawn()

    def _notice(self, error: Error) -> None:
        self.complaints.append(str(error))

    def _listen(self, message: ConsoleMessage) -> None:
        if message.type == "error" and not message.text.startswith(USUAL_COMPLAINT):
            self.complaints.append(message.text)

    def wait_until_drawn(self, timeout: float = PATIENCE) -> None:
        """Until the first verdict is on the page."""
        self.page.wait_for_function(READY, timeout=timeout * 1000)
        self.wait_for_text(self._says, timeout)

    def reload(self) -> None:
        """As with the browser's button."""
        self.page.reload()
        self.wait_until_drawn()

    def begin_anew(self, failures: int = 0, *, tab: str = "Motion") -> None:
        """The first preset as it is shipped, at its start, whatever an earlier test has left, with a tab in front.

        `failures`: how many tests have failed so far. After one more the page is a new one, for anything may be open.
        """
        if failures != self._failures:
            self.page.context.close()
            self._new, self._failures = True, failures
            self._open()
            self.dismiss_notifications()
        self.complaints.clear()
        if self._new:
            self._new = False
            self.tab(tab)
            self.page.evaluate(BLUR)
            return
        if not self.page.evaluate(PLOTS_IN_FRONT):
            self.tab(FIRST_PLOTS)
        self.tab("Presets")
        if FIRST in self.typed("preset"):
            self.press("start this preset again")
        else:
            self.choose("preset", FIRST)
        if tab != "Presets":
            self.tab(tab)
        self.page.evaluate(BLUR)
        self.page.keyboard.press("ArrowRight")  # a moment is shown once everything before it has been done
        self.page.wait_for_function(f"() => !{AT_START}")
        self.page.keyboard.press("Home")
        self.page.wait_for_function(f"() => {AT_START}")
        self.wait_for_text(self._says)

    @contextmanager
    def reconnecting(self) -> Iterator[None]:
        """For a block that ends the connection: afterwards the page has been built anew over another one."""
        self.page.evaluate("() => { window.__viserMutable.nodeRefFromName['/path'].userData.old = true }")
        yield
        self.page.wait_for_function(
            "() => { const path = window.__viserMutable.nodeRefFromName['/path']; return path && !path.userData.old }",
            timeout=PATIENCE * 1000,
        )
        self.wait_until_drawn()

    def close(self) -> None:
        """Close the tab, or leave it to the next visitor."""
        for event, hear in self._heard.items():
            self.page.remove_listener(event, hear)
        self.page.close() if self._beside else spare_pages.leave(self._kind, self.page)

    def wait_until_saved(self, text: str) -> None:
        """Until the work of some tab that is saved on this machine has a text in it."""
        folder, deadline = Path(os.environ["RANGENAV_STATE"]) / "work", time.monotonic() + PATIENCE
        while not any(text in file.read_text(encoding="utf-8") for file in folder.glob("*.json")):
            assert time.monotonic() < deadline, f"waited in vain for saved work with {text}"
            time.sleep(0.05)

    def text(self) -> str:
        """Everything written on the page, also what is folded below the verdict."""
        return self.page.evaluate(f"() => {WRITTEN}")

    def wait_for_text(self, text: str, timeout: float = PATIENCE) -> None:
        """Until the text is on the page."""
        self.page.wait_for_function(f"text => ({WRITTEN}).includes(text)", arg=text, timeout=timeout * 1000)

    def wait_for_no_text(self, text: str, timeout: float = PATIENCE) -> None:
        """Until the text is not on the page."""
        self.page.wait_for_function(f"text => !({WRITTEN}).includes(text)", arg=text, timeout=timeout * 1000)

    def tab(self, label: str) -> None:
        """Bring a tab to the front."""
        named = re.compile(rf"^\s*{re.escape(label)}\s*$")
        self.page.locator(TAB).filter(has_text=named).first.click()
        time.sleep(INPUT_PAUSE)

    def folder(self, label: str) -> None:
        """Open or close the folder whose heading begins so."""
        head = self.page.get_by_text(re.compile(f"^{re.escape(label)}")).filter(visible=True).first
        was_open = head.evaluate(IS_OPEN)
        for _ in range(3):  # what grows above a heading may move it between press and release: that is no click
            head.click()
            deadline = time.monotonic() + 5.0
            while head.evaluate(IS_OPEN) == was_open and time.monotonic() < deadline:
                time.sleep(PERIOD)
            if head.evaluate(IS_OPEN) != was_open:
                break
        time.sleep(0.4)

    def beside(self, label: str) -> Locator:
        """The control with this label, whether or not it is marked as changed."""
        marked = f"normalize-space(.)='{label}' or normalize-space(.)='{label} •'"
        return self.page.locator(f"xpath=//label[{marked}]").first.locator(ROW)

    def box(self, label: str) -> Locator:
        """The box for a number with this label, or beside the slider with this label."""
        row = self.beside(label)
        row.wait_for(state="attached")
        slider = row.locator("[role=slider]").count()  # its own box is not shown; ours comes a moment later
        return (self.beside(f"{label}: number") if slider else row).locator("input:not([type=hidden])")

    def type_number(self, label: str, text: str, box: int = 0) -> None:
        """Type into the number box beside a label; of a vector, into the box of an axis: 0, 1 or 2."""
        field = self.box(f"{label}: {'xyz'[box]}" if box else label).first
        field.click()
        field.fill(text)
        time.sleep(INPUT_PAUSE)

    def type_text(self, label: str, text: str) -> None:
        """Put a text into the box beside a label."""
        field = self.beside(label).locator("input, textarea").first
        field.click()
        field.fill(text)
        time.sleep(INPUT_PAUSE)

    def typed(self, label: str) -> str:
        """What the text box beside a label holds."""
        return self.beside(label).locator("input, textarea").first.input_value()

    def number(self, label: str) -> str:
        """What the number box beside a label shows."""
        return self.box(label).first.input_value()

    def nudge(self, label: str, key: str = "ArrowRight", times: int = 1) -> None:
        """Move a slider with the keyboard."""
        thumb = self.beside(label).get_by_role("slider")
        for _ in range(times):
            thumb.press(key)
            time.sleep(INPUT_PAUSE)

    def choose(self, label: str, option: str) -> None:
        """Pick an option of a dropdown."""
        self.beside(label).locator("input").first.click()
        self.page.get_by_role("option", name=option, exact=False).first.click()
        self.page.evaluate(BLUR)
        time.sleep(INPUT_PAUSE)

    def press(self, label: str) -> None:
        """Press a button; the heading of a folder is none here."""
        self.page.locator(BUTTON.replace("NAME", json.dumps(label, ensure_ascii=False))).first.click()
        time.sleep(INPUT_PAUSE)

    def upload(self, label: str, name: str, content: bytes) -> None:
        """Hand over a file through a button and the browser's own dialogue."""
        with self.page.expect_file_chooser() as opened:
            self.press(label)
        opened.value.set_files({"name": name, "mimeType": "application/octet-stream", "buffer": content})
        time.sleep(INPUT_PAUSE)

    def chart_labels(self) -> list[list[str]]:
        """The labels of the curves of every plot on view."""
        return self.page.evaluate(f"() => {CHARTS}.map(chart => chart.series.map(series => series.label || ''))")

    def chart_data(self, label: str) -> list[list[float | None]]:
        """All columns of the plot that has a curve of this label."""
        expression = f"(label) => Array.from(({FIND_CHART})(label).data, column => Array.from(column))"
        return self.page.evaluate(expression, label)

    def node_position(self, name: str) -> list[float]:
        """Where a node of the scene is, in the scene's own frame (the page may turn the whole scene)."""
        expression = (
            "(name) => { const p = window.__viserMutable.nodeRefFromName[name].position; return [p.x, p.y, p.z] }"
        )
        return self.page.evaluate(expression, name)

    def wait_for_node(self, name: str, timeout: float = PATIENCE) -> None:
        """Until a node of the scene is drawn."""
        self.page.wait_for_function(
            "name => window.__viserMutable.nodeRefFromName[name]", arg=name, timeout=timeout * 1000
        )

    def screen_position(self, name: str, offset: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> tuple[float, float]:
        """Where on the page (CSS px) a node of the scene is seen, or a point (m) in its own axes."""
        x, y = self.page.evaluate(PROJECT, [name, offset])
        return x, y

    def drag_node(
        self, name: str, by_pixels: tuple[float, float], *, steps: int = 20, seconds: float = 1.0, release: bool = True
    ) -> None:
        """Take hold of a node of the scene with the mouse, and move it across the screen."""
        self.drag(self.screen_position(name), by_pixels, steps=steps, seconds=seconds, release=release)

    def drag(
        self,
        start: tuple[float, float],
        by_pixels: tuple[float, float],
        *,
        steps: int = 20,
        seconds: float = 1.0,
        release: bool = True,
    ) -> None:
        """Press the mouse at a place of the page, move it in equal steps, and let go."""
        mouse = self.page.mouse
        mouse.move(*start)
        time.sleep(INPUT_PAUSE)  # the page must know what is under the mouse
        mouse.down()
        for k in range(1, steps + 1):
            mouse.move(start[0] + by_pixels[0] * k / steps, start[1] + by_pixels[1] * k / steps)
            time.sleep(seconds / steps)
        if release:
            mouse.up()
        time.sleep(INPUT_PAUSE)

    def click_node(self, name: str) -> None:
        """Click on a node of the scene."""
        self.page.mouse.move(*self.screen_position(name))
        time.sleep(INPUT_PAUSE)
        self.page.mouse.down()
        self.page.mouse.up()
        time.sleep(INPUT_PAUSE)

    def dismiss_notifications(self) -> None:
        """Close them all; viser warns of a software renderer, which is what a test has."""
        for button in self.page.locator(".mantine-Notification-closeButton").all():
            button.click()

    def camera_position(self) -> list[float]:
        """Where the visitor looks from."""
        return self.page.evaluate("() => window.__viserMutable.camera.position.toArray()")

    def node_names(self) -> list[str]:
        """The names of all nodes of the scene."""
        return self.page.evaluate("() => Object.keys(window.__viserMutable.nodeRefFromName)")

    def slider_to_plot(self, slider: str, curve: str, count: int = 30) -> list[float]:
        """Milliseconds from a slider's event to changed data in a plot, `count` times, in the browser's own clock."""
        thumb = self.beside(slider).get_by_role("slider").element_handle()
        return self.page.evaluate(MEASURE, [thumb, curve, count])


PROJECT = """([name, offset]) => {
    const viewer = window.__viserMutable;
    const times = (matrix, [x, y, z, w]) =>
        [0, 1, 2, 3].map(i => matrix[i] * x + matrix[4 + i] * y + matrix[8 + i] * z + matrix[12 + i] * w);
    const place = times(viewer.nodeRefFromName[name].matrixWorld.elements, [...offset, 1]);
    const seen = times(viewer.camera.matrixWorldInverse.elements, place);
    const [x, y, , w] = times(viewer.camera.projectionMatrix.elements, seen);
    const canvas = viewer.canvas.getBoundingClientRect();
    return [canvas.left + (1 + x / w) / 2 * canvas.width, canvas.top + (1 - y / w) / 2 * canvas.height];
}"""
"""A point of a node, in the three.js world, through the camera, on the canvas."""
MEASURE = f"""async ([thumb, curve, count]) => {{
    const chart = ({FIND_CHART})(curve), times = [];
    const pause = ms => new Promise(done => setTimeout(done, ms));
    for (let i = 0; i < count; i++) {{
        const before = chart.data, key = i % 2 ? 'ArrowLeft' : 'ArrowRight';
        const began = performance.now();
        thumb.dispatchEvent(new KeyboardEvent('keydown', {{key, code: key, bubbles: true, cancelable: true}}));
        while (chart.data === before && performance.now() - began < 5000) await pause(1);
        times.push(performance.now() - began);
        await pause(250);
    }}
    return times;
}}"""


def until(holds: Callable[[], object], what: str, patience: float = PATIENCE) -> None:
    """Wait until a condition holds. Raises AssertionError after so many seconds."""
    deadline = time.monotonic() + patience
    while not holds():
        assert time.monotonic() < deadline, f"waited {patience:g} s in vain for {what}"
        time.sleep(PERIOD)


def until_still(read: Callable[[], Read], seconds: float = 1.0) -> Read:
    """What is read, once it is the same after some seconds."""
    seen = read()
    while True:
        time.sleep(seconds)
        if seen == (seen := read()):
            return seen


def quantile(values: list[float], share: float) -> float:
    """The value below which this share of the values lies."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, math.ceil(share * len(ordered)) - 1)]


def why_not() -> str | None:
    """Why the browser tests cannot run here, or None."""
    if CHROMIUM is None:
        return "no Chromium (apt install chromium)"
    return "RANGENAV_NO_BROWSER is set" if os.environ.get("RANGENAV_NO_BROWSER") else None
