"""Every shipped preset in every format of a motion: exported with a certificate, or refused with reason and cure."""

import dataclasses
from pathlib import Path

import msgspec
import numpy as np
import pytest

from rangenav import certificate, formats, preset
from rangenav.certificate import certified_export, cures
from rangenav.certificate.certified_export import RefusedExportError
from rangenav.formats import ExportOptions, piece_layouts
from rangenav.formats.path_preset import as_preset, choices
from rangenav.observability import excitation
from rangenav.signals import Flown, MinimumSnap, Polynomials, Waypoint
from rangenav.signals.polynomials import from_minimum_snap
from rangenav.vehicle import Vehicle
from tests.support.present import present

pytestmark = pytest.mark.slow

replace = msgspec.structs.replace
SHIPPED = preset.shipped()
MOTIONS = tuple(row.name for row in formats.writable() if row.certified_as == "motion")
PLAIN = ExportOptions()
LOOPS = {"barrel", "eight-repaired", "lissajous", "paper", "paper-slow", "soft", "trefoil"}
"""Presets whose path is one loop for a Crazyflie."""
FLIGHTS = {"torus"}
"""Its yaw does not repeat with its path."""
CURED = {
    ("hand-held", "reference"): ["write the preset's own attitude", "slow down 1.1×"],
    ("hand-held", "polynomial"): ["slow down 1.1×"],
}
"""What is observable and yet refused, and its cures."""
BLIND = "the ranges of {} s do not tell the position"


@pytest.fixture(scope="module")
def refusals() -> dict[tuple[str, str], RefusedExportError | None]:
    """Why each preset is refused in each format; None if it is exported."""
    return {(name, form): certified_export.refusal(SHIPPED[name], form, PLAIN) for name in SHIPPED for form in MOTIONS}


def test_every_observable_preset_is_exported_to_every_format_or_has_a_cure(refusals):
    for (name, form), refused in refusals.items():
        observable = SHIPPED[name].expect == "observable"
        assert (refused is None) == (observable and (name, form) not in CURED), (name, form, str(refused))


def test_what_is_refused_says_why_in_the_words_of_a_pilot(refusals):
    for (name, _), refused in refusals.items():
        if refused is not None and SHIPPED[name].expect == "unobservable":
            assert BLIND.format(f"{SHIPPED[name].requirement.window:g}") in str(refused)
    assert "tell the position to ±5.3 m, and ±0.5 m are required" in str(refusals["wiggle", "polynomial"])


@pytest.mark.parametrize(("name", "form"), CURED)
def test_a_motion_that_the_vehicle_cannot_fly_is_cured_by_what_is_offered(refusals, name: str, form: str):
    offered = cures.cures(present(refusals[name, form]))
    assert [cure.text for cure in offered] == CURED[name, form]
    for cure in offered:
        assert certified_export.refusal(cure.preset, cure.format_name, cure.options) is None


@pytest.mark.parametrize("name", sorted(LOOPS | FLIGHTS))
def test_a_crazyflie_gets_one_loop_between_ramps_of_a_path_that_repeats(name: str, tmp_path: Path):
    p, file = SHIPPED[name], tmp_path / "x.csv"
    written = certified_export.write(p, "polynomial", file, name=name, otherwise="").output
    issued = certificate.read_stored(file)
    rows = np.loadtxt(file, delimiter=",", skiprows=1)
    assert len(rows) <= piece_layouts.MAX_SEGMENTS
    assert (written.loop, issued.artifact.loop is not msgspec.UNSET) == (name in LOOPS, name in LOOPS)
    if name in LOOPS:
        first, count = written.figures["loop_first"], written.figures["loop_pieces"]
        assert rows[first : first + count, 0].sum() == pytest.approx(p.path.period, rel=1e-8)
        assert issued.claim.starts == "every t >= 0"
        assert issued.claim.duration >= p.requirement.window + present(p.path.period)  # windows that begin anywhere


