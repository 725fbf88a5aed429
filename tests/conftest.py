"""What holds for every test: array shapes are checked, and in CI no browser test may be skipped."""

import gc
import itertools
import json
import os
import subprocess
import sys
import time
from collections.abc import Generator, Iterator
from pathlib import Path

import jaxtyping
import pytest
from hypothesis import settings
from xdist.remote import Producer
from xdist.scheduler import LoadFileScheduling

from tests.support import compiled_kernels, kept_results, shape_checker

SOURCE = Path(__file__).parent.parent
BROWSER_TESTS = "tests/browser/"
PROOFS = (
    "tests/explorer/panels/presets/",
    "tests/rangenav/certificate/",
    "tests/rangenav/commands/",
    "tests/rangenav/test_preset.py",
    "tests/test_docs.py",
    "tests/test_json_keys.py",
    "tests/test_verdict.py",
)
"""These prove the same shipped presets: one worker takes them all, and proves each preset once."""
COMPILED = "kernels"
"""numba needs the functions as they are written; a wrapper around each cannot be compiled."""
SLOW_FILE = "\npytestmark = pytest.mark.slow\n"
"""How a file says that it is slow as a whole."""
NO_VISER = ("explorer.model.compute", "explorer.model.details", "explorer.model.settings")
"""The explorer's arrays are made there; its other modules only hand them on."""


def _checked_modules() -> list[str]:
    """Every module of rangenav but the kernels."""
    entries = (path.stem for path in sorted((SOURCE / "rangenav").iterdir()) if path.suffix == ".py" or path.is_dir())
    return [f"rangenav.{name}" for name in entries if name not in (COMPILED, "__init__", "__pycache__", "__main__")]


settings.register_profile("developer", deadline=None)  # the first call compiles, which no deadline forgives
# The gate judges the change, not the draw; it draws a third of the usual hundred, for `make fuzz` draws for minutes.
settings.register_profile("gate", deadline=None, derandomize=True, max_examples=33)
settings.load_profile("gate" if os.environ.get("CI") else "developer")

gc.disable()  # until all tests are collected: nothing of what is made there goes away
gc.set_threshold(10_000, 20, 20)  # arrays are freed by their count of references; cycles are few and small

kept_results.keep()
jaxtyping.jaxtyped = shape_checker.sampled  # the hook writes this name above every function
jaxtyping.install_import_hook([*_checked_modules(), *NO_VISER], f"{shape_checker.__name__}.checked")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """A file that is slow as a whole is not even imported for `make quick`: some compute while they are imported."""
    if config.getoption("markexpr") != "not slow" or collection_path.suffix != ".py":
        return None
    return True if SLOW_FILE in collection_path.read_text(encoding="utf-8") else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The longest work first, so that no worker is left with it at the end: browser, proofs, then the slow files."""
    slow = {item.path for item in items if item.get_closest_marker("slow")}

    def order(item: pytest.Item) -> tuple[bool, ...]:
        return (not item.nodeid.startswith(BROWSER_TESTS), not item.nodeid.startswith(PROOFS), item.path not in slow)

    items.sort(key=order)


COMPILING = pytest.StashKey[subprocess.Popen]()
COMPILED_ONCE, FIRST_WORKER, LONGEST = SOURCE / "tests" / "__pycache__" / "all", "gw0", 60.0
"""A file beside the compiled modules, who makes it, and how long (s) the others wait for it."""


def pytest_sessionstart(session: pytest.Session) -> None:
    """One process compiles the kernels for all workers, while they collect the tests."""
    if session.config.getoption("numprocesses", None):
        command = [sys.executable, "-m", "tests.support.compiled_kernels"]
        session.config.stash[COMPILING] = subprocess.Popen(command, cwd=SOURCE)


@pytest.hookimpl(wrapper=True)
def pytest_collection(session: pytest.Session) -> Generator[None, object, object]:
    """In a fresh clone one worker compiles all modules while it collects, and the others find them compiled."""
    worker = getattr(session.config, "workerinput", {}).get("workerid")
    if worker is None or COMPILED_ONCE.exists():
        return (yield)
    if worker != FIRST_WORKER:
        end = time.monotonic() + LONGEST
        while not COMPILED_ONCE.exists() and time.monotonic() < end:
            time.sleep(0.05)
        return (yield)
    collected = yield
    COMPILED_ONCE.parent.mkdir(exist_ok=True)
    COMPILED_ONCE.touch()
    return collected


def pytest_collection_finish(session: pytest.Session) -> None:
    """A worker waits for the kernels. Nothing is frozen: hypothesis asks who refers to a generator of random numbers,
    and of frozen objects the answer is nobody."""
    if hasattr(session.config, "workerinput"):
        compiled_kernels.read()
    gc.enable()


def pytest_sessionfinish(session: pytest.Session) -> None:
    """The process that compiles has ended before the tests begin, unless there are none."""
    if COMPILING in session.config.stash:
        session.config.stash[COMPILING].wait()


def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> LoadFileScheduling:
    """Each file stays in one worker, for it shares what it computed; all browser tests do, and so do all proofs."""
    config.option.loadscopereorder = False  # files in the order above, and not by their number of tests
    return FewFiles(config, log)


class FewFiles(LoadFileScheduling):
    """By file, and the browser tests as one file, and the proofs as another one."""

    def _split_scope(self, nodeid: str) -> str:
        if nodeid.startswith(BROWSER_TESTS):
            return "browser"
        return "proofs" if nodeid.startswith(PROOFS) else super()._split_scope(nodeid)


@pytest.fixture(autouse=True, scope="session")
def _state(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Nothing is written to, or read from, what the person who runs the tests has on this machine."""
    os.environ["RANGENAV_STATE"] = str(tmp_path_factory.mktemp("state"))
    os.environ["RANGENAV_DATA"] = str(tmp_path_factory.mktemp("data"))


