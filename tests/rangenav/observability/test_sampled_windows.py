"""The verdict of sampled windows computes no spectrum that nobody reads, and finds the worst windows of all spectra."""

import numpy as np
import pytest
from msgspec.structs import replace

from rangenav import analysis, preset
from rangenav.motion_analysis import WINDOWS, path_samples
from rangenav.observability import excitation, gramian_rank, rows, spectrum, worst_window
from rangenav.preset import Preset
from rangenav.signals import rotated

NAMES = ("paper-slow", "lissajous", "circle", "hover", "eight-repaired")
GRAVITY = (1.0, -2.0, 9.0)


def samples_of(p: Preset) -> rows.PathSamples:
    return path_samples(p.path, p.duration, p.requirement.window)


@pytest.mark.parametrize("name", NAMES)
def test_the_worst_windows_are_those_of_all_spectra(name: str) -> None:
    p = preset.load(name)
    samples, seen = samples_of(p), analysis.sampled(p)
    lifted = spectrum.lifted_spectra(samples, p.world.gravity)
    local = spectrum.local_spectra(samples, p.world.anchor)
    k, j = worst_window.of_spectrum(lifted), worst_window.of_spectrum(local)
    assert (seen.gramian_at, seen.nonlinear_at) == (samples.start[k], samples.start[j])
    same = {"rtol": 1e-9, "atol": lifted.floor[k]}  # compiled, and by LAPACK: see test_many_windows.py
    np.testing.assert_allclose(seen.gramian, lifted.eigenvalues[k], **same)
    assert seen.floor == pytest.approx(lifted.floor[k], rel=1e-9)
    np.testing.assert_array_equal(seen.nonlinear, local.eigenvalues[j])
    assert (seen.nonlinear_floor, seen.nonlinear_rank) == (local.floor[j], local.rank[j])
    np.testing.assert_array_equal(seen.windows.rank, lifted.rank)


def test_spectra_are_computed_when_they_are_read_and_once(monkeypatch: pytest.MonkeyPatch) -> None:
    counted: list[int] = []
    of_remainders = spectrum.of_remainders

    def counting(of: gramian_rank.Remainders, *, rounding: float) -> spectrum.Spectrum:
        counted.append(len(of.triangle))
        return of_remainders(of, rounding=rounding)

    monkeypatch.setattr(spectrum, "of_remainders", counting)
    p = preset.load("lissajous")
    tilted = rotated(p.path, np.linalg.qr(np.random.default_rng(5).standard_normal((3, 3)))[0], about=(0.0, 0.0, 0.0))
    for count in (WINDOWS, 34):
        counted.clear()
        windows = analysis.sampled(replace(p, path=tilted), count).windows
        assert counted == [1]
        assert windows.gramian.shape == windows.scaled.shape == (count, 13)
        assert (windows.gramian[:, -1] > windows.floor).all()
        assert counted == [1, count]


@pytest.mark.parametrize("moment", ["start", "end"])
def test_both_ends_of_a_window_share_one_decomposition(moment: rows.Moment) -> None:
    path = preset.load("trefoil").path
    samples = rows.sample(path, np.array([0.4, 2.0]), 3.0)
    other: rows.Moment = "end" if moment == "start" else "start"
    shared = gramian_rank.at_other_end(
        gramian_rank.of(samples, GRAVITY, samples.weight, other), samples, GRAVITY, samples.weight
    )
    own = gramian_rank.of(samples, GRAVITY, samples.weight, moment)
    assert shared.moment == moment
    for name in ("triangle", "floor", "departure", "states"):
        np.testing.assert_array_equal(getattr(shared, name), getattr(own, name))


@pytest.mark.parametrize("name", ["paper-slow", "lissajous", "soft", "trefoil", "circle"])
def test_the_least_excited_of_many_windows_is_the_least_of_each_of_them(name: str) -> None:
    p = preset.load(name)
    start = np.linspace(0.0, p.duration - p.requirement.window, 203)
    every = excitation.eigenvalues(p.path, start, p.requirement.window)
    values, at = excitation.worst(p.path, start, p.requirement.window)
    assert values[0] <= every[:, 0].min() * (1 + 1e-12) + 1e-30
    assert at in start
    np.testing.assert_allclose(values, excitation.eigenvalues(p.path, np.array([at]), p.requirement.window)[0])
