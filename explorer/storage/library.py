"""A person's own presets: one file each, never torn, never lost to another page or program. No viser here, no rangenav.

    <data folder>/presets/<name>.toml                  <name>.certificate.json beside it
    <data folder>/presets/.trash/                      what was deleted, or written over

The data folder is the system's own ($XDG_DATA_HOME/rangenav, or what macOS and Windows have for it), or what
RANGENAV_DATA says. People write titles; a file's name is made of the title's letters and digits, and nothing a title
holds can be a path. Whatever the disk refuses is one `LibraryError` with a sentence, and what was there before stays.
"""

import contextlib
import hashlib
import os
import re
import time
import unicodedata
from collections.abc import Collection, Iterator
from pathlib import Path

import platformdirs

from explorer.storage.files import unlink, write
from explorer.storage.trash import Trash, moment, name_of

DATA = "RANGENAV_DATA"
SUFFIX, BESIDE, TRASH, LOCK = ".toml", ".certificate.json", ".trash", ".lock"
MAX_BYTES = 1_000_000
"""Of one preset, as everywhere."""
MAX_PRESETS = 300
LONGEST = 60
"""Characters of a file's name: with a number and a suffix any file system takes it."""
SAME_NAME = 1000
"""Presets of one title; more are no accident."""
NAMELESS = "preset"
RESERVED = re.compile(r"con|prn|aux|nul|com\d|lpt\d")
"""Names that Windows keeps for devices."""
PATIENCE = 5.0
"""s that another program may take for its own change of the folder."""


class LibraryError(ValueError):
    """Something about the library could not be done, and a sentence says what and why; nothing was lost."""


class Library:
    """The files of one person. Threads and programs may share the folder: each change is made alone."""

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = data_folder() / "presets" if folder is None else folder
        self._trash = Trash(self.folder / TRASH)

    def stamps(self) -> dict[str, tuple[int, int, int]]:
        """The names of all presets, alphabetically, each with what changes when its file does. Raises LibraryError."""
        found = {}
        try:
            with os.scandir(self.folder) as entries:
                for entry in entries:
                    name = entry.name.removesuffix(SUFFIX)
                    if name == entry.name or not _plain(name) or not entry.is_file():
                        continue
                    status = entry.stat()
                    if status.st_size:  # an empty one is a name that is being taken
                        found[name] = (status.st_mtime_ns, status.st_size, status.st_ino)
        except FileNotFoundError:
            return {}
        except OSError as error:
            raise LibraryError(f"your presets cannot be listed: {self.folder} ({error.strerror})") from None
        return dict(sorted(found.items())[:MAX_PRESETS])

    def read(self, name: str) -> bytes:
        """The bytes of a preset. Raises LibraryError if it is not there or cannot be read."""
        path = self._path(name)
        try:
            with path.open("rb") as file:
                content = file.read(MAX_BYTES + 1)
        except FileNotFoundError:
            raise LibraryError(f"{path.name}: it is not in your library any more") from None
        except OSError as error:
            raise LibraryError(f"{path.name}: cannot be read ({error.strerror})") from None
        if len(content) > MAX_BYTES:
            raise LibraryError(f"{path.name}: larger than {MAX_BYTES} bytes, which no preset is")
        return content

    def add(self, title: str, content: bytes) -> str:
        """Keep a new preset under a name made of its title; nothing that is there is touched. Returns the name."""
        with self._changing(content):
            if len(self.stamps()) >= MAX_PRESETS:
                raise LibraryError(f"not saved: your library holds {MAX_PRESETS} presets; delete some first")
            return self._added(slug(title), content)

    def save(self, name: str, content: bytes, *, known: Collection[str]) -> None:
        """Write over a preset, if what is there is one of the `known` editions; what was there goes to the trash."""
        with self._changing(content):
            self._overwrite(name, content, known)

    def rename(self, name: str, title: str, content: bytes, *, known: Collection[str]) -> str:
        """Keep a preset, with its new content, under the name of another title. Returns that."""
        with self._changing(content):
            if slug(title) == name:
                self._overwrite(name, content, known)
                return name
            self._trash.copy(name, self._known(name, known))
            new = self._added(slug(title), content)
            unlink(self._path(name))  # only now: at any moment one of the two is there
            self._forget_certificate(name)
            return new

    def delete(self, name: str, *, known: Collection[str]) -> str:
        """Move a preset to the trash. Returns a mark by which it can be restored."""
        with self._changing():
            self._known(name, known)
            mark = self._trash.move(self._path(name))
            self._forget_certificate(name)
            return mark

    def deleted(self) -> list[str]:
        """The marks of what was deleted and can be restored, the newest first."""
        return self._trash.deleted()

    def restore(self, mark: str) -> str:
        """Bring back what was deleted, under its name or the next one that is free. Returns that."""
        if not _plain(name_of(mark)) or not _plain(moment(mark)):
            raise LibraryError(f"{mark[:LONGEST]!r} is nothing that was deleted")
        with self._changing():
            kept = self._trash.path(mark)
            try:
                content = kept.read_bytes()
            except FileNotFoundError:
                raise LibraryError("it is not in the trash any more") from None
            name = self._added(name_of(mark), content)
            unlink(kept)
            return name

    def read_certificate(self, name: str) -> bytes | None:
        """The certificate that lies beside a preset, unchecked; None if there is none that can be read."""
        try:
            with self._path(name).with_name(name + BESIDE).open("rb") as file:
                return file.read(MAX_BYTES)
        except OSError:
            return None

    def write_certificate(self, name: str, certificate: bytes) -> None:
        """Keep a certificate beside its preset."""
        with self._changing(certificate):
            write(self._path(name).with_name(name + BESIDE), certificate)

    def _added(self, stem: str, content: bytes) -> str:
        for number in range(1, SAME_NAME):
            name = stem if number == 1 else f"{stem}-{number}"
            path = self._path(name)
            try:
                os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))  # the name is ours, or taken
            except FileExistsError:
                continue
            try:
                write(path, content)
            except BaseException:
                unlink(path)
                raise
            return name
        raise LibraryError(f"not saved: {SAME_NAME} presets are called {stem!r}")

    def _known(self, name: str, known: Collection[str]) -> bytes:
        content = self.read(name)
        if edition(content) not in known:
            raise LibraryError(
                f"{name}{SUFFIX} has been changed elsewhere since you opened it, and was left as it is: "
                "open it again to see it, or keep yours with “save as”"
            )
        return content

    def _overwrite(self, name: str, content: bytes, known: Collection[str]) -> None:
        self._trash.copy(name, self._known(name, known))
        write(self._path(name), content)
        self._forget_certificate(name)

    def _forget_certificate(self, name: str) -> None:
        unlink(self._path(name).with_name(name + BESIDE))

    @contextlib.contextmanager
    def _changing(self, content: bytes = b"") -> Iterator[None]:
        """Alone in the folder, with every refusal of the disk as a sentence."""
        if len(content) > MAX_BYTES:
            raise LibraryError(f"not saved: it has {len(content)} bytes, and at most {MAX_BYTES} are kept")
        try:
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            with _locked(self.folder / LOCK):
                yield
        except OSError as error:
            why = error.strerror or "unknown reason"
            raise LibraryError(f"your library was left as it was: {self.folder} cannot be written ({why})") from error

    def _path(self, name: str) -> Path:
        if not _plain(name):
            raise LibraryError(f"{name[:LONGEST]!r} is no name of a preset")
        return self.folder / (name + SUFFIX)


