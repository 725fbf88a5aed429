"""All presets that one visitor is offered: the shipped ones, their own, and what was imported and is not kept yet.

A name on the shelf is a shipped preset's own, `mine:<file>` or `new:<title>`. What was opened stays known under its
name for as long as the visitor is here, also when the file is deleted or changed elsewhere: what is on the page is held
against what it came from, and a save is refused if the file is no edition that this visitor has seen. No viser here.
"""

import contextlib
import hashlib
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from explorer.model.settings import Settings
from explorer.storage.certifier import CertificateOrReason, Certifier
from explorer.storage.library import Library, LibraryError, edition, slug
from rangenav import certificate, preset
from rangenav.preset import MAX_TITLE, Preset

MINE, NEW = "mine:", "new:"
OWN_MARK, NEW_MARK, DELETED_MARK = "★", "◌", "✗"
NEWS = 1.0
"""s between two looks for what other pages and programs have done."""
PARSED = 512
"""Files whose contents are remembered; more than a full library."""


@dataclass(frozen=True, eq=False)
class Own:
    """One file of the library, as it was when last looked at."""

    stamp: tuple[int, int, int]
    content: bytes
    preset: Preset | None
    complaint: str = ""


class Catalog:
    """One per visitor."""

    def __init__(self, shipped: dict[str, Preset], library: Library, certifier: Certifier) -> None:
        self._library, self._certifier = library, certifier
        self.presets: dict[str, Preset] = dict(shipped)
        """Everything known by name, also what is not offered any more."""
        self._shipped = tuple(shipped)
        self._own: dict[str, Own] = {}
        self._known: dict[str, set[str]] = {}
        self._put: set[bytes] = set()
        self.complaint = ""
        """Why the library, or some file of it, cannot be read; empty if all can."""
        self.refresh()

    def refresh(self) -> None:
        """Look at the library again; only what has changed is read."""
        self._looked_at = time.monotonic()
        try:
            stamps = self._library.stamps()
        except LibraryError as reason:
            self.complaint = str(reason)
            return
        self._own = {name: self._looked(name, stamp) for name, stamp in stamps.items()}
        for name, own in self._own.items():
            if own.preset is not None and MINE + name not in self._known:
                self.presets[MINE + name] = own.preset
        self.complaint = "; ".join(own.complaint for own in self._own.values() if own.complaint)

    def refresh_if_due(self) -> None:
        """The same, but not at every turn of a loop."""
        if time.monotonic() > self._looked_at + NEWS:
            self.refresh()

    @property
    def offered(self) -> dict[str, Preset]:
        """What can be opened: the shipped presets, one's own, and what was imported, each as it is now."""
        shipped = {name: self.presets[name] for name in self._shipped}
        own = {MINE + name: own.preset for name, own in self._own.items() if own.preset is not None}
        return shipped | own | {name: lent for name, lent in self.presets.items() if name.startswith(NEW)}

    def labels(self, shown: str) -> dict[str, str]:
        """What a menu says of each preset; of the one shown also if it is not offered any more."""
        labels = {}
        for name, one in self.offered.items():
            sign = f"{OWN_MARK} " if self.is_own(name) else f"{NEW_MARK} " if name.startswith(NEW) else ""
            lent = ", not saved" if name.startswith(NEW) else ""
            labels[name] = f"{sign}{one.title}{lent} ({display_name(name)})"
        if shown not in labels:
            labels[shown] = f"{DELETED_MARK} {self.presets[shown].title}, deleted ({display_name(shown)})"
        return labels

    def open(self, name: str) -> Settings:
        """A preset as it is now. Raises LibraryError if its file cannot be read any more."""
        if not self.is_own(name):
            return Settings(origin=name, preset=self.presets[name])
        content = self._library.read(name.removeprefix(MINE))
        self.presets[name] = _parsed(content, f"{name.removeprefix(MINE)}.toml")
        return self._seen(name, content)

    def is_own(self, name: str) -> bool:
        """Whether it is a file of one's own."""
        return name.startswith(MINE)

    def add_imported(self, imported: Preset) -> Settings:
        """Offer a preset that is in no file yet; it is opened."""
        stem = slug(imported.title)
        free = (f"{NEW}{stem}" + (f"-{k}" if k > 1 else "") for k in range(1, len(self.presets) + 2))
        name = next(name for name in free if name not in self.presets)
        self.presets[name] = imported
        return Settings(origin=name, preset=imported)

    def add(self, new: Preset) -> Settings:
        """Keep a new preset of one's own. Raises LibraryError."""
        content = _bytes(new)
        return self._kept(MINE + self._library.add(new.title, content), new, content)

    def save(self, name: str, new: Preset, *, edition: str) -> Settings:
        """Write over a preset of one's own that was opened in some edition. Raises LibraryError."""
        if not self.is_own(name):
            raise LibraryError("a shipped preset, or one not saved yet, is kept under a title of yours: use “save as”")
        content = _bytes(new)
        self._library.save(name.removeprefix(MINE), content, known=self._editions(name, edition))
        return self._kept(name, new, content)

    def rename(self, name: str, new: Preset, *, edition: str) -> Settings:
        """Keep a preset of one's own, retitled, under another name. Raises LibraryError."""
        if not self.is_own(name):
            raise LibraryError("only presets of your own can be renamed: use “save as”")
        content = _bytes(new)
        known = self._editions(name, edition)
        return self._kept(MINE + self._library.rename(name[len(MINE) :], new.title, content, known=known), new, content)

    def delete(self, name: str, *, edition: str) -> str:
        """Move a preset of one's own to the trash. Returns what `restore` needs. Raises LibraryError."""
        if not self.is_own(name):
            raise LibraryError("only presets of your own can be deleted")
        mark = self._library.delete(name.removeprefix(MINE), known=self._editions(name, edition))
        self.refresh()
        return mark

    def deleted(self) -> list[str]:
        """What `restore` could bring back, also from before this page was opened; the newest first."""
        return self._library.deleted()

    def restore(self, mark: str) -> Settings:
        """Bring back what was deleted. Raises LibraryError."""
        name = MINE + self._library.restore(mark)
        self.refresh()
        return self.open(name)

    def badge(self, name: str, shown: Preset, wake: Callable[[], None]) -> CertificateOrReason | None:
        """The certificate of a preset that is shown under a name, why there is none, or None while it is being
        computed; `note` tells of news. What another page has made of its file meanwhile has another."""
        own = self._own.get(name.removeprefix(MINE)) if self.is_own(name) else None
        own = own if own and own.preset == shown else None
        content = own.content if own else _bytes(shown)
        stored = self._library.read_certificate(name.removeprefix(MINE)) if own else _shipped_certificate(name)
        fitting = None if stored is None else _fitting(stored, content)
        if fitting is not None:
            return fitting
        found = self._certifier.find(content, wake)
        if own and isinstance(found, certificate.Certificate) and content not in self._put:
            self._put.add(content)  # once: a folder that cannot be written will not be so the next time
            with contextlib.suppress(LibraryError):
                self._library.write_certificate(name.removeprefix(MINE), certificate.dumps(found))
        return found

    def _looked(self, name: str, stamp: tuple[int, int, int]) -> Own:
        before = self._own.get(name)
        if before is not None and before.stamp == stamp:
            return before
        content = b""
        try:
            content = self._library.read(name)
            return Own(stamp, content, _parsed(content, f"{name}.toml"))
        except ValueError as error:
            return Own(stamp, content, None, str(error))

    def _seen(self, name: str, content: bytes) -> Settings:
        self._known.setdefault(name, set()).add(edition(content))
        return Settings(origin=name, preset=self.presets[name], edition=edition(content))

    def _kept(self, name: str, new: Preset, content: bytes) -> Settings:
        self.presets[name] = new
        self.refresh()
        return self._seen(name, content)

    def _editions(self, name: str, opened: str) -> set[str]:
        return self._known.get(name, set()) | {opened}


