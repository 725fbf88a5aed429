"""Exported files: certified from their own bytes, verified again, refused where they do not keep what is promised."""

from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rangenav import certificate, formats, preset, signals
from rangenav.certificate import certified_export, exports, files
from rangenav.certificate.schema import Certificate, Loop
from rangenav.formats import readback
from rangenav.preset import Preset
from rangenav.signals import Polynomials, polynomials
from rangenav.vehicle import CRAZYFLIE
from tests.support.signal_examples import POLYNOMIALS

pytestmark = pytest.mark.slow


replace = msgspec.structs.replace
READERS = exports.readers()
RUNS = tuple(row for row in formats.writable() if row.certified_as == "run")
SOFT = preset.load("soft")
SUFFIXES = {"preset": ".toml", "mat": ".mat", "npz": ".npz", "tum": ".tum"}

STEADY = {
    "reference": "2 s to 20 s of the file, between its ramps, and no more",
    "polynomial": "2 s to 10.3776 s of the file, flown again and again without a pause; not its ramps",
}


def written(p: Preset, form: str, folder: Path) -> tuple[Path, Certificate]:
    """A file and the certificate beside it."""
    file = folder / f"x{SUFFIXES.get(form, '.csv')}"
    made = formats.export(p, form, file)
    issued = exports.certified(p, form, file, steady=made.steady, loop=made.loop)
    assert issued is not None
    exports.write_certificate(issued, file)
    return file, issued


@pytest.mark.parametrize("form", ["preset", "polynomial", "reference", "tum", "mat", "npz", "csv", "log"])
def test_what_is_exported_is_certified_from_its_bytes_and_one_altered_byte_fails(form: str, tmp_path: Path):
    file, issued = written(SOFT, form, tmp_path)
    assert (issued.certified, issued.meets, issued.artifact.format) == (True, True, form)
    covers = {"preset": msgspec.UNSET, **STEADY}.get(form, exports.RECORDED)
    assert issued.artifact.covers == covers
    assert certificate.verify_file(file, readers=READERS) == ()
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)
    (said,) = certificate.verify_file(file, readers=READERS)
    assert said.startswith(f"{file.name}: its bytes are not those that were certified")


@pytest.mark.parametrize(
    ("name", "form"), [("soft", "polynomial"), ("barrel", "polynomial"), ("lissajous", "reference")]
)
def test_a_motion_in_a_file_has_the_excitation_of_its_preset(name: str, form: str, tmp_path: Path):
    """The pieces between the ramps, read back, z up: within half a percent of the path they were made from."""
    p = preset.load(name)
    _, issued = written(p, form, tmp_path)
    own = certificate.certify_file(name)
    assert issued.excitation.found == pytest.approx(own.excitation.found, rel=5e-3)
    assert issued.accuracy.lifted.end.position == pytest.approx(own.accuracy.lifted.end.position, rel=0.05)
    assert issued.limits.thrust_to_weight == pytest.approx(own.limits.thrust_to_weight, rel=0.02)
    assert issued.frame.up == "+z"
    if form == "polynomial":  # a loop that is flown again and again
        assert issued.claim.starts == "every t >= 0"
        assert issued.claim.period == pytest.approx(p.path.period, rel=1e-8)
    else:  # the steady part of one flight, and no more
        assert issued.claim.starts == "every t in [0, duration - window]"
        assert issued.claim.duration < p.duration
    assert issued.jumps.knots > 5
    assert (issued.jumps.position, issued.jumps.velocity) == pytest.approx((0, 0), abs=1e-6)  # ten printed digits


def test_a_certificate_put_beside_another_motion_fails(tmp_path: Path):
    _, issued = written(SOFT, "polynomial", tmp_path)
    larger = replace(SOFT, path=signals.scaled(SOFT.path, 1.1, about=(0.0, 0.0, 0.0)))
    file, other = written(larger, "polynomial", tmp_path)
    assert certificate.verify_file(file, readers=READERS) == ()
    exports.write_certificate(issued, file)
    assert len(certificate.verify_file(file, readers=READERS)) == 1  # its hash is another
    exports.write_certificate(replace(issued, artifact=other.artifact), file)  # even if it claims to be of these bytes
    assert any("excitation.lower is 140" in sentence for sentence in certificate.verify_file(file, readers=READERS))


