"""Each compiled kernel against plain numpy, and the sign of P over a million steps at every corner of the sliders."""

import itertools
from typing import Literal

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rangenav import model, preset, reference, riccati
from rangenav.attitude import AttitudeGains, Schedule
from rangenav.cascade import Sample, begin, observe
from rangenav.gains import Gains
from rangenav.kernels import cache, jit, one_sample
from rangenav.kernels import cascade as cascade_kernel
from rangenav.kernels import riccati as kernel
from rangenav.kernels import rotation as rot
from rangenav.kernels.layout import CONSISTENCY_TIME
from tests.support import records

pytestmark = pytest.mark.slow


CORNERS = [
    (q, (v,) * 4, np.full(13, p0), symmetric)
    for q, v, p0, symmetric in itertools.product(riccati.Q_RANGE, riccati.V_RANGE, riccati.P0_RANGE, (True, False))
]
MIXED = 4
"""Further corners in which each block has an end of its own range, drawn for each preset."""
MILLION, TENTH, CHECKS = 1_000_000, 100_000, 50
IMU_RATE = 200.0


@jit.kernel
def covariances(P, accel, variance, v, h, symmetric, steps, every, out):
    """Run only the covariance: Strang with ranges at the IMU's rate, or one correction every fourth step."""
    x, row = np.zeros(13), 0
    for k in range(steps):
        i = k % len(accel)
        if symmetric:
            kernel.correct(x, P, 0.0, 2 * variance)
        kernel.add_block_noise(P, v, h / 2)
        kernel.predict_covariance(P, accel[i, 0], accel[i, 1], accel[i, 2], h)
        kernel.add_block_noise(P, v, h / 2)
        if symmetric:
            kernel.correct(x, P, 0.0, 2 * variance)
        elif k % 4 == 0:
            kernel.correct(x, P, 0.0, variance)
        if (k + 1) % every == 0:
            out[row] = P
            row += 1


