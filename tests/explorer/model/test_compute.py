"""From settings to a picture: stages cached by their own inputs, switches that change what they claim."""

import gc
import weakref
from dataclasses import fields, is_dataclass

import msgspec
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from explorer.model import compute as stages
from explorer.model.compute import Picture, compute
from explorer.model.settings import Printed, Settings, effective
from rangenav import attitude, cascade, model, motion, preset, record, so3
from rangenav.analysis import worst_windows
from rangenav.motion import World
from rangenav.preset import Preset, Requirement
from rangenav.sensors import Effects, Noise, Sensors
from rangenav.signals import Multisine, Tone
from rangenav.signals.multisine import LETTERS

pytestmark = pytest.mark.slow


replace = msgspec.structs.replace
SLOW = preset.load("paper-slow")
BASE = Settings(preset=SLOW)


@pytest.fixture(scope="module")
def base_picture():
    """The picture of these settings; not made while tests are collected, which every worker does."""
    return compute(BASE)


def changed(path, value, base=BASE):
    """The settings with one field of the preset, given as a dotted path, replaced."""

    def put(struct, names):
        name, *rest = names
        return replace(struct, **{name: put(getattr(struct, name), rest) if rest else value})

    return replace(base, preset=put(base.preset, path.split(".")))


LATER = {"phi", "phi_printed", "printed_excitation", "reduced_min"}
"""Parts of a picture that are computed when they are read."""


def complete(settings):
    """A picture whose parts have all been read."""
    picture = compute(settings)
    for name in LATER:
        getattr(picture, name)
    return picture


def same(a, b):
    """Equal to the last bit, through dataclasses and arrays; NaN equals NaN."""
    if is_dataclass(a):
        return all(same(getattr(a, field.name), getattr(b, field.name)) for field in fields(a))
    if isinstance(a, np.ndarray):
        return np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
    if isinstance(a, tuple):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b, strict=True))
    return a == b or (a != a and b != b)


def different(picture, reference):
    """Names of the fields of two pictures that differ, apart from the settings themselves."""
    names = {field.name for field in fields(Picture)} | LATER
    names -= {"settings"}
    return {name for name in names if not same(getattr(picture, name), getattr(reference, name))}


def parts(picture):
    """One array of each stage in the list of `explorer.model.compute`, which no other stage computes."""
    return {
        "motion": picture.motion.position,
        "attitude": picture.motion.rotation,
        "gramian": picture.analysis.windows.gramian,
        "excitation": picture.analysis.windows.excitation,
        "accuracy": picture.analysis.windows.sigma_lifted,
        "printed": picture.printed_excitation,
        "measurements": picture.measurements.range,
        "estimate": picture.estimate.state,
    }


STAGES = {"motion", "attitude", "gramian", "excitation", "accuracy", "printed", "measurements", "estimate"}
TRUTH = {"motion", "measurements", "estimate", "printed"}
RECOMPUTED = [
    ("gains.riccati.q", 100.0, {"estimate"}),
    ("gains.attitude.k1", 1.0, {"estimate"}),
    ("gains.mode", "noise-matched", {"estimate"}),
    ("guess.state", "truth", {"estimate"}),
    ("seed", 2, {"measurements", "estimate"}),
    ("sensors.noise.gyro", 0.02, {"measurements", "estimate"}),
    ("sensors.noise.range", 0.2, {"measurements", "estimate", "accuracy"}),
    ("sensors.range_rate", 25.0, {"measurements", "estimate", "accuracy"}),
    ("sensors.noise.imu_unit", "density", {"measurements", "estimate"}),
    ("sensors.unmodelled.gyro_bias", (0.01, 0.0, 0.0), {"measurements", "estimate"}),
    ("sensors.unmodelled.outlier_probability", 0.1, {"measurements", "estimate"}),
    ("sensors.unmodelled.dropout_probability", 0.1, {"measurements", "estimate", "accuracy"}),
    ("requirement.window", 5.0, {"gramian", "excitation", "accuracy", "printed"}),
    ("requirement.mu", 2.0, {"accuracy"}),
    ("world.anchor", (0.0, 0.0, 1.0), TRUTH | {"accuracy"}),
    ("world.magnetic", (1.0, 0.0, 0.0), TRUTH | {"accuracy"}),
    ("initial_rotation", (0.1, 0.0, 0.0), TRUTH | {"attitude"}),
    ("angular_velocity", Multisine(offset=(0.0, 0.0, 1.0)), TRUTH | {"attitude"}),
    ("path", preset.load("soft").path, STAGES - {"attitude"}),
    ("world.gravity", (0.0, 0.0, 3.7), STAGES - {"attitude"}),
    ("duration", 15.0, STAGES),
    ("title", "another name", set()),
]


