"""Presets: written and read without loss, refused in one sentence, and true in what they promise."""

import math
import re
from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rangenav import motion, preset, signals
from rangenav.analysis import analyse
from rangenav.attitude import HALFWAY_RANGE, K1_RANGE, MEMORY_RANGE, RHO_RANGE, AttitudeGains, Schedule
from rangenav.gains import Gains, Guess
from rangenav.motion import World
from rangenav.observability import excitation
from rangenav.preset import Preset, Requirement
from rangenav.provenance import Source
from rangenav.riccati import P0_RANGE, Q_RANGE, V_RANGE, Blocks, RiccatiGains
from rangenav.sensors import MAX_SIGMA, MIN_SIGMA, MODELLED, Effects, Noise, Sensors, effects
from rangenav.signals import Flown, Multisine, Tone
from tests.support.present import present
from tests.support.toml_fragments import TOML_FRAGMENTS

pytestmark = pytest.mark.slow


SHIPPED = preset.shipped()
NAMES = sorted(SHIPPED)
ROOT = Path(preset.__file__).parent.parent
PAPER_TEXT = (ROOT / "presets" / "paper.toml").read_text(encoding="utf-8")


def vectors(size):
    return st.tuples(*[st.floats(-size, size)] * 3)


def normalised(vector):
    return tuple((np.array(vector) / np.linalg.norm(vector)).tolist())


def blocks(limits):
    return st.builds(Blocks, **dict.fromkeys(Blocks.__struct_fields__, st.floats(*limits)))


sigmas = st.just(0.0) | st.floats(MIN_SIGMA, MAX_SIGMA)
densities = st.just(0.0) | st.floats(MIN_SIGMA, MAX_SIGMA / math.sqrt(3000))  # as noisy as may be at 3000 Hz


def values_of(field):
    """An effect's default, or any value within its limits."""
    row, default = effects.rows()[field], getattr(MODELLED, field)
    if isinstance(default, tuple):
        return st.just(default) | vectors(row.limits[1] / 2)
    return st.just(default) | st.floats(*row.limits, exclude_max=row.excluded)


unmodelled = st.builds(Effects, **{field: values_of(field) for field in effects.rows()})
tones = st.builds(
    Tone,
    axis=st.sampled_from("xyz"),
    amplitude=st.floats(-1e4, 1e4),
    frequency=st.floats(1e-6, 570),  # so that a window of 2 s is not too much work
    phase=st.floats(allow_nan=False, allow_infinity=False),
)
multisines = st.builds(Multisine, tones=st.lists(tones, max_size=3).map(tuple), offset=vectors(1e6), drift=vectors(1e5))
worlds = st.builds(
    World,
    gravity=st.sampled_from([(0.0, 0.0, 9.81), (0.0, 0.0, -1.62), (1e-300, 0.0, 9.81)]),
    magnetic=vectors(1.0).filter(lambda v: np.linalg.norm(v[:2]) > 0.1).map(normalised),
    anchor=vectors(5e4),
)
hashes = st.text("0123456789abcdef", min_size=64, max_size=64)
sources = st.builds(
    Source,
    file=st.text(min_size=1, max_size=255),
    sha256=hashes,
    format=st.sampled_from(["reference", "polynomial", "tum", "euroc"]),
    derivatives=st.sampled_from(["file", "fit"]),
    fitted=st.text(max_size=400),
    unjudged=st.text(min_size=1, max_size=400),
    path_sha256=hashes,
)
presets = st.builds(
    Preset,
    title=st.text(min_size=1, max_size=preset.MAX_TITLE),
    story=st.text(max_size=preset.MAX_STORY),
    expect=st.sampled_from(["observable", "weak", "unobservable"]),
    duration=st.floats(10, 600),
    seed=st.integers(0, 2**53 - 1),
    initial_rotation=vectors(3.5),
    path=multisines,
    angular_velocity=multisines,
    source=st.none() | sources,
    world=worlds,
    sensors=st.builds(
        Sensors,
        imu_rate=st.floats(200, 3000),
        mag_rate=st.floats(1, 200),
        range_rate=st.floats(1, 3000),
        noise=st.builds(Noise, gyro=sigmas, accel=sigmas, mag=sigmas, range=sigmas)
        | st.builds(Noise, gyro=densities, accel=densities, mag=sigmas, range=sigmas, imu_unit=st.just("density")),
        unmodelled=st.just(MODELLED) | unmodelled,
    ),
    gains=st.builds(
        Gains,
        mode=st.sampled_from(["constant", "noise-matched"]),
        riccati=st.builds(RiccatiGains, q=st.floats(*Q_RANGE), v=blocks(V_RANGE), p0=blocks(P0_RANGE)),
        attitude=st.builds(
            AttitudeGains,
            k1=st.floats(1.0, K1_RANGE[1]),
            rho1=st.floats(*RHO_RANGE),
            rho2=st.floats(*RHO_RANGE),
            schedule=st.none()
            | st.builds(
                Schedule,
                steady=st.floats(K1_RANGE[0], 1.0),
                halfway=st.floats(*HALFWAY_RANGE),
                memory=st.floats(*MEMORY_RANGE),
            ),
        ),
    ),
    guess=st.builds(
        Guess,
        state=st.sampled_from(["zero", "truth", "offset"]),
        position_offset=vectors(5e3),
        attitude_axis=vectors(5e8).filter(lambda v: max(map(abs, v)) > 1e-3),
        attitude_angle=st.floats(-math.pi, math.pi),
    ),
    requirement=st.builds(
        Requirement,
        window=st.floats(0.05, 1.9),
        mu=st.floats(5e-324, 1.7e308),
        position_sigma=st.floats(5e-324, 1.7e308),
    ),
)


