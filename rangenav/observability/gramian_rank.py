"""The 13 functions of a window in coordinates that keep their small differences: polynomials, and what they leave.

With u = 2τ/δ − 1 in [−1, 1], P = p − Σ₀³ Cₖ Lₖ(u) is the path less its cubic fit. D = P + Σ₀³ Kₖ Lₖ(u), K known, and
    [L₀ … L₃ | Pᵢ, u Pᵢ + k₄ᵢ L₄, u² Pᵢ + d₄ᵢ L₄ + d₅ᵢ L₅] M = [1, τ, τ²/2, τ³/6, Dᵢ, τDᵢ, ½τ²Dᵢ]
k₄, d₄, d₅ are the coefficients of L₄ and L₅ in uD and u²D. M (see `coordinates`) can be inverted for every K, so the
rank is 4 plus the rank of the last nine columns less their cubic fits: the remainders. −½gτ² is in K alone. In D
itself, 441 km of it over 300 s hide a motion of metres.

A remainder carries the rounding of its column before projection, which is the column's floor. A remainder below its
floor is zero. Singular values are taken of the remainders in units of their floors: those above 1 count.
"""

from dataclasses import replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy import ndarray as Array

from rangenav.inputs import Vec3
from rangenav.observability import coordinates, cubic_fit, rows
from rangenav.observability.coordinates import STATES, TIMES_U, TIMES_U_TWICE, UNKNOWNS, Coordinates
from rangenav.observability.cubic_fit import CUBIC, CubicFit
from rangenav.observability.rows import Moment, PathSamples
from rangenav.results import result

ROUNDING = 4 * np.finfo(float).eps
"""A column's floor in units of its size. Degenerate motions over .2 to 600 s leave a tenth of it at most."""
SMALLEST = 1e-30
"""m: the size of a path that rests at its origin, so that its floors are not zero."""


@result
class Remainders:
    """The weighted rows of w windows in these coordinates; x = M⁻¹ z are the states in units of 1 m and δ."""

    triangle: Float[Array, "w 13 13"]
    """R of their QR decomposition."""
    floor: Float[Array, "w 9"]
    """The rounding of each remainder."""
    departure: Float[Array, "w 4 3"]
    """K: Legendre coefficients of D less P (m), axes turned by `turn`."""
    turn: Float[Array, "3 3"]
    """Inertial axes to axes whose third is that of gravity: d₄ is large along this one alone."""
    moment: Moment
    """When the states are: at the windows' starts or ends."""
    window: float
    inverse: Float[Array, "w 9 9"] | None = None
    """Of the remainders' triangle, not finite where it has none; None where nobody has computed it."""

    def some(self, chosen: Array) -> "Remainders":
        """Those of the chosen windows: indices, or a mask."""
        return replace(
            self,
            triangle=self.triangle[chosen],
            floor=self.floor[chosen],
            departure=self.departure[chosen],
            inverse=None if self.inverse is None else self.inverse[chosen],
        )

    @cached_property
    def decomposition(self) -> tuple[Float[Array, "w 9 9"], Float[Array, "w 9"], Float[Array, "w 9 9"]]:
        """The singular value decomposition U, S, Vᵀ of the remainders in units of their floors."""
        return np.linalg.svd(self.triangle[:, CUBIC:, CUBIC:] / self.floor[:, None, :])

    @property
    def singular(self) -> Float[Array, "w 9"]:
        """Singular values of the remainders in units of their floors, descending; those above 1 count."""
        return self.decomposition[1]

    @cached_property
    def states(self) -> Float[Array, "w 13 13"]:
        """M⁻¹: the 13 coordinates in units of 1 m and δ, inertial axes, from those of these columns."""
        return self._with(self.coordinates.states, self.coordinates.states_of_departure)

    @property
    def unknown_states(self) -> Float[Array, "9 9"]:
        """The block of M⁻¹ for position, velocity and gravity: it has no K, so their errors are the remainders'."""
        return self.coordinates.states[CUBIC:, CUBIC:]

    @cached_property
    def columns(self) -> Float[Array, "w 13 13"]:
        """M: these columns' coordinates from the 13."""
        return self._with(self.coordinates.columns, self.coordinates.columns_of_departure)

    @property
    def coordinates(self) -> Coordinates:
        """What M and M⁻¹ have in common in all windows."""
        return coordinates.of(self.moment, self.turn)

    def _with(self, constant: Float[Array, "13 13"], of_departure: Float[Array, "12 36"]) -> Float[Array, "w 13 13"]:
        """A matrix for each window whose block of the polynomials by the unknowns is linear in K."""
        result = np.empty((len(self.triangle), STATES, STATES))
        result[:] = constant
        block = self.departure.reshape(-1, 3 * CUBIC) @ of_departure
        result[:, :CUBIC, CUBIC:] = block.reshape(-1, CUBIC, UNKNOWNS)
        return result

    @cached_property
    def regular(self) -> tuple[Float[Array, "w 9 9"], Bool[Array, "w"]]:
        """See `regular`."""
        return regular(self)

    @cached_property
    def rank(self) -> Int[Array, "w"]:
        """Of all 13 functions. Only what the inverse of a triangle does not show to be 13 is decomposed."""
        counts = self.regular[1]
        rank = np.full(len(counts), STATES)
        if not counts.all():
            rank[~counts] = CUBIC + np.sum(self.some(~counts).singular > 1.0, axis=1)
        return rank


