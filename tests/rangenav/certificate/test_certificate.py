"""Certificates: computed from bytes, said in finite numbers, verified again, refused when altered, turned round."""

import functools
import json
import math
import re
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rangenav import analysis, certificate, motion, preset
from rangenav.certificate import encoding, exports, schema
from rangenav.certificate.schema import Certificate, Loop
from rangenav.certificate.tone_search import with_tones
from rangenav.motion import World
from rangenav.preset import Preset
from rangenav.signals import Flown, Formula, Multisine, Piece, Polynomials, Sum, Tone
from rangenav.signals.multisine import LETTERS
from rangenav.vehicle import CRAZYFLIE, FREE
from tests.support.null_reasons import nulls_without_reason
from tests.support.signal_examples import EXAMPLES

pytestmark = pytest.mark.slow


SHIPPED = [file.stem for file in preset.shipped_files()]
SOFT = preset.load("soft")
SOFT_BYTES = preset.dumps(SOFT).encode()
replace = msgspec.structs.replace


@functools.cache
def soft_certificate() -> Certificate:
    """The certificate of the soft path; not made while tests are collected, which every worker does."""
    return certificate.certify(SOFT_BYTES, source="soft.toml")


def certified(p: Preset) -> Certificate:
    return certificate.certify(preset.dumps(p).encode(), source="here.toml")


def stored(name: str) -> Certificate:
    """The certificate that is shipped; another test computes it again."""
    return encoding.loads(certificate.path_for(preset.find(name)).read_bytes(), source=name)


def check(issued: Certificate, name: str) -> schema.Check:
    (one,) = [one for one in issued.checks if one.name == name]
    return one


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_preset_lies_beside_a_certificate_that_holds(name: str):
    assert certificate.verify_file(name) == ()


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_certificate_is_whole_and_says_what_the_analysis_says(name: str):
    text = certificate.path_for(preset.find(name)).read_text(encoding="utf-8")
    said = json.loads(text, parse_constant=pytest.fail)
    assert nulls_without_reason(said) == []
    analysed, p = analysis.analyse(preset.load(name)), preset.load(name)
    assert said["certified"]
    assert (said["expect"], said["verdict"], said["rank"]["rank"]) == (p.expect, analysed.verdict.word, analysed.rank)
    assert said["rank"]["nonlinear"] == analysed.nonlinear_rank
    sigma = said["accuracy"]["lifted"]["end"]["position"]
    if math.isfinite(analysed.lifted_end.position):
        assert sigma == pytest.approx(analysed.lifted_end.position, rel=1e-6)
    else:
        assert sigma is None
    if said["excitation"]["found"] is not None:
        assert said["excitation"]["found"] == pytest.approx(analysed.mu, rel=0.02)
        assert 0.98 * said["excitation"]["found"] <= said["excitation"]["lower"]
    assert said["claim"]["starts"].startswith("every t >= 0") == (p.path.period is not None)


def test_the_flight_ready_presets_can_be_flown_with_margin_in_a_bounded_box():
    for name in ("barrel", "trefoil", "torus", "eight-repaired"):
        p, issued = preset.load(name), stored(name)
        assert isinstance(p.angular_velocity, Flown)
        assert (issued.meets, issued.vehicle.flyable) == (True, True)
        assert issued.accuracy.lifted.end.position is not None
        assert issued.accuracy.lifted.end.position < 0.15
        assert p.requirement.window <= 20.0
        assert p.vehicle.thrust_to_weight is not None
        assert issued.limits.thrust_to_weight * 1.35 <= p.vehicle.thrust_to_weight
        assert p.vehicle.height_min is not None
        assert issued.limits.height_min > p.vehicle.height_min
        assert issued.limits.height_max < 3.0
        assert issued.frame.up == ("+z" if p.world.gravity[2] < 0 else "-z")
        moved = motion.simulate(
            p.path, p.angular_velocity, world=p.world, initial_rotation=(0, 0, 0), duration=p.duration, rate=50.0
        )
        hover = np.asarray(p.world.gravity) * -1.0
        assert (np.einsum("nij,j->ni", moved.rotation, [0, 0, hover[2]]) @ hover > 0).all()  # never upside down


