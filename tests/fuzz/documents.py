"""Other bytes that come from outside: certificates, zips, saved work, and the packed bytes of a folder."""

import io
import zipfile
from pathlib import Path
from random import Random

import msgspec

from explorer.model.settings import Settings
from explorer.storage.autosave import Autosave, SavedWork
from explorer.storage.import_file import ImportFile, preset_in
from explorer.storage.work_files import WorkFiles
from rangenav import certificate as certificates
from rangenav import preset
from rangenav.certificate import files
from rangenav.certificate.files import path_for
from tests.fuzz import damage, sentences

JSON_PIECES = (
    *(
        b"null",
        b"true",
        b"NaN",
        b"-1",
        b"1e999",
        b"9" * 400,
        b"1e-320",
        b'""',
        b"{}",
        b"[]",
        b"[" * 5000,
        b'{"a":' * 5000,
    ),
    *(b'"version":2,', b'"kind":"sum",', b'"\\u0000"', b'"\\ud800"', b"\xff", b",", b":", b"}", b'"unknown":1,'),
)
METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA)
ZIP_NAMES = ("a.toml", "b.toml", "x.csv", "../../a.toml", "A.TOML", "", "a" * 300 + ".toml", "\u202ea.toml", "d/")
_SEEDS: dict[str, list[bytes]] = {}


def seeds() -> dict[str, list[bytes]]:
    """What is damaged: texts of presets, certificates, and saved work."""
    if not _SEEDS:
        chosen = [preset.load(name) for name in ("paper-slow", "soft", "hover")]
        _SEEDS["preset"] = [preset.dumps(p).encode() for p in chosen]
        stored = [path_for(file) for file in preset.shipped_files()]
        _SEEDS["certificate"] = [place.read_bytes() for place in stored if place.is_file()]
        works = [SavedWork(opened="soft", settings=Settings(origin="soft", preset=p)) for p in chosen]
        _SEEDS["work"] = [msgspec.json.encode(work) for work in works]
        for content in _SEEDS["certificate"]:  # undamaged they are read; and modules imported now are not run later
            certificates.dumps(certificates.loads(content, source="x"))
        for work, content in zip(works, _SEEDS["work"], strict=True):
            assert _restored(content) == (work, [])
        preset_in(ImportFile("x.zip", _zipped([("a.toml", _SEEDS["preset"][0], zipfile.ZIP_DEFLATED)])))
        for method in METHODS:
            _zipped([("a", b"", method)])
    return _SEEDS


def certificate(random: Random) -> None:
    """A certificate with places damaged: refused in one line, or read and written."""
    content = _damaged_json(random, random.choice(seeds()["certificate"]))
    try:
        certificate = certificates.loads(content, source="x")
    except ValueError as error:
        sentences.check(str(error), "x: ")
        return
    certificates.dumps(certificate)


def saved_work(random: Random) -> None:
    """Saved work with places damaged: restored, or kept and the visitor notified in one line."""
    work, notices = _restored(_damaged_json(random, random.choice(seeds()["work"])))
    assert (work is None) == (len(notices) == 1)
    for sentence in notices:
        sentences.check(sentence, "Your earlier work ", longest=1000)
    if work is not None:
        msgspec.json.encode(work)


def zipped_preset(random: Random) -> None:
    """A zip of any members, packed by any method, torn at times: the preset in it, or refused in one line."""
    members = []
    for _ in range(random.choice((1, 1, 1, 2, 5))):
        content = random.choice(seeds()["preset"])
        content = random.choice((content, content, damage.damaged(random, content, text=True), bytes(2_000_000)))
        members.append((random.choice(ZIP_NAMES), content, random.choice(METHODS)))
    packed = _zipped(members)
    if random.random() < 0.7:
        packed = damage.damaged(random, packed, text=False)
    try:
        preset_in(ImportFile("x.zip", b"PK\x03\x04" + packed[4:]))
    except ValueError as error:
        sentences.check(str(error).replace(" in x.zip", ""), "", longest=1000)


def folder(random: Random) -> None:
    """The packed bytes of a folder, damaged: its files, or refused in one line."""
    packed = b"".join(f"f{k} {k}\n".encode() + b"x" * k for k in range(random.randint(1, 80)))
    packed = damage.damaged(random, packed, text=random.random() < 0.5)
    try:
        files.unpacked(packed, "x")
    except ValueError as error:
        sentences.check(str(error), "x: ")


class _OneFile(WorkFiles):
    """Saved work in memory."""

    def __init__(self, content: bytes) -> None:
        self.folder, self._content = Path("work"), content

    def load(self, session_key: str) -> bytes | None:
        return self._content

    def keep(self, session_key: str, ending: str) -> str:
        return f"x{ending}"


def _restored(content: bytes) -> tuple[SavedWork | None, list[str]]:
    notices: list[str] = []
    return Autosave(_OneFile(content), "soft", notices.append).restore("x"), notices


def _damaged_json(random: Random, content: bytes) -> bytes:
    for _ in range(random.choice((1, 1, 2))):
        if random.random() < 0.3:
            content = damage.damaged(random, content, text=True)
        else:
            at = random.randrange(len(content) + 1)
            content = content[:at] + random.choice(JSON_PIECES) + content[at + random.choice((0, 0, 1, 5, 20)) :]
    return content


def _zipped(members: list[tuple[str, bytes, int]]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for k, (name, content, method) in enumerate(members):
            archive.writestr(zipfile.ZipInfo(f"{k}{name}" if k else name), content, compress_type=method)
    return packed.getvalue()
