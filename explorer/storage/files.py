"""Files are written whole: a reader, or a crash at any moment, finds the old content or the new one, never a mixture.

The content goes to a temporary file in the same folder, is flushed to the disk, and is then renamed.
"""

import os
import tempfile
from pathlib import Path

UNFINISHED = ".part"
"""Suffix of a temporary file."""


def write(path: Path, content: bytes) -> None:
    """Write a file that only its owner may read. Raises OSError, and leaves the old file, if the disk refuses."""
    opened, name = tempfile.mkstemp(dir=path.parent, prefix=f"{path.stem}.", suffix=UNFINISHED)
    temporary = Path(name)
    try:
        with open(opened, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException:
        unlink(temporary)
        raise


def unlink(path: Path) -> None:
    """Remove a file if it exists and may be removed."""
    try:
        path.unlink(missing_ok=True)
    except OSError:
        return
