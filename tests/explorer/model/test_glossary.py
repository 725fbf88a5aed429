"""The words of the page come from one table, and no key of a preset's file is among them."""

import re
from typing import Any

import msgspec
import pytest

from explorer.model import differences, glossary
from explorer.model.gain_units import GAIN_LIMITS
from rangenav import preset
from rangenav.physical_gains import PhysicalGains

KEY = re.compile(r"\b[a-z]+_[a-z]+\b|\b[a-z]{2,}\.[a-z_]{2,}\b")


@pytest.mark.parametrize("key", glossary.TERMS)
def test_a_term_has_a_label_one_sentence_and_no_key(key: str):
    term = glossary.TERMS[key]
    assert term.meaning.endswith(".")
    assert term.meaning.count(". ") == 0
    assert len(term.hint) <= 220
    assert not KEY.search(f"{term.caption} {term.hint}")


def test_chapters_share_no_key_and_no_field_belongs_to_two_terms():
    assert sum(map(len, glossary.CHAPTERS.values())) == len(glossary.TERMS)
    fields = [field for term in glossary.TERMS.values() for field in term.fields]
    assert len(fields) == len(set(fields))


def test_every_physical_gain_has_a_term_and_limits():
    names = set(PhysicalGains.__struct_fields__) - {"mode", "schedule", "rho1"}  # ρ1 is the paper's in both
    assert set(glossary.PHYSICAL_GAINS) == set(GAIN_LIMITS) == names


def _keys(value: Any, where: str = "") -> list[str]:
    if isinstance(value, dict):
        return [key for name in value for key in _keys(value[name], f"{where}.{name}" if where else name)]
    if isinstance(value, list | tuple) and any(isinstance(entry, dict) for entry in value):
        return [key for k, entry in enumerate(value, 1) for key in _keys(entry, f"{where}[{k}]")]
    return [where]


@pytest.mark.parametrize("name", ["paper-slow", "eight-repaired", "hand-held", "minimum-snap"])
def test_every_key_of_a_preset_is_named_without_dots_underscores_and_brackets(name: str):
    for key in _keys(msgspec.to_builtins(preset.load(name))):
        assert not re.search(r"[_\[\]]|\.[a-z]", glossary.field_label(key)), key


def test_a_fields_term_names_a_key_that_presets_have():
    known = set(_keys(msgspec.to_builtins(preset.load("paper-slow"))))
    stored = [
        field for term in glossary.TERMS.values() for field in term.fields if field.startswith(("gains.r", "sens"))
    ]
    assert set(stored) <= known


@pytest.mark.parametrize(
    ("sentence", "shown"),
    [
        ("q must lie between 1 and 2, got 3", "range weight q must lie between 1 and 2, got 3"),
        ("Not shown: q must be 1. More.", "Not shown: range weight q must be 1. More."),
        ("p0.position must lie between 1 and 2, got 3", "initial variance P₀(p) must lie between 1 and 2, got 3"),
        ("accel_bias must not be longer than 100 m/s²", "accelerometer bias must not be longer than 100 m/s²"),
        ("noise range must be 0, or lie between 1e-09 and 2", "range noise σ must be 0, or lie between 1e-9 and 2"),
        ("own.toml: cannot be read, e.g. by 0.5 s", "own.toml: cannot be read, e.g. by 0.5 s"),
    ],
)
def test_a_sentence_of_the_library_is_shown_with_the_labels_of_the_page(sentence: str, shown: str):
    assert glossary.in_labels(sentence) == shown


def test_differences_are_written_with_the_labels_of_the_page():
    a = preset.load("paper-slow")
    riccati = msgspec.structs.replace(a.gains.riccati, q=316.2)
    b = msgspec.structs.replace(a, gains=msgspec.structs.replace(a.gains, riccati=riccati))
    assert differences.choices(a, b) == [f"Range weight q: {a.gains.riccati.q:g} → 316.2"]