def edition(content: bytes) -> str:
    """What tells one content of a file from another: its SHA-256."""
    return hashlib.sha256(content).hexdigest()


def slug(title: str) -> str:
    """A file's name for a title: its Latin letters and digits; of another script, just “preset”."""
    plain = unicodedata.normalize("NFKD", title).encode("ascii", "ignore").decode().lower()
    name = "-".join(re.findall(r"[a-z0-9]+", plain))[:LONGEST].strip("-") or NAMELESS
    return f"{NAMELESS}-{name}" if RESERVED.fullmatch(name) else name


def data_folder() -> Path:
    """Where this program keeps what a person has made."""
    told = os.environ.get(DATA)
    return Path(told) if told else platformdirs.user_data_path("rangenav", appauthor=False)


def _plain(name: str) -> bool:
    """Whether a name is one of a file in the folder itself, whoever put it there."""
    return 0 < len(name) <= 2 * LONGEST and name[0] != "." and name.isprintable() and not set("/\\:\0") & set(name)


@contextlib.contextmanager
def _locked(path: Path) -> Iterator[None]:
    """Hold a lock that the system lets go of when its holder dies. Raises LibraryError if another keeps it too long."""
    with path.open("a") as file:
        deadline = time.monotonic() + PATIENCE
        while not _take(file.fileno()):
            if time.monotonic() > deadline:
                raise LibraryError("another program is changing your library just now: try again")
            time.sleep(0.01)
        yield  # closing the file lets go


def _take(file: int) -> bool:
    try:
        import fcntl
    except ImportError:  # Windows
        import msvcrt

        try:
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]
        except OSError:
            return False
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
