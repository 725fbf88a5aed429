"""`rangenav-explorer`, or `python -m explorer`: serves the page on this machine and prints its address."""

import contextlib
import signal
import sys
import threading
import urllib.request
import webbrowser
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

from explorer.web.logs import configure
from rangenav import preset
from rangenav.inputs import require

if TYPE_CHECKING:
    import viser

    from explorer.web.access.entrance import Entrance
    from explorer.web.metrics import Metrics

DEFAULT_PRESET = "paper-slow"
STOPPING_SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")
MAX_PLACES = 200
ANSWER_TIMEOUT = 10.0
"""s until the server must answer its first request."""


@dataclass(frozen=True)
class Arguments:
    """Edit motion and gains in a browser and see, live, what one range can tell."""

    preset: str = DEFAULT_PRESET
    """A shipped preset's name, or the path of a TOML file."""
    lesson: int | None = None
    """The number of a lesson, 1 to 14, that the page begins with."""
    handout: Path | None = None
    """Write the preset or the lesson as one HTML file that opens without a network, and start no page."""
    slider: tuple[str, ...] = ()
    """Up to two numbers that move in the handout: gains.attitude.k1, or with limits gains.attitude.k1=0.5:20."""
    host: str = "127.0.0.1"
    """127.0.0.1 for this machine alone. An address of this machine, or 0.0.0.0 for all of them, opens the page to
    others, who need a link or a code: both are printed."""
    port: int = 8080
    url: str = ""
    """The address that visitors type where a proxy stands in between, as https://class.example.org: they need a link or
    a code, too."""
    token_file: Path | None = None
    """A file that holds the token of the teacher's link; without it the variable RANGENAV_TOKEN, else a new one."""
    places: int = 40
    """How many students may be on the page at the same time."""
    check: bool = False
    """Try every part of this installation, say what does not work and what to do, and start no page."""
    log: Literal["text", "json"] = "text"
    """How warnings and errors are written: as text, or each as one line of JSON."""
    browser: Annotated[bool, tyro.conf.arg(help="Open a browser, if there is one.")] = True


def main() -> None:
    """Entry point of the command."""
    arguments = tyro.cli(Arguments, prog="rangenav-explorer")
    configure(arguments.log)
    try:
        if arguments.check:
            sys.exit(check())
        if arguments.handout is not None:
            write_handout(arguments, arguments.handout)
        else:
            serve(arguments)
    except ValueError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        pass


def check() -> int:
    """Print what works, line by line. Returns 1 if something does not."""
    from explorer.server.installation import checks

    failed = 0
    for one in checks():
        print(one, flush=True)
        failed += not one.works
    return int(failed > 0)


def write_handout(arguments: Arguments, path: Path) -> None:
    """Write a handout and print where it is. Raises ValueError with one sentence if it cannot be made or written."""
    from explorer.handout import handout
    from explorer.lessons import course
    from explorer.model.settings import Settings

    _refuse_unknown_lesson(arguments.lesson)
    lesson = None if arguments.lesson is None else course().lesson(arguments.lesson)
    shown = preset.load(arguments.preset)
    settings = Settings(origin=arguments.preset, preset=shown) if lesson is None else lesson.start.settings
    name = lesson.name if lesson is not None else preset.find(arguments.preset).stem
    content = handout(settings, arguments.slider, lesson=lesson, name=name)
    try:
        path.write_bytes(content)
    except OSError as error:
        raise ValueError(f"{path}: cannot be written: {error.strerror}") from None
    print(f"{path}, {len(content) / 1e6:.1f} MB: opens in any browser, without a network")