@pytest.fixture(autouse=True)
def moving():
    """No picture of another test is at rest: its windows would be kept."""
    stages.AT_REST.clear()


def test_a_picture_at_rest_is_freed_with_its_last_user():
    resting = compute(changed("gains.riccati.q", 123.0)).at_rest
    assert resting.at_rest is resting
    alive = weakref.ref(resting)
    gc.disable()
    del resting
    freed = alive() is None
    gc.enable()
    assert freed


def test_a_gain_keeps_the_windows_of_a_picture_at_rest_and_a_path_does_not():
    resting = compute(BASE).at_rest
    riccati = replace(SLOW.gains.riccati, q=2 * SLOW.gains.riccati.q)
    assert compute(changed("gains.riccati", riccati)).analysis is resting.analysis
    assert len(compute(changed("world.anchor", (1.0, 2.0, 3.0))).analysis.windows.start) == stages.MOVING_WINDOWS


def forget():
    """Empty every cache, as in a new process."""
    for module in (stages, worst_windows, motion, record):
        for function in vars(module).values():
            if hasattr(function, "cache_clear"):
                function.cache_clear()


def test_the_same_settings_are_not_computed_twice():
    before, after = parts(compute(BASE)), parts(compute(BASE))
    assert all(before[stage] is after[stage] for stage in STAGES)


@pytest.mark.parametrize(("path", "value", "expected"), RECOMPUTED, ids=[path for path, _, _ in RECOMPUTED])
def test_a_change_recomputes_only_the_stages_that_depend_on_it(path, value, expected):
    forget()  # what other tests have pushed out of an inner cache would count as recomputed
    before = parts(compute(BASE))
    after = parts(compute(changed(path, value)))
    assert {stage for stage in STAGES if after[stage] is not before[stage]} == expected


@pytest.mark.parametrize(("path", "value", "expected"), RECOMPUTED, ids=[path for path, _, _ in RECOMPUTED])
def test_no_stage_keeps_an_old_result(path, value, expected):
    """The cached picture is the one that empty caches give."""
    complete(BASE)
    cached = complete(changed(path, value))
    forget()
    fresh = compute(changed(path, value))
    summary = {"summary"}  # holds the microseconds that the run took
    assert different(cached, fresh) <= summary
    assert same(cached.summary.steady_position, fresh.summary.steady_position)


SWITCHES = [
    ("model", {"estimate", "errors", "position_estimate", "summary"}),
    ("excitation", {"printed_excitation", "reduced_min"}),
    ("reduced_row", {"reduced_min"}),
    ("body_axes", {"printed_excitation", "reduced_min"}),
    ("attitude_rate", {"attitude_time_constants"}),
]


@pytest.mark.parametrize(("switch", "claimed"), SWITCHES)
def test_each_printed_switch_changes_what_it_claims_and_nothing_else(switch, claimed):
    reference = compute(BASE)
    assert different(compute(replace(BASE, printed=Printed(**{switch: True}))), reference) == claimed