def refusal(text, source="eight.toml"):
    """What is said about a text that is no preset; None if it is one."""
    try:
        preset.loads(text, source=source)
    except ValueError as error:
        return str(error)
    return None


def edited(old, new):
    """The paper's preset with one piece of text replaced."""
    assert old in PAPER_TEXT
    return PAPER_TEXT.replace(old, new, 1)


@pytest.mark.parametrize("name", NAMES)
def test_every_shipped_preset_loads_and_is_written_as_it_is_shipped(name):
    text = preset.find(name).read_text(encoding="utf-8")
    assert preset.dumps(preset.load(name)) == text
    assert preset.load(preset.find(name)) == SHIPPED[name]


def test_the_shipped_presets_are_those_of_the_table_in_the_documentation():
    table = (ROOT / "docs" / "presets.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"^\| `([a-z-]+)` \|", table, flags=re.MULTILINE)) == NAMES


@settings(max_examples=200)
@given(presets)
def test_reading_what_was_written_gives_an_equal_preset(p):
    assert preset.loads(preset.dumps(p), source="round trip") == p


def test_what_no_sensor_does_is_not_written_and_what_one_does_is_written_alone():
    """So files from before there were such effects stay as they were, and equal presets are equal texts."""
    p = SHIPPED["paper"]
    zeros = (float("0"), float("-0"), 0.0)  # equal to the default and not the same object
    same = msgspec.structs.replace(p.sensors, unmodelled=Effects(gyro_bias=zeros, outlier_size=float("1")))
    assert preset.dumps(msgspec.structs.replace(p, sensors=same)) == PAPER_TEXT
    lost = msgspec.structs.replace(p.sensors, unmodelled=Effects(gyro_bias=zeros, dropout_probability=0.25))
    text = preset.dumps(msgspec.structs.replace(p, sensors=lost))
    added = "\n[sensors.unmodelled]\ndropout_probability = 0.25\n"
    assert text.replace(added, "") == PAPER_TEXT


def test_the_unit_of_the_imus_noise_is_written_only_where_it_is_a_density():
    p = SHIPPED["paper"]
    noise = msgspec.structs.replace(p.sensors.noise, imu_unit="density")
    text = preset.dumps(msgspec.structs.replace(p, sensors=msgspec.structs.replace(p.sensors, noise=noise)))
    assert text.replace('imu_unit = "density"\n', "") == PAPER_TEXT


@pytest.mark.parametrize(
    "text", ["[\n    1,\n    2,\n]", "a\"b\\c'd", "\t\u0007\u0000\r\n", "σ → 30°, \U0001f681", "]] = # [path]", " "]
)
def test_titles_and_stories_that_look_like_toml_survive(text):
    title = "".join(c for c in text if c.isprintable()) or "?"  # a title stands on one line
    p = msgspec.structs.replace(SHIPPED["paper"], title=f"{title}.", story=text)
    assert preset.loads(preset.dumps(p), source="round trip") == p


def test_arrays_of_numbers_stand_on_one_line():
    p = msgspec.structs.replace(SHIPPED["hover"], path=Multisine(offset=(-0.1, 1e5, 2.5e-7)))
    assert "offset = [-0.1, 100000.0, 2.5e-07]\n" in preset.dumps(p)


def test_saving_and_loading_a_file_gives_an_equal_preset(tmp_path):
    preset.save(SHIPPED["soft"], tmp_path / "mine.toml")
    assert preset.load(str(tmp_path / "mine.toml")) == SHIPPED["soft"]


def test_whole_numbers_may_be_written_without_a_point():
    text = edited("frequency = 8.0", "frequency = 8").replace("duration = 20.0", "duration = 20")
    assert preset.loads(text, source="p") == SHIPPED["paper"]


def test_what_a_preset_leaves_out_takes_the_documented_defaults():
    minimal = 'title = "x"\n[path]\nkind = "multisine"\n[angular_velocity]\nkind = "multisine"\n'
    expected = Preset(title="x", path=Multisine(), angular_velocity=Multisine())
    assert preset.loads(minimal, source="p") == expected
    assert (expected.duration, expected.sensors.imu_rate, expected.requirement.window) == (20.0, 200.0, 6.0)


NO_PLACE = ""
REFUSALS = [
    pytest.param(edited("seed = 1", "colour = 2"), "unknown field `colour`", NO_PLACE, id="unknown key"),
    pytest.param(edited("mag = 0.1", "mog = 0.1"), "unknown field `mog`", "$.sensors.noise", id="unknown nested key"),
    pytest.param(edited("[gains]", "[gians]"), "unknown field `gians`", NO_PLACE, id="unknown table"),
    pytest.param(
        edited("frequency = 8.0", 'frequency = "fast"'),
        "Expected `float`, got `str`",
        "$.path.tones[0].frequency",
        id="text",
    ),
    pytest.param(
        edited("duration = 20.0", "duration = true"), "Expected `float`, got `bool`", "$.duration", id="truth"
    ),
    pytest.param(
        edited("duration = 20.0", "duration = 1979-05-27"), "Expected `float`, got `date`", "$.duration", id="date"
    ),
    pytest.param(edited("seed = 1", "seed = 1.5"), "Expected `int`, got `float`", "$.seed", id="broken seed"),
    pytest.param(
        edited("drift = [0.0, 0.0, 0.0]", "drift = [0.0]"), "length 3, got 1", "$.path.drift", id="short vector"
    ),
    pytest.param(re.sub("title = .*", "", PAPER_TEXT), "missing required field `title`", NO_PLACE, id="missing key"),
    pytest.param(edited("version = 1", "version = 2"), "Invalid enum value 2", "$.version", id="later version"),
    pytest.param(
        edited('axis = "x"', 'axis = "w"'), "Invalid enum value 'w'", "$.path.tones[0].axis", id="no such axis"
    ),
    pytest.param(edited('"multisine"', '"spline"'), "Invalid value 'spline'", "$.path.kind", id="no such kind"),
    pytest.param(
        edited("frequency = 8.0", "frequency = nan"), "frequency must be a finite", "$.path.tones[0]", id="nan"
    ),
    pytest.param(
        edited("amplitude = 0.3", "amplitude = -inf"), "amplitude must be a finite", "$.path.tones[1]", id="inf"
    ),
    pytest.param(edited("offset = [0.0", "offset = [nan"), "offset must be a finite", "$.path", id="nan in a vector"),
    pytest.param(
        edited("mu = 10000000.0", "mu = inf"), "mu must be a finite", "$.requirement", id="infinite requirement"
    ),
    pytest.param(
        re.sub(r"magnetic = .*", "magnetic = [0.0, 0.0, -1.0]", PAPER_TEXT),
        "must not be collinear",
        "$.world",
        id="collinear",
    ),
    pytest.param(
        re.sub(r"magnetic = .*", "magnetic = [1, 1, 0]", PAPER_TEXT), "a unit vector", "$.world", id="not unit"
    ),
    pytest.param(
        edited("gyro = 0.01", "gyro = -0.01"), "noise gyro must lie between", "$.sensors.noise", id="negative noise"
    ),
    pytest.param(
        edited("duration = 20.0", "duration = 1e6"), "duration must lie between 0.5 and 600 s", NO_PLACE, id="long"
    ),
    pytest.param(
        edited("duration = 20.0", "duration = -1"), "duration must lie between", NO_PLACE, id="negative duration"
    ),
    pytest.param(
        edited("imu_rate = 200.0", "imu_rate = 1e9"), "imu_rate must lie between", "$.sensors", id="absurd rate"
    ),
    pytest.param(
        edited("range_rate = 200.0", "range_rate = 0"), "range_rate must lie between", "$.sensors", id="no rate"
    ),
    pytest.param(
        edited("imu_rate = 200.0", "imu_rate = 20"), "mag_rate must lie between", "$.sensors", id="mag over imu"
    ),
    pytest.param(
        edited("range = 0.1", 'range = 0.1\nimu_unit = "root"'),
        "Invalid enum value",
        "$.sensors.noise.imu_unit",
        id="unit",
    ),
    pytest.param(
        edited("accel = 0.1", "accel = 100").replace("range = 0.1", 'range = 0.1\nimu_unit = "density"'),
        "noise accel must lie between 1e-09 and 1000 or be 0, got 1414.21 per sample at 200 Hz",
        "$.sensors",
        id="density at this rate",
    ),
    pytest.param(
        edited("[gains]", "[sensors.unmodelled]\nlever_arm = [0.0, 0.0, 1e4]\n[gains]"),
        "lever_arm must not be longer than 100 m, got 10000",
        "$.sensors.unmodelled",
        id="antenna in the next town",
    ),
    pytest.param(
        edited("[gains]", "[sensors.unmodelled]\ndropout_probability = 1.0\n[gains]"),
        "dropout_probability must lie between 0 and 1, 1 excluded, got 1",
        "$.sensors.unmodelled",
        id="no range ever",
    ),
    pytest.param(
        edited("[gains]", "[sensors.unmodelled]\nhum = 1.0\n[gains]"),
        "unknown field `hum`",
        "$.sensors.unmodelled",
        id="unknown effect",
    ),
    pytest.param(
        edited("duration = 20.0", "duration = 600").replace("imu_rate = 200.0", "imu_rate = 1e4"),
        "duration × rate must not exceed 2000000 samples, got 6000000",
        NO_PLACE,
        id="too many samples",
    ),
    pytest.param(
        edited("window = 6.0", "window = 20"),
        "window must be shorter than the duration, got 20 s",
        NO_PLACE,
        id="window",
    ),
    pytest.param(
        edited("window = 6.0", "window = 0.01"), "window must lie between 0.05", "$.requirement", id="no window"
    ),
    pytest.param(
        edited("window = 6.0", "window = 0.05").replace("_rate = 200.0", "_rate = 50.0").replace("= 16.0", "= 9.0"),
        "requirement.window must be at least 4 IMU samples long, got 2.5",
        NO_PLACE,
        id="window between two samples",
    ),
    pytest.param(
        edited("frequency = 8.0", "frequency = 629"),
        "path: 629 rad/s is faster than the IMU can sample",
        NO_PLACE,
        id="aliased",
    ),
    pytest.param(
        edited("frequency = 0.1", "frequency = 700"),
        "angular_velocity: 700 rad/s is faster",
        NO_PLACE,
        id="aliased turning",
    ),
    pytest.param(
        edited("frequency = 8.0", "frequency = 0"), "frequency must lie between", "$.path.tones[0]", id="no tone"
    ),
    pytest.param(edited("q = 5000.0", "q = 0.0"), "q must lie between 0.001 and 100000", "$.gains.riccati", id="q = 0"),
    pytest.param(
        edited("xi = 0.001", "xi = 0.0"), "v.xi must lie between 1e-06 and 100", "$.gains.riccati", id="v = 0"
    ),
    pytest.param(edited("k1 = 4.0", "k1 = -4.0"), "k1 must lie between", "$.gains.attitude", id="negative k1"),
    pytest.param(
        edited("[guess]", "[gains.attitude.schedule]\nsteady = 5.0\n[guess]"),
        "schedule.steady must not exceed k1 (4), got 5",
        "$.gains.attitude",
        id="schedule upside down",
    ),
    pytest.param(edited("_axis = [0.0", "_axis = [1e200"), "must be shorter than 1e9", "$.guess", id="axis too long"),
    pytest.param(edited("_angle = 1.57", "_angle = 15.7"), "attitude_angle must lie in", "$.guess", id="angle over π"),
    pytest.param(
        edited("seed = 1", "seed = -1"), "seed must lie between 0 and 2^53, got -1", NO_PLACE, id="negative seed"
    ),
    pytest.param(edited("seed = 1", "seed = " + "9" * 5000), "digits", NO_PLACE, id="integer of 5000 digits"),
    pytest.param(
        edited("duration = 20.0", "duration = " + "9" * 400), "out of range", "$.duration", id="beyond floats"
    ),
    pytest.param(edited("title = ", 'title = ""\nstory = '), "", NO_PLACE, id="key twice"),
    pytest.param(re.sub("title = .*", 'title = ""', PAPER_TEXT), "title must have 1 to 80", NO_PLACE, id="empty title"),
    pytest.param(
        edited("initial_rotation = [0.0", "initial_rotation = [7.0"), "at most 2π rad", NO_PLACE, id="turned twice"
    ),
    pytest.param(edited("[path]", "[path"), "at line 9, column 6", NO_PLACE, id="broken TOML"),
    pytest.param("title = ", "Invalid value", NO_PLACE, id="cut off"),
    pytest.param("", "missing required field `title`", NO_PLACE, id="empty"),
    pytest.param("a = " + "[" * 50_000, "nested too deeply", NO_PLACE, id="deep arrays"),
    pytest.param("a = " + "{b = " * 50_000, "nested too deeply", NO_PLACE, id="deep tables"),
    pytest.param('"a\\nb" = 1', "unknown field `a b`", NO_PLACE, id="line end in a key"),
]


@pytest.mark.parametrize(("text", "rule", "place"), REFUSALS)
def test_a_bad_preset_is_refused_in_one_sentence_that_names_file_rule_and_field(text, rule, place):
    sentence = refusal(text)
    assert sentence is not None
    assert sentence.startswith("eight.toml: ")
    assert rule in sentence
    assert sentence.endswith(f" - at `{place}`") if place else " - at " not in sentence
    assert "\n" not in sentence
    assert len(sentence) < 250


@settings(max_examples=200)
@given(st.text())
def test_no_text_whatever_raises_anything_but_a_sentence(text):
    sentence = refusal(text)
    assert sentence is None or (sentence.startswith("eight.toml: ") and "\n" not in sentence)


@settings(max_examples=200)
@given(
    st.sampled_from(NAMES),
    st.lists(
        st.tuples(
            st.floats(0, 1),
            st.integers(0, 25),
            st.sampled_from([*TOML_FRAGMENTS, "[[path.tones]]"]) | st.text(max_size=3),
        ),
        min_size=1,
        max_size=3,
    ),
)
def test_a_shipped_file_damaged_anywhere_is_read_or_refused_in_one_sentence(name, damages):
    text = preset.dumps(SHIPPED[name])
    for where, length, replacement in damages:
        start = int(where * len(text))
        text = text[:start] + replacement + text[start + length :]
    sentence = refusal(text)
    assert sentence is None or (sentence.startswith("eight.toml: ") and "\n" not in sentence)


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("binary.toml", b'title = "\xff\xfe"', "binary.toml: not UTF-8 text (byte 9)"),
        ("huge.toml", b"#" * 1_000_001, "huge.toml: larger than 1000000 bytes, which no preset is"),
        ("broken.toml", b"title", "broken.toml: "),
    ],
)
def test_a_file_that_is_no_preset_is_refused_by_its_name(tmp_path, name, content, sentence):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ValueError, match="^" + re.escape(sentence)):
        preset.load(tmp_path / name)


