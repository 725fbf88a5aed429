"""Spectra of many windows come from compiled code, those of a few from LAPACK: both have the digits that rows carry."""

import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest

from rangenav import preset
from rangenav.observability import gramian_rank, rows, singular_values, spectrum
from rangenav.observability.coordinates import STATES
from rangenav.observability.cubic_fit import CUBIC
from rangenav.observability.singular_values import MANY
from tests.support import precise_gramian

SHIPPED = [file.stem for file in preset.shipped_files()]
A_TENTH = 0.1
"""Of a floor: what rounding leaves of a remainder (`gramian_rank.ROUNDING`). Twice that for the square of a value."""
PRECISE = [
    ("paper", 0.25), ("paper", 1.0), ("paper-slow", 0.5), ("paper-slow", 6.0), ("lissajous", 0.5), ("soft", 0.5),
    ("barrel", 0.5), ("circle", 0.5), ("hand-held", 0.5),
]  # fmt: skip


def least_margin(of: gramian_rank.Remainders) -> np.ndarray:
    """The least singular value that counts, in units of the floors, or 1e15 if only polynomials count."""
    last = np.take_along_axis(of.singular, np.maximum(of.rank - CUBIC - 1, 0)[:, None], axis=1)[:, 0]
    return np.where(of.rank > CUBIC, last, 1e15)


def halves(name: str, window: float) -> Iterator[tuple[spectrum.Spectrum, spectrum.Spectrum, slice]]:
    """The spectra of 40 windows by compiled code, and those of a few of them at a time by LAPACK."""
    p = preset.load(name)
    start = np.linspace(0.0, p.duration - window, 40)
    many = spectrum.window_spectra(p.path, p.world.gravity, start, window)
    for k in range(0, 40, 20):
        some = slice(k, k + 20)
        yield many, spectrum.window_spectra(p.path, p.world.gravity, start[some], window), some


@pytest.mark.parametrize("name", SHIPPED)
def test_many_windows_have_the_ranks_and_spectra_of_a_few(name: str) -> None:
    """Values that count differ by what rounding may be of them; floors and tolerances follow from these values."""
    for window in (preset.load(name).requirement.window, 0.5):
        for many, few, some in halves(name, window):
            assert isinstance(few, spectrum.LiftedSpectrum)
            np.testing.assert_array_equal(many.rank[some], few.rank)
            allowed = (2 * A_TENTH / least_margin(few.remainders) + 1e-11)[:, None]
            counted = np.arange(STATES) < few.rank[:, None]
            for values, expected in (
                (many.eigenvalues[some, ::-1], few.eigenvalues[:, ::-1]),
                (many.scaled[some], few.scaled),
            ):
                assert (np.abs(values - expected) <= 2 * allowed * expected)[counted].all()
            assert (np.sum(many.eigenvalues[some] > many.floor[some, None], axis=1) == few.rank).all()
            assert (np.sum(many.scaled[some] > many.tolerance[some, None], axis=1) == few.rank).all()


@pytest.mark.parametrize(("name", "window"), PRECISE)
def test_their_spectra_are_those_of_fifty_digits(name: str, window: float) -> None:
    """Down to 3e-28, where a product of rows in double precision loses everything below 1e-17 of the largest."""
    p = preset.load(name)
    many = spectrum.window_spectra(p.path, p.world.gravity, np.full(MANY + 1, 0.3), window)
    assert isinstance(many, spectrum.LiftedSpectrum)
    exact = np.array([float(value) for value in precise_gramian.gramian_eigenvalues(p, 0.3, window)])
    above = many.eigenvalues[0] > many.floor[0]
    assert np.sum(above) == many.rank[0]
    allowed = 2 * A_TENTH / least_margin(many.remainders)[0] + 1e-11
    np.testing.assert_allclose(many.eigenvalues[-1][above], exact[above], rtol=allowed)