def test_the_same_bytes_give_the_same_certificate_to_the_last_byte():
    again = certificate.certify(SOFT_BYTES, source="elsewhere.toml")
    assert certificate.dumps(again) == certificate.dumps(soft_certificate())
    assert encoding.loads(certificate.dumps(again), source="here") == soft_certificate()


@settings(max_examples=30)
@given(st.integers(0, len(SOFT_BYTES) - 1), st.integers(1, 255))
def test_one_altered_byte_fails(place: int, change: int):
    altered = bytearray(SOFT_BYTES)
    altered[place] ^= change
    (said,) = certificate.verify(bytes(altered), soft_certificate(), source="soft.toml")
    assert said.startswith("soft.toml: its bytes are not those that were certified: SHA-256 ")


def test_the_certificate_of_another_preset_fails(tmp_path: Path):
    (tmp_path / "soft.toml").write_bytes(SOFT_BYTES)
    other = certificate.certify_file("lissajous")
    (tmp_path / "soft.certificate.json").write_bytes(certificate.dumps(other))
    assert len(certificate.verify_file(tmp_path / "soft.toml")) == 1
    disguised = replace(other, artifact=soft_certificate().artifact)  # even if it claims to be of these bytes
    (tmp_path / "soft.certificate.json").write_bytes(certificate.dumps(disguised))
    wrong = certificate.verify_file(tmp_path / "soft.toml")
    assert any("excitation.lower is 97." in sentence for sentence in wrong)


def test_a_file_without_a_certificate_or_that_is_none_is_answered_with_a_sentence(tmp_path: Path):
    (tmp_path / "soft.toml").write_bytes(SOFT_BYTES)
    assert certificate.verify_file(tmp_path / "soft.toml") == (
        "soft.toml: there is no certificate beside it (soft.certificate.json)",
    )
    (said,) = certificate.verify_file(tmp_path / "none.toml")
    assert said.endswith("none.toml: no such file")
    (said,) = certificate.verify_file("papper")
    assert said.startswith("papper: no such preset")
    for wrong in (b"", b"{}", b"[1, 2]", b"\xff\xfe", b'{"format": NaN}', b"[" * 100_000, b"9" * 5000, b" " * 300_000):
        (tmp_path / "soft.certificate.json").write_bytes(wrong)
        (said,) = certificate.verify_file(tmp_path / "soft.toml")
        assert said.startswith("soft.certificate.json: ")
        assert "\n" not in said


def leaves(value: Any, path: tuple = ()) -> list[tuple]:
    """The places of all that is no dict and no list."""
    if isinstance(value, dict):
        return [place for key, entry in value.items() for place in leaves(entry, (*path, key))]
    if isinstance(value, list) and value:
        return [place for k, entry in enumerate(value) for place in leaves(entry, (*path, k))]
    return [path]


def put(value: Any, path: tuple, new: Any) -> Any:
    """A copy with one place replaced."""
    if not path:
        return new
    copy = value.copy()
    copy[path[0]] = put(value[path[0]], path[1:], new)
    return copy


def place(value: Any, path: tuple) -> Any:
    return value if not path else place(value[path[0]], path[1:])


