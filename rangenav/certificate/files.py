"""The bytes that are certified, and where their certificate lies.

A file's bytes are its own. A folder's (a ROS bag, a EuRoC record) are those of all its files one after the other, in
the order of their names: for each its name, its size and its content, so that no byte and no file of it can be altered,
added or lost. Its certificate lies in the folder and is none of them.
"""

import os
import stat
from pathlib import Path

from rangenav.inputs import require

MAX_FILE = 256_000_000
"""Bytes; ten minutes of every array of a run."""
MAX_ENTRIES = 64
"""Files and folders in a folder that may be certified: ours have a dozen."""
SUFFIX = ".certificate.json"
OF_FOLDER = "certificate.json"
"""The certificate in a folder."""


def path_for(path: Path) -> Path:
    """The path of a file's certificate.

    NAME.certificate.json for the preset NAME.toml; NAME.csv.certificate.json for NAME.csv, because a preset may be
    exported in many formats under one name; certificate.json within a folder.
    """
    if path.is_dir():
        return path / OF_FOLDER
    return path.with_name((path.stem if path.suffix == ".toml" else path.name) + SUFFIX)


def file_of(certificate: Path) -> Path | None:
    """The file or folder that a certificate belongs to, by the certificate's name; None if it has no such name."""
    if certificate.name == OF_FOLDER:
        return certificate.parent
    if not certificate.name.endswith(SUFFIX):
        return None
    file = certificate.with_name(certificate.name.removesuffix(SUFFIX))
    return file if file.is_file() else file.with_name(f"{file.name}.toml")


def certified_in(name: str) -> tuple[str, ...]:
    """The paths of all files and folders in a folder that have a certificate beside them, in the order of their names.

    The name alone, if it is of no folder, of a folder with a certificate of its own, or if nothing in it has one.
    """
    folder = Path(name)
    if not folder.is_dir() or path_for(folder).is_file():
        return (name,)
    return tuple(str(path) for path in sorted(folder.iterdir()) if path_for(path).is_file()) or (name,)


def read_bytes(path: Path) -> bytes:
    """All bytes of a file or folder that is not too large to be read whole. Raises ValueError."""
    try:
        if path.is_dir():
            return _packed(path)
        require(not path.exists() or path.is_file(), f"{path.name}: not a file")
        with path.open("rb") as file:
            content = file.read(MAX_FILE + 1)  # no more, also of a file that states no size
        require(len(content) <= MAX_FILE, f"{path.name}: larger than {MAX_FILE} bytes")
        return content
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror}") from None


def unpacked(content: bytes, source: str) -> dict[str, bytes]:
    """The files of a folder by their names. Raises ValueError for bytes that are none of a folder's."""
    files, at = {}, 0
    while at < len(content):
        end = content.find(b"\n", at)
        name, _, size = content[at:end].rpartition(b" ")
        broken = end < 0 or not size.isdigit() or len(size) > 12 or end + 1 + int(size) > len(content)
        require(not broken and len(files) < MAX_ENTRIES, f"{source}: these are not the bytes of a folder")
        at = end + 1 + int(size)
        files[name.decode("utf-8", "replace")] = content[end + 1 : at]
    return files


def _packed(folder: Path) -> bytes:
    """Name, size, line feed, content of every file; nothing is followed out of the folder."""
    files = _files(folder)
    sizes = {name: file.stat().st_size for name, file in files.items()}
    require(sum(sizes.values()) <= MAX_FILE, f"{folder.name}: larger than {MAX_FILE} bytes")
    packed = []
    for name in sorted(files):
        content = files[name].read_bytes()
        packed += [f"{name} {len(content)}\n".encode("utf-8", "surrogateescape"), content]
    return b"".join(packed)


def _files(folder: Path) -> dict[str, Path]:
    files_by_name: dict[str, Path] = {}
    folders, entries = [folder], 0
    while folders:
        with os.scandir(folders.pop()) as listed:
            for entry in listed:
                entries += 1
                name = Path(entry.path).relative_to(folder).as_posix()
                require(entries <= MAX_ENTRIES, f"{folder.name}: more than {MAX_ENTRIES} files, which no export is")
                rule = f"{folder.name}: {name!r} is neither a file nor a folder, or has a line feed in its name"
                mode = entry.stat(follow_symlinks=False).st_mode
                require((stat.S_ISREG(mode) or stat.S_ISDIR(mode)) and "\n" not in name, rule)
                if stat.S_ISDIR(mode):
                    folders.append(Path(entry.path))
                elif name != OF_FOLDER:
                    files_by_name[name] = Path(entry.path)
    return files_by_name