def test_the_excitation_of_a_loop_is_that_of_flying_it_three_times(tmp_path: Path):
    """The witness: the loop's pieces written three times after one another, with windows across the seams."""
    p, file = SHIPPED["eight-repaired"], tmp_path / "x.csv"
    written = certified_export.write(p, "polynomial", file, name="x", otherwise="").output
    imported = formats.read(file, "polynomial", part=(0.0, None))
    path, window = present(imported.path), p.requirement.window
    assert isinstance(path, Polynomials)
    first, count = written.figures["loop_first"], written.figures["loop_pieces"]
    laps = Polynomials(pieces=5 * path.pieces[first : first + count])
    mu = excitation.eigenvalues(laps, np.linspace(0, 4, 41), window)[:, 0].min()
    found = certificate.read_stored(file).excitation
    assert present(found.lower) <= mu * (1 + 1e-9)
    assert found.found == pytest.approx(mu, rel=1e-3)


@pytest.mark.parametrize("ramp", [1.0, 3.0])
def test_the_ramp_is_a_choice_and_is_recognised_when_the_file_is_read(ramp: float, tmp_path: Path):
    certified_export.write(SHIPPED["soft"], "polynomial", tmp_path / "x.csv", name="x", ramp=ramp, otherwise="")
    imported = formats.read(tmp_path / "x.csv", "polynomial")
    assert imported.duration == pytest.approx(present(SHIPPED["soft"].path.period))
    assert any(f"the first and last {ramp:g} s are the ramps" in sentence for sentence in imported.findings)
    again = as_preset(imported)
    assert present(again.path.period) == pytest.approx(present(SHIPPED["soft"].path.period))
    with pytest.raises(ValueError, match=r"a ramp must last 0\.2 to 20 s, got 0\.01 s"):
        formats.export(SHIPPED["soft"], "polynomial", tmp_path / "y.csv", ramp=0.01)


def test_ramps_that_are_too_much_for_the_vehicle_are_refused_and_longer_ones_offered(tmp_path: Path):
    """The witness: the jerk of the written ramp, by differences of its positions."""
    slow = replace(SHIPPED["soft"], vehicle=Vehicle(name="slow", jerk=20.0))
    assert certified_export.refusal(slow, "polynomial", PLAIN) is None
    refused = present(certified_export.refusal(slow, "polynomial", ExportOptions(ramp=0.5)))
    assert "its ramps of 0.5 s, which no certificate covers, are too much for slow: jerk" in str(refused)
    formats.export(slow, "polynomial", tmp_path / "x.csv", ramp=0.5)
    path = present(formats.read(tmp_path / "x.csv", "polynomial", part=(0.0, None)).path)
    t = np.linspace(0, 0.5, 2001)
    assert np.linalg.norm(np.diff(path(t), n=3, axis=0) / (t[1] - t[0]) ** 3, axis=-1).max() > 20.0
    assert "use ramps of 2 s" in [cure.text for cure in cures.cures(refused)]


def test_a_yaw_that_does_not_repeat_with_the_path_makes_no_loop():
    barrel = SHIPPED["barrel"]
    assert piece_layouts.loop_refusal(barrel) is None
    period = present(barrel.path.period)
    for yaw, repeats in (("0.3", True), (f"{2 * np.pi / period!r}*t", True), ("0.1*t", False), ("sin(t/7)", False)):
        turned = replace(barrel, angular_velocity=Flown(yaw=yaw))
        assert (piece_layouts.loop_refusal(turned) is None) == repeats, yaw
    assert "somewhere else" in present(piece_layouts.loop_refusal(SHIPPED["helix"]))


def test_even_if_uncertified_delivers_what_the_certificate_refuses(tmp_path: Path):
    waved = SHIPPED["hand-held"]
    export = certified_export.write(waved, "polynomial", tmp_path / "x.csv", name="x", uncertified=True, otherwise="")
    assert export.certificate is None
    assert [path.name for path in tmp_path.iterdir()] == ["x.uncertified.csv"]
    assert export.notes[1].startswith("UNCERTIFIED: as polynomial it does not keep what it promises: hand-held")


