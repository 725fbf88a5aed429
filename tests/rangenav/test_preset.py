"""Presets: written and read without loss, and true in what they promise."""

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
    title=st.text(min_size=1, max_size=preset.MAX_TITLE).filter(lambda title: title.isprintable() and title.strip()),
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


@pytest.mark.parametrize("name", NAMES)
def test_every_shipped_preset_loads_and_is_written_as_it_is_shipped(name):
    text = preset.find(name).read_text(encoding="utf-8")
    assert preset.dumps(preset.load(name)) == text
    assert preset.load(preset.find(name)) == SHIPPED[name]


def test_the_shipped_presets_are_those_of_the_table_in_the_documentation():
    table = (ROOT / "docs" / "presets.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"^\| `([a-z-]+)` \|", table, flags=re.MULTILINE)) == NAMES


@settings(max_examples=60)
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
    assert "frequency = 8.0" in PAPER_TEXT
    text = PAPER_TEXT.replace("frequency = 8.0", "frequency = 8").replace("duration = 20.0", "duration = 20")
    assert preset.loads(text, source="p") == SHIPPED["paper"]


def test_what_a_preset_leaves_out_takes_the_documented_defaults():
    minimal = 'title = "x"\n[path]\nkind = "multisine"\n[angular_velocity]\nkind = "multisine"\n'
    expected = Preset(title="x", path=Multisine(), angular_velocity=Multisine())
    assert preset.loads(minimal, source="p") == expected
    assert (expected.duration, expected.sensors.imu_rate, expected.requirement.window) == (20.0, 200.0, 6.0)


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