def serve(arguments: Arguments) -> None:
    """Serve until interrupted. Raises ValueError with one sentence if host, port or preset cannot be used."""
    requested = preset.load(arguments.preset)
    _refuse_unknown_lesson(arguments.lesson)
    # here: a wrong preset is reported at once
    from explorer.web.access.entrance import Entrance
    from explorer.web.access.invitation import codes_with, invitation
    from explorer.web.access.visitors import Role
    from explorer.web.addresses import Addresses
    from explorer.web.allocation import give_back
    from explorer.web.metrics import Metrics
    from explorer.web.security import close_server, open_server

    give_back()
    addresses = Addresses(arguments.host, arguments.url)
    entrance = None
    if not addresses.only_this_machine:
        require(
            1 <= arguments.places <= MAX_PLACES, f"--places {arguments.places}: must lie between 1 and {MAX_PLACES}"
        )
        entrance = Entrance(codes=codes_with(arguments.token_file), places=arguments.places, secure=addresses.secure)
    metrics, visited = Metrics(), threading.Event()
    server = open_server(
        arguments.host, arguments.port, url=arguments.url, entrance=entrance, metrics=metrics, visited=visited
    )
    stopped = _stopping_signals()
    page = addresses.link(server.get_port())
    url = page if entrance is None else entrance.link(Role.TEACHER, page)
    try:
        with urllib.request.urlopen(addresses.own_link(server.get_port()) + "healthz", timeout=ANSWER_TIMEOUT):
            print(url if entrance is None else invitation(entrance, page), flush=True)
        if arguments.browser:
            threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()
        with _sessions(arguments, requested, server, entrance=entrance, metrics=metrics, visited=visited, page=page):
            stopped.wait()
    finally:
        close_server(server)


@contextlib.contextmanager
def _sessions(
    arguments: Arguments,
    requested: preset.Preset,
    server: "viser.ViserServer",
    *,
    entrance: "Entrance | None",
    metrics: "Metrics",
    visited: threading.Event,
    page: str,
) -> Iterator[None]:
    """Within it, everybody who comes gets a page. The imports are here, because the server answers by now."""
    from explorer.server import SessionServer
    from explorer.shared import Compilation, Shared
    from explorer.storage.class_folder import class_folder
    from explorer.storage.work_files import WorkFiles
    from explorer.web.identity import Slots, connected

    shipped = preset.shipped()
    first = _first_preset(shipped, requested, arguments.preset)
    compilation, slots = Compilation(visited), Slots(lambda tab: connected(server, tab))
    with class_folder() if entrance is not None else contextlib.nullcontext() as students_folder:
        sessions = SessionServer(
            server,
            Shared(
                shipped=shipped,
                first=first,
                requested=arguments.preset != DEFAULT_PRESET,
                lesson="" if arguments.lesson is None else str(arguments.lesson),
                entrance=entrance,
                metrics=metrics,
                address=page,
                compilation=compilation,
                work_files=WorkFiles(),
                slots=slots,
                class_folder=students_folder,
            ),
        )
        compilation.start()
        try:
            yield
        finally:
            sessions.stop()


def _stopping_signals() -> threading.Event:
    """An event that Ctrl+C, SIGTERM and SIGHUP set: the work is saved before the program ends. A second one ends it at
    once. A signal that is ignored, as by nohup, stays ignored."""
    stopped = threading.Event()
    numbers = [getattr(signal, name) for name in STOPPING_SIGNALS if hasattr(signal, name)]
    before = {number: signal.getsignal(number) for number in numbers}

    def stop(number: int, frame: object) -> None:
        stopped.set()
        for number, handler in before.items():
            signal.signal(number, handler)

    for number, handler in before.items():
        if handler is not signal.SIG_IGN:
            signal.signal(number, stop)
    return stopped


def _refuse_unknown_lesson(number: int | None) -> None:
    """Raise ValueError if there is no lesson of that number."""
    if number is None:
        return
    from explorer.lessons import course  # here: a start without a lesson need not wait for the texts

    numbers = [lesson.number for lesson in course().lessons]
    require(number in numbers, f"--lesson {number}: no such lesson; there are {', '.join(map(str, numbers))}")


def _first_preset(shipped: dict[str, preset.Preset], requested: preset.Preset, name_or_path: str) -> str:
    """The name of the preset that a new visitor sees; one of a file that is not shipped is added to `shipped`."""
    if name_or_path in shipped:
        return name_or_path
    name = preset.find(name_or_path).stem
    name = f"{name} (file)" if name in shipped else name
    shipped[name] = requested
    return name


if __name__ == "__main__":
    main()