def test_printed_initial_values_move_the_truth_and_leave_attitude_and_excitation():
    reference = compute(BASE)
    drifting = compute(replace(BASE, printed=Printed(initial_values=True)))
    assert drifting.preset != reference.preset
    np.testing.assert_array_equal(drifting.motion.position[0], [1.0, 0.0, 0.0])
    np.testing.assert_array_equal(drifting.phi, reference.phi)
    np.testing.assert_array_equal(drifting.analysis.windows.excitation, reference.analysis.windows.excitation)
    # the Gramian knows neither start nor drift: MATH, "path and gravity only"
    np.testing.assert_array_equal(drifting.analysis.windows.gramian, reference.analysis.windows.gramian)
    assert drifting.analysis.lifted_end.position > 10 * reference.analysis.lifted_end.position  # far from the anchor


def test_the_printed_attitude_rate_doubles_the_time_constants():
    printed = compute(replace(BASE, printed=Printed(attitude_rate=True))).attitude_time_constants
    np.testing.assert_array_equal(printed, 2 * compute(BASE).attitude_time_constants)
    np.testing.assert_array_equal(
        compute(BASE).attitude_time_constants, attitude.time_constants(SLOW.gains.attitude, SLOW.world)
    )


def test_the_printed_model_is_a_metre_off_where_the_derived_one_is_not():
    derived, printed = (
        compute(replace(BASE, printed=Printed(model=on))).summary.steady_position for on in (False, True)
    )
    assert derived < 0.3
    assert printed > 1.0


def test_the_printed_excitation_certifies_a_hover_that_turns():
    hover = Settings(preset=preset.load("hover"))
    right, wrong = (compute(replace(hover, printed=Printed(excitation=on, body_axes=on))) for on in (False, True))
    assert np.abs(right.printed_excitation).max() < 1e-20  # no motion, no snap
    assert wrong.printed_excitation[:, 0].min() > 1e-3  # positive on every window, although the range is constant
    assert right.analysis.verdict.word == wrong.analysis.verdict.word == "blind"


def test_body_axes_certify_a_planar_circle_flown_by_a_tumbling_vehicle():
    tumbling = Multisine(
        tones=tuple(Tone(axis=a, amplitude=1.5, frequency=w) for a, w in zip(LETTERS, (1.0, 1.3, 0.7), strict=True))
    )
    circle = changed("angular_velocity", tumbling, Settings(preset=preset.load("circle")))
    inertial, body = (compute(replace(circle, printed=Printed(body_axes=on))) for on in (False, True))
    largest = inertial.printed_excitation.max()
    assert np.abs(inertial.printed_excitation[:, 0]).max() < 1e-12 * largest
    assert body.printed_excitation[:, 0].min() > 0.01 * largest


def test_the_reduced_pair_misses_the_planar_circle_unless_it_is_misprinted():
    circle = Settings(preset=preset.load("circle"))
    right = compute(circle).reduced_min
    wrong = compute(replace(circle, printed=Printed(excitation=True, reduced_row=True, body_axes=True))).reduced_min
    assert right < 1e-20
    assert wrong > 1e-6


def test_without_switches_the_sampled_excitation_is_the_exact_one(base_picture):
    """The trapezoid over 5 ms of signals with the double frequency 8 rad/s: (8·5ms)²/12 per oscillating part."""
    windows = base_picture.analysis.windows
    np.testing.assert_allclose(
        base_picture.printed_excitation, windows.excitation, atol=2e-3 * windows.excitation.max()
    )


