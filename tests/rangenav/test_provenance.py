"""Imported paths: they know their file, what was fitted is not judged, and what a person changes is a design."""

import functools
import hashlib
from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from explorer.model.settings import Settings, effective
from explorer.storage import import_file, preset_file
from rangenav import axes, certificate, formats, preset, provenance, repair, signals, verdict
from rangenav.certificate import exports
from rangenav.formats import reference_fit
from rangenav.formats.path_preset import as_preset
from rangenav.preset import Preset
from rangenav.provenance import Source
from rangenav.signals import Multisine, Tone
from tests.support.present import present
from tests.support.signal_examples import EXAMPLES, POLYNOMIALS

pytestmark = pytest.mark.slow


replace = msgspec.structs.replace
SOFT = preset.load("soft")
RECORDS = ("tum", "euroc", "positions", "jerk")


def certified(p: Preset) -> certificate.Certificate:
    return certificate.certify(preset.dumps(p).encode(), source="x.toml")


def without(file: Path, *words: str) -> None:
    """Take columns out of a reference file."""
    rows = [line.split(",") for line in file.read_text().splitlines()]
    kept = [k for k, name in enumerate(rows[0]) if not name.startswith(words)]
    file.write_text("\n".join(",".join(row[k] for k in kept) for row in rows) + "\n")


@pytest.fixture(scope="module")
def imported(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], tuple[Path, Preset]]:
    """imported(kind) -> a file of `soft` and what it is imported as; each kind is written and read once."""

    @functools.cache
    def of_kind(kind: str) -> tuple[Path, Preset]:
        folder = tmp_path_factory.mktemp(kind)
        form = kind if kind in ("tum", "euroc", "polynomial") else "reference"
        file = folder / f"{kind}.csv"
        if kind == "euroc":
            formats.export(SOFT, "euroc", folder / "record")
            file = folder / "record" / "mav0" / "state_groundtruth_estimate0" / "data.csv"
        else:
            formats.export(SOFT, form, file)
        if kind == "positions":
            without(file, "v_", "a_lin", "jerk", "snap", "a_x", "a_y", "a_z")
        if kind == "jerk":
            without(file, "snap")
        read = formats.read(file, form, confirm={"frame": "z-up"} if form == "tum" else {})
        return file, as_preset(read)

    return of_kind


@pytest.mark.parametrize("kind", RECORDS)
def test_a_path_whose_snap_was_not_in_its_file_is_not_judged_and_not_certified(
    imported, answer, tmp_path: Path, kind: str
):
    file, made = imported(kind)
    assert made.source is not None
    assert (made.source.derivatives, made.source.file) == ("fit", file.name)
    assert made.source.sha256 == hashlib.sha256(file.read_bytes()).hexdigest()
    issued = certified(made)
    said = f"the path's snap was not in {file.name} but comes from fitting: {made.source.unjudged}"
    assert (issued.certified, issued.meets, issued.verdict, issued.failures) == (False, False, "not judged", (said,))
    for expect in ("weak", "unobservable"):  # nor is the opposite
        assert certified(replace(made, expect=expect)).failures == (said,)
    preset.save(made, tmp_path / "made.toml")
    told = answer("analyze", tmp_path / "made.toml")
    assert (told["verdict"], told["verdict_reason"]) == (None, f"null: not judged: {said}")
    assert told["source"]["fitted"] == made.source.fitted
    assert answer("explain", tmp_path / "made.toml")["verdict"] is None


@pytest.mark.parametrize("kind", ["reference", "polynomial"])
def test_a_path_whose_snap_was_in_its_file_is_certified_as_what_it_is(imported, answer, tmp_path: Path, kind: str):
    file, made = imported(kind)
    assert made.source is not None
    assert (made.source.derivatives, made.source.unjudged) == ("file", "")
    issued = certified(made)
    assert issued.verdict in ("weak", "observable")
    (check,) = (one for one in issued.checks if one.name == "source")
    assert check.met
    assert check.words.startswith(f"imported from {file.name} ({kind}), whose own snap it has")
    preset.save(made, tmp_path / "made.toml")
    assert answer("analyze", tmp_path / "made.toml")["verdict"] == issued.verdict
    assert issued.source is not msgspec.UNSET
    assert (issued.source.sha256, issued.source.edited) == (made.source.sha256, False)


def test_snap_columns_that_the_pieces_cannot_follow_are_not_theirs(tmp_path: Path):
    file = tmp_path / "x.csv"
    formats.export(SOFT, "reference", file)
    rows = [line.split(",") for line in file.read_text().splitlines()]
    k = rows[0].index("snap_x")
    rows[1:] = [[*row[:k], repr(3 * float(row[k])), *row[k + 1 :]] for row in rows[1:]]
    file.write_text("\n".join(map(",".join, rows)))
    imported = formats.read(file, "reference")
    assert imported.derivatives == "fit"
    assert str(imported.unjudged).startswith("of the snap in the file the pieces miss ")


