"""The complementary filter on SO(3) (paper, eq. 9): Ṙ̂ = R̂ [ω_y + k1 σ]x, σ = ρ1 (m_y × R̂ᵀm) + ρ2 (ĝ_B × R̂ᵀg).

Near identity the error R̃ = R R̂ᵀ decays at the rates that are the eigenvalues of k1 (tr(M) I − M), with
M = ρ1 mmᵀ + ρ2 ggᵀ; the printed error equation has half these rates. The other equilibria are R̃ = 2uuᵀ − I, with u an
eigenvector of M; the paper prints I − 2uuᵀ, which is no rotation.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import so3
from rangenav.inputs import Input, require, require_within
from rangenav.model import ModelForm
from rangenav.motion import World

K1_RANGE = (1e-3, 1e3)
RHO_RANGE = (1e-6, 1e3)
HALFWAY_RANGE = (1e-4, 1.0)
MEMORY_RANGE = (1e-3, 1e2)
MISALIGNED = 1.0
"""The misalignment s at the start, where the error is unknown: its value at an error of 90°."""
STIFF = 1.0
"""Largest product of the fastest rate and the step. At 1 a single step removes the whole error, and adds the whole
noise of a sample to the estimate; at 2 Heun's method is unstable."""


class Schedule(Input, frozen=True, kw_only=True):
    """A gain schedule: k1 is high while the measured vectors differ from the expected ones, and low when they agree.

        k1(s) = steady (k1/steady)^(s²/(s² + halfway²)),   ṡ = (c − s)/memory,   s(0) = 1
        c = [ρ1 (1 − m_y·R̂ᵀm) + ρ2|g|² |ĝ_B − R̂ᵀg|²/(|ĝ_B|² + |g|²)] / (ρ1 + ρ2|g|²)

    c is the weighted mean of 1 − cos of the two angles; the second term stays below 2 for every ĝ_B. Near the undesired
    equilibria, which are errors of 180°, σ vanishes but c does not, so k1 stays high. The theorem assumes a constant k1
    and does not cover a schedule.
    """

    steady: float = 0.5
    """1/s: the lower end of k1, for s = 0; at most `AttitudeGains.k1`."""
    halfway: float = 0.02
    """The misalignment s at which k1 is the geometric mean of its two ends."""
    memory: float = 2.0
    """s, the time constant of the low-pass that removes the magnetometer's noise from s."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("steady", self.steady, *K1_RANGE)
        require_within("halfway", self.halfway, *HALFWAY_RANGE)
        require_within("memory", self.memory, *MEMORY_RANGE, "s")


class AttitudeGains(Input, frozen=True, kw_only=True):
    """k1 scales the whole correction; rho1 weighs the magnetometer, rho2 the estimated gravity."""

    k1: float = 4.0
    """1/s, for unit vectors; under a schedule its upper end."""
    rho1: float = 1.0
    rho2: float = 0.01
    """s⁴/m²; multiplies |g|² ≈ 96: with about 1/|g|² gravity weighs as much as the unit magnetic vector; 1 is stiff at
    low rates."""
    schedule: Schedule | None = None
    """None: k1 is constant, as in the paper."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("k1", self.k1, *K1_RANGE)
        require_within("rho1", self.rho1, *RHO_RANGE)
        require_within("rho2", self.rho2, *RHO_RANGE)
        if self.schedule is not None:
            steady = self.schedule.steady
            require(steady <= self.k1, f"schedule.steady must not exceed k1 ({self.k1:g}), got {steady:g}")


SCHEDULED = AttitudeGains(k1=8.0, schedule=Schedule())
"""Gains with a schedule. Attitude error with noise-matched gains at 200 Hz and default noise, median of 10 seeds over
the last half of 20 s: 0.28° on the paper's path and on its slowed form; a constant k1 = 4 has 0.73°. Of 10 000 random
starts all are within 5° after 9 s; with the constant k1 it is 9 982."""


def innovation(
    rotation: Float[Array, "3 3"],
    mag: Float[Array, "3"],
    gravity_body: Float[Array, "3"],
    *,
    gains: AttitudeGains,
    world: World,
) -> Float[Array, "3"]:
    """σ (body axes): k1 σ is the angular velocity that turns the estimate towards the measured vectors."""
    sigma = gains.rho1 * np.cross(mag, rotation.T @ np.asarray(world.magnetic))
    return sigma + gains.rho2 * np.cross(gravity_body, rotation.T @ np.asarray(world.gravity))