def test_what_is_no_file_is_refused_by_its_name(tmp_path):
    (tmp_path / "folder.toml").mkdir()
    long = "a" * 5000 + ".toml"
    for path, rule in [
        ("none.toml", "no such file"),
        ("folder.toml", "not a file"),
        ("", "not a file"),
        (long, "too long"),
    ]:
        with pytest.raises(ValueError, match=rule) as refused:
            preset.load(tmp_path / path)
        assert str(refused.value).startswith(str(tmp_path / path))


def test_a_file_one_may_not_read_is_refused_by_its_name(tmp_path, monkeypatch):
    def forbidden(path):
        raise PermissionError(13, "Permission denied", str(path))

    (tmp_path / "secret.toml").touch()
    monkeypatch.setattr(Path, "read_bytes", forbidden)  # root, who runs most gates, may read everything
    with pytest.raises(ValueError, match=r"secret.toml: cannot be read: Permission denied"):
        preset.load(tmp_path / "secret.toml")


@pytest.mark.parametrize("name", ["papper", "", "PAPER", "paper\x00", "circle "])
def test_an_unknown_name_is_answered_with_the_shipped_ones(name):
    sentence = f"{name}: no such preset; shipped are barrel, circle, eight-repaired, "
    with pytest.raises(ValueError, match="^" + re.escape(sentence)):
        preset.load(name)