@pytest.mark.parametrize(("name", "once"), [("paper", True), ("wiggle", False), ("minimum-snap", False)])
def test_what_no_pieces_hold_is_written_as_far_as_they_go_and_marked(name: str, once: bool, tmp_path: Path):
    assert certified_export.refusal(SHIPPED[name], "polynomial", ExportOptions(once=once)) is not None
    export = certified_export.write(
        SHIPPED[name], "polynomial", tmp_path / "x.csv", name=name, once=once, uncertified=True, otherwise=""
    )
    assert [path.name for path in tmp_path.iterdir()] == ["x.uncertified.csv"]
    assert any(note.startswith("UNCERTIFIED: ") for note in export.notes)
    assert formats.read(tmp_path / "x.uncertified.csv", "polynomial").rows <= piece_layouts.MAX_SEGMENTS


def closed_pieces(lift: float) -> Polynomials:
    """A lap through four corners in 4 s, from rest to rest; at its end `lift` m higher."""
    corners = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.3), (1.0, 1.0, 0.0), (0.0, 1.0, 0.3), (0.0, 0.0, lift))
    points = tuple(Waypoint(time=float(k), value=corner) for k, corner in enumerate(corners))
    return from_minimum_snap(MinimumSnap(points=points))


def as_file(path: Polynomials, folder: Path) -> formats.ImportResult:
    """The path, written and read again."""
    design = preset.Preset(title="x", path=path, angular_velocity=Flown(), duration=4.0, requirement=ONE_SECOND)
    formats.export(design, "polynomial", folder / "x.csv")
    return formats.read(folder / "x.csv", "polynomial")


ONE_SECOND = preset.Requirement(window=1.0)


def test_an_imported_path_that_closes_is_a_loop_with_an_anchor_outside_it_and_says_so(tmp_path: Path):
    imported = as_file(closed_pieces(0.0), tmp_path)
    made = as_preset(imported)
    assert present(made.path.period) == pytest.approx(4.0)
    assert (made.requirement.window, made.duration) == pytest.approx((12.0, 20.0))  # whole loops
    away = np.linalg.norm(made.path(np.linspace(0, 4, 401)) - made.world.anchor, axis=-1)
    assert away.min() >= 1.0
    anchor, window, end = choices(made, imported)
    assert "the file does not say where it stands" in anchor
    assert (window, "it repeats: 5 loops of 4 s" in end) == ("the window judged, δ, is 12 s, which is 3 loops", True)
    once = as_preset(imported, ends="hold")
    assert (once.path.period, once.duration) == (None, pytest.approx(4.0))


def test_the_anchor_of_a_path_farther_away_than_an_anchor_may_be_stands_at_the_origin(tmp_path: Path):
    imported = as_file(closed_pieces(0.0), tmp_path)
    path = present(imported.path)
    assert isinstance(path, Polynomials)
    far = dataclasses.replace(imported, path=path.mapped(np.eye(3), np.array([6e5, 0.0, 0.0])))
    assert as_preset(far).world.anchor == (0.0, 0.0, 0.0)


def test_an_imported_path_that_does_not_close_is_flown_once(tmp_path: Path):
    imported = as_file(closed_pieces(0.5), tmp_path)
    made = as_preset(imported)
    assert made.path.period is None
    assert "holds still at its end" in choices(made, imported)[2]
    with pytest.raises(ValueError, match="does not end where it begins"):
        as_preset(imported, ends="repeat")


def test_a_loop_is_offered_where_a_flight_is_too_short_and_its_path_closes():
    flight = preset.Preset(
        title="x", path=closed_pieces(0.0), angular_velocity=Flown(), duration=4.0, requirement=ONE_SECOND
    )
    looped = present(cures.as_loop(flight))
    assert (looped.path.period, looped.duration) == pytest.approx((4.0, 20.0))
    assert cures.as_loop(replace(flight, path=closed_pieces(0.5))) is None
    assert cures.as_loop(SHIPPED["soft"]) is None
