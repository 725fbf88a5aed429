"""A reference implementation of the nine-state error dynamics, with scipy's rotations and matrix exponential."""

import numpy as np
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from rangenav import so3
from rangenav.cascade import ObserverConfig
from rangenav.sensors import Measurements, Noise


def axes(setting: ObserverConfig) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gravity, magnetic direction, anchor."""
    world = setting.world
    return np.array(world.gravity), np.array(world.magnetic), np.array(world.anchor)


def turn(z: Measurements, k: int) -> np.ndarray:
    """The rotation from body axes at k + 1 to body axes at k."""
    return Rotation.from_rotvec((z.gyro[k] + z.gyro[k + 1]) / 2 * (z.time[k + 1] - z.time[k])).as_matrix()


def push(z: Measurements, k: int, R: np.ndarray) -> np.ndarray:
    """Mean specific force over interval k, inertial axes."""
    return (R @ z.accel[k] + R @ turn(z, k) @ z.accel[k + 1]) / 2


def generator(a: np.ndarray) -> np.ndarray:
    """The error dynamics δṗ = δv, δv̇ = φ × a, φ̇ = 0."""
    A = np.zeros((9, 9))
    A[:3, 3:6], A[3:6, 6:] = np.eye(3), -so3.hat(a)
    return A


def transition(a: np.ndarray, h: float) -> np.ndarray:
    return expm(generator(a) * h)


def noise_input(h: float) -> np.ndarray:
    """The input matrix of velocity and attitude noise; velocity noise acts evenly over the interval."""
    G = np.zeros((9, 6))
    G[:3, :3], G[3:6, :3], G[6:, 3:] = h / 2 * np.eye(3), np.eye(3), np.eye(3)
    return G


def intensity(noise: Noise, rate: float, h: float) -> np.ndarray:
    """Variances of the six noises over h seconds."""
    return np.repeat([noise.accel**2 / rate * h, noise.gyro**2 / rate * h], 3)


def ranges_at(z: Measurements, k: int) -> np.ndarray:
    """Indices of the ranges after sample k − 1, up to sample k."""
    before = z.time[k - 1] if k > 0 else -np.inf
    return np.flatnonzero((z.range_time > before) & (z.range_time <= z.time[k]) & (z.range_time >= z.time[0]))


def outputs(
    z: Measurements, k: int, p: np.ndarray, v: np.ndarray, R: np.ndarray, a: np.ndarray, setting: ObserverConfig
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Residuals, rows and variances of the measurements at sample k: ranges, then all three components of R m_y − m."""
    g, m, _ = axes(setting)
    noise = setting.sensors.noise
    residuals, rows, variances = [], [], []
    for j in ranges_at(z, k):
        back = z.time[k] - z.range_time[j]
        there = p - back * v + back**2 / 2 * (g + a)
        residuals.append(z.range[j] - np.linalg.norm(there))
        rows.append(there / np.linalg.norm(there) @ transition(a, -back)[:3])
        variances.append(noise.range**2)
    if not np.isnan(z.mag[k]).any():
        residuals.extend(R @ z.mag[k] - m)
        rows.extend(np.hstack([np.zeros((3, 6)), so3.hat(m)]))
        variances.extend([noise.mag**2] * 3)
    return np.array(residuals), np.array(rows).reshape(-1, 9), np.array(variances)
