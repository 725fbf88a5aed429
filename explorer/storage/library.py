"""A person's own presets, one file each: no file is ever half written, and no page or program
overwrites the changes of another.

    <data folder>/presets/<name>.toml                  <name>.certificate.json: its certificate
    <data folder>/presets/.trash/                      presets that were deleted or overwritten

The data folder is the system's own ($XDG_DATA_HOME/rangenav, or its counterpart on macOS and Windows), or the one that
RANGENAV_DATA names. A file's name is made of the letters and digits of the preset's title, so no title can be a path.
Every failure of the disk is a `LibraryError` with one sentence, and the files stay as they were.
"""

import contextlib
import hashlib
import os
import re
import unicodedata
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

import platformdirs
from filelock import FileLock, Timeout

from explorer.storage.files import unlink, write
from explorer.storage.trash import Trash, moment, name_of

DATA = "RANGENAV_DATA"
SUFFIX, CERTIFICATE, TRASH, LOCK = ".toml", ".certificate.json", ".trash", ".lock"
MAX_BYTES = 1_000_000
"""The largest size of one preset file."""
MAX_PRESETS = 300
MAX_NAME = 60
"""Characters of a file's name; with a number and a suffix every file system accepts it."""
MAX_SAME_TITLE = 1000
"""The largest number of presets with one title."""
NAMELESS = "preset"
RESERVED = re.compile(r"con|prn|aux|nul|com\d|lpt\d")
"""Names that Windows reserves for devices."""
LOCK_TIMEOUT, LOCK_POLL = 5.0, 0.01
"""s to wait for another program's change of the folder to end, and between two tries."""


class LibraryError(ValueError):
    """The library could not do something; the message is one sentence that says what and why. Nothing was lost."""