def test_pieces_that_are_cut_out_are_the_same_curve():
    whole = POLYNOMIALS
    part = polynomials.cut(whole, 1.3, 6.2)
    t = np.linspace(0, 6.2, 201)[1:-1]
    for order in range(6):
        np.testing.assert_allclose(part(t, order), whole(t + 1.3, order), rtol=1e-9, atol=1e-9)
    assert sum(piece.duration for piece in part.pieces) == pytest.approx(6.2, rel=1e-12)
    with pytest.raises(ValueError, match="the file ends before its path does"):
        polynomials.cut(Polynomials(pieces=whole.pieces[:1]), 0.0, 100.0)


def test_the_gate_lets_a_run_of_a_counterexample_pass_and_no_trajectory_of_it():
    hover = preset.load("hover")
    assert exports.gate(hover, "log") is None
    assert "refused: the excitation along" in str(exports.gate(hover, "polynomial"))
    assert exports.gate(SOFT, "polynomial") is None
    timid = replace(SOFT, expect="unobservable")  # it is not what it says it is, and does meet its requirement
    assert exports.gate(timid, "log") is None
    assert "refused" in str(exports.gate(replace(hover, expect="observable"), "log"))


def test_a_format_whose_file_does_not_say_enough_is_answered_with_a_sentence(tmp_path: Path):
    file, issued = written(SOFT, "polynomial", tmp_path)
    exports.write_certificate(replace(issued, context=msgspec.UNSET), file)
    (said,) = certificate.verify_file(file, readers=READERS)
    assert said == "x.csv: its certificate says nothing of the world and the requirement"
    exports.write_certificate(replace(issued, context="version = 1"), file)
    (said,) = certificate.verify_file(file, readers=READERS)
    assert said.startswith("x.csv, context: ")
    exports.write_certificate(replace(issued, artifact=replace(issued.artifact, loop=Loop(begin=2.0, end=3.1))), file)
    (said,) = certificate.verify_file(file, readers=READERS)
    assert said == "x.csv: no pieces begin and end where its certificate says that the loop does"
    exports.write_certificate(replace(issued, artifact=replace(issued.artifact, format="word")), file)
    (said,) = certificate.verify_file(file, readers=READERS)
    assert said == "x.csv: files of the format 'word' cannot be certified"


def test_the_command_line_writes_certifies_and_verifies(answer, run, complaint, tmp_path: Path):
    said = answer("export", "soft", "--to", "polynomial", "-o", tmp_path / "soft.csv")
    assert said["certificate"] == str(tmp_path / "soft.csv.certificate.json")
    assert holds(run, tmp_path / "soft.csv")
    refused = complaint("export", "circle", "--to", "reference", "-o", tmp_path / "circle.csv")
    assert refused.startswith("circle: on this motion the ranges of 10 s do not tell the position along z (")
    assert "Horizontal circle, anchor 1.5 m off its plane: refused: the excitation along z over" in refused
    assert "what cures it: add for example a tone of" in refused
    assert ": rangenav repair circle --by tones --export reference -o repaired.toml" in refused
    assert "it would do to add for example a tone of" in refused
    marked = answer("export", "circle", "--to", "reference", "-o", tmp_path / "circle.csv", "--uncertified")
    assert marked["uncertified"]
    assert sorted(one.name for one in tmp_path.iterdir()) == [
        "circle.uncertified.csv",
        "soft.csv",
        "soft.csv.certificate.json",
    ]
    code, _, err = run("verify", tmp_path / "circle.uncertified.csv")
    assert (code, err.count("\n")) == (1, 1)
    assert "there is no certificate beside it" in err


def holds(run, file: Path) -> bool:
    """Whether `rangenav verify` says so of a file, without a word on stderr."""
    code, out, err = run("verify", file)
    return (code, err) == (0, "") and out.startswith(f"{file.name}   ✓ holds: ")