@pytest.mark.parametrize(
    ("name", "steps"),
    [
        ("circle", MILLION),
        *((name, TENTH) for name in ("hover", "paper", "figure-eight", "wiggle", "barrel", "torus", "hand-held")),
    ],
)
def test_covariance_stays_positive_over_a_million_steps_at_every_corner(name: str, steps: int):
    """A million steps for a blind circle, whose P grows all the time; a tenth for further paths and for the mixed
    corners."""
    p = preset.load(name)
    time = (np.arange(4000) + 0.5) / IMU_RATE
    accel = p.path(time, 2) - np.asarray(p.world.gravity)
    corners = [(steps, *corner) for corner in CORNERS] + [(TENTH, *corner) for corner in mixed_corners(name)]
    for steps, q, v, p0, symmetric in corners:
        rate = IMU_RATE if symmetric else IMU_RATE / 4
        P, out = np.diag(p0).ravel(), np.empty((CHECKS, 169))
        covariances(P, accel, rate / q, v, 1 / IMU_RATE, symmetric, steps, steps // CHECKS, out)
        matrices = out.reshape(-1, 13, 13)
        assert np.isfinite(matrices).all()
        np.testing.assert_array_equal(matrices, np.swapaxes(matrices, -1, -2))
        std = np.sqrt(np.diagonal(matrices, axis1=-2, axis2=-1))
        correlation = matrices / (std[:, :, None] * std[:, None, :])
        least = np.linalg.eigvalsh(correlation)[:, 0].min()
        assert least >= -1e-9, f"q={q:g}, v={v}, p0={p0}, symmetric={symmetric}: {least}"


def mixed_corners(name: str) -> list[tuple]:
    rng = np.random.default_rng(sum(name.encode()))
    return [
        (
            float(rng.choice(riccati.Q_RANGE)),
            tuple(float(v) for v in rng.choice(riccati.V_RANGE, 4)),
            np.repeat(rng.choice(riccati.P0_RANGE, 4), [4, 3, 3, 3]),
            bool(rng.integers(2)),
        )
        for _ in range(MIXED)
    ]


def test_prediction_is_the_matrix_product_it_stands_for():
    rng = np.random.default_rng(1)
    for h in (1e-3, 0.05, 1.0):
        accel, root, x = rng.standard_normal(3) * 10, rng.standard_normal((13, 13)), rng.standard_normal(13)
        phi, integral = model.transition(accel, h, gravity_norm=9.81)
        P = root @ root.T
        flat, moved = P.ravel().copy(), x.copy()
        kernel.predict_covariance(flat, *accel, h)
        kernel.predict_state(moved, *accel, h, model.input_4(9.81))
        expected = phi @ P @ phi.T
        np.testing.assert_allclose(flat.reshape(13, 13), expected, rtol=1e-11, atol=1e-11 * np.abs(expected).max())
        np.testing.assert_allclose(moved, phi @ x + integral, rtol=1e-12, atol=1e-12)


def test_correction_is_the_conditional_distribution_of_a_gaussian():
    rng = np.random.default_rng(2)
    root, x = rng.standard_normal((13, 13)), rng.standard_normal(13)
    P, y, variance = root @ root.T, 0.7, 0.3
    gain = P[:, 0] / (P[0, 0] + variance)
    joseph = np.eye(13) - np.outer(gain, np.eye(13)[0])
    flat, moved = P.ravel().copy(), x.copy()
    innovation, total = kernel.correct(moved, flat, y, variance)
    assert (innovation, total) == pytest.approx((y - x[0], P[0, 0] + variance), rel=1e-14)
    np.testing.assert_allclose(moved, x + gain * (y - x[0]), rtol=1e-12)
    expected = joseph @ P @ joseph.T + variance * np.outer(gain, gain)
    np.testing.assert_allclose(flat.reshape(13, 13), expected, rtol=1e-10, atol=1e-11)


def test_the_reminder_is_the_conditional_distribution_given_a_product():
    """ξ1 − ½|p|² = 0 linearised, in Joseph's form; the variance of ½|e|² and its mean as the docstring has them."""
    rng = np.random.default_rng(3)
    root, x, h = rng.standard_normal((13, 13)) / 4, rng.standard_normal(13), 0.005
    P, p = root @ root.T, x[4:7]
    spread = np.trace(P[4:7, 4:7])
    row = np.concatenate([[1.0, 0, 0, 0], -p, np.zeros(6)])
    variance = spread**2 / 2 * (CONSISTENCY_TIME / h)
    gain = P @ row / (row @ P @ row + variance)
    joseph = np.eye(13) - np.outer(gain, row)
    expected = joseph @ P @ joseph.T + variance * np.outer(gain, gain)
    flat, moved = P.ravel().copy(), x.copy()
    kernel.remind(moved, flat, h)
    np.testing.assert_allclose(moved, x + gain * ((p @ p + spread) / 2 - x[0]), rtol=1e-12)
    np.testing.assert_allclose(flat.reshape(13, 13), expected, rtol=0, atol=1e-14 * np.abs(P).max())
    one, other = riccati.remind(x, P, h)
    np.testing.assert_allclose(one, moved, rtol=1e-12)
    np.testing.assert_allclose(other, expected, rtol=0, atol=1e-14 * np.abs(P).max())


@pytest.mark.parametrize("name", ["paper", "circle", "hover"])
def test_noise_matched_covariance_stays_positive(name: str):
    """Ten minutes at 200 Hz, 120 000 steps with the reminder in each, observable and blind."""
    scene = records.scene(name, duration=600.0, range_rate=50.0)
    z, setting = scene.measurements, scene.setting(Gains(mode="noise-matched"))
    first = Sample(z.time[0], z.gyro[0], z.accel[0], z.mag[0], z.range_time[:1], z.range[:1])
    state, innovation = begin(first, scene.start, setting), np.empty((len(z.range), 2))
    least = []
    for part in range(4):
        rows, ranges = slice(part * 30_000, (part + 1) * 30_000 + 1), slice(1 + part * 7500, 1 + (part + 1) * 7500)
        n = len(z.time[rows])
        cascade_kernel.run(
            state.packed, z.time[rows], z.gyro[rows], z.accel[rows], z.mag[rows], z.range_time[ranges], z.range[ranges],
            np.empty((n, 13)), np.empty((n, 4)), np.empty((n, 3, 3, 3)), np.empty((n, 3, 3)), np.empty(n),
            np.empty(n, dtype=np.int8), np.empty((n, 3)), innovation, 0, state.packed_parameters,
        )  # fmt: skip
        P = state.arrays.P.reshape(13, 13)
        np.testing.assert_array_equal(P, P.T)
        std = np.sqrt(np.diag(P))
        least.append(np.linalg.eigvalsh(P / (std[:, None] * std)).min())
    assert min(least) >= -1e-9


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.0099, 0.0101, 1.0, 3.14])
def test_rotations_agree_with_scipy(angle: float):
    axis = np.array([0.6, -0.48, 0.64])
    expected = Rotation.from_rotvec(angle * axis)
    other = Rotation.from_rotvec([0.3, 0.2, -1.0])
    r, s, u = rot.exp(*(angle * axis)), rot.load(other.as_matrix()), np.array([1.0, -2.0, 3.0])
    np.testing.assert_allclose(np.reshape(r, (3, 3)), expected.as_matrix(), atol=4e-16)
    np.testing.assert_allclose(np.reshape(rot.multiply(r, s), (3, 3)), (expected * other).as_matrix(), atol=1e-15)
    np.testing.assert_allclose(rot.apply(r, *u), expected.apply(u), atol=2e-15)
    np.testing.assert_allclose(rot.apply_inverse(r, *u), expected.inv().apply(u), atol=2e-15)


