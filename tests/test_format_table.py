"""One row per exchange format: the command line, the page, the certificates and the documentation follow from it."""

import contextlib
import importlib
import io
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import get_args

import pytest
import tyro

from explorer.panels.presets import bundle, import_panel
from explorer.storage import import_file
from explorer.storage.bundle import pack
from rangenav import certificate, formats, preset, provenance
from rangenav.certificate import certified_export, exports
from rangenav.commands import export, import_, log
from rangenav.formats import format, table, text
from rangenav.formats import tum as witness
from rangenav.formats.exported_run import run_of
from rangenav.formats.output_files import write_text
from rangenav.preset import Preset

pytestmark = pytest.mark.slow


COMMANDS = (export, import_, log)


def written(chosen: Preset, path: Path) -> formats.OutputFile:
    """Blank-separated times and positions, under one comment."""
    run = run_of(chosen)
    rows = [f"{t!r} {x!r} {y!r} {z!r}" for t, (x, y, z) in zip(run.time.tolist(), run.position.tolist(), strict=True)]
    write_text(path, "\n".join(["# a new format", *rows, ""]))
    return formats.OutputFile(files=(path,), frame="as the preset")


def positions(content: Mapping[str, bytes], source: str) -> format.Samples:
    """The same columns again."""
    values = text.table(content[""], source=source, names=("t", "x", "y", "z")).values
    return values[:, 0], values[:, 1:]


NEW = formats.Format(
    name="blank",
    label="blank-separated",
    hint="For whoever has nothing else.",
    keeps="times and positions",
    suffix=".blank",
    writer=written,
    reads=("path", "flight"),
    reader=lambda data, asked: witness.parse(data, source=asked.source, confirm=asked.confirm),
    read_label="blank-separated poses",
    read_suffixes=(".blank",),
    certified_as="run",
    gate="claim",
    positions=positions,
)


@pytest.fixture
def new_format(monkeypatch: pytest.MonkeyPatch) -> Iterator[formats.Format]:
    """A table with one more row; the commands, which read it when they are imported, are imported anew."""
    monkeypatch.setattr(table, "FORMATS", (*table.FORMATS, NEW))
    for command in COMMANDS:
        importlib.reload(command)
    yield NEW
    monkeypatch.undo()
    for command in COMMANDS:
        importlib.reload(command)


def usage(command: object) -> str:
    """What `--help` of a command prints."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said), pytest.raises(SystemExit):
        tyro.cli(command, args=["--help"])  # type: ignore[reportCallIssue]
    return said.getvalue()


def test_a_new_row_is_offered_by_the_command_line_the_page_and_the_documentation(new_format: formats.Format) -> None:
    for command in (export.export, import_.import_, log.log):
        assert "blank" in usage(command)
    assert new_format in bundle.choices()
    assert import_panel.choices()["blank"] == "blank-separated poses"
    assert import_file.guess(import_file.ImportFile("x.BLANK", b"")) == "blank"
    assert "| blank-separated | `blank` | file | path, flight | times and positions | run | as the preset |\n" in (
        formats.markdown()
    )


def test_a_file_of_a_new_row_is_written_certified_and_verified(new_format: formats.Format, tmp_path: Path) -> None:
    packed = pack(
        preset.load("soft"), "x", ["blank"], uncertified=False, progress=lambda _: None, cancelled=lambda: False
    )
    zipfile.ZipFile(io.BytesIO(packed.content)).extractall(tmp_path)
    assert (tmp_path / "x.blank").read_text().startswith("# a new format\n")
    assert certificate.verify_file(tmp_path / "x.blank", readers=exports.readers()) == ()
    moved = (tmp_path / "x.blank").read_text().replace("\n0.1 ", "\n0.1 1")
    (tmp_path / "x.blank").write_text(moved)
    assert certificate.verify_file(tmp_path / "x.blank", readers=exports.readers()) != ()


def test_a_format_that_nothing_can_be_certified_of_gets_no_certificate_and_the_reason(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    row = formats.Format(name="blank", label="blank", keeps="positions", writer=written)
    monkeypatch.setattr(table, "FORMATS", (*table.FORMATS, row))
    path = tmp_path / "x.blank"
    export = certified_export.write(preset.load("soft"), "blank", path, name="soft", otherwise="")
    assert (export.certificate, export.complaint) == (None, None)
    assert export.reason == "nothing in a file of blank can be certified"
    assert [path.name for path in tmp_path.iterdir()] == ["x.blank"]
    assert "blank" not in exports.readers()


@pytest.mark.parametrize("row", formats.rows(), ids=lambda row: row.name)
def test_every_row_says_what_its_readers_and_writers_need(row: formats.Format) -> None:
    assert row.keeps
    assert row.written != bool(row.unsupported)
    assert not row.written or (row.hint and row.suffix.startswith("."))
    assert (row.reader is None) or (row.read_label and set(row.reads) <= {"path", "flight"})
    assert row.written == (row.certified_as != "neither")


def test_a_preset_can_say_that_its_path_came_from_any_format_with_paths() -> None:
    paths = {row.name for row in formats.holding("path")}
    assert paths == set(get_args(provenance.SourceFormat)) - {"arrays"}  # arrays come from no file


def test_no_two_rows_have_one_name_label_or_suffix() -> None:
    for values in (
        [row.name for row in formats.rows()],
        [row.label for row in formats.rows()],
        [row.suffix for row in formats.writable()],
        [suffix for row in formats.rows() for suffix in row.read_suffixes],
    ):
        assert len(set(values)) == len(values)


def test_a_row_that_contradicts_itself_is_refused() -> None:
    with pytest.raises(TypeError, match="positions must be given for what is certified as a run"):
        formats.Format(name="x", label="x", keeps="x", writer=written, certified_as="run")
    with pytest.raises(TypeError, match="reader must be given for what is certified as a motion"):
        formats.Format(name="x", label="x", keeps="x", writer=written, certified_as="motion")