@pytest.mark.parametrize("name", NAMES)
def test_a_shipped_preset_delivers_what_it_promises(name):
    """observable: rank 13 on every window, μ and σ as required; weak: all but σ; unobservable: a rank below 13."""
    p = SHIPPED[name]
    analysed = analyse(p)
    if p.expect != "unobservable":
        assert analysed.rank == 13
        assert analysed.verdict.word == p.expect
        assert analysed.mu >= p.requirement.mu
        assert analysed.bound_for_all_t is not None
        assert analysed.bound_for_all_t >= 0.9 * p.requirement.mu  # the grid's bound gives away at most 5 percent
    else:
        assert analysed.rank < 13
        assert analysed.verdict.word == "blind"
        assert analysed.directions


def test_the_figures_in_the_stories_are_true():
    def thrust_to_weight(p):
        moved = motion.simulate(
            p.path, p.angular_velocity, world=p.world, initial_rotation=p.initial_rotation, duration=5.0, rate=1000.0
        )
        return motion.limits(moved, world=p.world).thrust_to_weight

    fast, slow = SHIPPED["paper"], SHIPPED["paper-slow"]
    assert "14.9 times the weight" in fast.story
    assert round(thrust_to_weight(fast), 1) == 14.9
    assert "1.8 times the weight" in slow.story
    assert round(thrust_to_weight(slow), 1) == 1.8
    assert "16 384 times less excitation per period" in slow.story
    assert slow.path == signals.slowed(fast.path, 4.0)
    mu = [excitation.eigenvalues(p.path, np.array([0.0]), present(p.path.period))[0, 0] for p in (fast, slow)]
    assert mu[0] / mu[1] == pytest.approx(16384, rel=1e-9)
    assert 4**7 == 16384


