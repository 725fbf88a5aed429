"""The rank of slow and long motions: decided by what polynomials leave of the 13 functions, against 60 digits."""

import numpy as np
import pytest
from msgspec.structs import replace

from rangenav import analysis, preset
from rangenav.inputs import Vec3
from rangenav.motion import World
from rangenav.observability import accuracy, functions, gramian_rank, rows, spectrum
from rangenav.preset import Preset, Requirement
from rangenav.sensors import Noise, Sensors
from rangenav.signals import Formula, Multisine, Signal, rotated
from tests.support import precise_rank
from tests.support.precise_rank import circle, motions, tones

GRAVITY: Vec3 = (0.0, 0.0, 9.81)
ANCHOR: Vec3 = (0.0, 0.0, 0.1)


INDOORS = Multisine(tones=tones(("x", 0.4, 0.1, 0.0), ("y", 0.3, 0.2, 0.0), ("z", 0.1, 0.25, 0.0)), offset=(0, 0, 1.0))
"""m, over 60 s: a beacon that drifts through a room."""
VEHICLE = Multisine(
    tones=tones(("x", 60.0, 0.02, 0.0), ("y", 40.0, 0.04, 0.0), ("z", 8.0, 0.05, 0.0)), offset=(0, 0, -20)
)
"""m, over 300 s: an underwater vehicle that dives and rises while it flies an eight."""
PLANAR = Multisine(tones=VEHICLE.tones[:2], offset=VEHICLE.offset)


def rank_of(path: Signal, start: float, window: float, gravity: Vec3 = GRAVITY) -> int:
    return int(spectrum.window_spectra(path, gravity, np.array([start]), window).rank[0])


@pytest.mark.parametrize(("path", "window"), [(INDOORS, 60.0), (VEHICLE, 300.0)], ids=["indoors", "vehicle"])
def test_slow_motions_of_three_frequencies_have_rank_13_and_no_relation(path: Multisine, window: float):
    for start in (0.0, 17.0, 150.0):
        assert precise_rank.rank(path, GRAVITY, start, window) == 13
        seen = functions.functions(path, GRAVITY, start, window)
        assert (seen.rank, seen.relations, seen.unseen) == (13, (), ())


@pytest.mark.parametrize("window", [0.2, 6.0, 60.0, 600.0])
def test_the_rank_is_that_of_60_digits_on_windows_of_every_length(window: float):
    rng = np.random.default_rng(int(10 * window))
    for name, path in motions(window, rng).items():
        exact = precise_rank.rank(path, GRAVITY, 0.37 * window, window)
        assert rank_of(path, 0.37 * window, window) == exact, name


def test_cubics_in_time_count_their_own_powers():
    """D_x = τ³ adds τ⁴ and τ⁵, and the fall along z adds τ⁴ once more: 4 + 2 of 13, 4 + 1 without the cubic."""
    cubic = Formula(x="0.2*t**3", y="1 - t", z="0.1*t**2")
    for window in (0.5, 6.0, 60.0):
        assert rank_of(cubic, 0.0, window) == 6
        assert rank_of(Formula(x="2*t", y="1 - t", z="0.1*t**2"), 0.0, window) == 5


def test_rounding_of_a_formula_does_not_become_a_motion():
    """(1e5 + sin t) − 1e5 is rounded to 1e-11 m: without its size measured, the planar path has rank 13."""
    path = Formula(x="sin(t)", y="cos(t) + 0.3*sin(2*t)", z="(1e5 + sin(t)) - 1e5")
    assert rank_of(path, 1.0, 8.0) == 11


@pytest.mark.parametrize("gravity", [GRAVITY, (0.0, 0.0, 0.0), (1.0, -2.0, 9.0)])
@pytest.mark.parametrize("moment", ["start", "end"])
def test_the_coordinates_are_the_rows_in_another_basis(gravity: Vec3, moment: rows.Moment):
    """RᵀR = Σ hᵀh once the columns are changed back, and the determinant of the change does not depend on the path."""
    start, window = np.array([0.4, 2.0]), 3.0
    for name in ("lissajous", "trefoil"):
        samples = rows.sample(preset.load(name).path, start, window)
        of = gramian_rank.of(samples, gravity, samples.weight, moment)
        changed = of.triangle @ np.linalg.inv(of.states)
        tau = samples.tau - window if moment == "end" else samples.tau
        reference = start + window if moment == "end" else start
        h = rows.lifted(preset.load(name).path, gravity, reference, tau) / window**spectrum.LIFTED_TIME_POWERS
        gramian = np.einsum("wki,wk,wkj->wij", h, np.broadcast_to(samples.weight, h.shape[:2]), h)
        size = np.sqrt(np.einsum("wii->wi", gramian))
        difference = np.abs(changed.swapaxes(1, 2) @ changed - gramian) / size[:, :, None] / size[:, None, :]
        assert np.nanmax(difference) < 1e-13
        determinant = 0.5 * (1 / 8 * 2 / 3) * (1 / 48 * 2 / 5) * (1 / 16) ** 3
        np.testing.assert_allclose(np.abs(np.linalg.det(of.states)) * determinant, 1.0, rtol=1e-9)


