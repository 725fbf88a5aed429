"""Singular values of many matrices side by side, compared with LAPACK and with matrices whose values are known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rangenav.kernels import gramian_spectra
from rangenav.kernels.singular_values import LANES

N = 13
EPS = np.finfo(float).eps
OF_THE_LARGEST = 100 * EPS
"""Of the largest value: 26 reflections of 13 numbers round each number some fifty times, in this code and in LAPACK."""


def decomposed(matrices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """As rows without any change of coordinates."""
    values, found = np.empty(matrices.shape[:2]), np.empty(len(matrices), dtype=bool)
    unchanged = np.zeros((len(matrices), 12)), np.eye(N), np.zeros((12, 36)), np.ones(N)
    gramian_spectra.run(np.ascontiguousarray(matrices), *unchanged, False, values, found)
    return values, found


def assert_as_by_lapack(matrices: np.ndarray) -> None:
    values, found = decomposed(matrices)
    expected = np.linalg.svd(matrices, compute_uv=False)
    assert found.all()
    assert (np.diff(values, axis=1) <= 0).all()
    assert (np.abs(values - expected) <= OF_THE_LARGEST * expected[:, :1]).all()


@settings(max_examples=60)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(1, 2 * LANES + 1),
    rows=st.floats(-12.0, 12.0),
    columns=st.floats(-12.0, 12.0),
    triangular=st.booleans(),
    rank=st.integers(1, N),
    size=st.floats(-40.0, 40.0),
)
def test_values_are_those_of_lapack(
    seed: int, count: int, rows: float, columns: float, triangular: bool, rank: int, size: float
) -> None:
    """Rows and columns whose sizes rise or fall by up to 12 powers of ten, any rank, and sizes from 1e-40 to 1e40."""
    rng = np.random.default_rng(seed)
    matrices = rng.standard_normal((count, N, rank)) @ rng.standard_normal((count, rank, N))
    share = np.linspace(0.0, 1.0, N)
    matrices *= 10.0 ** (rows * share[:, None] + columns * share + size)
    assert_as_by_lapack(np.triu(matrices) if triangular else matrices)


def with_values(exact: np.ndarray) -> np.ndarray:
    """40 matrices of random directions with these singular values."""
    rng = np.random.default_rng(3)
    left, right = (np.linalg.qr(rng.standard_normal((40, N, N)))[0] for _ in range(2))
    return (left * exact) @ right


@pytest.mark.parametrize("spread", [0.01, 1.0, 12.0], ids=lambda spread: f"{spread:g}")
def test_known_values_are_found(spread: float) -> None:
    """Values that differ by 0.2 % from one to the next, and values down to 1e-12 of the largest."""
    exact = 10.0 ** (-spread * np.linspace(0.0, 1.0, N))
    values, found = decomposed(with_values(exact))
    assert found.all()
    np.testing.assert_allclose(values, np.broadcast_to(exact, values.shape), rtol=0, atol=OF_THE_LARGEST)


def test_what_falls_apart_is_found_as_it_is_or_not_at_all() -> None:
    """Values that are equal or nearly so, and a diagonal: what falls apart has no shift for all of it."""
    rng = np.random.default_rng(4)
    sizes, near = rng.uniform(0.5, 2.0, (20, N)), 1.0 - 1e-8 * np.arange(N) / N
    for matrices, exact in (
        (with_values(np.ones(N)), np.ones((40, N))),
        (with_values(near), np.broadcast_to(near, (40, N))),
        (np.eye(N)[rng.permutation(N)] * sizes[:, None], np.sort(sizes)[:, ::-1]),
    ):
        values, found = decomposed(matrices)
        np.testing.assert_allclose(values[found], exact[found], rtol=OF_THE_LARGEST)


@pytest.mark.parametrize("bad", [0.0, np.nan, np.inf, -np.inf, 1e200])
def test_what_has_no_values_is_not_found_and_leaves_its_neighbours_alone(bad: float) -> None:
    matrices = np.random.default_rng(5).standard_normal((LANES + 3, N, N))
    expected = decomposed(matrices)[0]
    spoiled = matrices.copy()
    spoiled[[1, LANES]] = bad
    spoiled[2, 4, 5] = np.nan
    values, found = decomposed(spoiled)
    assert np.flatnonzero(~found).tolist() == [1, 2, LANES]
    np.testing.assert_array_equal(values[found], expected[found])


def test_a_matrix_has_the_same_values_wherever_it_stands() -> None:
    matrices = np.random.default_rng(6).standard_normal((2 * LANES + 5, N, N))
    together = decomposed(matrices)[0]
    for k in (0, 1, LANES - 1, LANES, 2 * LANES + 4):
        np.testing.assert_array_equal(decomposed(matrices[[k]])[0][0], together[k])
