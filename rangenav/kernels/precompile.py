"""Compile every kernel ahead of its first use, innermost first, so that progress can be shown."""

from collections.abc import Callable

import numpy as np

Stage = Callable[[], object]


def compile_all(progress: Callable[[float, str], None]) -> None:
    """Run each kernel of the cascade on a tiny problem; progress(fraction, name) comes before each and at the end."""
    _compile(_stages, progress)


def compile_estimators(progress: Callable[[float, str], None]) -> None:
    """The same for what no first picture waits for: other estimators, a single sample, many attitudes."""
    _compile(_estimators, progress)


def _compile(named: Callable[[], list[tuple[str, Stage]]], progress: Callable[[float, str], None]) -> None:
    progress(0.0, "loading the compiler")
    stages = named()
    for done, (name, stage) in enumerate(stages):
        progress((done + 1) / (len(stages) + 1), name)
        stage()
    progress(1.0, "ready")


def _parameters() -> np.ndarray:
    from rangenav.kernels.layout import Parameters

    return Parameters(
        gravity=(0.0, 0.0, 9.81), magnetic=(1.0, 0.0, 0.0), b4=1.0, variance=1.0, v=(1.0, 1.0, 1.0, 1.0),
        p0=(1.0, 1.0, 1.0, 1.0), k1=1.0,
        rho1=1.0, rho2=1.0, scheduled=True, k1_steady=1.0, halfway=1.0, memory=1.0, symmetric=True, matched=False,
        range_sigma=0.1, accel_density=0.1, gyro_density=0.1,
    ).packed()  # fmt: skip


def _stages() -> list[tuple[str, Stage]]:
    from rangenav.kernels import (
        attitude,
        cascade,
        errors,
        gramian_spectra,
        remainder_rows,
        riccati,
        rotation,
        triangles,
    )
    from rangenav.kernels.layout import LENGTH, views

    p = _parameters()
    s, matrix, three = np.zeros(LENGTH), np.eye(3), (0.0, 0.0, 9.81)
    arrays = views(s)
    arrays.P[::14], arrays.turned[:], arrays.rotation[:] = 1.0, matrix, matrix
    time, rows, ranges = np.array([0.0, 1e-3]), np.zeros((2, 3)), np.ones(2)
    r, pairs = rotation.load(matrix), np.empty((2, 2))
    packed, first = np.ones((1, 2, 6)), np.zeros(1, dtype=np.int64)
    known = attitude.unpacked(p)
    return [
        ("rotations", lambda: rotation.orthonormal(rotation.multiply(rotation.exp(0.0, 0.0, 0.1), r))),
        ("attitude filter", lambda: attitude.step(r, 1.0, three, three, three, three, three, three, 1e-3, known)),
        ("Riccati prediction", lambda: riccati.predict_covariance(arrays.P, 0.0, 0.0, 9.8, 1e-3)),
        ("Riccati correction", lambda: riccati.correct(arrays.x, arrays.P, 1.0, 1.0)),
        ("first sample", lambda: cascade.begin(s, 1.0, p)),
        ("one step", lambda: cascade.advance(s, 1e-3, three, three, three, time, ranges, 1, 2, pairs, known)),
        (
            "reading the estimate",
            lambda: (
                cascade.read(s, 0, np.empty((1, 13)), np.empty((1, 4)), np.empty((1, 3, 3, 3))),
                cascade.k1(s, p),
            ),
        ),
        (
            "whole record",
            lambda: cascade.run(
                s, time, rows, rows, rows, time, ranges, np.empty((2, 13)), np.empty((2, 4)), np.empty((2, 3, 3, 3)),
                np.empty((2, 3, 3)), np.empty(2), np.empty(2, dtype=np.int8), np.empty((2, 3)),
                np.empty((2, 2)), 1, p,
            ),
        ),
        (
            "triangles of ranges",
            lambda: (
                triangles.grow(np.ones((1, 1, 3)), 1, packed.copy()),
                triangles.join(packed, first, packed, first, first, np.empty((1, 3, 3))),
                triangles.invert(matrix[None], np.empty((1, 3, 3))),
            ),
        ),
        ("errors", lambda: errors.norms(np.zeros((1, 13)), np.zeros((1, 13)), np.empty((1, 3)))),
        ("angles", lambda: errors.angles(np.tile(matrix, (1, 1, 1, 1)), matrix[None], np.empty((1, 1)))),
        (
            "rows of many windows",
            lambda: remainder_rows.run(
                np.zeros((1, 3, 2)), np.zeros((1, 6, 2)), np.zeros((1, 2)), np.zeros((1, 21)), np.empty((1, 13, 13)),
                np.empty((1, 9, 9)),
            ),
        ),
        (
            "Gramian spectra",
            lambda: gramian_spectra.run(
                np.eye(13)[None], np.zeros((1, 12)), np.eye(13), np.zeros((12, 36)), np.ones(13), False,
                np.empty((1, 13)), np.empty(1, dtype=bool),
            ),
        ),
    ]  # fmt: skip