@pytest.mark.parametrize("name", ["soft", "circle"])
def test_every_claim_that_is_changed_is_noticed(name: str):
    """A number made 5% larger (or 5% of a unit), a flag turned, a word added: every place but who computed it."""
    content = preset.find(name).read_bytes()
    issued = certificate.certify(content, source=name)
    whole = encoding.to_builtins(issued)
    loose = {("excitation", "floor"), ("excitation", "starts"), ("rank", "windows")}  # allowances, not claims
    for where in leaves(whole):
        if where[0] == "tool" or where in loose:
            continue
        value = place(whole, where)
        if isinstance(value, bool):
            changed: Any = not value
        elif isinstance(value, int):
            changed = value + 1
        elif isinstance(value, float):
            changed = value * 1.05 + 0.05
        elif value is None:
            changed = 1.0
        else:
            changed = [*value, "words"] if isinstance(value, list) else value + " and more"
        text = json.dumps(put(whole, where, changed)).encode()
        try:
            wrong = certificate.differences(encoding.loads(text, source=name), issued)
        except ValueError:
            continue  # not even read
        assert wrong, where


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=6,
)
STORED = encoding.to_builtins(certificate.read_stored("soft"))
PLACES = leaves(STORED) + [(key,) for key in STORED]


@settings(max_examples=60)
@given(st.lists(st.tuples(st.sampled_from(PLACES), json_values), min_size=1, max_size=3))
def test_certificates_with_anything_in_them_are_answered_with_sentences(mutations: list):
    mutated = encoding.to_builtins(soft_certificate())
    for where, value in mutations:
        try:
            mutated = put(mutated, where, value)
        except (KeyError, TypeError, IndexError, AttributeError):
            continue  # what the place was in is gone
    answered(json.dumps(mutated).encode())


def answered(text: bytes) -> None:
    """Whatever a certificate holds, what is said of it are sentences of one line."""
    try:
        read = encoding.loads(text, source="soft.certificate.json")
    except ValueError as error:
        said = [str(error)]
    else:
        said = list(certificate.verify(SOFT_BYTES, read, source="soft.toml"))
    assert all(sentence.startswith("soft.") and "\n" not in sentence for sentence in said)


@settings(max_examples=60)
@given(st.integers(0, 4000), st.binary(max_size=6), st.integers(0, 40))
def test_a_certificate_damaged_anywhere_is_answered_with_sentences(where: int, new: bytes, cut: int):
    whole = certificate.dumps(soft_certificate())
    answered(whole[:where] + new + whole[where + cut :])


@settings(max_examples=200)
@given(st.floats(1e-300, 1e300) | st.floats(-1e300, -1e-300))
def test_figures_are_rounded_to_the_side_on_which_bounds_stay_bounds(value: float):
    low, high = schema.figure(value, toward=-1), schema.figure(value, toward=1)
    assert low <= value <= high
    assert high - low <= 2.1e-7 * abs(value)
    assert schema.figure(value) in (low, high)
    assert f"{low:.7e}" == f"{float(f'{low:.7e}'):.7e}"


def test_expectations_are_held_against_what_is_found():
    assert certified(replace(SOFT, expect="unobservable")).failures == (
        "expected unobservable, but no window of 12 s at any t ≥ 0 has an excitation below 139.9, 50 m²/s⁷ required, "
        "and the rank is 13 of 13 on every window of 12 s at every t ≥ 0",
    )
    (said,) = certified(replace(SOFT, expect="weak")).failures
    assert said.startswith("expected weak, but position is predicted to 0.323 m (1-σ) or better after every window of ")
    circle = certified(replace(preset.load("circle"), expect="observable"))
    assert not circle.certified
    assert len(circle.failures) == 3  # excitation, rank, accuracy
    wiggle = certified(replace(preset.load("wiggle"), expect="observable"))
    assert [check(wiggle, name).met for name in ("excitation", "rank", "accuracy")] == [True, True, False]
    assert wiggle.failures == (check(wiggle, "accuracy").words,)


def test_an_unobservable_motion_is_proven_so_for_every_window_where_that_can_be_had():
    for name in ("circle", "tilted-circle", "vertical-circle", "paper-implied", "figure-eight", "hover", "helix"):
        issued = stored(name)
        assert check(issued, "excitation").proven
        assert issued.excitation.upper_everywhere is not None
        assert issued.excitation.upper_everywhere < 1e-6
        assert issued.claim.starts == "every t >= 0"
    snap = stored("minimum-snap")  # excited, by a bound, and of rank 10 all the same
    assert (check(snap, "excitation").met, check(snap, "excitation").proven, snap.rank.rank) == (True, True, 10)


