"""Sampled paths: in motion at their ends, gaps and units asked, and judged the same whatever their number of rows."""

import numpy as np
import pytest

from rangenav import analysis, formats
from rangenav.formats import hermite
from rangenav.formats.path_preset import as_preset
from rangenav.observability import excitation
from rangenav.signals import Multisine, Tone
from tests.support.present import present

RATE, TURN, RADIUS = 50.0, 1.2, 2.0
TIME = np.arange(601) / RATE
CIRCLE = Multisine(
    tones=(
        Tone(axis="x", amplitude=RADIUS, frequency=TURN, phase=np.pi / 2),
        Tone(axis="y", amplitude=RADIUS, frequency=TURN),
        Tone(axis="z", amplitude=0.3, frequency=2 * TURN),
    )
)


def tum(time, noise=0.0, factor=1.0):
    position = CIRCLE(time) + noise * np.random.default_rng(2).standard_normal((len(time), 3))
    rows = [" ".join(f"{v:.6f}" for v in (factor * t, *p, 0, 0, 0, 1)) for t, p in zip(time, position, strict=True)]
    return "\n".join(rows).encode()


def read(data, **options):
    confirm = {key: options.pop(key) for key in ("frame", "gaps", "time") if key in options}
    return formats.parse(data, "tum", source="x.tum", confirm={"frame": "z-up", **confirm}, **options)


def test_a_circle_in_motion_is_not_forced_to_rest_at_its_ends():
    """Speed and acceleration at the ends and everywhere are the circle's, to what samples of a micrometre hold."""
    imported = present(read(tum(TIME)).path)
    t = np.linspace(0, 12, 2001)
    np.testing.assert_allclose(imported(t), CIRCLE(t), atol=1e-3)
    np.testing.assert_allclose(imported(t, 1), CIRCLE(t, 1), atol=0.03)
    np.testing.assert_allclose(imported(t, 2), CIRCLE(t, 2), atol=0.3)


@pytest.mark.parametrize(("rate", "noise"), [(20.0, 0.0), (30.0, 1e-3), (100.0, 1e-3)])
def test_between_the_samples_the_curve_is_as_near_the_motion_as_at_them(rate, noise):
    time = np.arange(int(12 * rate) + 1) / rate
    imported = read(tum(time, noise))
    t = np.linspace(0, 12, 3001)
    between = np.linalg.norm(present(imported.path)(t) - CIRCLE(t), axis=-1).max()
    assert between < 1.1 * present(imported.fit_error) < 5e-4 + 12 * noise