def _estimators() -> list[tuple[str, Stage]]:
    from rangenav.kernels import attitude, ekf, error_dynamics, one_sample, smoother
    from rangenav.kernels.layout import LENGTH, Strapdown

    known = Strapdown(
        gravity=(0.0, 0.0, 9.81), across1=(0.0, 1.0, 0.0), across2=(0.0, 0.0, 1.0), range_variance=0.01,
        mag_variance=0.01, accel_density=1e-4, gyro_density=1e-6,
    )  # fmt: skip
    p, matrix, nine, one = _parameters(), np.eye(3), np.zeros(9), np.ones(1)
    time, rows, pairs = np.array([0.0, 1e-3]), np.zeros((2, 3)), np.empty((2, 2))
    imu, given = (time, rows, rows), (np.ones(2), np.arange(2), np.zeros(2))
    track = (np.ones((2, 3)), np.zeros((2, 3)), np.array([matrix, matrix]))
    covariances, kept = np.tile(np.eye(9).ravel(), (2, 1)), np.empty((6, smoother.KEPT))
    work = (np.empty((2, 9)), covariances, np.zeros((2, 3)), kept, np.empty(2, dtype=np.int64))
    return [
        ("extended Kalman filter", lambda: ekf.run(*imu, rows, *given, *track, covariances, pairs, known)),
        (
            "smoother, forward",
            lambda: smoother.forward(*imu, rows, *given, *track, nine, np.eye(9).ravel(), *work, known),
        ),
        ("smoother, backward", lambda: smoother.backward(time, *work)),
        ("smoother, step", lambda: smoother.apply(work[0], *track)),
        ("smoother, covariance", lambda: smoother.smooth_covariance(time, covariances, work[2], known)),
        (
            "error dynamics",
            lambda: error_dynamics.run(
                time,
                rows,
                time[1:],
                0,
                False,
                np.arange(2),
                1.0,
                False,
                (1.0, 1.0, 1.0, 1.0),
                np.eye(13).ravel(),
                np.empty((2, 169)),
                np.empty((1, 169)),
            ),
        ),
        ("smoother, residuals", lambda: smoother.residuals(*imu, *given, *track, covariances, pairs, known)),
        (
            "one sample",
            lambda: one_sample.compiled_step()(np.zeros(LENGTH), 2e-3, rows[0], rows[0], rows[0], one * 2e-3, one, p),
        ),
        (
            "many attitudes",
            lambda: attitude.run(
                time, rows, rows, rows, np.array([matrix, matrix]), matrix[None], np.empty((1, 2, 3, 3)),
                np.ones(2, dtype=bool), np.empty((1, 2)), 1.0, np.empty(1, dtype=np.int64), 1.0, p,
            ),
        ),
    ]  # fmt: skip
