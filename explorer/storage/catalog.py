"""All presets that one visitor is offered: the shipped ones, the visitor's own, and imported ones not saved yet.

The name of an entry is the shipped preset's name, `mine:<file>` or `new:<title>`. A preset that was opened stays in the
catalog while the visitor is connected, even if its file is deleted or changed elsewhere: the page marks what differs
from it, and a save is refused if the file has changed since this visitor opened or saved it.
"""

import contextlib
import hashlib
import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from explorer.model.settings import Settings
from explorer.storage.certifier import CertificateOrReason, Certifier
from explorer.storage.library import Library, LibraryError, edition, slug
from explorer.storage.preset_file import as_it_became
from rangenav import certificate, preset
from rangenav.preset import Preset

MINE, NEW = "mine:", "new:"
OWN_MARK, NEW_MARK, DELETED_MARK = "★", "◌", "✗"
REFRESH_PERIOD = 1.0
"""s between two scans of the library, whose files other pages and programs may have changed."""
MAX_CACHED = 512
"""Parsed files in the cache; more than a full library."""


@dataclass(frozen=True, eq=False)
class OwnFile:
    """One file of the library, as it was when it was last read."""

    stamp: tuple[int, int, int]
    content: bytes
    preset: Preset | None
    complaint: str = ""


class Catalog:
    """The presets of one visitor, by name."""

    def __init__(self, shipped: dict[str, Preset], library: Library, certifier: Certifier) -> None:
        self._library, self._certifier = library, certifier
        self.presets: dict[str, Preset] = dict(shipped)
        """Every preset by name, also those that are not offered any more."""
        self._shipped = tuple(shipped)
        self._own: dict[str, OwnFile] = {}
        self._editions_seen: dict[str, set[str]] = {}
        self._certificates_written: set[bytes] = set()
        self.complaint = ""
        """Why the library, or one of its files, cannot be read; empty if all can be read."""
        self.refresh()

    def refresh(self) -> None:
        """Look at the library again; only changed files are read."""
        self._refreshed_at = time.monotonic()
        try:
            stamps = self._library.stamps()
        except LibraryError as reason:
            self.complaint = str(reason)
            return
        self._own = {name: self._read(name, stamp) for name, stamp in stamps.items()}
        for name, own in self._own.items():
            if own.preset is not None and MINE + name not in self._editions_seen:
                self.presets[MINE + name] = own.preset
        self.complaint = "; ".join(own.complaint for own in self._own.values() if own.complaint)

    def refresh_if_due(self) -> None:
        """Refresh if that was not done within the last second."""
        if time.monotonic() > self._refreshed_at + REFRESH_PERIOD:
            self.refresh()

    @property
    def offered(self) -> dict[str, Preset]:
        """The presets that can be opened: shipped, own and imported ones, each as its file is now."""
        shipped = {name: self.presets[name] for name in self._shipped}
        own = {MINE + name: own.preset for name, own in self._own.items() if own.preset is not None}
        return shipped | own | {name: imported for name, imported in self.presets.items() if name.startswith(NEW)}

    def labels(self, shown: str) -> dict[str, str]:
        """The label of each preset in a menu; the shown one has a label even if it is not offered any more."""
        labels = {}
        for name, offered in self.offered.items():
            symbol = f"{OWN_MARK} " if self.is_own(name) else f"{NEW_MARK} " if name.startswith(NEW) else ""
            remark = ", not saved" if name.startswith(NEW) else ""
            labels[name] = f"{symbol}{offered.title}{remark} ({display_name(name)})"
        if shown not in labels:
            labels[shown] = f"{DELETED_MARK} {self.presets[shown].title}, deleted ({display_name(shown)})"
        return labels

    def open(self, name: str) -> Settings:
        """A preset as its file is now. Raises LibraryError if the file cannot be read any more."""
        if not self.is_own(name):
            return Settings(origin=name, preset=self.presets[name])
        content = self._library.read(name.removeprefix(MINE))
        self.presets[name] = _parsed(content, f"{name.removeprefix(MINE)}.toml")
        return self._opened(name, content)

    def has_changed(self, settings: Settings) -> bool:
        """Whether settings differ from the preset that they come from, or come from one that is in no file yet."""
        if settings.origin.startswith(NEW) or settings.origin not in self.presets:
            return True
        opened = Settings(
            origin=settings.origin,
            edition=settings.edition,
            preset=self.presets[settings.origin],
            drafts=settings.drafts,
        )
        return settings != opened

    def is_own(self, name: str) -> bool:
        """Whether a preset is a file of the visitor's own."""
        return name.startswith(MINE)

    def add_imported(self, imported: Preset) -> Settings:
        """Offer an imported preset, which is in no file yet, and open it."""
        stem = slug(imported.title)
        free = (f"{NEW}{stem}" + (f"-{k}" if k > 1 else "") for k in range(1, len(self.presets) + 2))
        name = next(name for name in free if name not in self.presets)
        self.presets[name] = imported
        return Settings(origin=name, preset=imported)

    def add(self, new: Preset) -> Settings:
        """Save a new preset in the library. Raises LibraryError."""
        new = as_it_became(new)
        content = _bytes(new)
        return self._saved(MINE + self._library.add(new.title, content), new, content)

    def save(self, name: str, new: Preset, *, edition: str) -> Settings:
        """Overwrite an own preset that was opened in some edition. Raises LibraryError."""
        if not self.is_own(name):
            raise LibraryError("a shipped preset, or one not saved yet, is kept under a title of yours: use “save as”")
        new = as_it_became(new)
        content = _bytes(new)
        self._library.save(name.removeprefix(MINE), content, known=self._known_editions(name, edition))
        return self._saved(name, new, content)

    def rename(self, name: str, new: Preset, *, edition: str) -> Settings:
        """Save an own preset with a new title under a new name. Raises LibraryError."""
        if not self.is_own(name):
            raise LibraryError("only presets of your own can be renamed: use “save as”")
        new = as_it_became(new)
        content = _bytes(new)
        known = self._known_editions(name, edition)
        return self._saved(
            MINE + self._library.rename(name[len(MINE) :], new.title, content, known=known), new, content
        )

    def delete(self, name: str, *, edition: str) -> str:
        """Move an own preset to the trash. Returns the mark that `restore` needs. Raises LibraryError."""
        if not self.is_own(name):
            raise LibraryError("only presets of your own can be deleted")
        mark = self._library.delete(name.removeprefix(MINE), known=self._known_editions(name, edition))
        self.refresh()
        return mark

    def deleted(self) -> list[str]:
        """The marks of all deleted presets, also from earlier visits; the newest first."""
        return self._library.deleted()

    def restore(self, mark: str) -> Settings:
        """Restore a deleted preset. Raises LibraryError."""
        name = MINE + self._library.restore(mark)
        self.refresh()
        return self.open(name)

    def badge(self, name: str, shown: Preset, wake: Callable[[], None]) -> CertificateOrReason | None:
        """The certificate of the preset on the page, the reason why it has none, or None while it is being computed.

        `wake` is called when the computation has ended. The certificate is that of the preset `shown`, even if
        another page has saved a different one under this `name` meanwhile."""
        own = self._own.get(name.removeprefix(MINE)) if self.is_own(name) else None
        own = own if own and own.preset == shown else None
        content = own.content if own else _bytes(shown)
        stored = self._library.read_certificate(name.removeprefix(MINE)) if own else _shipped_certificate(name)
        stored_valid = None if stored is None else _valid_certificate(stored, content)
        if stored_valid is not None:
            return stored_valid
        result = self._certifier.certificate(content, wake)
        if own and isinstance(result, certificate.Certificate) and content not in self._certificates_written:
            self._certificates_written.add(content)  # only one attempt: a folder that cannot be written stays so
            with contextlib.suppress(LibraryError):
                self._library.write_certificate(name.removeprefix(MINE), certificate.dumps(result))
        return result

    def _read(self, name: str, stamp: tuple[int, int, int]) -> OwnFile:
        before = self._own.get(name)
        if before is not None and before.stamp == stamp:
            return before
        content = b""
        try:
            content = self._library.read(name)
            return OwnFile(stamp, content, _parsed(content, f"{name}.toml"))
        except ValueError as error:
            return OwnFile(stamp, content, None, str(error))

    def _opened(self, name: str, content: bytes) -> Settings:
        self._editions_seen.setdefault(name, set()).add(edition(content))
        return Settings(origin=name, preset=self.presets[name], edition=edition(content))

    def _saved(self, name: str, new: Preset, content: bytes) -> Settings:
        self.presets[name] = new
        self.refresh()
        return self._opened(name, content)

    def _known_editions(self, name: str, opened: str) -> set[str]:
        return self._editions_seen.get(name, set()) | {opened}