def test_a_window_inside_one_piece_of_degree_7_has_at_most_rank_10():
    """D, τD and τ²D are polynomials of degree 9 at most there, of which there are ten."""
    p = preset.load("minimum-snap")
    coefficients = np.eye(10)
    assert np.linalg.matrix_rank(coefficients) == 10
    assert p.requirement.window < min(np.diff([point.time for point in p.path.points]))  # pyright: ignore
    assert stored("minimum-snap").rank.rank == 10


def test_where_nothing_is_bounded_the_certificate_says_null_and_why():
    kinked = "sin(2*t) + 1e-9*((t - 3.0001)**2 + 1e-12)**2.5"  # smooth, but within a micrometre of a kink
    path = Formula(x=kinked, y="cos(3*t)", z="0.5*sin(5*t)")
    issued = certified(replace(SOFT, path=path))
    assert (issued.excitation.lower, issued.excitation.upper) == (None, None)
    assert "nothing is known to bound" in str(issued.excitation.reason)
    assert not check(issued, "excitation").proven
    assert check(issued, "excitation").met
    assert nulls_without_reason(encoding.to_builtins(issued)) == []


def test_a_path_that_does_not_repeat_is_bounded_on_its_flight_and_says_so():
    tones = (*SOFT.path.tones, Tone(axis="x", amplitude=0.01, frequency=math.sqrt(5)))  # pyright: ignore
    issued = certified(replace(SOFT, path=Multisine(tones=tones)))
    assert issued.claim.starts == "every t in [0, duration - window]"
    assert issued.claim.reason == "not every t: the path does not repeat"
    assert issued.excitation.lower is not None
    assert issued.excitation.lower > 100


def test_a_period_too_long_to_bound_is_left_for_the_flight_and_that_is_said():
    """Frequencies in ratios of hundreds repeat after an hour: the bound holds on the flight, and no more is claimed."""
    ratios = (997 / 996, 991 / 990, 40.0)
    extra = tuple(Tone(axis="x", amplitude=1e-3, frequency=1.5 * ratio) for ratio in ratios)
    issued = certified(replace(SOFT, path=Multisine(tones=(*SOFT.path.tones, *extra))))  # pyright: ignore
    assert issued.claim.period is not None
    assert issued.claim.period > 1000
    assert issued.claim.starts == "every t in [0, duration - window]"
    assert str(issued.claim.reason).startswith("not every t: ")
    assert issued.meets


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_path_of_any_family_is_certified_or_refused_with_reasons(name: str):
    p = replace(SOFT, path=EXAMPLES[name], duration=10.0, requirement=replace(SOFT.requirement, window=4.0))
    issued = certified(p)
    assert nulls_without_reason(encoding.to_builtins(issued)) == []
    assert issued.meets == (certificate.gate(issued) is None)
    assert issued.certified == (not issued.failures)