def test_the_rank_does_not_depend_on_the_axes_in_which_gravity_lies():
    turn = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    gravity = tuple((turn @ np.array(GRAVITY)).tolist())
    for path, known in ((INDOORS, 13), (Multisine(tones=circle(("x", "y"), 2.0, 0.2)), 11)):
        assert rank_of(rotated(path, turn, about=(0.0, 0.0, 0.0)), 5.0, 60.0, gravity) == known


@pytest.mark.parametrize(("path", "window"), [(INDOORS, 60.0), (VEHICLE, 300.0)], ids=["indoors", "vehicle"])
def test_the_predicted_error_of_slow_motions_is_that_of_60_digits(path: Multisine, window: float):
    world, rate = World(gravity=GRAVITY, anchor=ANCHOR), 40 / window
    for start in (0.0, 31.0):
        predicted = accuracy.predict(path, world, start, window, sigma=0.05, rate=rate, kind="lifted", at="start")
        witness = precise_rank.sigma(path, GRAVITY, ANCHOR, start, np.arange(41) / rate, 0.05)
        assert predicted.position == pytest.approx(witness, rel=1e-6)


def slow_preset(path: Multisine) -> Preset:
    return Preset(
        title="slow",
        duration=240.0,
        path=path,
        angular_velocity=Multisine(),
        world=World(gravity=GRAVITY, anchor=ANCHOR),
        sensors=Sensors(imu_rate=50.0, mag_rate=50.0, range_rate=20.0, noise=Noise(range=0.05)),
        requirement=Requirement(window=60.0, mu=1e-12, position_sigma=0.5),
    )


def test_a_slow_motion_is_weak_and_its_horizon_is_not_blind():
    slow = slow_preset(INDOORS)
    found = analysis.analyse(slow)
    assert (found.verdict.word, found.rank, found.directions) == ("weak", 13, ())
    assert (found.windows.gramian > found.windows.floor[:, None]).all()
    horizon = analysis.how_long(slow)
    assert horizon.full_rank[1] is not None
    assert horizon.full_rank[1] < 60.0
    assert horizon.rank[-1, 1] == 13


def test_as_many_values_lie_above_floor_and_tolerance_as_the_rank_says():
    for path, window in ((INDOORS, 60.0), (PLANAR, 300.0), (preset.load("hover").path, 6.0)):
        spectra = spectrum.window_spectra(path, GRAVITY, np.linspace(0.0, 100.0, 7), window)
        assert (np.sum(spectra.eigenvalues > spectra.floor[:, None], axis=1) == spectra.rank).all()
        assert (np.sum(spectra.scaled > spectra.tolerance[:, None], axis=1) == spectra.rank).all()
        assert (np.diff(spectra.scaled, axis=1) <= 1e-12 * spectra.scaled[:, :1]).all()


def test_an_hour_of_pings_every_ten_seconds_is_judged():
    dive = slow_preset(VEHICLE)
    sensors = Sensors(imu_rate=10.0, mag_rate=10.0, range_rate=0.1, noise=Noise(range=0.5))
    dive = replace(dive, duration=3600.0, sensors=sensors, requirement=Requirement(window=600.0, mu=1e-12))
    assert analysis.analyse(dive).rank == 13
    with pytest.raises(ValueError, match=r"range_rate must lie between 0\.1 and 10000 Hz, got 0\.05"):
        replace(sensors, range_rate=0.05)


@pytest.mark.parametrize("window", [50.0, 300.0, 600.0])
def test_what_a_planar_path_does_not_show_has_its_name_on_windows_of_every_length(window: float):
    """Height and climb, unseen with ξ₃ and ξ₄: in units of 600 s, 1 m of height is 2e-7 of that change of the state."""
    seen = functions.functions(PLANAR, GRAVITY, 0.0, window)
    assert seen.relations == ("D_z = −9.81 τ²/2", "τ D_z = −29.4 τ³/6")
    assert seen.unseen == ("p_z +1 m with ξ₃ +9.81 m²/s²", "v_z +1 m/s with ξ₄ +29.4 m²/s³")
    samples = rows.sample(PLANAR, np.zeros(1), window)
    told = accuracy.along(samples, World(anchor=ANCHOR), sigma=0.1, rate=1.0, kind="lifted")[0]
    assert np.isnan(told[:2]).all()
    assert np.isfinite(told[2])