@pytest.mark.parametrize(("unit", "factor"), [("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
def test_stamps_in_another_unit_are_asked_and_the_answer_is_used(unit, factor):
    data = tum(TIME, factor=factor)
    imported = read(data)
    assert [(question.key, question.flag, question.suggestion) for question in imported.questions] == [
        ("time", "--time-unit", unit)
    ]
    assert imported.path is None
    answered = read(data, time=unit)
    assert (answered.questions, answered.duration) == ((), pytest.approx(12.0))
    assert answered.findings[0].endswith(f"stamps in {unit} as confirmed")
    slow = read(tum(TIME[:40] * 50), time="s")  # one pose in a second: the person's word stands
    assert (slow.questions, slow.duration) == ((), pytest.approx(39.0))


def test_a_gap_is_named_by_its_lines_and_cut_or_bridged_as_asked():
    time = TIME[(TIME < 5.0) | (TIME > 6.5)]
    data = tum(time)
    (question,) = read(data).questions
    assert (question.key, question.flag, question.options) == ("gaps", "--gaps", ("longest", "bridge"))
    assert "no rows for 1.54 s between line 250 at 4.98 s and line 251 at 6.52 s" in question.evidence
    longest, bridged, cut = read(data, gaps="longest"), read(data, gaps="bridge"), read(data, part=(None, 4.98))
    assert [imported.duration for imported in (longest, bridged, cut)] == pytest.approx([5.48, 12.0, 4.98])
    assert not any(imported.questions for imported in (longest, bridged, cut))
    for imported, begin in ((longest, 6.52), (bridged, 0.0), (cut, 0.0)):
        path, there = present(imported.path), time[(time >= begin) & (time <= begin + imported.duration)]
        np.testing.assert_allclose(path(there - begin), CIRCLE(there), atol=1e-3)


def test_a_part_that_the_file_does_not_have_is_refused():
    with pytest.raises(ValueError, match=r"x\.tum: the part from 20 s to inf s is none of the 12 s of the file"):
        read(tum(TIME), part=(20.0, None))


# --- files with derivatives


def table(names, time, orders):
    header = ["t", *(f"{name}_{axis}" for name in names for axis in "xyz")]
    values = np.column_stack([time, *(CIRCLE(time, order) for order in orders)])
    return "\n".join([",".join(header), *(",".join(map(repr, row)) for row in values.tolist())]).encode()


def reference(time):
    names = ("p", "v", "a_lin", "jerk", "snap")
    return formats.parse(table(names, time, range(5)), "reference", source="x.csv", confirm={})


@pytest.mark.parametrize("rows", [601, 578])
def test_neither_the_pieces_nor_the_verdict_depend_on_the_number_of_rows(rows):
    imported = reference(TIME[:rows])
    assert present(imported.fit_error) < 2e-6
    window = 5.0
    start = np.linspace(0, imported.duration - window, 5)
    got, wanted = (excitation.eigenvalues(path, start, window) for path in (present(imported.path), CIRCLE))
    np.testing.assert_allclose(got, wanted, rtol=3e-3)
    assert analysis.analyse(as_preset(imported)).verdict.word == "weak"


def test_velocity_and_acceleration_of_a_plain_csv_are_used():
    data = table(("p", "v", "a"), TIME[::10], range(3))  # 5 Hz: the positions alone are centimetres off between them
    imported = formats.parse(data, "csv", source="x.csv", confirm={"frame": "z-down"})
    assert (imported.questions, imported.frame, imported.derivatives) == ((), "z-down", "fit")
    path, t = present(imported.path), np.linspace(0, 12, 1001)
    np.testing.assert_allclose(path(t), CIRCLE(t), atol=5e-5)
    np.testing.assert_allclose(path(TIME[::10], 2), CIRCLE(TIME[::10], 2), atol=2e-3)
    assert present(imported.unjudged).startswith("the file holds acceleration and no jerk")
    (question,) = formats.parse(data, "csv", source="x.csv", confirm={}).questions
    assert question.key == "frame"


def test_a_velocity_that_is_not_that_of_the_positions_is_said_and_not_used():
    data = table(("p", "v", "a"), TIME, (0, 3, 2))
    findings = formats.parse(data, "csv", source="x.csv", confirm={"frame": "z-up"}).findings
    assert any(text.startswith("the velocity columns differ by") for text in findings)


def test_pieces_of_degree_5_pass_through_position_velocity_and_acceleration_and_are_smooth_to_there():
    knots = np.array([0.0, 0.7, 1.0, 2.2])
    given = np.stack([CIRCLE(knots, order) for order in range(3)], axis=1)
    path = hermite.polynomials(knots, given)
    for order in range(3):
        for side in (-1e-12, 1e-12):
            np.testing.assert_allclose(path(knots[1:-1] + side, order), given[1:-1, order], atol=1e-9)
    assert all(piece.x[6:] == (0.0, 0.0) for piece in path.pieces)


@pytest.mark.parametrize(
    ("gap", "rule"),
    [
        (5.0, "are too short for a curve through 4 knots 0.02 s apart: check the unit of the stamps"),
        (200.0, "with knots 0.05 s apart no smooth curve can be found through these waypoints"),
    ],
)
def test_two_bursts_for_which_there_is_no_curve_are_refused_by_the_name_of_their_file(gap: float, rule: str):
    stamps = np.r_[TIME[:22], TIME[:22] + gap]
    with pytest.raises(ValueError, match=r"^x\.tum: ") as refused:
        read(tum(stamps), time="ms")
    assert rule in str(refused.value)