def test_orthonormal_squares_the_drift_and_finds_the_nearest_rotation():
    exact = Rotation.from_rotvec([0.3, 0.2, -1.0]).as_matrix()
    symmetric = np.array([[1.0, 0.2, 0.1], [0.2, -0.5, 0.3], [0.1, 0.3, 0.4]])
    drifted = exact @ (np.eye(3) + 1e-6 * symmetric)  # its polar factor is `exact`
    mended = np.reshape(rot.orthonormal(rot.load(drifted)), (3, 3))
    assert np.abs(mended - exact).max() < 3e-12  # 1.5 |E|², |E| = 1.2e-6


@pytest.mark.parametrize("mode", ["constant", "noise-matched"])
@pytest.mark.parametrize(
    ("range_rate", "mag_rate", "schedule"),
    [(200.0, 200.0, Schedule()), (50.0, 200.0, None), (333.0, 57.0, None), (7.0, 11.0, Schedule())],
)
def test_compiled_cascade_and_plain_numpy_agree(
    mode: Literal["constant", "noise-matched"], range_rate: float, mag_rate: float, schedule
):
    """Two coordinate systems, one scheme: they differ by rounding only.

    It is amplified by the first corrections, which take a variance of 1e4 down to R: 10⁶ times when R = 1/(q h), 2·10⁸
    times when noise-matched, where the first predicted distance is zero and R = ½σ⁴.
    """
    tolerance = 1e-8 if mode == "constant" else 1e-7
    scene = records.scene("paper-slow", duration=4.0, range_rate=range_rate, mag_rate=mag_rate)
    setting = scene.setting(Gains(mode=mode, attitude=AttitudeGains(schedule=schedule)))
    fast = observe(scene.measurements, scene.start, setting)
    slow = reference.observe(scene.measurements, scene.start, setting)
    for name in ("state", "covariance", "xi_variance", "rotation", "k1", "innovation"):
        one, other = getattr(fast, name), getattr(slow, name)
        scale = np.nanmax(np.abs(other))
        np.testing.assert_allclose(one, other, rtol=0, atol=tolerance * scale, err_msg=name)


def test_the_cache_folder_is_named_after_the_sources():
    assert cache.folder().name.startswith("kernels-")
    assert {source.name for source in cache.SOURCES} >= {"riccati.py", "cascade.py", "attitude.py", "rotation.py"}


def test_the_kernel_of_one_sample_is_compiled_once_however_often_it_is_asked_for():
    assert one_sample.compiled_step() is one_sample.compiled_step()
    assert len(one_sample.step.signatures) == 1
