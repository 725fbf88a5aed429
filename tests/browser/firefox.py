"""Debian's Firefox on a screen of its own, driven through its own protocol, Marionette.

Mesa draws the scene in software; without a display Firefox would have no WebGL.
"""

import base64
import gc
import json
import os
import shutil
import signal
import socket
import subprocess
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

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
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
}
START, PATIENCE = 60, 120.0
"""s"""
WIDTH, HEIGHT = 1366, 768


class Firefox:
    """One window of Firefox."""

    def __init__(self, folder: Path) -> None:
        driver = pytest.importorskip("marionette_driver.marionette")
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
        self._marionette = driver.Marionette(host="127.0.0.1", port=port)
        _wait_for_port(port)
        self._marionette.start_session()

    def open(self, url: str) -> None:
        """Go to an address."""
        self._marionette.navigate(url)

    def run(self, script: str, *arguments: object) -> object:
        """What a script returns; `page` is the window as the page's own scripts see it."""
        whole = f"const page = window.wrappedJSObject; {script}"
        return self._marionette.execute_script(whole, script_args=arguments)

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
        return base64.b64decode(self._marionette.screenshot(full=False))

    def close(self) -> None:
        """End Firefox and its screen."""
        self._marionette.client.close()
        os.killpg(self._process.pid, signal.SIGTERM)
        self._process.wait(timeout=20)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ResourceWarning)
            del self._marionette
            gc.collect()  # the driver leaves the socket open with which it waited for Firefox


def _wait_for_port(port: int) -> None:
    """Until Firefox listens; the driver's own waiting leaves its sockets open."""
    deadline = time.monotonic() + START
    while True:
        try:
            socket.create_connection(("127.0.0.1", port), timeout=1.0).close()
            return
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