@pytest.mark.parametrize("gravity", [(0.0, 0.0, 9.81), (1.0, -2.0, 9.0)])
@pytest.mark.parametrize("name", ["lissajous", "minimum-snap", "circle"])
def test_compiled_triangles_are_those_of_the_same_rows(name: str, gravity: tuple[float, float, float]) -> None:
    """RᵀR to the floors, which are the rounding of the columns; the inverses are inverses."""
    p = preset.load(name)
    samples = rows.sample(p.path, np.linspace(0.0, p.duration - 4.0, 21), 4.0)
    for moment in ("start", "end"):
        compiled = gramian_rank.of(samples, gravity, samples.weight, moment, compiled=True)
        few = gramian_rank.of(samples, gravity, samples.weight, moment)
        squares, expected = (R.swapaxes(1, 2) @ R for R in (compiled.triangle, few.triangle))
        size = np.sqrt(np.einsum("wii->wi", expected))
        rounding = np.concatenate([1e-14 * size[:, :CUBIC], few.floor], axis=1)
        allowed = size[:, :, None] * rounding[:, None, :]
        assert (np.abs(squares - expected) <= allowed + allowed.swapaxes(1, 2)).all()
        np.testing.assert_array_equal(compiled.floor, few.floor)
        np.testing.assert_array_equal(compiled.rank, few.rank)
        assert compiled.inverse is not None
        for R, inverse in zip(compiled.triangle[:, CUBIC:, CUBIC:], compiled.inverse, strict=True):
            if np.isfinite(inverse).all():
                np.testing.assert_allclose(np.abs(R) @ np.abs(inverse) * 1e-14 >= np.abs(R @ inverse - np.eye(9)), True)


def test_fewer_samples_than_columns_have_no_more_ranks_than_samples() -> None:
    p = preset.load("lissajous")
    start, tau = np.linspace(0.0, 5.0, MANY), np.linspace(0.0, 4.0, 9)[None]
    samples = rows.sample_at(p.path, start, 4.0, tau=tau, weight=np.full(tau.shape, 1 / 9))
    many = spectrum.lifted_spectra(samples, p.world.gravity)
    np.testing.assert_array_equal(many.rank, 9)
    assert np.isfinite(many.eigenvalues).all()


def test_windows_that_are_blind_or_not_found_are_decomposed_by_lapack(monkeypatch: pytest.MonkeyPatch) -> None:
    """Some of the windows of a motion that rests and then flies, and all of them where the iteration finds none."""
    slow = preset.load("paper-slow")
    start = np.linspace(0.0, 10.0, MANY + 8)
    samples = rows.sample(slow.path, start, 6.0)
    rested = rows.sample(preset.load("hover").path, start, 6.0)
    flown = gramian_rank.of(samples, slow.world.gravity, samples.weight, "start", compiled=True)
    hovered = gramian_rank.of(rested, slow.world.gravity, rested.weight, "start", compiled=True)
    resting = np.arange(len(start)) % 11 == 3
    for field in ("triangle", "floor", "departure", "inverse"):
        getattr(flown, field)[resting] = getattr(hovered, field)[resting]
    mixed, expected = (
        spectrum.of_remainders(flown, rounding=samples.rounding),
        spectrum.of_remainders(flown.some(np.arange(20)), rounding=samples.rounding),
    )
    np.testing.assert_array_equal(mixed.rank < STATES, resting)
    np.testing.assert_allclose(mixed.eigenvalues[:20], expected.eigenvalues, rtol=1e-9, atol=1e-25)
    found = mixed.eigenvalues.copy()

    def nothing(of: gramian_rank.Remainders, *given: object, **named: object) -> tuple[np.ndarray, np.ndarray]:
        return np.full((len(of.triangle), STATES), np.nan), np.zeros(len(of.triangle), dtype=bool)

    monkeypatch.setattr(singular_values, "_compiled", nothing)
    again = spectrum.of_remainders(flown, rounding=samples.rounding)
    np.testing.assert_allclose(again.eigenvalues, found, rtol=1e-9, atol=1e-25)


def test_a_verdict_does_not_load_the_compiler() -> None:
    """It takes half a second, which is why a few windows go without it."""
    program = (
        "import sys; from rangenav import analysis, preset; analysis.analyse(preset.load('paper-slow')); "
        "sys.exit('numba' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
