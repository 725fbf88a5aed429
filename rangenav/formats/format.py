"""The description of an exchange format: one frozen row. Every list of formats follows from these rows.

The rows are in `table`; the command line, the page, the certificates and the documentation read them there.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats import text
from rangenav.formats.import_result import ImportResult
from rangenav.formats.output_files import Draft, ExportOptions, OutputFile
from rangenav.formats.sampled_rows import FLIGHT, Part
from rangenav.preset import Preset

Content = Literal["preset", "path", "flight"]
"""What is read from a file: every input of one run, a path, or what the sensors of a flight gave."""
Certified = Literal["preset", "motion", "run", "neither"]
"""What the certificate of an exported file is computed from.

preset   the preset that the file is
motion   the motion that the file holds between its ramps
run      the preset whose run the file is a record of, after every position in the file was compared with its path
neither  there is no certificate: nothing about the file can be certified
"""
Gate = Literal["requirement", "claim"]
"""What a preset must do to be exported: meet every requirement, or only be what it says that it is."""
Samples = tuple[Float[Array, "n"], Float[Array, "n 3"]]
"""Times from the beginning of the run (s) and positions (m)."""


@dataclass(frozen=True, kw_only=True)
class ReadOptions:
    """The arguments of a reader other than the file's bytes."""

    source: str
    """The file's name, for messages."""
    confirm: Mapping[str, str]
    """Answers to questions, by the questions' keys."""
    knots: float | None = None
    """s between the knots of a curve that is fitted to sampled positions; None: the reader chooses."""
    part: Part = FLIGHT
    """Begin and end (s, from the first row) of the part of a path that is read."""


Writer = Callable[[Preset, Path], OutputFile]
"""Writes a preset, or its run, to a path. Raises ValueError for what the format cannot hold."""
Drafts = Callable[[Preset, ExportOptions], Iterator[Draft]]
"""The ways to write a motion, the coarsest first. Raises ValueError if there is none, and why."""
Reader = Callable[[bytes, ReadOptions], ImportResult]
"""Reads the bytes of a file. Raises ValueError naming the file and the line."""
FolderReader = Callable[[Path, ReadOptions], ImportResult]
"""Reads a folder. Raises ValueError naming the file and the line."""
PositionReader = Callable[[Mapping[str, bytes], str], Samples]
"""Reads the true positions of an exported record again: (bytes by file name, name for messages) → samples."""


def never(head: str) -> bool:
    """A format whose files are not recognised by how they begin."""
    return False


@dataclass(frozen=True, eq=False, kw_only=True)
class Format:
    """One exchange format."""

    name: str
    """What the command line and the certificate call it."""
    label: str
    """What the page calls it."""
    hint: str = ""
    """For whom it is and what is in it, a sentence."""
    keeps: str
    """What of a preset a file of this format keeps, a sentence without a full stop."""
    suffix: str = ""
    """The end of a file's (or folder's) name in the page's download."""
    folder: bool = False
    """Whether a folder is written instead of a file."""
    upright: bool = False
    """Whether z points up in every file, whatever the preset's frame is."""

    writer: Writer | None = None
    """Of a preset or a run; None: `drafts` write the format, or nothing does."""
    drafts: Drafts | None = None
    """For a motion: the ways to write it, of which an export takes the first that its certificate confirms."""
    own_attitude: bool = False
    """Whether the preset's own attitude can be written instead of the one that flying the path takes."""
    unsupported: str = ""
    """Why the format is neither written nor read, one sentence; empty if it is."""

    reads: tuple[Content, ...] = ()
    """What its files may hold for `rangenav import` and `rangenav log`."""
    reader: Reader | None = None
    """None: `formats.read` does not read it."""
    folder_reader: FolderReader | None = None
    """None: there are no folders of this format."""
    read_label: str = ""
    """What the page calls a file that is read."""
    read_suffixes: tuple[str, ...] = ()
    """Ends of file names that no other format has."""
    recognises: Callable[[str], bool] = never
    """Whether a file that begins with this text (in lower case) looks like one."""
    max_bytes: int = text.MAX_BYTES
    """A larger file is not read."""

    certified_as: Certified = "neither"
    gate: Gate = "requirement"
    positions: PositionReader | None = None
    """For a run: reads the positions again that are compared with the certified path."""

    @property
    def written(self) -> bool:
        """Whether there are files of it that are exported."""
        return self.writer is not None or self.drafts is not None

    def __post_init__(self) -> None:
        if (self.certified_as == "run") != (self.positions is not None):
            raise TypeError(f"{self.name}: positions must be given for what is certified as a run, and only then")
        if self.certified_as == "motion" and self.reader is None:
            raise TypeError(f"{self.name}: reader must be given for what is certified as a motion")
        if (self.certified_as == "motion") != (self.drafts is not None):
            raise TypeError(f"{self.name}: drafts must be given for what is certified as a motion, and only then")