def test_snap_in_body_axes_is_the_derived_phi_and_the_printed_one_is_its_misprint():
    """φ = ä + 2ω×ȧ + ω̇×a + ω×(ω×a), with ȧ and ä from central differences of the accelerometer's signal."""
    sensors = Sensors(imu_rate=1000.0, mag_rate=200.0)
    tumbling = Multisine(
        tones=tuple(
            Tone(axis=a, amplitude=1.0, frequency=w, phase=1.0) for a, w in zip(LETTERS, (1.0, 1.3, 0.7), strict=True)
        )
    )
    picture = compute(changed("angular_velocity", tumbling, changed("sensors", sensors, changed("duration", 7.0))))
    moved, h = picture.motion, 1e-3
    a, w, w_rate = (x[1:-1] for x in (moved.apparent_acceleration, moved.angular_velocity, moved.angular_acceleration))
    before, after = moved.apparent_acceleration[:-2], moved.apparent_acceleration[2:]
    rate, second = (after - before) / (2 * h), (after - 2 * a + before) / h**2
    derived = second + 2 * np.cross(w, rate) + np.cross(w_rate, a) + np.cross(w, np.cross(w, a))
    printed = second - np.cross(w, rate) - 2 * np.cross(w, np.cross(w, a))
    # differences of signals up to 5 rad/s: (5·1ms)²/6 of 150 m/s⁴, and rounding 1e-15/h²
    np.testing.assert_allclose(picture.phi[1:-1], derived, atol=1e-3)
    np.testing.assert_allclose(picture.phi_printed[1:-1], printed, atol=1e-3)
    assert np.abs(derived - printed).max() > 1  # they are not the same by accident


