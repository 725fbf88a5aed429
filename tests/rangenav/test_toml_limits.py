"""What a hostile TOML text costs is bounded before it is parsed, and whatever a person may write passes."""

import re
import tracemalloc
from pathlib import Path

import msgspec
import pytest

from rangenav import preset, toml_limits
from rangenav.signals.waypoints import MAX_POINTS

DOTS = ".".join("a" * 20_000)
SOURCE, WORD = Path(__file__).parent.parent.parent, re.compile(r"toml\.decode|tomllib")
MANY = 600
"""Keys, twice as many as are allowed here: the true limit takes a second to reach where every call is checked."""
HOSTILE = {
    "a key of 20,000 dots": f"{DOTS} = 1",
    "a table's name of 20,000 dots": f"[{DOTS}]",
    "one in an array of tables": f"[[{DOTS}]]",
    "one in an inline table": f"x = {{ {DOTS} = 1 }}",
    "one with blanks around the dots": f"{DOTS.replace('.', ' . ')} = 1",
    "one of quoted parts": ".".join(['"a"', "'b'"] * 10_000) + " = 1",
    "one after a string that is not closed": f'x = "abc\n{DOTS} = 1',
    "one after a string of several lines": f'x = """\n[a.b]\n"""\n{DOTS} = 1',
    "many keys of 5,000 dots": "\n".join(f"k{k}.{DOTS[:10_000]}a = 1" for k in range(20)),
    "a key of 300 characters": "a" * 300 + " = 1",
    "a quoted key of 300 characters": f'"{"a" * 300}" = 1',
    "arrays in arrays": "x = " + "[" * 5000,
    "inline tables in inline tables": "x = " + "{ a = " * 5000,
    "many tables": "\n".join(f"[{k:x}]" for k in range(MANY)),
    "many keys": "\n".join(f"{k:x} = 1" for k in range(MANY)),
    "many empty arrays": "x = [" + "[]," * MANY + "]",
    "a number of 400 digits": "duration = " + "9" * 400,
    "a number of 400,000 hexadecimal digits": "seed = 0x" + "f" * 400_000,
    "too many bytes": "#" * (toml_limits.MAX_BYTES + 1),
}


@pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE)
def test_a_text_that_costs_too_much_is_refused_before_it_is_parsed(text: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(toml_limits, "MAX_KEYS", MANY // 2)
    tracemalloc.start()
    with pytest.raises(ValueError, match=r"^x\.toml: ") as refused:
        preset.loads(text, source="x.toml")
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 2**21
    assert "\n" not in str(refused.value)
    assert len(str(refused.value)) < 120


@pytest.mark.parametrize("last", ["", "\\"])
@pytest.mark.parametrize("part", ['\\"""\n', "'''a", '"a', '"""a', "\\", '"\\'])
@pytest.mark.parametrize("first", ['x = """', "x = '''", 'x = "', ""])
def test_a_text_of_strings_that_do_not_end_is_read_once(first: str, part: str, last: str):
    """Read anew from each quote, these texts would take ten seconds each, and a megabyte an hour."""
    text = first + part * (60_000 // len(part)) + last
    with pytest.raises(ValueError, match=r"^x\.toml: "):
        preset.loads(text, source="x.toml")


def test_dots_brackets_and_signs_in_strings_and_comments_do_not_count():
    story = "a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r.s.t = [[[{ # '"
    shown = msgspec.structs.replace(preset.load("soft"), story=story)
    text = f'# {"[a.b.c.d.e.f.g.h.i.j]" * 100} = """ {"x" * 500}\n' + preset.dumps(shown)
    assert preset.loads(text, source="x.toml") == shown
    literal = text.replace(f'"{story}"', f"'''\n{story}'''")
    assert literal != text
    assert preset.loads(literal, source="x.toml") == shown


def test_the_largest_path_that_a_preset_may_hold_passes(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(toml_limits, "MAX_KEYS", toml_limits.MAX_KEYS // 100)
    point = "[[path.points]]\ntime = 1.0\nvalue = [1.0, 2.0, 3.0]\n"
    toml_limits.refuse_large(preset.dumps(preset.load("soft")) + point * (MAX_POINTS // 100 * 4))


def test_a_wrong_value_is_not_repeated_whole():
    text = preset.dumps(preset.load("soft")).replace('expect = "', f'expect = "{"y" * 100_000}')
    with pytest.raises(ValueError, match=r"^x\.toml: Invalid enum value 'yyy.* … .*at `\$\.expect`$") as refused:
        preset.loads(text, source="x.toml")
    assert len(str(refused.value)) < 400


def test_a_preset_that_states_no_size_is_bounded_as_well(tmp_path):
    (tmp_path / "x.toml").write_bytes(b"#" * (toml_limits.MAX_BYTES + 1))
    with pytest.raises(ValueError, match="larger than 1000000 bytes, which no preset is"):
        preset.load(tmp_path / "x.toml")


def test_toml_is_parsed_in_one_place_behind_the_limits():
    sources = [file for folder in ("rangenav", "explorer") for file in (SOURCE / folder).rglob("*.py")]
    parsing = [file.name for file in sources if {"toml.decode", "tomllib"} & set(WORD.findall(file.read_text()))]
    assert parsing == ["toml_limits.py"]
