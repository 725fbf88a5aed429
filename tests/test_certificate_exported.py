"""Exported files: certified from their own bytes, verified again, refused where they do not keep what is promised."""

from pathlib import Path

import msgspec
import numpy as np
import pytest

from rangenav import certificate, formats, preset, signals
from rangenav.certificate import exported
from rangenav.certificate.contents import Certificate
from rangenav.preset import Preset
from rangenav.signals import Polynomials
from tests.families import POLYNOMIALS

replace = msgspec.structs.replace
READERS = exported.readers()
SOFT = preset.load("soft")
SUFFIXES = {"preset": ".toml", "mat": ".mat", "npz": ".npz", "tum": ".tum"}


def written(p: Preset, form: str, folder: Path) -> tuple[Path, Certificate]:
    """A file and the certificate beside it."""
    file = folder / f"x{SUFFIXES.get(form, '.csv')}"
    made = formats.export(p, form, file)
    found = exported.certified(p, form, file, steady=made.steady)
    assert found is not None
    exported.write_beside(found, file)
    return file, found


@pytest.mark.parametrize("form", ["preset", "polynomial", "reference", "tum", "mat", "npz", "csv", "log"])
def test_what_is_exported_is_certified_from_its_bytes_and_one_altered_byte_fails(form: str, tmp_path: Path):
    file, found = written(SOFT, form, tmp_path)
    assert (found.certified, found.meets, found.artifact.format) == (True, True, form)
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
    _, found = written(p, form, tmp_path)
    own = certificate.certify_file(name)
    assert found.excitation.found == pytest.approx(own.excitation.found, rel=5e-3)
    assert found.accuracy.lifted.end.position == pytest.approx(own.accuracy.lifted.end.position, rel=0.05)
    assert found.limits.thrust_to_weight == pytest.approx(own.limits.thrust_to_weight, rel=0.02)
    assert found.frame.up == "+z"
    assert found.claim.starts == "every t in [0, duration - window]"  # the steady part of one file, and no more
    assert found.claim.duration < p.duration
    assert found.jumps.knots > 5
    assert (found.jumps.position, found.jumps.velocity) == pytest.approx((0, 0), abs=1e-6)  # ten printed digits


def test_a_certificate_put_beside_another_motion_fails(tmp_path: Path):
    _, found = written(SOFT, "polynomial", tmp_path)
    larger = replace(SOFT, path=signals.scaled(SOFT.path, 1.1, about=(0.0, 0.0, 0.0)))
    file, other = written(larger, "polynomial", tmp_path)
    assert certificate.verify_file(file, readers=READERS) == ()
    exported.write_beside(found, file)
    assert len(certificate.verify_file(file, readers=READERS)) == 1  # its hash is another
    exported.write_beside(replace(found, artifact=other.artifact), file)  # even if it claims to be of these bytes
    assert any("excitation.lower is 140" in sentence for sentence in certificate.verify_file(file, readers=READERS))


def test_pieces_that_are_cut_out_are_the_same_curve():
    whole = POLYNOMIALS
    part = exported.cut(whole, 1.3, 6.2)
    t = np.linspace(0, 6.2, 201)[1:-1]
    for order in range(6):
        np.testing.assert_allclose(part(t, order), whole(t + 1.3, order), rtol=1e-9, atol=1e-9)
    assert sum(piece.duration for piece in part.pieces) == pytest.approx(6.2, rel=1e-12)
    with pytest.raises(ValueError, match="the file ends before its path does"):
        exported.cut(Polynomials(pieces=whole.pieces[:1]), 0.0, 100.0)


def test_the_gate_lets_a_run_of_a_counterexample_pass_and_no_trajectory_of_it():
    hover = preset.load("hover")
    assert exported.gate(hover, "log") is None
    assert "refused: the excitation along" in str(exported.gate(hover, "polynomial"))
    assert exported.gate(SOFT, "polynomial") is None
    timid = replace(SOFT, expect="unobservable")  # it is not what it says it is, and does meet its requirement
    assert exported.gate(timid, "log") is None
    assert "refused" in str(exported.gate(replace(hover, expect="observable"), "log"))


def test_a_format_whose_file_does_not_say_enough_is_answered_with_a_sentence(tmp_path: Path):
    file, found = written(SOFT, "polynomial", tmp_path)
    exported.write_beside(replace(found, context=msgspec.UNSET), file)
    (said,) = certificate.verify_file(file, readers=READERS)
    assert said == "x.csv: its certificate says nothing of the world and the requirement"
    exported.write_beside(replace(found, context="version = 1"), file)
    (said,) = certificate.verify_file(file, readers=READERS)
    assert said.startswith("x.csv, context: ")
    exported.write_beside(replace(found, artifact=replace(found.artifact, format="bag")), file)
    (said,) = certificate.verify_file(file, readers=READERS)
    assert said == "x.csv: files of the format 'bag' cannot be certified"


def test_the_command_line_writes_certifies_and_verifies(answer, run, complaint, tmp_path: Path):
    said = answer("export", "soft", "--to", "polynomial", "-o", tmp_path / "soft.csv")
    assert said["certificate"] == str(tmp_path / "soft.certificate.json")
    assert run("verify", tmp_path / "soft.csv") == (0, "✓ soft.csv\n", "")
    refused = complaint("export", "circle", "--to", "reference", "-o", tmp_path / "circle.csv")
    assert "circle: Horizontal circle, anchor 1.5 m off its plane: refused: the excitation along z over" in refused
    assert "it would do to add a tone of at least" in refused
    marked = answer("export", "circle", "--to", "reference", "-o", tmp_path / "circle.csv", "--uncertified")
    assert marked["uncertified"]
    assert sorted(one.name for one in tmp_path.iterdir()) == [
        "circle.uncertified.csv",
        "soft.certificate.json",
        "soft.csv",
    ]
    code, _, err = run("verify", tmp_path / "circle.uncertified.csv")
    assert (code, err.count("\n")) == (1, 1)
    assert "there is no certificate beside it" in err


def test_a_folder_has_no_certificate_and_that_is_said(answer, tmp_path: Path):
    said = answer("export", "soft", "--to", "euroc", "-o", tmp_path / "flight")
    assert (said["certificate"], said["certificate_reason"]) == (None, "null: a euroc folder has no bytes of its own")