def test_the_papers_scenario_is_the_papers():
    p = SHIPPED["paper"]
    t = np.linspace(0, 3, 31)
    position = np.stack(
        [np.cos(8 * t), 0.3 * np.sin(16 * t + np.pi / 12), -np.sqrt(3) / 4 * np.sin(16 * t - np.pi / 9)], axis=-1
    )
    turning = np.stack([np.sin(0.1 * t + np.pi), 0.5 * np.sin(0.2 * t), 0.1 * np.sin(0.3 * t + np.pi / 3)], axis=-1)
    np.testing.assert_allclose(p.path(t), position, atol=1e-13)
    assert not isinstance(p.angular_velocity, Flown)
    np.testing.assert_allclose(p.angular_velocity(t), turning, atol=1e-14)
    assert (p.world.gravity, p.world.anchor) == ((0.0, 0.0, 9.81), (0.0, 0.0, 0.0))
    np.testing.assert_allclose(p.world.magnetic, np.array([1, 0, 1]) / np.sqrt(2), rtol=1e-15)
    assert p.initial_rotation == (0.0, math.pi / 2, 0.0)
    assert p.guess.state == "zero"
    # R̂(0) = I: the attitude error R(0)R̂(0)ᵀ is R(0) itself, a quarter turn about e2
    assert (p.guess.attitude_axis, p.guess.attitude_angle) == ((0.0, 1.0, 0.0), math.pi / 2)
    assert p.sensors.noise.mag**2 == pytest.approx(1e-2)


