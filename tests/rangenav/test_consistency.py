"""NIS and NEES: their bands against scipy, and an exact linear Kalman filter that must be found consistent, or not."""

import control
import numpy as np
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

from rangenav import consistency
from rangenav.gains import Gains
from tests.support import records

F = np.array([[1.0, 0.1, 0.005], [0.0, 1.0, 0.1], [0.0, 0.0, 0.99]])
H = np.array([[1.0, 0.0, 0.0]])
Q = np.diag([1e-4, 1e-3, 1e-2])
R, P0 = 0.04, np.diag([1.0, 0.5, 0.2])
"""A body on a line with a wandering acceleration, whose position is measured: linear and Gaussian."""
SEEDS, STEPS = 60, 400


def kalman(seed: int, *, believed: float = 1.0):
    """Innovations with variances, errors, covariances of a Kalman filter that takes Q for `believed` times itself."""
    rng = np.random.default_rng(seed)
    x, estimate, P = np.linalg.cholesky(P0) @ rng.standard_normal(3), np.zeros(3), P0
    innovations, errors, covariances = [], [], []
    for _ in range(STEPS):
        x = F @ x + np.sqrt(np.diag(Q)) * rng.standard_normal(3)
        estimate, P = F @ estimate, F @ P @ F.T + believed * Q
        S = (H @ P @ H.T)[0, 0] + R
        innovation = x[0] + np.sqrt(R) * rng.standard_normal() - estimate[0]
        gain = P[:, 0] / S
        estimate, P = estimate + gain * innovation, P - np.outer(gain, P[0])
        innovations.append((innovation, S))
        errors.append(estimate - x)
        covariances.append(P)
    return np.array(innovations), np.array(errors), np.array(covariances)


def judged(believed: float):
    """NIS and NEES of the toy, averaged over seeds."""
    time = np.arange(STEPS) * 0.1
    runs = [kalman(seed, believed=believed) for seed in range(SEEDS)]
    nis = np.array([consistency.innovations(innovation) for innovation, _, _ in runs])
    nees = np.array([consistency.errors(error, covariance) for _, error, covariance in runs])
    return consistency.averaged(nis, time, freedom=1), consistency.averaged(nees, time, freedom=3)


def test_the_toy_is_a_kalman_filter():
    """Its covariance settles where the discrete Riccati equation of python-control says."""
    _, predicted, _ = control.dlqe(F, np.eye(3), H, Q, np.array([[R]]))
    gain = predicted[:, 0] / (predicted[0, 0] + R)
    np.testing.assert_allclose(kalman(0)[2][-1], predicted - np.outer(gain, predicted[0]), rtol=1e-9)


def test_a_kalman_filter_on_its_own_model_is_inside_the_band_as_often_as_promised():
    nis, nees = judged(1.0)
    # innovations are independent: 400 draws have a share of .95 ± .011; errors last some ten steps, so fewer count
    assert nis.inside == pytest.approx(0.95, abs=4 * 0.011)
    assert nees.inside == pytest.approx(0.95, abs=4 * 0.011 * np.sqrt(10))
    assert nis.expected == 1
    assert nis.mean.mean() == pytest.approx(1, abs=4 * np.sqrt(2 / (SEEDS * STEPS)))
    assert nees.expected == 3
    assert nees.mean.mean() == pytest.approx(3, abs=4 * np.sqrt(6 / (SEEDS * STEPS / 10)))


def test_a_filter_that_believes_in_too_little_noise_is_found_too_sure_and_one_in_too_much_too_cautious():
    for believed, above in ((0.02, True), (50.0, False)):
        nis, nees = judged(believed)
        assert nees.inside < 0.1
        assert (nees.above > 0.9) == above
        assert nis.inside < 0.85  # most of an innovation is the measurement's noise, which both know
        assert (nis.above > 0.1) == above


