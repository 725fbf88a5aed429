"""The Riccati observer against the paper's own differential equation and a steady Riccati equation."""

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
from msgspec.structs import replace

from rangenav import cascade, model, riccati, so3
from rangenav.attitude import AttitudeGains
from rangenav.cascade import ObserverConfig, Start
from rangenav.gains import Gains
from rangenav.model import STATES
from rangenav.preset import Preset
from rangenav.riccati import Blocks, RiccatiGains
from rangenav.signals import Flown
from tests.support import records

SOFT = Gains(
    riccati=RiccatiGains(
        q=10.0,
        v=Blocks(xi=0.1, position=0.01, velocity=0.1, gravity=0.01),
        p0=Blocks(xi=10.0, position=10.0, velocity=10.0, gravity=10.0),
    )
)
RATES = (200.0, 400.0, 800.0, 1600.0)


class PaperOde:
    """Equations (8) and (9) as printed, but for the derived model; continuous true signals, body axes."""

    def __init__(self, preset: Preset, gains: Gains) -> None:
        assert not isinstance(preset.angular_velocity, Flown)
        self.preset, self.gains, self.turning = preset, gains, preset.angular_velocity
        self.gravity = np.asarray(preset.world.gravity)
        self.magnetic = np.asarray(preset.world.magnetic)
        self.V = np.diag(gains.riccati.v.diagonal())

    def initial(self) -> np.ndarray:
        P0 = np.diag(self.gains.riccati.p0.diagonal())
        R0 = so3.exp(np.asarray(self.preset.initial_rotation))
        return np.concatenate([np.zeros(STATES), P0.ravel(), R0.ravel(), np.eye(3).ravel()])

    def split(self, y: np.ndarray) -> tuple[np.ndarray, ...]:
        P, R, estimate = y[13:182].reshape(13, 13), y[182:191].reshape(3, 3), y[191:].reshape(3, 3)
        return y[:13], P, R, estimate

    def accel(self, t: float, R: np.ndarray) -> np.ndarray:
        return R.T @ (self.preset.path(np.array(t), 2) - self.gravity)

    def rate(self, t: float, y: np.ndarray) -> np.ndarray:
        x, P, R, estimate = self.split(y)
        w, k = self.turning(np.array(t)), self.gains.attitude
        A, b = model.dynamics(w, self.accel(t, R), gravity_norm=9.81)
        distance2 = np.sum((self.preset.path(np.array(t)) - np.asarray(self.preset.world.anchor)) ** 2)
        gain = P[:, 0] * self.gains.riccati.q
        sigma = k.rho1 * np.cross(R.T @ self.magnetic, estimate.T @ self.magnetic)
        sigma = sigma + k.rho2 * np.cross(x[10:], estimate.T @ self.gravity)
        return np.concatenate(
            [
                A @ x + b + gain * (distance2 / 2 - x[0]),
                (A @ P + P @ A.T - np.outer(gain, P[0]) + self.V).ravel(),
                (R @ so3.hat(w)).ravel(),
                (estimate @ so3.hat(w + k.k1 * sigma)).ravel(),
            ]
        )

    def solve(self, duration: float) -> tuple[np.ndarray, ...]:
        solution = scipy.integrate.solve_ivp(
            self.rate, (0, duration), self.initial(), method="DOP853", rtol=1e-11, atol=1e-12
        )
        return self.split(solution.y[:, -1])


def final_errors(name: str, gains: Gains, duration: float, rate: float, reference: tuple) -> tuple[float, ...]:
    x, P, _, rotation = reference
    scene = records.scene(name, duration=duration, imu_rate=rate, range_rate=rate, noise=records.SILENT)
    start = Start(state=np.zeros(STATES), rotation=np.eye(3))
    estimate = cascade.observe(scene.measurements, start, scene.setting(gains))
    covariance = estimate.covariance[-1, 0] - P[model.POSITION, model.POSITION]
    return (
        float(np.linalg.norm(estimate.state[-1] - x) / np.linalg.norm(x)),
        float(np.linalg.norm(covariance) / np.linalg.norm(P[model.POSITION, model.POSITION])),
        float(np.linalg.norm(estimate.rotation[-1] - rotation)),
    )


@pytest.mark.parametrize("gains", [Gains(), SOFT], ids=["default", "soft"])
@pytest.mark.parametrize("duration", [0.5, 1.0])
def test_state_covariance_and_attitude_converge_with_order_two_to_the_ode(gains: Gains, duration: float):
    """From x̂(0) = 0: starting at the truth would hide an unsymmetric, first-order splitting."""
    reference = PaperOde(records.scene("paper-slow", duration=duration).preset, gains).solve(duration)
    errors = [final_errors("paper-slow", gains, duration, rate, reference) for rate in RATES]
    slopes = -np.polyfit(np.log(RATES), np.log(errors), 1)[0]
    assert np.all(slopes > 1.9), slopes
    assert np.all(np.asarray(errors[-1]) < 1e-4)


def test_an_unsymmetric_correction_would_be_order_one():
    """The witness above can fail: with one full correction per range, the order drops to one."""
    reference = PaperOde(records.scene("paper-slow", duration=0.5).preset, SOFT).solve(0.5)
    errors = []
    for rate in RATES:
        scene = records.scene("paper-slow", duration=0.5, imu_rate=rate, range_rate=rate, noise=records.SILENT)
        start = Start(state=np.zeros(STATES), rotation=np.eye(3))
        shifted = replace(scene.preset.sensors, range_rate=rate * (1 + 1e-12))  # no longer "at the IMU's rate"
        setting = ObserverConfig(world=scene.preset.world, sensors=shifted, gains=SOFT)
        estimate = cascade.observe(scene.measurements, start, setting)
        errors.append(np.linalg.norm(estimate.state[-1] - reference[0]))
    slope = -np.polyfit(np.log(RATES), np.log(errors), 1)[0]
    assert 0.8 < slope < 1.3, slope


def test_covariance_settles_on_the_algebraic_riccati_equation():
    """With a = 0, ξ is a chain of four integrators measured at its top: constant, observable, and known to scipy."""
    A = np.diag(np.ones(3), 1)
    q, v = 50.0, 0.2
    expected = scipy.linalg.solve_continuous_are(A.T, np.eye(4)[:, :1], v * np.eye(4), np.array([[1 / q]]))
    P, h = np.eye(STATES), 1e-3
    for _ in range(8000):
        P = P + np.diag([v] * 4 + [0.0] * 9) * (h / 2)
        _, P = riccati.predict(np.zeros(STATES), P, np.zeros(3), np.zeros(3), h, gravity_norm=9.81)
        P = P + np.diag([v] * 4 + [0.0] * 9) * (h / 2)
        _, P = riccati.correct(np.zeros(STATES), P, 0.0, 1 / (q * h))
    np.testing.assert_allclose(P[:4, :4], expected, rtol=2e-2)  # one correction per step: first order in h


@pytest.mark.parametrize("field", ["q", "v", "p0"])
def test_gains_outside_their_stated_ranges_are_refused(field: str):
    zero = {"q": 0.0, "v": Blocks(xi=0.0, position=1.0, velocity=1.0, gravity=1.0)}
    zero["p0"] = Blocks(xi=1.0, position=1.0, velocity=1.0, gravity=1e5)
    with pytest.raises(ValueError, match=field):
        replace(RiccatiGains(), **{field: zero[field]})


def test_attitude_gains_must_be_positive():
    with pytest.raises(ValueError, match="k1"):
        AttitudeGains(k1=0.0)