def display_name(name: str) -> str:
    """A name as a person knows it: of the shipped preset, of the file, or made of the title."""
    return name.removeprefix(MINE).removeprefix(NEW)


def marked(name: str) -> str:
    """The same with the sign of whose it is."""
    sign = OWN_MARK if name.startswith(MINE) else NEW_MARK if name.startswith(NEW) else ""
    return f"{sign} {display_name(name)}".strip()


def checked_title(text: str) -> str:
    """A title a person has typed, without blanks around it. Raises LibraryError if it is none."""
    title = " ".join(text.split())
    if not 0 < len(title) <= MAX_TITLE or not title.isprintable():
        raise LibraryError(
            f"a title has 1 to {MAX_TITLE} printable characters, this one has {len(title)}: type one above"
        )
    return title


@lru_cache(maxsize=PARSED)
def _parsed(content: bytes, source: str) -> Preset:
    try:
        return preset.loads(content.decode("utf-8"), source=source)
    except UnicodeDecodeError as error:
        raise LibraryError(f"{source}: not UTF-8 text (byte {error.start})") from None


@lru_cache(maxsize=PARSED)
def _bytes(shown: Preset) -> bytes:
    return preset.dumps(shown).encode()


@lru_cache(maxsize=PARSED)
def _shipped_certificate(name: str) -> bytes | None:
    """The bytes beside a shipped preset's file, None if there are none."""
    for file in preset.shipped_files():
        if file.stem == name:
            beside = certificate.beside(file)
            return beside.read_bytes() if beside.is_file() else None
    return None


@lru_cache(maxsize=PARSED)
def _fitting(stored: bytes, content: bytes) -> certificate.Certificate | None:
    """A stored certificate if it can be read and is of these very bytes."""
    try:
        found = certificate.loads(stored, source="certificate")
    except ValueError:
        return None
    return found if _fits(found, content) else None


def _fits(found: certificate.Certificate, content: bytes) -> bool:
    return found.artifact.sha256 == hashlib.sha256(content).hexdigest()