def every_byte_counts(folder: Path) -> None:
    """Alter, add and lose files of a certified folder; each must fail, and undone it holds again."""
    written_files = [path for path in folder.rglob("*") if path.is_file() and path.name != files.OF_FOLDER]
    assert written_files
    for file in written_files:
        content = file.read_bytes()
        file.write_bytes(content[:-1] + bytes([content[-1] ^ 1]))
        (said,) = certificate.verify_file(folder, readers=READERS)
        assert said.startswith(f"{folder.name}: its bytes are not those that were certified")
        file.unlink()
        assert len(certificate.verify_file(folder, readers=READERS)) == 1
        file.write_bytes(content)
    (folder / "more.txt").write_text("x")
    assert len(certificate.verify_file(folder, readers=READERS)) == 1
    (folder / "more.txt").unlink()
    assert certificate.verify_file(folder, readers=READERS) == ()


@pytest.mark.parametrize("form", ["euroc", "bag"])
def test_a_folder_is_certified_with_every_byte_of_every_file_in_it(answer, run, tmp_path: Path, form: str):
    if form == "bag":
        pytest.importorskip("rosbags", reason="rosbags is not installed (the extra ros has it)")
    folder = tmp_path / "flight"
    said = answer("export", "soft", "--to", form, "-o", folder)
    assert said["certificate"] == str(folder / "certificate.json")
    assert holds(run, folder)
    assert holds(run, folder / "certificate.json")
    every_byte_counts(folder)


def test_an_mcap_file_is_certified_as_well(tmp_path: Path):
    pytest.importorskip("rosbags", reason="rosbags is not installed (the extra ros has it)")
    file, issued = written(SOFT, "mcap", tmp_path)
    assert issued.certified
    assert certificate.verify_file(file, readers=READERS) == ()


def test_a_folder_that_leads_out_of_itself_or_has_no_end_is_refused(tmp_path: Path):
    folder = tmp_path / "flight"
    formats.export(SOFT, "euroc", folder)
    issued = exports.certified(SOFT, "euroc", folder)
    exports.write_certificate(issued, folder)
    (folder / "out").symlink_to("/etc")
    (said,) = certificate.verify_file(folder, readers=READERS)
    assert said == "flight: 'out' is neither a file nor a folder, or has a line feed in its name"
    (folder / "out").unlink()
    for k in range(files.MAX_ENTRIES):
        (folder / f"{k}").mkdir()
    (said,) = certificate.verify_file(folder, readers=READERS)
    assert said == "flight: more than 64 files, which no export is"


@given(parts=st.dictionaries(st.text("abc/ 0", min_size=1, max_size=9), st.binary(max_size=40), max_size=6))
def test_the_bytes_of_a_folder_are_taken_apart_as_they_were_put_together(parts: dict[str, bytes]):
    packed = b"".join(f"{name} {len(data)}\n".encode() + data for name, data in parts.items())
    assert files.unpacked(packed, "x") == parts
    if packed:
        with pytest.raises(ValueError, match="these are not the bytes of a folder"):
            files.unpacked(packed + b"x", "x")


@pytest.mark.parametrize("form", [row.name for row in RUNS])
@pytest.mark.parametrize("name", ["soft", "paper-slow"])
def test_the_positions_in_a_record_are_read_again_and_lie_on_the_path(name: str, form: str, tmp_path: Path):
    """The witness is the preset's formula, z up where the format is."""
    if form in ("bag", "mcap"):
        pytest.importorskip("rosbags", reason="rosbags is not installed (the extra ros has it)")
    p, path = preset.load(name), tmp_path / f"x{SUFFIXES.get(form, '')}"
    formats.export(p, form, path)
    content = files.read_bytes(path)
    parts = files.unpacked(content, "x") if path.is_dir() else {"": content}
    time, position = readback.positions(parts, formats.row(form), "x")
    assert (len(time), time[0], time[-1]) == pytest.approx((4001, 0, 20), abs=1e-8)
    own = p.path(time) * ((1, -1, -1) if formats.row(form).upright and p.world.gravity[2] > 0 else 1)
    np.testing.assert_allclose(position, own, atol=1e-8)


