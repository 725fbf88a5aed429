"""Debian's Firefox on a screen of its own, driven through its own protocol, Marionette.

A message is its length, a colon and JSON: [0, number, command, arguments] and [1, number, error, result]. The package
marionette-driver leaves sockets open and imports a module that Python 3.13 no longer has, so it is spoken here.

Mesa draws the scene in software; without a display Firefox would have no WebGL.
"""

import base64
import json
import os
import shutil
import signal
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

PROGRAMS = ("firefox-esr", "xvfb-run")
PREFERENCES = {
    "webgl.force-enabled": True,
    "gfx.webrender.software": True,
    "security.sandbox.content.level": 0,
    "app.normandy.enabled": False,
    "browser.aboutwelcome.enabled": False,
    "browser.shell.checkDefaultBrowser": False,
    "datareporting.policy.dataSubmissionEnabled": False,
    "layout.frame_rate": 10,  # a software renderer would draw as fast as it can
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
}
START, PATIENCE = 60, 120.0
"""s"""
WIDTH, HEIGHT = 1366, 768


class Firefox:
    """One window of Firefox."""

    def __init__(self, folder: Path) -> None:
        with socket.create_server(("127.0.0.1", 0)) as probe:
            port = probe.getsockname()[1]
        profile, home = folder / "profile", folder / "home"
        profile.mkdir()
        home.mkdir()
        lines = [f"user_pref({json.dumps(name)}, {json.dumps(value)});" for name, value in PREFERENCES.items()]
        lines.append(f'user_pref("marionette.port", {port});')
        (profile / "user.js").write_text("\n".join(lines), encoding="utf-8")
        screen = ["xvfb-run", "-a", "-s", f"-screen 0 {WIDTH}x{HEIGHT}x24"]
        size = ["--width", str(WIDTH), "--height", str(HEIGHT)]
        self._process = subprocess.Popen(
            [*screen, "firefox-esr", "--marionette", "--profile", str(profile), *size],
            env=os.environ | {"LIBGL_ALWAYS_SOFTWARE": "1", "HOME": str(home)},
            start_new_session=True,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self._socket, self._sent = _connected(port), 0
        self._stream = self._socket.makefile("rb")
        assert self._received()["marionetteProtocol"] == 3
        self._answer("WebDriver:NewSession", capabilities={})

    def open(self, url: str) -> None:
        """Go to an address."""
        self._answer("WebDriver:Navigate", url=url)

    def run(self, script: str, *arguments: object) -> object:
        """What a script returns; `page` is the window as the page's own scripts see it."""
        whole = f"const page = window.wrappedJSObject; {script}"
        return self._answer("WebDriver:ExecuteScript", script=whole, args=list(arguments), sandbox="default")

    def text(self) -> str:
        """Everything written on the page."""
        return str(self.run("return document.body.innerText"))

    def wait_for_text(self, text: str) -> None:
        """Until the text is on the page."""
        deadline = time.monotonic() + PATIENCE
        while text not in self.text():
            assert time.monotonic() < deadline, f"waited in vain for {text!r} in:\n{self.text()}"
            time.sleep(0.2)

    def press(self, label: str) -> None:
        """Press the button with this text."""
        script = """
            const buttons = Array.from(document.querySelectorAll('button'));
            buttons.find(button => button.innerText.includes(arguments[0])).click();
        """
        self.run(script, label)

    def screenshot(self) -> bytes:
        """The window as a PNG."""
        return base64.b64decode(str(self._answer("WebDriver:TakeScreenshot", full=False, hash=False)))

    def close(self) -> None:
        """End Firefox and its screen."""
        self._stream.close()
        self._socket.close()
        os.killpg(self._process.pid, signal.SIGTERM)
        self._process.wait(timeout=20)

    def _answer(self, command: str, **arguments: object) -> object:
        self._sent += 1
        message = json.dumps([0, self._sent, command, arguments]).encode()
        self._socket.sendall(b"%d:%s" % (len(message), message))
        _, number, error, result = self._received()
        assert (number, error) == (self._sent, None), error
        return result.get("value") if isinstance(result, dict) else result

    def _received(self) -> Any:
        length = b""
        while (digit := self._stream.read(1)) != b":":
            assert digit, "Firefox has closed the connection"
            length += digit
        return json.loads(self._stream.read(int(length)))


def _connected(port: int) -> socket.socket:
    """A connection to Firefox, once it listens."""
    deadline = time.monotonic() + START
    while True:
        try:
            return socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)
        except OSError:
            assert time.monotonic() < deadline, "Firefox did not start"
            time.sleep(0.2)


@contextmanager
def firefox(folder: Path) -> Iterator[Firefox]:
    """A Firefox for as long as it is needed."""
    missing = [program for program in PROGRAMS if shutil.which(program) is None]
    if missing:
        pytest.skip(f"no {' and no '.join(missing)} (apt install firefox-esr xvfb xauth libgl1-mesa-dri libegl1)")
    window = Firefox(folder)
    try:
        yield window
    finally:
        window.close()