@pytest.fixture(autouse=True, scope="module")
def _shapes() -> Iterator[int]:
    """Each test file has the first calls of its own checked, whatever ran before it; and the number of each test."""
    shape_checker.begin_file()
    return itertools.count(1)


@pytest.fixture(autouse=True)
def _later_shapes(_shapes: Iterator[int]) -> None:
    """Later tests of a file have a few more calls checked."""
    shape_checker.begin_test(next(_shapes))


@pytest.fixture(scope="module")
def sessions():
    """(port, SessionServer) of a server of this module's own."""
    from explorer.server import SessionServer
    from explorer.shared import Compilation
    from explorer.web.security import open_server
    from tests.support.shared_server import shared

    server, compilation = open_server("127.0.0.1", 0), Compilation()
    made = SessionServer(server, shared(server, compilation))
    compilation.start()
    yield server.get_port(), made
    server.stop()


@pytest.fixture
def editing(sessions):
    """A visitor of that server."""
    from tests.support.waiting_visitor import Editing, newest
    from tests.support.wire import Wire

    tab = Wire(sessions[0])
    yield Editing(tab, newest(sessions[1], tab))
    tab.close()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """In CI a skipped browser test has failed: there the browser is always installed."""
    report = yield
    if report.skipped and os.environ.get("CI") and item.get_closest_marker("browser"):
        report.outcome = "failed"
        report.longrepr = f"{item.nodeid} was skipped, but in CI every browser test must run: {report.longrepr}"
    return report


@pytest.fixture
def run(monkeypatch, capsys):
    """run(arguments) -> (exit code, stdout, stderr) of the command line, in this process."""
    from rangenav import __main__ as cli

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["rangenav", *map(str, arguments)])
        code = 0
        try:
            cli.main()
        except SystemExit as stop:
            code = stop.code
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return call


@pytest.fixture
def answer(run):
    """answer(arguments) -> the one JSON object on stdout, after success without a word on stderr."""

    def call(*arguments):
        code, out, err = run(*arguments, "--json")
        assert (code, err) == (0, "")
        assert out.endswith("}\n")
        assert out.count("\n") == 1
        return json.loads(out, parse_constant=pytest.fail)  # NaN and Infinity are no JSON

    return call


@pytest.fixture
def complaint(run):
    """complaint(arguments) -> the one line on stderr, after exit 2 and not a word on stdout."""

    def call(*arguments):
        code, out, err = run(*arguments)
        assert (code, out, err.count("\n")) == (2, "", 1)
        return err

    return call