def display_name(name: str) -> str:
    """The name of an entry without its prefix: the shipped preset's, the file's, or one made of the title."""
    return name.removeprefix(MINE).removeprefix(NEW)


def marked(name: str) -> str:
    """The display name after the symbol of an own (★) or an imported (◌) preset."""
    symbol = OWN_MARK if name.startswith(MINE) else NEW_MARK if name.startswith(NEW) else ""
    return f"{symbol} {display_name(name)}".strip()


def checked_title(text: str) -> str:
    """A typed title without surplus blanks. Raises ValueError with the sentence that a file's title gets."""
    title = re.sub(" +", " ", text.strip(" "))
    preset.refuse_title(title or text)
    return title


@lru_cache(maxsize=MAX_CACHED)
def _parsed(content: bytes, source: str) -> Preset:
    try:
        return preset.loads(content.decode("utf-8"), source=source)
    except UnicodeDecodeError as error:
        raise LibraryError(f"{source}: not UTF-8 text (byte {error.start})") from None


@lru_cache(maxsize=MAX_CACHED)
def _bytes(shown: Preset) -> bytes:
    return preset.dumps(shown).encode()


@lru_cache(maxsize=MAX_CACHED)
def _shipped_certificate(name: str) -> bytes | None:
    """The stored certificate of a shipped preset, None if there is none."""
    for file in preset.shipped_files():
        if file.stem == name:
            stored = certificate.path_for(file)
            return stored.read_bytes() if stored.is_file() else None
    return None


@lru_cache(maxsize=MAX_CACHED)
def _valid_certificate(stored: bytes, content: bytes) -> certificate.Certificate | None:
    """A stored certificate, if it can be read and its hash is that of these bytes; else None."""
    try:
        parsed = certificate.loads(stored, source="certificate")
    except ValueError:
        return None
    return parsed if _is_certificate_of(parsed, content) else None


def _is_certificate_of(candidate: certificate.Certificate, content: bytes) -> bool:
    return candidate.artifact.sha256 == hashlib.sha256(content).hexdigest()