def test_an_import_tells_where_the_snap_is_from(imported, answer, tmp_path: Path):
    for kind in ("reference", "jerk"):
        file, _ = imported(kind)
        said = answer("import", file, "--from", "reference", "-o", tmp_path / "y.toml")
        fit = kind == "jerk"
        assert said["snap_from"] == ("a fit: it is not in the file" if fit else "the file")
        assert (said["verdict"] is None, said["excitation"] is None, said["rank"] is None) == (fit,) * 3
        assert (reference_fit.IMPLIED in said["findings"]) == fit


def test_every_command_that_prints_a_verdict_has_one_spelling_of_it(imported, answer, tmp_path: Path):
    """Of a path that is judged, and of one that is not: null, with the reason."""
    for kind in ("reference", "jerk"):
        file, _ = imported(kind)
        said = answer("import", file, "--from", "reference", "-o", tmp_path / "y.toml")
        stated = {key: value for key, value in said.items() if key.startswith("verdict")}
        assert (stated["verdict"] is None, "verdict_reason" in stated) == (kind == "jerk",) * 2
        for command in ("analyze", "explain", "simulate"):
            again = answer(command, tmp_path / "y.toml")
            assert {key: value for key, value in again.items() if key.startswith("verdict")} == stated


@pytest.mark.parametrize("kind", ["tum", "polynomial"])
def test_the_source_is_kept_by_every_file_and_a_design_has_none(imported, answer, tmp_path: Path, kind: str):
    _, made = imported(kind)
    assert preset.loads(preset.dumps(made), source="x") == made
    preset.save(made, tmp_path / "one.toml")
    answer("import", tmp_path / "one.toml", "--from", "preset", "-o", tmp_path / "two.toml")
    assert preset.load(tmp_path / "two.toml") == made
    assert "source" not in preset.dumps(SOFT)
    assert preset.loads(preset.dumps(SOFT), source="x").source is None


def test_whoever_changes_the_path_has_designed_one_and_whoever_undoes_it_has_not(imported):
    _, made = imported("tum")
    changed = replace(made, path=signals.scaled(made.path, 1.01, about=(0.0, 0.0, 0.0)))
    issued = certified(changed)
    assert issued.verdict != "not judged"
    assert next(one for one in issued.checks if one.name == "source").words == (
        "imported from tum.csv (tum) and changed since: a design"
    )
    assert issued.source is not msgspec.UNSET
    assert issued.source.edited
    assert certified(replace(changed, path=made.path)).verdict == "not judged"
    kept = replace(made, title="other", seed=7, duration=made.duration - 1, world=replace(made.world, anchor=(1, 2, 3)))
    assert verdict.restriction(kept.path, kept.source, kept.duration) is not None  # all but the path may change
    slower = effective(Settings(preset=made, time_scale=2.0))
    assert provenance.edited(present(slower.source), slower.path)
    assert effective(Settings(preset=made)).path == made.path


def test_whoever_deletes_the_source_has_made_the_curve_a_design(imported):
    _, made = imported("tum")
    text = preset.dumps(made)
    head, _, rest = text.partition("[source]\n")
    after = rest.partition("\n[")
    adopted = preset.loads(head + (f"[{after[2]}" if after[1] else ""), source="x")
    assert adopted == replace(made, source=None)
    assert verdict.restriction(adopted.path, adopted.source, adopted.duration) is None


def test_the_gate_and_repair_say_what_would_help(imported, complaint, run, tmp_path: Path):
    _, made = imported("jerk")
    easy = replace(made, requirement=replace(made.requirement, window=12.0, mu=1e-6, position_sigma=3.0))
    for form in ("preset", "polynomial", "log"):
        said = exports.gate(easy, form)
        assert said is not None
        assert "refused: the path's snap was not in jerk.csv but comes from fitting" in said
        assert f"it would do to {provenance.ADOPT}" in said
        assert "excitation along" not in said
    with pytest.raises(repair.CannotRepairError, match=r"as a design it meets its requirement already: judge the flig"):
        repair.repair(easy)
    preset.save(easy, tmp_path / "easy.toml")
    code, _, err = run("certify", tmp_path / "easy.toml")
    assert (code, err.count("\n")) == (1, 1)
    assert "nothing was written" in complaint("export", tmp_path / "easy.toml", "--to", "log", "-o", tmp_path / "x.csv")


def test_a_jump_is_named_with_its_time_wherever_a_verdict_is_asked(answer, tmp_path: Path):
    piece = POLYNOMIALS.pieces[0]
    jumping = signals.Polynomials(pieces=(piece, replace(piece, x=(piece.x[0] + 5, *piece.x[1:]))))
    length = 2 * piece.duration
    made = replace(SOFT, path=jumping, duration=length, requirement=replace(SOFT.requirement, window=length / 2))
    preset.save(made, tmp_path / "x.toml")
    said = answer("analyze", tmp_path / "x.toml")
    assert said["verdict"] is None
    assert said["verdict_reason"].startswith("null: not judged: position jumps by ")
    assert f" at t = {piece.duration:.4g} s, which nothing can follow" in said["verdict_reason"]
    assert certified(made).verdict == "not judged"


