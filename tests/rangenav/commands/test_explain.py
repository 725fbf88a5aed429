"""`rangenav explain` as a person and a script meet it."""

from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from rangenav import analysis, preset
from rangenav.signals import Multisine, Tone
from rangenav.twin import Twin, twin

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("name", ["hover", "circle", "paper-slow"])
def test_the_report_says_what_the_library_found(answer, name: str):
    output, p = answer("explain", name), preset.load(name)
    other = twin(p)
    assert output["verdict"] == {"hover": "blind", "circle": "blind", "paper-slow": "observable"}[name]
    assert (output["functions"]["rank"], len(output["functions"]["relations"])) == {
        "hover": (5, 8),
        "circle": (11, 2),
        "paper-slow": (13, 0),
    }[name]
    assert output["frozen"]["turned"] == 5
    assert output["printed"]["false_certificate"] is (name == "circle")
    if isinstance(other, Twin):
        assert output["twin"]["kind"] == other.kind
        assert output["twin"]["shift"] == other.shift.tolist()
        assert output["horizon"]["full_rank"] == {"from_start": None, "worst": None}
    else:
        assert output["twin"]["kind"] is None
        assert output["twin"]["words"] == other.reason
        assert 0.3 < output["horizon"]["full_rank"]["from_start"] <= output["horizon"]["full_rank"]["worst"] < 2


def test_a_length_that_is_enough_is_so_in_every_window_and_is_not_said_of_ranges_that_fall_on_one_place(
    run, answer, tmp_path: Path
):
    """At 1 Hz all three tones repeat from range to range; the motion alone has rank 13 before a second range comes."""
    turn = 2 * np.pi
    tones = (
        Tone(axis="x", amplitude=1.0, frequency=turn),
        Tone(axis="y", amplitude=1.0, frequency=2 * turn),
        Tone(axis="z", amplitude=1.0, frequency=3 * turn),
    )
    soft = preset.load("soft")
    once = replace(soft, path=Multisine(tones=tones), sensors=replace(soft.sensors, range_rate=1.0))
    preset.save(once, tmp_path / "once.toml")
    horizon = answer("explain", tmp_path / "once.toml")["horizon"]
    assert horizon["accurate"] == {"from_start": None, "worst": None}
    assert (horizon["full_rank"]["from_start"], horizon["full_rank"]["worst"]) == (12.0, 13.0)
    said = " ".join(run("explain", tmp_path / "once.toml")[1].split())
    assert "✗ an error below 0.5 m: no window of the flight is long enough" in said
    horizon = answer("explain", "soft")["horizon"]
    assert horizon["accurate"]["worst"] == analysis.shortest(soft).every
    assert "s in every window" in " ".join(run("explain", "soft")[1].split())


def test_the_saved_twin_is_a_preset_with_the_same_range_elsewhere(run, tmp_path: Path):
    file = tmp_path / "twin.toml"
    code, out, err = run("explain", "circle", "--save", file)
    assert (code, err) == (0, "")
    assert "the mirror image in the plane" in out
    true, other = preset.load("circle"), preset.load(file)
    time, anchor = np.linspace(0.0, 20.0, 500), np.asarray(true.world.anchor)
    ranges = [np.linalg.norm(p.path(time) - anchor, axis=1) for p in (true, other)]
    np.testing.assert_allclose(*ranges, atol=1e-12)
    assert np.linalg.norm(other.path(time) - true.path(time), axis=1).min() > 1.0
    assert other.title == f"Twin of {true.title}"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("circle", "--apart", "-1"), "apart must lie between 0.01 and 10000 m, got -1"),
        (("circle", "--save", "twin.txt"), "--save must name a file that ends in .toml, got twin.txt"),
        (("circle", "--window", "30"), "circle, --window: requirement.window must be shorter than the duration"),
        (("lissajous", "--save", "twin.toml"), "--save: lissajous has no twin to write: no twin: "),
    ],
)
def test_bad_input_is_one_sentence_and_exit_2(run, arguments: tuple[str, ...], sentence: str):
    code, out, err = run("explain", *arguments)
    assert (code, out) == (2, "")
    assert err.startswith(sentence)
    assert err.count("\n") == 1
