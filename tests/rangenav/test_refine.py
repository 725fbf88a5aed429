"""The smoother against a loop, a dense solve and an optimiser; what it reaches, and what it says when it does not."""

import dataclasses
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace
from scipy.optimize import least_squares

from rangenav import baselines, cascade, model, preset, record, refine, so3, strapdown
from rangenav.cascade import ObserverConfig, Start
from rangenav.gains import Gains
from rangenav.kernels import smoother as kernel
from rangenav.refine import refine as refined
from rangenav.sensors import Measurements, Noise
from rangenav.signals import Tone
from rangenav.strapdown import Track
from tests.support import nine_states, records

pytestmark = pytest.mark.slow


PRIOR = np.diag(np.repeat([1.0, 1.0, 0.01], 3))


def rms(error: np.ndarray) -> float:
    """Over the last half."""
    return float(np.sqrt(np.mean(error[len(error) // 2 :] ** 2)))


def body_errors(scene: records.Scene, track: Track):
    return scene.errors(strapdown.lifted(track, scene.measurements, scene.preset.world))


def from_truth(scene: records.Scene) -> Track:
    """The filter's track from a start at the truth."""
    motion = scene.truth.motion
    start = (motion.position[0], motion.velocity[0], motion.rotation[0])
    return baselines.filtered(scene.measurements, start, np.eye(9) * 0.01, scene.setting())


def one_pass(
    z: Measurements, nominal: Track, first: np.ndarray, setting: ObserverConfig
) -> tuple[np.ndarray, np.ndarray]:
    """Smoothed errors and covariances about the nominal, by the kernels, without moving it."""
    attached, anchor = strapdown.attach(z), np.array(setting.world.anchor)
    work = refine.workspace(z, attached)
    kernel.forward(
        z.time, z.gyro, z.accel, z.mag, z.range[attached.kept], attached.sample, attached.back,
        nominal.position - anchor, nominal.velocity, nominal.rotation, first, PRIOR.ravel().copy(), *work,
        strapdown.parameters(setting),
    )  # fmt: skip
    kernel.backward(z.time, *work)
    kernel.smooth_covariance(z.time, work.covariances, work.accelerations, strapdown.parameters(setting))
    return work.errors, work.covariances.reshape(-1, 9, 9)


def linearised(z: Measurements, nominal: Track, setting: ObserverConfig) -> list[tuple]:
    """Φ, Q, defect, residuals, rows and variances of every sample about the nominal."""
    g, _, anchor = nine_states.axes(setting)
    sensors, steps = setting.sensors, []
    for k in range(len(z.time)):
        p, v, R = nominal.position[k] - anchor, nominal.velocity[k], nominal.rotation[k]
        phi, Q, defect, a = np.eye(9), np.zeros((9, 9)), np.zeros(9), np.zeros(3)
        if k > 0:
            h, before = z.time[k] - z.time[k - 1], nominal.rotation[k - 1]
            a, p0, v0 = nine_states.push(z, k - 1, before), nominal.position[k - 1] - anchor, nominal.velocity[k - 1]
            G, phi = nine_states.noise_input(h), nine_states.transition(a, h)
            Q = G @ np.diag(nine_states.intensity(sensors.noise, sensors.imu_rate, h)) @ G.T
            turned = so3.log(before @ nine_states.turn(z, k - 1) @ R.T)
            defect = np.concatenate([p0 + h * v0 + h**2 / 2 * (g + a) - p, v0 + h * (g + a) - v, turned])
        steps.append((phi, Q, defect, *nine_states.outputs(z, k, p, v, R, a, setting)))
    return steps


def rauch_tung_striebel(steps: list[tuple], first: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The textbook's smoother: filter, then x ← x + C (xₛ⁺ − x⁻), C = P Φᵀ (P⁻)⁻¹."""
    x, P, predicted, filtered = first, PRIOR, [], []
    for phi, Q, defect, residual, H, variance in steps:
        if filtered:
            x, P = phi @ x + defect, phi @ P @ phi.T + Q
        predicted.append((x, P))
        if len(residual):
            K = np.linalg.solve(H @ P @ H.T + np.diag(variance), H @ P).T
            kept = np.eye(9) - K @ H
            x, P = x + K @ (residual - H @ x), kept @ P @ kept.T + K @ np.diag(variance) @ K.T
        filtered.append((x, P))
    smooth = [filtered[-1]]
    for k in range(len(steps) - 2, -1, -1):
        x, P = filtered[k]
        ahead, covariance = predicted[k + 1]
        C = np.linalg.solve(covariance, steps[k + 1][0] @ P).T
        smooth.append((x + C @ (smooth[-1][0] - ahead), P + C @ (smooth[-1][1] - covariance) @ C.T))
    xs, Ps = zip(*smooth[::-1], strict=True)
    return np.array(xs), np.array(Ps)


@pytest.mark.parametrize(("range_rate", "mag_rate"), [(100.0, 100.0), (37.0, 100.0), (250.0, 13.0)])
def test_one_pass_is_the_smoother_of_the_textbook(range_rate: float, mag_rate: float):
    """An adjoint that inverts nothing against Rauch, Tung and Striebel, who invert every P⁻."""
    scene = records.scene("lissajous", duration=3.0, imu_rate=100.0, range_rate=range_rate, mag_rate=mag_rate)
    setting, nominal, first = scene.setting(), from_truth(scene), np.linspace(-0.1, 0.1, 9)
    errors, covariances = one_pass(scene.measurements, nominal, first, setting)
    expected, P = rauch_tung_striebel(linearised(scene.measurements, nominal, setting), first)
    np.testing.assert_allclose(errors, expected, atol=1e-8)
    np.testing.assert_allclose(covariances, P, atol=1e-8)


def test_one_pass_is_the_least_squares_solution():
    """One dense matrix: the first error and all noises as unknowns; its inverse gives the covariances too."""
    scene = records.scene("lissajous", duration=1.0, imu_rate=50.0, range_rate=50.0)
    z, setting, nominal, first = scene.measurements, scene.setting(), from_truth(scene), np.linspace(-0.1, 0.1, 9)
    steps, sensors = linearised(z, nominal, setting), setting.sensors
    count = 9 + 6 * (len(steps) - 1)
    maps, offset = [np.eye(9, count)], np.zeros(9)  # each error is maps[k] @ unknowns + offsets[k]
    offsets, rows, right = [offset], [], []
    rows.append(np.eye(9, count) / np.sqrt(np.diag(PRIOR))[:, None])
    right.append(first / np.sqrt(np.diag(PRIOR)))
    for k, (phi, _, defect, residual, H, variance) in enumerate(steps):
        if k > 0:
            h, M = z.time[k] - z.time[k - 1], phi @ maps[-1]
            columns = slice(9 + 6 * (k - 1), 9 + 6 * k)
            M[:, columns] += nine_states.noise_input(h)
            maps.append(M)
            offsets.append(phi @ offsets[-1] + defect)
            noise = np.zeros((6, count))
            noise[:, columns] = np.diag(1 / np.sqrt(nine_states.intensity(sensors.noise, sensors.imu_rate, h)))
            rows.append(noise)
            right.append(np.zeros(6))
        weight = 1 / np.sqrt(variance)
        rows.append(weight[:, None] * (H @ maps[-1]))
        right.append(weight * (residual - H @ offsets[-1]))
    J, b = np.vstack(rows), np.concatenate(right)
    unknowns, inverse = np.linalg.lstsq(J, b, rcond=None)[0], np.linalg.inv(J.T @ J)
    errors, covariances = one_pass(z, nominal, first, setting)
    np.testing.assert_allclose(errors, [M @ unknowns + o for M, o in zip(maps, offsets, strict=True)], atol=1e-8)
    np.testing.assert_allclose(covariances, [M @ inverse @ M.T for M in maps], atol=1e-8)


def test_the_passes_end_at_the_minimum_that_an_optimiser_finds(monkeypatch: pytest.MonkeyPatch):
    """scipy's least_squares on the same nonlinear cost, its unknowns the first state and all noises, started beside it.

    They differ by the curvature of exp over noises of 1e-3 rad, and by what is left when the optimiser stops.
    """
    monkeypatch.setattr(refine, "SMALL_STEP", 1e-10)
    fine = Noise(gyro=0.01, accel=0.1, mag=0.1, range=0.02)
    scene = records.scene("lissajous", duration=4.0, imu_rate=20.0, range_rate=20.0, noise=fine)
    z, setting, nominal = scene.measurements, scene.setting(), from_truth(scene)
    smoothed = refine.smooth(z, nominal, setting)
    assert smoothed.converged
    count, step = 9 + 6 * (len(z.time) - 1), 1e-6

    def residuals(unknowns: np.ndarray) -> np.ndarray:
        return rolled(z, nominal, setting, unknowns[None])[1][0]

    def jacobian(unknowns: np.ndarray) -> np.ndarray:
        moved = unknowns + step * np.concatenate([np.eye(count), -np.eye(count)])
        costs = rolled(z, nominal, setting, moved)[1]
        return (costs[:count] - costs[count:]).T / (2 * step)

    start = 1e-2 * np.random.default_rng(0).standard_normal(count)
    exact: Any = jacobian  # scipy has no types, and its default is a string
    best = least_squares(residuals, start, exact, x_scale="jac", xtol=1e-12, ftol=1e-14, gtol=1e-10, max_nfev=40)
    position, velocity, rotation = (part[0] for part in rolled(z, nominal, setting, best.x[None])[0])
    np.testing.assert_allclose(smoothed.track.position, position, atol=1e-5)
    np.testing.assert_allclose(smoothed.track.velocity, velocity, atol=1e-5)
    np.testing.assert_allclose(smoothed.track.rotation, rotation, atol=1e-5)
    m = np.array(setting.world.magnetic)
    along = (np.einsum("kij,kj,i->k", rotation, z.mag, m) - 1) / fine.mag  # of the magnetometer, which tells nothing
    assert smoothed.passes[-1].cost * 3 * len(z.time) == pytest.approx(2 * best.cost - along @ along, rel=1e-6)


def rolled(z: Measurements, nominal: Track, setting: ObserverConfig, unknowns: np.ndarray) -> tuple[tuple, np.ndarray]:
    """Trajectories of first errors and noises, one in each row, and all weighted residuals; ranges at every sample."""
    g, m, anchor = nine_states.axes(setting)
    noise, rate = setting.sensors.noise, setting.sensors.imu_rate
    first, w = unknowns[:, :9], unknowns[:, 9:].reshape(len(unknowns), -1, 6)
    p, v = nominal.position[0] - anchor + first[:, :3], nominal.velocity[0] + first[:, 3:6]
    R, track, costs = so3.exp(first[:, 6:]) @ nominal.rotation[0], [], []
    for k in range(len(z.time)):
        if k > 0:
            h, turned = z.time[k] - z.time[k - 1], R @ nine_states.turn(z, k - 1)
            a = g + (R @ z.accel[k - 1] + turned @ z.accel[k]) / 2
            p, v = p + h * v + h**2 / 2 * a + h / 2 * w[:, k - 1, :3], v + h * a + w[:, k - 1, :3]
            R = so3.exp(w[:, k - 1, 3:]) @ turned
            costs.append(w[:, k - 1] / np.sqrt(nine_states.intensity(noise, rate, h)))
        costs.append((z.range[k] - np.linalg.norm(p, axis=-1))[:, None] / noise.range)
        costs.append((R @ z.mag[k] - m) / noise.mag)
        track.append((p + anchor, v, R))
    parts = tuple(np.moveaxis(np.array(part), 0, 1) for part in zip(*track, strict=True))
    return parts, np.concatenate(costs, axis=1)


@pytest.mark.parametrize("name", ["paper", "paper-slow"])
def test_it_is_within_25_millimetres_on_the_papers_paths(name: str):
    """Median over ten seeds of the RMS over the last half of 20 s, from the cascade that starts at nothing."""
    positions, attitudes, ratios = [], [], []
    for seed in range(10):
        scene = records.scene(name, duration=20.0, seed=seed)
        before = scene.observe()
        refinement = refined(scene.measurements, before, scene.setting())
        assert refinement.summary.startswith("converged after")
        assert refinement.fit == pytest.approx(1, abs=0.06)
        errors = body_errors(scene, refinement.track)
        assert rms(errors.position) < rms(scene.errors(before).position)
        positions.append(rms(errors.position))
        attitudes.append(np.degrees(rms(errors.attitude)))
        off = refinement.track.position - scene.truth.motion.position
        weighted = np.linalg.solve(refinement.track.covariance[:, :3, :3], off[..., None])[..., 0]
        ratios.append(np.mean(np.sum(off * weighted, axis=-1)) / 3)
    assert np.median(positions) < 0.025
    assert np.median(attitudes) < 0.2
    assert np.mean(ratios) == pytest.approx(1, abs=0.4)  # errors of one record hang together


def test_smoothed_covariances_are_symmetric_and_positive():
    scene = records.scene("paper-slow", duration=20.0, range_rate=50.0)
    P = refined(scene.measurements, scene.observe(), scene.setting()).track.covariance
    np.testing.assert_array_equal(P, np.swapaxes(P, -1, -2))
    std = np.sqrt(np.diagonal(P, axis1=-2, axis2=-1))
    assert np.linalg.eigvalsh(P / (std[:, :, None] * std[:, None, :])).min() > 0


@pytest.mark.parametrize(
    ("range_rate", "mag_rate", "lost"), [(50.0, 20.0, 0.3), (333.0, 200.0, 0.0), (10.0, 200.0, 0.0)]
)
def test_slow_irregular_and_missing_samples_do_not_stop_it(range_rate: float, mag_rate: float, lost: float):
    scene = records.scene("lissajous", duration=30.0, range_rate=range_rate, mag_rate=mag_rate)
    gone = np.random.default_rng(1).random(len(scene.measurements.range)) < lost
    z = records.without_ranges(scene.measurements, gone)
    scene = dataclasses.replace(scene, measurements=z)
    refinement = refined(z, scene.observe(), scene.setting())
    assert refinement.summary.startswith("converged after")
    assert rms(body_errors(scene, refinement.track).position) < 0.1
    assert np.isfinite(refinement.track.innovation).all()


def test_residuals_have_the_variance_that_is_claimed():
    scene = records.scene("lissajous", duration=30.0, range_rate=133.0)
    track = refined(scene.measurements, scene.observe(), scene.setting()).track
    ratio = np.mean(track.innovation[:, 0] ** 2 / track.innovation[:, 1])
    assert ratio == pytest.approx(1, abs=0.07)  # 4000 ranges: a standard deviation of .022


def test_a_wrong_minimum_is_said():
    """Two records of one motion mixed: no trajectory fits, and the residuals of the ranges tell."""
    scene = records.scene("lissajous", duration=10.0)
    other = dataclasses.replace(scene.measurements, range=scene.measurements.range[::-1] + 0.5)
    smoothed = refine.smooth(other, from_truth(scene), scene.setting())
    assert smoothed.fit > refine.WORST_FIT
    assert ("off by" in smoothed.summary) or smoothed.summary.startswith(("stopped after", "diverged"))


def test_a_start_that_is_no_number_is_a_divergence_said():
    scene = records.scene("lissajous", duration=1.0)
    nominal = from_truth(scene)
    nowhere = dataclasses.replace(nominal, position=np.full_like(nominal.position, np.nan))
    smoothed = refine.smooth(scene.measurements, nowhere, scene.setting())
    assert not smoothed.converged
    assert smoothed.summary == "diverged: pass 1 is not finite"


def test_too_few_passes_are_said(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(refine, "MAX_PASSES", 2)
    scene = records.scene("soft", duration=10.0)
    refinement = refined(scene.measurements, scene.observe(Gains()), scene.setting())
    assert not refinement.converged
    assert refinement.summary.startswith("stopped after 2 passes: the last one still moved the position by")


def test_nominal_and_measurements_are_left_as_they_were():
    scene = records.scene("lissajous", duration=2.0)
    nominal = from_truth(scene)
    before = {field.name: getattr(nominal, field.name).copy() for field in dataclasses.fields(nominal)}
    refine.smooth(scene.measurements, nominal, scene.setting())
    for name, array in before.items():
        np.testing.assert_array_equal(getattr(nominal, name), array)


def test_a_record_of_another_length_is_refused():
    scene, longer = records.scene("lissajous", duration=1.0), records.scene("lissajous", duration=2.0)
    with pytest.raises(ValueError, match="the trajectory must have one row for each of the 401 IMU samples, got 201"):
        refine.smooth(longer.measurements, from_truth(scene), scene.setting())


def test_without_noise_it_is_within_a_millimetre_and_its_covariance_stays_positive():
    """What a record tells is then 10⁵ times what was known before, where differences of covariances lose their sign."""
    scene = records.scene("paper", duration=10.0, range_rate=50.0, noise=records.SILENT)
    track = refined(scene.measurements, scene.observe(), scene.setting()).track
    assert body_errors(scene, track).position.max() < 1e-3
    P = track.covariance
    std = np.sqrt(np.diagonal(P, axis1=-2, axis2=-1))
    assert np.linalg.eigvalsh(P / (std[:, :, None] * std[:, None, :])).min() > 0


def test_without_a_magnetometer_the_position_in_body_axes_is_refined_all_the_same():
    """The heading is then anything; a turn about the anchor changes no range and no p_B."""
    scene = records.scene("lissajous", duration=20.0)
    silent = dataclasses.replace(scene.measurements, mag=np.full_like(scene.measurements.mag, np.nan))
    scene = dataclasses.replace(scene, measurements=silent)
    refinement = refined(silent, scene.observe(), scene.setting())
    assert refinement.summary.startswith("converged after")
    assert rms(body_errors(scene, refinement.track).position) < 0.05


def test_a_record_without_ranges_is_refused():
    scene = records.scene("lissajous", duration=1.0)
    none = records.without_ranges(scene.measurements, np.ones(len(scene.measurements.range), dtype=bool))
    with pytest.raises(ValueError, match="a refinement needs ranges, and the record has none"):
        refined(none, scene.observe(), scene.setting())


def test_the_filter_from_the_truth_and_the_cascade_lead_to_the_same_minimum():
    scene = records.scene("paper-slow", duration=20.0)
    one = refined(scene.measurements, scene.observe(), scene.setting()).track
    other = refine.smooth(scene.measurements, from_truth(scene), scene.setting()).track
    np.testing.assert_allclose(one.position, other.position, atol=2e-3)  # each stops when steps are below 1e-4 m
    np.testing.assert_allclose(one.rotation, other.rotation, atol=1e-4)


def test_from_random_starts_it_follows_the_cascade():
    """Any attitude, 3 m and 3 m/s off: where the cascade comes, the refinement comes."""
    rng = np.random.default_rng(11)
    for seed in range(5):
        scene = records.scene("paper-slow", duration=20.0, seed=seed)
        turn = so3.exp(rng.uniform(-np.pi, np.pi) * np.eye(3)[seed % 3])
        state = scene.truth.state[0].copy()
        p, v = (turn @ state[block] + 3 * rng.standard_normal(3) for block in (slice(4, 7), slice(7, 10)))
        start = Start(state=model.lift(p, v, turn @ state[10:]), rotation=scene.truth.motion.rotation[0] @ turn.T)
        estimate = cascade.observe(scene.measurements, start, scene.setting())
        computed = refined(scene.measurements, estimate, scene.setting())
        assert computed.summary.startswith("converged after")
        assert rms(body_errors(scene, computed.track).position) < 0.05


def test_a_minimum_that_fits_less_well_than_chance_is_left_for_the_true_one():
    """A circle with a ripple of 6 cm has its mirror image as a second minimum, the repaired eight others."""
    circle, eight = preset.load("circle"), preset.load("eight-repaired")
    ripple = Tone(axis="z", amplitude=0.0624, frequency=4.0)
    path = replace(circle.path, tones=(*circle.path.tones, ripple))  # type: ignore[union-attr]
    helped = 0
    for p, seeds in ((replace(circle, path=path), range(8, 14)), (eight, range(3, 7))):
        setting = ObserverConfig(world=p.world, sensors=p.sensors, gains=p.gains)
        for seed in seeds:
            run = record.run_seed(p, seed)
            refinement = refined(run.measurements, run.estimate, setting)
            assert rms(np.linalg.norm(refinement.track.position - run.truth.motion.position, axis=1)) < 0.08
            assert refinement.fit == pytest.approx(1.0, abs=refine.POOR / np.sqrt(2 * len(run.measurements.range)))
            if refinement.starts == 1:
                continue
            first = refine.smooth(
                run.measurements, refine.start_trajectory(run.measurements, run.estimate, setting), setting
            )
            assert first.fit > refinement.fit
            assert refinement.summary.endswith(f"passes, the best of {refinement.starts} starts")
            helped += 1
    assert helped > 0