@pytest.mark.parametrize("name", ["paper-slow", "circle", "hover"])
def test_all_parts_of_a_picture_belong_to_each_other(name):
    p = preset.load(name)
    picture = compute(Settings(preset=p))
    moved, estimate, n = picture.motion, picture.estimate, len(picture.motion.time)
    assert len(estimate.time) == len(picture.errors.position) == len(picture.phi) == n
    assert picture.preset == p
    rows = np.arange(0, n, 371)
    for k in rows:
        R, R_hat = moved.rotation[k], estimate.rotation[k]
        np.testing.assert_allclose(picture.phi[k], R.T @ moved.snap[k], atol=1e-9)
        position = np.asarray(p.world.anchor) + R_hat @ estimate.state[k, 4:7]
        np.testing.assert_allclose(picture.position_estimate[k], position, atol=1e-12 * (1 + np.abs(position).max()))
        body_error = estimate.state[k, 4:7] - R.T @ (moved.position[k] - np.asarray(p.world.anchor))
        assert picture.errors.position[k] == pytest.approx(np.linalg.norm(body_error), rel=1e-9, abs=1e-12)
        assert picture.errors.attitude[k] == pytest.approx(so3.angle(R @ R_hat.T), abs=1e-12)
    tail = picture.errors.position[3 * n // 4 :]
    assert picture.summary.steady_position == pytest.approx(np.sqrt(np.mean(tail**2)))
    assert picture.summary.final_position == picture.errors.position[-1]
    assert picture.summary.peak_position == picture.errors.position.max()
    assert picture.limits.speed == np.linalg.norm(moved.velocity, axis=-1).max()


def test_the_estimate_is_the_cascades_own(base_picture):
    z = base_picture.measurements
    start = cascade.start(
        SLOW.guess,
        state=model.true_state(base_picture.motion, world=SLOW.world)[0],
        rotation=base_picture.motion.rotation[0],
        world=SLOW.world,
    )
    setting = cascade.ObserverConfig(world=SLOW.world, sensors=SLOW.sensors, gains=SLOW.gains)
    np.testing.assert_array_equal(cascade.observe(z, start, setting).state, base_picture.estimate.state)


def test_slowing_the_papers_path_four_times_gives_the_picture_of_paper_slow():
    scaled = compute(Settings(preset=replace(SLOW, path=preset.load("paper").path), time_scale=4.0))
    assert different(scaled, compute(BASE)) == set()


def test_a_window_with_too_much_in_it_is_refused_in_one_sentence():
    path = Multisine(tones=(Tone(axis="x", amplitude=0.01, frequency=620.0),))
    with pytest.raises(
        ValueError, match=r"^requirement.window must be at most 1.86 s for tones of 620 rad/s, got 19 s$"
    ):
        replace(SLOW, path=path, requirement=Requirement(window=19.0))


def test_warming_up_reports_progress_from_start_to_end():
    reports = []
    stages.compile_kernels(lambda share, what: reports.append((share, what)))
    shares = [share for share, _ in reports]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert all(isinstance(what, str) and what for _, what in reports)


vectors = st.tuples(*[st.floats(-4, 4)] * 3)
multisines = st.builds(
    Multisine,
    tones=st.lists(
        st.builds(
            Tone,
            axis=st.sampled_from("xyz"),
            amplitude=st.floats(-1e4, 1e4) | st.floats(-2, 2),
            frequency=st.floats(0.01, 30),
        ),
        max_size=3,
    ).map(tuple),
    offset=vectors,
    drift=vectors,
)
anything = st.builds(
    Preset,
    title=st.just("anything"),
    duration=st.floats(1.5, 4),
    seed=st.integers(0, 9),
    path=multisines,
    angular_velocity=multisines,
    world=st.builds(World, anchor=vectors),
    sensors=st.builds(
        Sensors,
        imu_rate=st.floats(20, 200),
        mag_rate=st.floats(1, 20),
        range_rate=st.floats(1, 300),
        noise=st.builds(Noise, range=st.sampled_from([0.0, 1e-9, 0.1, 1e3]), accel=st.floats(0.01, 1e3)),
        unmodelled=st.builds(
            Effects,
            outlier_probability=st.floats(0, 0.9),
            outlier_size=st.floats(0, 1e3),
            dropout_probability=st.sampled_from([0.0, 0.5, 0.999]),
            burst_length=st.sampled_from([0.0, 1.0, 100.0]),
            lever_arm=vectors.map(lambda v: tuple(x / 100 for x in v)),
        ),
    ),
    requirement=st.builds(Requirement, window=st.floats(0.2, 1.4)),
)


def refusal(chosen):
    """Why a time scale or the printed start cannot be applied to a path, None if they can."""
    try:
        effective(chosen)
    except ValueError as error:
        return str(error)
    return None


@settings(max_examples=40)
@given(anything, st.floats(0.5, 10), st.builds(Printed, **dict.fromkeys(Printed.__struct_fields__, st.booleans())))
def test_any_valid_choice_gives_a_picture_with_finite_truth_and_excitation_and_no_warning(p, scale, printed):
    chosen = Settings(preset=p, time_scale=scale, printed=printed)
    assume(refusal(chosen) is None)
    picture = compute(chosen)
    assert np.isfinite(picture.motion.snap).all()
    assert np.isfinite(picture.analysis.windows.gramian).all()
    assert (picture.analysis.windows.gramian >= 0).all()
    assert picture.analysis.mu >= 0
    assert np.isfinite(picture.measurements.range).all()
    assert len(picture.estimate.innovation) == len(picture.measurements.range)


def test_an_anchor_on_the_path_gives_a_picture():
    """Where the range is zero it has no direction: nothing may be divided by it."""
    hover = preset.load("hover").path
    assert isinstance(hover, Multisine)
    for name, anchor in (("hover", hover.offset), ("circle", (1.0, 0.0, 0.0))):
        picture = compute(changed("world.anchor", anchor, Settings(preset=preset.load(name))))
        assert picture.limits.anchor_distance_min < 1e-12
        assert picture.analysis.verdict.word == "blind"


def test_a_flight_without_any_range_gives_a_picture():
    picture = compute(changed("sensors.unmodelled.burst_length", 100.0))
    assert len(picture.measurements.range) == len(picture.estimate.innovation) == 0
    assert picture.summary.diverged


def test_fewer_ranges_than_unknowns_in_a_window_determine_nothing_and_break_nothing():
    picture = compute(changed("sensors.range_rate", 1.0))  # seven ranges in six seconds, for 13 unknowns
    assert np.isnan(picture.analysis.lifted_end.position)
