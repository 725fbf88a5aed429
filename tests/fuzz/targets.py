"""Every reader of bytes or text from outside, by name, and the targets in which they take turns."""

from collections.abc import Callable
from random import Random

from tests.fuzz import documents, importers, presets, records
from tests.fuzz.formulas import formula

Reader = Callable[[Random], None]
IMPORTERS: dict[str, Reader] = {name: importers.importer(name) for name in importers.NAMES}
RECORDS: dict[str, Reader] = {f"{name}-record": records.exported_record(name) for name in records.NAMES}
DOCUMENTS: dict[str, Reader] = {
    "certificate": documents.certificate,
    "zip": documents.zipped_preset,
    "work": documents.saved_work,
    "folder": documents.folder,
}
READERS: dict[str, Reader] = {
    "formula": formula,
    "preset": presets.damaged_preset,
    "toml": presets.toml_like,
    **IMPORTERS,
    **RECORDS,
    **DOCUMENTS,
}
TARGETS: dict[str, tuple[str, ...]] = {
    "formula": ("formula",),
    "preset": (*("preset",) * 9, "toml"),
    "importers": tuple(IMPORTERS),
    "records": tuple(RECORDS),
    "documents": tuple(DOCUMENTS),
}
LEAST_CASES = {"formula": 100_000, "preset": 8_000, "importers": 4_000, "records": 2_000, "documents": 5_000}
"""What a run of a minute or more must reach: fewer cases prove nothing."""


def prepare() -> None:
    """Make the files that are damaged, so that no case makes them."""
    presets.texts()
    importers.files()
    records.records()
    documents.seeds()