def test_the_implied_path_has_the_printed_initial_values_and_stays_in_one_plane():
    path = SHIPPED["paper-implied"].path
    zero = np.array(0.0)
    # the paper prints p(0) = (1, 0, 0) and v(0) = (-.0125, 2.5, -4.33), to three digits or so
    np.testing.assert_allclose(path(zero), [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(path(zero, 1), [-0.0125, 2.5, -4.33], atol=0.013)
    t = np.linspace(0, 2, 50)
    assert np.abs(path(t) @ [0, math.sqrt(3), 1]).max() < 1e-15


@pytest.mark.parametrize("name", NAMES)
def test_titles_and_stories_are_for_reading(name):
    p = SHIPPED[name]
    assert p.title[0].isupper()
    assert p.story.endswith(".")
    assert "\n" not in p.title + p.story


@pytest.mark.parametrize(
    ("title", "match"),
    [
        ("", "title must have 1 to 80 printable characters, got none"),
        ("   ", "title must have 1 to 80 printable characters, got blanks only"),
        ("x" * 81, "title must have 1 to 80 printable characters, got 81"),
        ("a\x00b", r"mark of writing direction: got U\+0000 at character 2"),
        ("two\nlines", r"line end.*: got U\+000A at character 4"),
        ("\u202edesrever", r"mark of writing direction: got U\+202E at character 1"),
        ("two\u2028lines", r"got U\+2028 at character 4"),
    ],
)
def test_a_title_that_cannot_be_shown_as_it_is_is_refused_from_a_file_in_the_words_of_the_pages_box(title, match):
    from explorer.storage.catalog import checked_title

    text = preset.dumps(preset.load("soft"))
    damaged = msgspec.toml.encode(msgspec.toml.decode(text) | {"title": title}).decode()
    with pytest.raises(ValueError, match=match) as from_file:
        preset.loads(damaged, source="x.toml")
    with pytest.raises(ValueError, match=match) as from_box:
        checked_title(title)
    if title.strip():
        assert str(from_file.value).startswith(f"x.toml: {from_box.value}")


def test_a_title_may_have_any_script_and_any_blank():
    for title in ("Süd « Tour » 1", "北 — 南", "é̂ ∫p⁗"):
        shown = msgspec.structs.replace(preset.load("soft"), title=title)
        assert preset.loads(preset.dumps(shown), source="x.toml") == shown