class Library:
    """The files of one person. Threads and programs may share the folder; they change it one at a time."""

    def __init__(self, folder: Path | None = None, rooms: Sequence[tuple[Path, float]] = ()) -> None:
        """rooms: folders around the library, or its own, and the bytes that all files in each may have together. In its
        own the trash is not counted: who deletes presets has room again."""
        self.folder, self._rooms = data_folder() / "presets" if folder is None else folder, tuple(rooms)
        self._trash = Trash(self.folder / TRASH)

    def stamps(self) -> dict[str, tuple[int, int, int]]:
        """The names of all presets, alphabetically, each with its file's (time, size, inode). Raises LibraryError."""
        stamps = {}
        try:
            with os.scandir(self.folder) as entries:
                for entry in entries:
                    name = entry.name.removesuffix(SUFFIX)
                    if name == entry.name or not _is_file_name(name) or not entry.is_file():
                        continue
                    status = entry.stat()
                    if status.st_size:  # an empty file reserves a name for a preset that is being written
                        stamps[name] = (status.st_mtime_ns, status.st_size, status.st_ino)
        except FileNotFoundError:
            return {}
        except OSError as error:
            raise LibraryError(f"your presets cannot be listed: {self.folder} ({error.strerror})") from None
        return dict(sorted(stamps.items())[:MAX_PRESETS])

    def read(self, name: str) -> bytes:
        """The bytes of a preset. Raises LibraryError if there is no such preset or it cannot be read."""
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
        """Save a new preset under a name made of its title; no other file is touched. Returns the name."""
        with self._change(content):
            if len(self.stamps()) >= MAX_PRESETS:
                raise LibraryError(f"not saved: your library holds {MAX_PRESETS} presets; delete some first")
            return self._add(slug(title), content)

    def save(self, name: str, content: bytes, *, known: Collection[str]) -> None:
        """Overwrite a preset if the file is one of the `known` editions; the old content goes to the trash."""
        with self._change(content):
            self._overwrite(name, content, known)

    def rename(self, name: str, title: str, content: bytes, *, known: Collection[str]) -> str:
        """Save a preset, with its new content, under a name made of its new title. Returns the name."""
        with self._change(content):
            if slug(title) == name:
                self._overwrite(name, content, known)
                return name
            self._trash.copy(name, self._require_edition(name, known))
            new = self._add(slug(title), content)
            unlink(self._path(name))  # only now, so that at any moment one of the two files exists
            self._forget_certificate(name)
            return new

    def delete(self, name: str, *, known: Collection[str]) -> str:
        """Move a preset to the trash. Returns the mark by which `restore` finds it."""
        with self._change():
            self._require_edition(name, known)
            mark = self._trash.move(self._path(name))
            self._forget_certificate(name)
            return mark

    def deleted(self) -> list[str]:
        """The marks of the deleted presets, the newest first."""
        return self._trash.deleted()

    def restore(self, mark: str) -> str:
        """Restore a deleted preset under its name, or the next free one. Returns the name."""
        if not _is_file_name(name_of(mark)) or not _is_file_name(moment(mark)):
            raise LibraryError(f"{mark[:MAX_NAME]!r} is nothing that was deleted")
        with self._change():
            deleted_file = self._trash.path(mark)
            try:
                content = deleted_file.read_bytes()
            except FileNotFoundError:
                raise LibraryError("it is not in the trash any more") from None
            name = self._add(name_of(mark), content)
            unlink(deleted_file)
            return name

    def read_certificate(self, name: str) -> bytes | None:
        """The stored certificate of a preset, not verified; None if there is none that can be read."""
        try:
            with self._path(name).with_name(name + CERTIFICATE).open("rb") as file:
                return file.read(MAX_BYTES)
        except OSError:
            return None

    def write_certificate(self, name: str, certificate: bytes) -> None:
        """Store the certificate of a preset."""
        with self._change(certificate):
            write(self._path(name).with_name(name + CERTIFICATE), certificate)

    def _add(self, stem: str, content: bytes) -> str:
        for number in range(1, MAX_SAME_TITLE):
            name = stem if number == 1 else f"{stem}-{number}"
            path = self._path(name)
            try:
                os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))  # reserves the name, or fails
            except FileExistsError:
                continue
            try:
                write(path, content)
            except BaseException:
                unlink(path)
                raise
            return name
        raise LibraryError(f"not saved: {MAX_SAME_TITLE} presets are called {stem!r}")

    def _require_edition(self, name: str, known: Collection[str]) -> bytes:
        content = self.read(name)
        if edition(content) not in known:
            raise LibraryError(
                f"{name}{SUFFIX} has been changed elsewhere since you opened it, and was left as it is: "
                "open it again to see it, or keep yours with “save as”"
            )
        return content

    def _overwrite(self, name: str, content: bytes, known: Collection[str]) -> None:
        self._trash.copy(name, self._require_edition(name, known))
        write(self._path(name), content)
        self._forget_certificate(name)

    def _forget_certificate(self, name: str) -> None:
        unlink(self._path(name).with_name(name + CERTIFICATE))

    @contextlib.contextmanager
    def _change(self, content: bytes = b"") -> Iterator[None]:
        """Change the folder while no one else does; every failure of the disk becomes a LibraryError."""
        if len(content) > MAX_BYTES:
            raise LibraryError(f"not saved: it has {len(content)} bytes, and at most {MAX_BYTES} are kept")
        try:
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            with _locked(self.folder / LOCK):
                self._require_room(len(content))
                yield
        except OSError as error:
            why = error.strerror or "unknown reason"
            raise LibraryError(f"your library was left as it was: {self.folder} cannot be written ({why})") from error

    def _require_room(self, size: int) -> None:
        for folder, most in self._rooms if size else ():
            files = folder.glob("*") if folder == self.folder else folder.rglob("*")  # its own without the trash
            held = sum(path.stat().st_size for path in files if path.is_file())
            if held + size > most:
                whose = "your library" if folder == self.folder else "the class"
                raise LibraryError(f"not saved: {whose} has no room for more than {most / 1e6:g} MB of presets")

    def _path(self, name: str) -> Path:
        if not _is_file_name(name):
            raise LibraryError(f"{name[:MAX_NAME]!r} is no name of a preset")
        return self.folder / (name + SUFFIX)


def edition(content: bytes) -> str:
    """The SHA-256 of a file's content: two editions of a file differ in it."""
    return hashlib.sha256(content).hexdigest()


def slug(title: str) -> str:
    """A file's name for a title: its Latin letters and digits; “preset” if it has none."""
    latin = unicodedata.normalize("NFKD", title).encode("ascii", "ignore").decode().lower()
    name = "-".join(re.findall(r"[a-z0-9]+", latin))[:MAX_NAME].strip("-") or NAMELESS
    return f"{NAMELESS}-{name}" if RESERVED.fullmatch(name) else name


def data_folder() -> Path:
    """The folder for a person's data: the one that RANGENAV_DATA names, else the system's own."""
    named = os.environ.get(DATA)
    return Path(named) if named else platformdirs.user_data_path("rangenav", appauthor=False)


def _is_file_name(name: str) -> bool:
    """Whether a name can only be that of a file in the folder itself: it contains no separators of a path."""
    return 0 < len(name) <= 2 * MAX_NAME and name[0] != "." and name.isprintable() and not set("/\\:\0") & set(name)


@contextlib.contextmanager
def _locked(path: Path) -> Iterator[None]:
    """Hold the folder's lock, which the system releases when its program ends. Raises LibraryError after a time-out.

    The lock is an flock of the file, as in version 0.1.0, so programs of both versions exclude each other.
    """
    lock = FileLock(path, timeout=LOCK_TIMEOUT)
    try:
        lock.acquire(poll_interval=LOCK_POLL)
    except Timeout:
        raise LibraryError("another program is changing your library just now: try again") from None
    try:
        yield
    finally:
        lock.release()