def test_the_sliding_mean_of_innovations_is_inside_its_band_as_often_as_promised():
    """One run, windows of 2 s = 20 innovations: the share over many runs, because neighbours overlap."""
    time = np.arange(STEPS) * 0.1
    computed = [consistency.sliding(consistency.innovations(kalman(s)[0]), time, window=2.0) for s in range(SEEDS)]
    assert np.mean([one.inside for one in computed]) == pytest.approx(0.95, abs=0.02)
    assert computed[0].time[0] == pytest.approx(2.0)
    assert computed[0].time[-1] == time[-1]


def test_a_sliding_mean_is_the_plain_mean_of_what_the_window_holds():
    rng = np.random.default_rng(3)
    time = np.cumsum(rng.uniform(0.01, 0.3, 300))
    square = rng.chisquare(1, 300)
    square[::17] = np.nan
    computed = consistency.sliding(square, time, window=1.5)
    for t, mean, low, high in zip(computed.time, computed.mean, computed.low, computed.high, strict=True):
        held = square[(time > t - 1.5) & (time <= t)]
        held = held[np.isfinite(held)]
        assert mean == pytest.approx(held.mean(), rel=1e-12)
        bounds = scipy.stats.chi2.ppf([0.025, 0.975], len(held)) / len(held)
        np.testing.assert_allclose([low, high], bounds, rtol=1e-9)


def test_a_large_transient_does_not_spoil_the_windows_after_it():
    square, time = np.ones(200), np.arange(200.0)
    square[0] = 1e30
    np.testing.assert_array_equal(consistency.sliding(square, time, window=10.0).mean[1:], 1.0)


@given(st.integers(1, 10_000), st.floats(0.5, 0.999))
def test_the_band_is_the_one_of_the_chi_square_distribution(freedom, share):
    low, high = consistency.band(np.array([freedom]), share=share)
    expected = scipy.stats.chi2.ppf([(1 - share) / 2, (1 + share) / 2], freedom)
    np.testing.assert_allclose([low[0], high[0]], expected, rtol=1e-8)


def test_the_normalised_error_is_the_mahalanobis_distance_and_not_a_number_where_p_has_none():
    rng = np.random.default_rng(1)
    root = rng.standard_normal((4, 3, 3))
    P, e = root @ np.swapaxes(root, -1, -2), rng.standard_normal((4, 3))
    P[1], P[2, 0, 0] = np.diag([1.0, -1.0, 1.0]), np.inf
    computed = consistency.errors(e, P)
    for k in (0, 3):
        assert computed[k] == pytest.approx(e[k] @ np.linalg.inv(P[k]) @ e[k], rel=1e-9)
    assert np.isnan(computed[1:3]).all()


def test_counts_weigh_the_means_they_belong_to():
    square, count = np.array([[2.0, np.nan], [1.0, np.nan]]), np.array([[3, 0], [1, 0]])
    computed = consistency.averaged(square, np.array([0.0, 1.0]), count=count, freedom=1)
    assert computed.mean[0] == pytest.approx(7 / 4)
    np.testing.assert_allclose([computed.low[0], computed.high[0]], scipy.stats.chi2.ppf([0.025, 0.975], 4) / 4)
    assert np.isnan(computed.mean[1])
    assert computed.summary == "100% inside the 95% band, 0% too sure, 0% too cautious"
    assert "nothing" in consistency.averaged(square[:, 1:], np.array([1.0]), freedom=1).summary


def test_noise_matched_innovations_of_the_observer_are_consistent_and_constant_ones_too_cautious_or_too_sure():
    inside = {}
    for mode in ("noise-matched", "constant"):
        scene = records.scene("paper", duration=20.0, range_rate=50.0)
        innovation = scene.observe(Gains(mode=mode)).innovation
        nis = consistency.sliding(consistency.innovations(innovation), scene.measurements.range_time, window=1.0)
        inside[mode] = np.mean(((nis.mean > nis.low) & (nis.mean < nis.high))[nis.time > 5])
    assert inside["noise-matched"] > 0.85
    assert inside["constant"] < inside["noise-matched"]
