"""Compile every kernel ahead of its first use, innermost first, so that progress can be shown."""

from collections.abc import Callable

import numpy as np


def compile_all(progress: Callable[[float, str], None]) -> None:
    """Run each kernel once on a tiny problem; progress(fraction, name) is called before each and once at the end."""
    progress(0.0, "loading the compiler")
    stages = _stages()
    for done, (name, stage) in enumerate(stages):
        progress((done + 1) / (len(stages) + 1), name)
        stage()
    progress(1.0, "ready")


def _stages() -> list[tuple[str, Callable[[], object]]]:
    from rangenav.kernels import attitude, cascade, errors, riccati, rotation
    from rangenav.kernels.layout import Arrays, Parameters

    vector, matrix, state = np.zeros(3), np.eye(3), np.zeros(13)
    p = Parameters(
        gravity=(0.0, 0.0, 9.81), magnetic=(1.0, 0.0, 0.0), b4=1.0, variance=1.0, v=(1.0, 1.0, 1.0, 1.0), k1=1.0,
        rho1=1.0, rho2=1.0, scheduled=True, k1_steady=1.0, halfway=1.0, memory=1.0, symmetric=True, matched=False,
        range_sigma=0.1, accel_density=0.1, gyro_density=0.1,
    )  # fmt: skip
    s = Arrays(
        x=state, P=np.eye(13).ravel(), turned=matrix.copy(), rotation=matrix.copy(), gyro=vector.copy(),
        accel=vector.copy(), mag=vector.copy(), misaligned=np.ones(1), pending=np.full(2, np.nan),
    )  # fmt: skip
    time, rows, ranges = np.array([0.0, 1e-3]), np.zeros((2, 3)), np.ones(2)
    r, pairs = rotation.load(matrix), np.empty((2, 2))
    return [
        ("rotations", lambda: rotation.orthonormal(rotation.multiply(rotation.exp(0.0, 0.0, 0.1), r))),
        ("attitude filter", lambda: attitude.step(r, 1.0, vector, vector, vector, vector, vector, vector, 1e-3, p)),
        ("Riccati prediction", lambda: riccati.predict_covariance(s.P, 0.0, 0.0, 9.8, 1e-3)),
        ("Riccati correction", lambda: riccati.correct(s.x, s.P, 1.0, 1.0)),
        ("first sample", lambda: cascade.begin(s, 1.0, p)),
        ("one step", lambda: cascade.advance(s, 0.0, 1e-3, vector, vector, vector, time, ranges, 1, 2, pairs, p)),
        ("reading the estimate", lambda: (cascade.read(s, np.empty(13), np.empty((3, 3, 3))), cascade.k1(s, p))),
        (
            "whole record",
            lambda: cascade.run(
                s, time, rows, rows, rows, time, ranges, np.empty((2, 13)), np.empty((2, 4)), np.empty((2, 3, 3, 3)),
                np.empty((2, 3, 3)), np.empty(2), np.empty((2, 2)), 1, p,
            ),
        ),
        (
            "many attitudes",
            lambda: cascade.run_attitudes(
                s, time, rows, rows, rows, time, ranges, np.tile(matrix, (1, 2, 1, 1)), np.empty((2, 2)), 1, p
            ),
        ),
        ("errors", lambda: errors.norms(np.zeros((1, 13)), np.zeros((1, 13)), np.empty((1, 3)))),
        ("angles", lambda: errors.angles(np.tile(matrix, (1, 1, 1, 1)), matrix[None], np.empty((1, 1)))),
    ]  # fmt: skip