def of(
    samples: PathSamples, gravity: Vec3, weight: Float[Array, "v k"], moment: Moment, *, compiled: bool = False
) -> Remainders:
    """The remainders of windows whose samples are known, with these weights of their rows.

    compiled: by compiled code, with the inverses. It takes a fifth of the time, but more than half a second to load.
    """
    turn, fall = _turn(gravity)
    turned = _turned(samples, turn)
    fit = cubic_fit.of(turned)
    if compiled:
        R, inverse = _compiled(turned, fit, weight, fall)
        return replace(_with_departure(turned, fit.cubic, R, weight, turn, fall, moment), inverse=inverse)
    made = ((inside, _columns(some, fit.some(inside), fall)) for inside, some in rows.parts(turned))
    R = rows.factors(turned, weight, made)
    if R.shape[1] < STATES:  # fewer rows than columns: rows of zeros tell nothing
        R = np.pad(R, ((0, 0), (0, STATES - R.shape[1]), (0, 0)))
    return _with_departure(turned, fit.cubic, R, weight, turn, fall, moment)


def _compiled(
    samples: PathSamples, fit: CubicFit, weight: Float[Array, "v k"], fall: float
) -> tuple[Float[Array, "w 13 13"], Float[Array, "w 9 9"]]:
    """R of the weighted columns of each window, and the inverse of its remainders' triangle."""
    from rangenav.kernels import remainder_rows as kernel

    k4, high = _high(fit.cubic, fall, samples.window)
    w = len(samples.start)
    known = np.concatenate([part.reshape(w, -1) for part in (fit.cubic, k4, high)], axis=1)
    R, inverse = np.empty((w, STATES, STATES)), np.empty((w, UNKNOWNS, UNKNOWNS))
    kernel.run(samples.curved, fit.polynomials, np.sqrt(weight), known, R, inverse)
    return R, inverse


def at_other_end(of: Remainders, samples: PathSamples, gravity: Vec3, weight: Float[Array, "v k"]) -> Remainders:
    """The remainders for the states at the other ends of the windows, whose triangle is the same."""
    turn, fall = _turn(gravity)
    moment: Moment = "start" if of.moment == "end" else "end"
    turned = _turned(samples, turn)
    return _with_departure(turned, cubic_fit.of(turned).cubic, of.triangle, weight, turn, fall, moment)


def _with_departure(
    turned: PathSamples,
    cubic: Float[Array, "w 4 3"],
    R: Float[Array, "w 13 13"],
    weight: Float[Array, "v k"],
    turn: Array,
    fall: float,
    moment: Moment,
) -> Remainders:
    departure = _departure(turned, cubic, fall, moment)
    size = np.broadcast_to(turned.size[:, None], (len(R), UNKNOWNS)).copy()
    size[:, -1] += np.abs(_times_u_twice(departure)[:, CUBIC, 2])
    total = np.sqrt(np.broadcast_to(weight, (len(R), weight.shape[1])).sum(axis=1))
    floor = ROUNDING * total[:, None] * np.maximum(size, SMALLEST)
    return Remainders(triangle=R, floor=floor, departure=departure, turn=turn, moment=moment, window=turned.window)