@given(name=st.sampled_from(sorted(EXAMPLES)), share=st.sampled_from([1e-12, 1e-3, 0.5]))
def test_equal_paths_have_equal_fingerprints_and_any_other_path_another(name: str, share: float):
    path = EXAMPLES[name]
    again = preset.loads(preset.dumps(replace(SOFT, path=path)), source="x").path
    assert provenance.fingerprint(path) == provenance.fingerprint(again)
    moved = path.mapped(np.eye(3), np.array([share, 0.0, 0.0]))
    assert (provenance.fingerprint(moved) == provenance.fingerprint(path)) == (moved == path)


def test_a_zero_has_no_sign_and_a_whole_number_no_kind():
    def tones(amplitude: float) -> Multisine:
        return Multisine(tones=(Tone(axis="x", amplitude=amplitude, frequency=2.0),))

    assert provenance.fingerprint(tones(0.0)) == provenance.fingerprint(tones(-0.0))
    assert provenance.fingerprint(tones(1)) == provenance.fingerprint(tones(1.0))
    assert provenance.fingerprint(tones(1.0)) != provenance.fingerprint(tones(1.0000000000000002))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"sha256": "12"}, "source.sha256 must be 64 hexadecimal digits, got '12'"),
        ({"path_sha256": "Z" * 64}, "source.path_sha256 must be 64 hexadecimal digits"),
        ({"file": ""}, "source.file must not be empty"),
        ({"file": "x" * 256}, "source.file must have at most 255 characters, got 256"),
        ({"derivatives": "fit"}, 'source.unjudged must say why, where derivatives is "fit"'),
    ],
)
def test_a_source_that_says_too_little_is_refused(change: dict[str, str], said: str):
    good = Source(file="x.csv", sha256="0" * 64, format="tum", derivatives="file", path_sha256="f" * 64)
    with pytest.raises(ValueError, match=said):
        replace(good, **change)


def test_the_page_remembers_the_visitors_own_name_of_the_file(imported):
    file, _ = imported("reference")
    content = file.read_bytes()
    made = import_file.interpret(
        import_file.ImportFile("Tour Süd 1.csv", content), "reference", {}, (0.0, 0.0, 0.0)
    ).preset
    assert made is not None
    assert made.source is not None
    assert (made.source.file, made.source.sha256) == ("Tour Süd 1.csv", hashlib.sha256(content).hexdigest())


def test_naming_the_axes_anew_makes_no_design_of_a_fit(imported):
    _, made = imported("tum")
    turned = axes.flipped(made)
    assert provenance.restriction(turned.source, turned.path) == provenance.restriction(made.source, made.path)
    assert (certified(turned).certified, certified(turned).verdict) == (False, "not judged")
    assert axes.flipped(turned) == made
    design = replace(made, path=signals.slowed(made.path, 2.0))
    assert axes.flipped(design).source == design.source


def test_a_download_of_a_fit_states_no_verdict(imported):
    _, made = imported("tum")
    comments = [line for line in preset_file.document(Settings(preset=made)).decode().splitlines() if line[:1] == "#"]
    assert [comment.partition(":")[0] for comment in comments] == ["# verdict", "# units"]
    assert comments[0].startswith("# verdict: none, not judged")
    assert preset.loads(preset_file.document(Settings(preset=made)).decode(), source="x") == made


def test_pieces_put_through_a_fit_are_certified_as_little_as_the_fit(tmp_path: Path):
    source = Source(
        file="flight.tum",
        sha256=64 * "0",
        format="tum",
        derivatives="fit",
        unjudged="it was sampled",
        path_sha256=provenance.fingerprint(SOFT.path),
    )
    file = formats.export(SOFT, "polynomial", tmp_path / "fit.csv")
    assert exports.certified(SOFT, "polynomial", tmp_path / "fit.csv", steady=file.steady, loop=file.loop).certified
    with pytest.raises(ValueError, match=r"fit\.csv: the path's snap was not in flight\.tum"):
        exports.certified(
            replace(SOFT, source=source), "polynomial", tmp_path / "fit.csv", steady=file.steady, loop=file.loop
        )


@pytest.mark.parametrize("amplitude", [None, 0.0, 1e-3])
def test_a_wiggle_that_does_nothing_makes_no_design_of_a_fit(imported, amplitude: float | None):
    """As when “plus a wiggle” is switched on and no tone of it is set."""
    _, made = imported("tum")
    tones = () if amplitude is None else (Tone(axis="z", amplitude=amplitude, frequency=2.0),)
    assert not isinstance(made.path, signals.Sum)
    wiggled = replace(made, path=signals.Sum(base=made.path, wiggle=Multisine(tones=tones)))
    assert (verdict.restriction(wiggled.path, wiggled.source, wiggled.duration) is None) == bool(amplitude)
    turned = axes.flipped(wiggled)
    assert (verdict.restriction(turned.path, turned.source, turned.duration) is None) == bool(amplitude)
    assert axes.flipped(turned).source == made.source