def test_a_jump_is_found_and_named():
    step = Piece(duration=5.0, x=(0.0, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    back = Piece(duration=5.0, x=(0.9, -0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    issued = certified(replace(SOFT, path=Polynomials(pieces=(step, back, step, back))))
    assert issued.jumps.position == pytest.approx(0.1)  # 1.0 → 0.9, and back −0.1 → 0
    assert issued.jumps.velocity == pytest.approx(0.4)
    assert check(issued, "smooth").words == "the position jumps by 0.1 m, which nothing can follow"
    assert certified(replace(SOFT, path=EXAMPLES["waypoints"])).jumps.snap == 0.0


def test_the_limits_are_those_of_the_textbook():
    """A circle of radius 1 at 2 rad/s: speed 2, acceleration 4, jerk 8, snap 16, leaning atan(4/9.81)."""
    issued = stored("circle").limits
    assert (issued.speed, issued.acceleration, issued.jerk, issued.snap) == pytest.approx((2, 4, 8, 16), rel=1e-6)
    assert issued.thrust_to_weight == pytest.approx(math.hypot(1, 4 / 9.81), rel=1e-6)
    assert issued.tilt_deg == pytest.approx(math.degrees(math.atan2(4, 9.81)), rel=1e-6)
    assert issued.anchor_distance_min == pytest.approx(math.hypot(1, 1.5), rel=1e-6)


def test_what_a_vehicle_cannot_do_is_refused_with_how_much_slower_it_would_go():
    p = replace(SOFT, vehicle=CRAZYFLIE, angular_velocity=Flown(), path=Multisine(tones=FAST))
    said = exports.gate(p)
    assert said is not None
    assert "Crazyflie 2.1 cannot fly it: thrust 1.73 times the weight" in said
    slower = float(re.findall(r"fly it ([\d.]+) times slower", said)[0])
    from rangenav.signals import slowed

    assert check(certified(replace(p, path=slowed(p.path, slower))), "vehicle").met
    assert not check(certified(replace(p, path=slowed(p.path, 0.9 * slower))), "vehicle").met


FAST = (
    Tone(axis="x", amplitude=1.0, frequency=2.0),
    Tone(axis="y", amplitude=0.5, frequency=3.0),
    Tone(axis="z", amplitude=0.4, frequency=4.0),
)


def test_the_gate_is_open_for_what_meets_its_requirement_whatever_was_expected():
    assert certificate.gate(soft_certificate()) is None
    assert certificate.gate(certified(replace(SOFT, expect="unobservable"))) is None
    assert exports.gate(SOFT) is None


@pytest.mark.parametrize(
    "name", ["circle", "tilted-circle", "vertical-circle", "helix", "figure-eight", "paper-implied"]
)
def test_the_gate_names_direction_window_and_deficit_and_its_remedy_is_one(name: str):
    """Whoever does what the sentence says gets a motion that meets every requirement; with half of it not."""
    p, issued = preset.load(name), stored(name)
    said = exports.gate(p, "polynomial")
    assert said is not None
    window = re.escape(f"the {p.requirement.window:g} s from t = 0 s")
    assert re.search(rf"the excitation along \S.* over {window} is nothing, [\d.e+]+ m²/s⁷ required", said)
    assert "rank is 1" in said
    size, frequency = map(float, re.findall(r"a tone of ([\d.]+) m at ([\d.]+) rad/s along", said)[0])
    n = np.asarray(issued.excitation.direction)

    def helped(amplitude: float) -> Certificate:
        added = tuple(
            Tone(axis=axis, amplitude=float(amplitude * n[k]), frequency=frequency)
            for k, axis in enumerate(("x", "y", "z"))
            if n[k]
        )
        return certified(replace(p, expect="observable", path=with_tones(p.path, added)))

    assert helped(size).meets
    assert not helped(0.5 * size).meets


def test_a_certificate_of_version_1_is_verified_by_what_it_claimed():
    """Its rank and σ are those of sampled windows; a claim that is changed is noticed as in the current version."""
    old = certificate.certify(SOFT_BYTES, source="soft.toml", version=1)
    said = encoding.to_builtins(old)
    assert said["version"] == 1
    assert {"scope", "bound", "ranges"}.isdisjoint(said["accuracy"])
    assert old.accuracy.lifted.end.position != soft_certificate().accuracy.lifted.end.position
    assert certificate.verify(SOFT_BYTES, old, source="soft.toml") == ()
    wrong = encoding.loads(json.dumps(put(said, ("rank", "windows"), 7)).encode(), source="soft")
    assert len(certificate.verify(SOFT_BYTES, wrong, source="soft.toml")) == 1
    raised = encoding.loads(json.dumps(put(said, ("version",), 2)).encode(), source="soft")
    assert any("accuracy.scope is missing" in one for one in certificate.verify(SOFT_BYTES, raised, source="soft.toml"))


def test_a_motion_of_full_rank_is_blind_for_ranges_that_fall_on_the_same_places():
    """A loop of 1 s with ranges at 1 Hz, flown at two rates of ranges."""
    turn = 2 * math.pi
    loop = Multisine(
        tones=tuple(Tone(axis=LETTERS[k], amplitude=1.0, frequency=turn * (k + 1), phase=float(k)) for k in range(3))
    )
    aliased, enough = (
        certified(
            replace(
                SOFT,
                path=loop,
                duration=40.0,
                expect="unobservable" if rate == 1.0 else "observable",
                sensors=replace(SOFT.sensors, range_rate=rate),
                requirement=replace(SOFT.requirement, window=20.0, position_sigma=5.0),
                angular_velocity=Multisine(),
                vehicle=FREE,
            )
        )
        for rate in (1.0, 11.7)
    )
    assert (aliased.verdict, aliased.rank.rank, aliased.certified, aliased.meets) == ("blind", 13, True, False)
    assert str(aliased.verdict_reason).endswith("fall on too few places of the path, which repeats every 1 s")
    assert (enough.verdict, enough.certified) == ("observable", True)


def test_gravity_and_axes_are_said():
    assert soft_certificate().frame.up == "-z"
    assert soft_certificate().frame.gravity == (0.0, 0.0, 9.81)
    up = certified(replace(SOFT, world=World(gravity=(0.0, 0.0, -9.81))))
    assert up.frame.up == "+z"
    tilted = certified(replace(SOFT, world=World(gravity=(0.0, 6.0, 8.0))))
    assert tilted.frame.up == "(0.00, -0.60, -0.80)"


def tones_file(content: bytes, source: str, context: Preset | None, loop: Loop | None) -> certificate.FileContents:
    """A made-up format that holds a path and nothing else: axis, amplitude and frequency a line."""
    if context is None:
        raise ValueError(f"{source}: says nothing of the world")
    rows = [line.split() for line in content.decode().splitlines()]
    made = tuple(Tone(axis=axis, amplitude=float(a), frequency=float(w)) for axis, a, w in rows)  # pyright: ignore
    return certificate.FileContents(replace(context, path=Multisine(tones=made)))


def test_a_file_that_holds_a_path_only_is_certified_with_its_context_and_read_by_who_knows_it(tmp_path: Path):
    readers = {**certificate.READERS, "tones": tones_file}
    file = tmp_path / "three.tones"
    file.write_text("x 1.0 1.5\ny -0.4 2.25\nz 0.3 3.0\n")
    issued = certificate.certify(file.read_bytes(), source="three.tones", form="tones", context=SOFT, readers=readers)
    assert issued.excitation == soft_certificate().excitation
    certificate.path_for(file).write_bytes(certificate.dumps(issued))
    assert certificate.verify_file(file, readers=readers) == ()
    assert certificate.verify_file(file) == ("three.tones: files of the format 'tones' cannot be certified",)
    file.write_text("x 1.0 1.5\ny -0.4 2.25\nz 0.3 3.1\n")
    assert len(certificate.verify_file(file, readers=readers)) == 1


def test_a_sum_whose_wiggle_takes_no_tones_is_refused_without_a_remedy():
    path = Sum(base=Multisine(tones=FAST[:2]), wiggle=Formula(x="0.1*sin(t)"))
    said = exports.gate(replace(SOFT, path=path))
    assert said is not None
    assert "it would do to" not in said


def test_a_number_beyond_all_floats_in_a_title_is_equal_to_itself():
    content = preset.dumps(replace(SOFT, title="run 1e999")).encode()
    assert certificate.verify(content, certificate.certify(content, source="x"), source="x") == ()