@pytest.mark.parametrize("form", ["tum", "csv", "npz", "euroc"])
def test_a_record_of_another_path_is_not_certified_by_this_ones_preset(form: str, tmp_path: Path):
    path = tmp_path / f"x{SUFFIXES.get(form, '')}"
    formats.export(replace(SOFT, path=signals.scaled(SOFT.path, 1.001, about=(0.0, 0.0, 0.0))), form, path)
    with pytest.raises(ValueError, match=r"^x.*: at t = .* s it is .* m from the path of the preset that is certified"):
        exports.certified(SOFT, form, path)


def test_what_is_no_record_at_all_is_a_sentence(tmp_path: Path):
    for row in RUNS:
        for content in (b"", b"nonsense", b"PK\x03\x04" + bytes(40), b"t,p_x,p_y,p_z\n0,1,2,nan\n"):
            with pytest.raises(ValueError, match=r"^x") as caught:
                readback.positions({"": content}, row, "x")
            assert "\n" not in str(caught.value)


def test_a_certificate_may_be_named_in_place_of_its_file(answer, run, tmp_path: Path):
    answer("export", "soft", "--to", "preset", "-o", tmp_path / "soft.toml")
    answer("export", "soft", "--to", "npz", "-o", tmp_path / "soft.npz")  # its certificate is not the preset's
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["soft.certificate.json", "soft.npz", "soft.npz.certificate.json", "soft.toml"]
    code, out, err = run("verify", *(tmp_path / name for name in names))
    assert (code, err) == (0, "")
    assert out.count("✓") == 1 + 4  # all of them, and each one


def test_an_export_that_cannot_be_certified_leaves_nothing_behind(complaint, tmp_path: Path, monkeypatch):
    def broken(*_: object, **__: object) -> None:
        raise ValueError("it cannot be read again")

    monkeypatch.setattr(exports, "certified", broken)
    for form, name in (("tum", "x.tum"), ("euroc", "x")):
        assert complaint("export", "soft", "--to", form, "-o", tmp_path / name) == "soft: it cannot be read again\n"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("yaw", [None, "4*sin(t)"])
def test_the_body_rate_of_a_trajectory_is_that_of_flying_its_file(yaw: str | None, tmp_path: Path):
    """Held against the file's own columns: a body that does not turn in the preset does, once the path is flown."""
    turning = signals.Multisine() if yaw is None else signals.Flown(yaw=yaw)
    p = replace(SOFT, angular_velocity=turning)
    file, issued = written(p, "reference", tmp_path)
    head, *rows = [line.split(",") for line in file.read_text().splitlines()]
    w = np.array([[float(row[head.index(f"w_{axis}")]) for axis in "xyz"] for row in rows])
    t = np.array([float(row[0]) for row in rows])
    inside = (t >= 2) & (t <= 20)
    assert issued.limits.body_rate == pytest.approx(np.linalg.norm(w[inside], axis=-1).max(), rel=2e-3)
    assert issued.frame.body == "flown along the path"


def test_a_trajectory_that_the_vehicle_cannot_turn_with_is_not_certified(tmp_path: Path):
    stiff = replace(SOFT, angular_velocity=signals.Multisine(), vehicle=replace(CRAZYFLIE, name="stiff", body_rate=0.3))
    assert exports.gate(stiff, "polynomial") is None  # the preset's own body does not turn
    _, issued = written(stiff, "polynomial", tmp_path)
    assert (issued.certified, issued.vehicle.flyable) == (False, False)
    with pytest.raises(ValueError, match=r"promises: stiff cannot fly it: body rate 0\.7"):
        certified_export.write(stiff, "polynomial", tmp_path / "y.csv", name="stiff", otherwise="")
    assert not (tmp_path / "y.csv").exists()


def test_a_trajectory_with_the_presets_own_attitude_is_judged_by_that(tmp_path: Path):
    export = certified_export.write(SOFT, "reference", tmp_path / "x.csv", name="soft", attitude="preset", otherwise="")
    assert export.certificate is not None
    issued = certificate.loads(export.certificate.read_bytes(), source="x")
    own = certificate.certify_file("soft")
    assert issued.frame.body == own.frame.body == "angular velocity of its own"
    assert issued.limits.body_rate == pytest.approx(own.limits.body_rate, rel=1e-6)
    assert certificate.verify_file(tmp_path / "x.csv", readers=READERS) == ()