def regular(of: Remainders) -> tuple[Float[Array, "w 9 9"], Bool[Array, "w"]]:
    """The inverse of the remainders' triangle of each window where it shows that all of them count, and which these
    windows are; zeros elsewhere.

    In units of the floors no singular value is less than 1/|inverse|. An inverse takes a fifth of the time of a
    singular value decomposition.
    """
    triangle = of.triangle[:, CUBIC:, CUBIC:]
    counts = np.all(np.abs(np.diagonal(triangle, axis1=1, axis2=2)) > of.floor, axis=1)
    inverses = np.zeros_like(triangle)
    inverses[counts] = np.linalg.inv(triangle[counts]) if of.inverse is None else of.inverse[counts]
    counts &= np.linalg.norm(of.floor[..., None] * inverses, axis=(1, 2)) < 1.0
    return inverses, counts


def _turn(gravity: Vec3) -> tuple[Float[Array, "3 3"], float]:
    """An orthogonal matrix whose third axis is that of gravity, and gravity along it (m/s²)."""
    vector = np.asarray(gravity, dtype=float)
    if not vector[:2].any():
        return np.eye(3), float(vector[2])
    across = np.linalg.svd(vector[None])[2][1:]
    size = float(np.linalg.norm(vector))
    return np.concatenate([across, vector[None] / size]), size


def _turned(samples: PathSamples, turn: Array) -> PathSamples:
    """The samples in turned axes."""
    if np.array_equal(turn, np.eye(3)):
        return samples
    return replace(
        samples,
        curved=turn @ samples.curved,
        end_position=samples.end_position @ turn.T,
        end_velocity=samples.end_velocity @ turn.T,
    )


def _departure(samples: PathSamples, cubic: Array, fall: float, moment: Moment) -> Float[Array, "w 4 3"]:
    """K = C less the Legendre coefficients of p(t) + τ v(t) + ½τ² g."""
    K = cubic.copy()
    end, half = int(moment == "end"), samples.window / 2
    s = -1.0 if end else 1.0
    velocity = half * samples.end_velocity[end]
    K[:, 0] -= samples.end_position[end] + s * velocity
    K[:, 1] -= velocity
    K[:, :3, 2] -= fall / 2 * half**2 * np.array([4 / 3, 2 * s, 2 / 3])
    return K


def _times_u_twice(coefficients: Float[Array, "w 4 3"]) -> Float[Array, "w 6 3"]:
    return TIMES_U_TWICE @ coefficients


def _columns(samples: PathSamples, fit: CubicFit, fall: float) -> Float[Array, "w k 13"]:
    """[L₀ … L₃ | P, uP + k₄L₄, u²P + d₄L₄ + d₅L₅]; L₄ and L₅ are the same at the windows' starts and ends."""
    polynomials = fit.polynomials
    u = polynomials[:, 1]
    P = samples.curved - fit.cubic.swapaxes(1, 2) @ polynomials[:, :CUBIC]
    k4, high = _high(fit.cubic, fall, samples.window)
    columns = np.empty((len(P), STATES, P.shape[-1]))
    columns[:, :CUBIC], columns[:, 4:7] = polynomials[:, :CUBIC], P
    columns[:, 7:10] = u[:, None] * P + k4[..., None] * polynomials[:, None, CUBIC]
    columns[:, 10:13] = (u**2)[:, None] * P + high.swapaxes(1, 2) @ polynomials[:, CUBIC:]
    return columns.swapaxes(1, 2)


def _high(
    cubic: Float[Array, "w 4 3"], fall: float, window: float
) -> tuple[Float[Array, "w 3"], Float[Array, "w 2 3"]]:
    """k₄; d₄ and d₅."""
    K = cubic.copy()
    K[:, 2, 2] -= fall / 12 * window**2
    return TIMES_U[CUBIC, CUBIC - 1] * K[:, 3], _times_u_twice(K)[:, CUBIC:]