def disagreement(
    rotation: Float[Array, "3 3"],
    mag: Float[Array, "3"],
    gravity_body: Float[Array, "3"],
    *,
    gains: AttitudeGains,
    world: World,
) -> float:
    """c of `Schedule`: the distance between measured and expected vectors; between 0 and 2 without noise."""
    gravity = rotation.T @ np.asarray(world.gravity)
    weight = gains.rho2 * (gravity @ gravity)
    magnetic = 1 - mag @ rotation.T @ np.asarray(world.magnetic)
    difference = gravity_body - gravity
    inclination = (difference @ difference) / (gravity_body @ gravity_body + gravity @ gravity)
    return float((gains.rho1 * magnetic + weight * inclination) / (gains.rho1 + weight))


def gain(gains: AttitudeGains, misaligned: float) -> float:
    """k1 (1/s) at a low-passed misalignment s."""
    plan = gains.schedule
    if plan is None:
        return gains.k1
    share = misaligned**2 / (misaligned**2 + plan.halfway**2)
    return plan.steady * (gains.k1 / plan.steady) ** share


def step(
    rotation: Float[Array, "3 3"],
    misaligned: float,
    gyro: tuple[Array, Array],
    mag: tuple[Array, Array],
    gravity_body: tuple[Array, Array],
    h: float,
    *,
    gains: AttitudeGains,
    world: World,
) -> tuple[Float[Array, "3 3"], float]:
    """R̂ and s after a step of h seconds, from the signals at both of its ends: Heun's method on SO(3), of order 2.

    s relaxes exactly towards the mean of c at both ends. Without a schedule s is unchanged.
    """

    def rate(at: Array, s: float, end: int) -> Array:
        sigma = innovation(at, mag[end], gravity_body[end], gains=gains, world=world)
        return gyro[end] + gain(gains, s) * sigma

    def relaxed(towards: float) -> float:
        return misaligned if plan is None else towards + np.exp(-h / plan.memory) * (misaligned - towards)

    plan = gains.schedule
    misalignment = disagreement(rotation, mag[0], gravity_body[0], gains=gains, world=world)
    first_rate = rate(rotation, misaligned, 0)
    trial = rotation @ so3.exp(h * first_rate)
    end = rate(trial, relaxed(misalignment), 1)
    misalignment = (misalignment + disagreement(trial, mag[1], gravity_body[1], gains=gains, world=world)) / 2
    return rotation @ so3.exp(h / 2 * (first_rate + end)), relaxed(misalignment)


def decay_matrix(gains: AttitudeGains, world: World) -> Float[Array, "3 3"]:
    """M = ρ1 mmᵀ + ρ2 ggᵀ; its eigenvectors are the axes of the undesired equilibria."""
    m, g = np.asarray(world.magnetic), np.asarray(world.gravity)
    return gains.rho1 * np.outer(m, m) + gains.rho2 * np.outer(g, g)


def time_constants(gains: AttitudeGains, world: World, form: ModelForm = "derived") -> Float[Array, "3"]:
    """The three time constants (s) of a small attitude error, slowest first; the printed form has twice these.

    A schedule is taken at its lower end, since a small error has a small misalignment.
    """
    M = decay_matrix(gains, world)
    rates = gain(gains, 0.0) * np.linalg.eigvalsh(np.trace(M) * np.eye(3) - M)
    return (1.0 if form == "derived" else 2.0) / rates


def stiffness(gains: AttitudeGains, world: World, *, imu_rate: float, mag_rate: float) -> str | None:
    """One sentence if the gains are too high for the sensors' rates (Hz), None if they are not.

    The IMU's step is multiplied by the fastest rate. The magnetometer's step is multiplied by k1ρ1 alone, because the
    gravity term corrects between its samples.
    """
    fastest = gains.k1 * float(np.trace(decay_matrix(gains, world)))  # M has rank two: one rate is k1 tr M itself
    products = (
        (fastest, imu_rate, "the IMU", "k1 or rho2"),
        (gains.k1 * gains.rho1, mag_rate, "the magnetometer", "k1 or rho1"),
    )
    for rate, hertz, sensor, which in products:
        product = rate / hertz
        if product > STIFF:
            step = f"{rate:.3g}/s times {sensor}'s {1e3 / hertz:.3g} ms is {product:.2g}, above {STIFF:g}"
            return f"The attitude filter is stiff: {step}; lower {which}, or sample faster."
    return None


def equilibria(gains: AttitudeGains, world: World, form: ModelForm = "derived") -> Float[Array, "3 3 3"]:
    """The undesired equilibria R̃ = 2uuᵀ − I, u the eigenvectors of M. The printed I − 2uuᵀ have determinant −1."""
    _, axes = np.linalg.eigh(decay_matrix(gains, world))
    turns = 2 * np.einsum("ik,jk->kij", axes, axes) - np.eye(3)
    return turns if form == "derived" else -turns
