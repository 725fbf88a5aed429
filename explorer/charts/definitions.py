"""The definition of each plot: its equation, the meaning of its letters, and at most one note. All of it is HTML."""

from typing import NamedTuple


class Definition(NamedTuple):
    """An equation and one or two sentences, which a visitor unfolds."""

    equation: str
    meaning: str
    note: str = ""
    """Always on view: one line, short enough for a narrow page."""


POSITION_ERROR = Definition(
    "|p̂<sub>B</sub> − p<sub>B</sub>|, &nbsp; x̂̇ = 𝒜x̂ + b + K(y − ŷ), &nbsp; K = P𝒞ᵀQ",
    "Position relative to the anchor, body axes (paper, fig. 3). Dashed: the σ that the observer's own P claims, √tr P."
    " With constant gains P is a tuning, not a promise.",
)
VELOCITY_ERROR = Definition(
    "|v̂<sub>B</sub> − v<sub>B</sub>|, &nbsp; v̇<sub>B</sub> = −ω×v<sub>B</sub> + g<sub>B</sub> + a",
    "Velocity, body axes (paper, fig. 3). Dashed: √tr of P's velocity block.",
)
GRAVITY_ERROR = Definition(
    "|ĝ<sub>B</sub> − g<sub>B</sub>|, &nbsp; ġ<sub>B</sub> = −ω×g<sub>B</sub>",
    "Gravity seen from the body (paper, fig. 3). It feeds the attitude filter. Dashed: √tr of P's gravity block.",
)
ATTITUDE_ERROR = Definition(
    "∠R̃, &nbsp; R̃ = RR̂ᵀ, &nbsp; R̂̇ = R̂[ω<sub>y</sub> + k₁(ρ₁ m<sub>y</sub>×R̂ᵀm + ρ₂ ĝ<sub>B</sub>×R̂ᵀg)]<sub>×</sub>",
    "The angle of the attitude error (paper, eq. 9, fig. 4): 0° is right, 180° is one of the undesired equilibria.",
)
SNAP = Definition(
    "φ = ä + 2ω×ȧ + ω̇×a + ω×(ω×a) = Rᵀp⁗",
    "The snap of the path in body axes: what excites the estimate. The paper prints ä − ω×ȧ − 2ω×(ω×a), which is not"
    " zero even for a hover that turns.",
    note="Turning the body leaves |φ| as it is; the printed φ changes.",
)
EXCITATION = Definition(
    "∫<sub>t</sub><sup>t+δ</sup> p⁗ p⁗ᵀ ds ≥ μ I₃",
    "The three eigenvalues over the window that starts at t. Persistency of excitation: the least one stays above μ for"
    " all t. What is below the axis is rounding noise.",
    note="Turning the body changes no λ; it changes the printed λ.",
)
GRAMIAN = Definition(
    "W(t) = (1/δ) ∫<sub>t</sub><sup>t+δ</sup> hᵀh ds, &nbsp; h = [1, τ, τ²/2, τ³/6, Dᵀ, τDᵀ, ½τ²Dᵀ]",
    "D(s) = p(s) − p(t) − τv(t) − ½τ²g, τ = s − t. The 13 eigenvalues (SI) are squares of singular values. Below the"
    " grey floor lies rounding noise: those eigenvalues run along the floor instead.",
    note="Turning the body changes no eigenvalue: only path and gravity do.",
)
PREDICTED = Definition(
    "σ² = tr [ (Σ hᵀh / (d²σ<sub>d</sub>² + ½σ<sub>d</sub>⁴))⁻¹ ]<sub>position</sub>",
    "The best 1-σ position error at the end of the window that starts at t, from its ranges alone and perfect IMU:"
    " for the lifted linear model, and for the nonlinear range (Cramér–Rao). A blind window has none. The observer"
    " also remembers the ranges before the window, so it may do better.",
)
INNOVATION = Definition(
    "(y − ŷ) / √(𝒞P𝒞ᵀ + R<sub>d</sub>), &nbsp; y = ½d², &nbsp; R<sub>d</sub> = 1/(Q T) or the matched one",
    "What each range adds, in units of the σ that P expects. With noise-matched gains it should mostly stay within ±2.",
)
DISTANCE = Definition("d = |p − p<sub>anchor</sub>|", "The only position measurement there is: true, and as measured.")
SPEED = Definition("|ṗ|", "Of the true path, and the most that the chosen vehicle may have.")
RANK_BY_LENGTH = Definition(
    "rank W, &nbsp; W = (1/δ) ∫<sub>t</sub><sup>t+δ</sup> hᵀh ds, &nbsp; δ on the time axis",
    "How long must I fly? The window that starts with the flight, and the worst of several, as they grow. Rank counts"
    " singular values above 10⁻¹³ of the largest: what no rounding hides.",
)
SIGMA_BY_LENGTH = Definition(
    "σ(δ)² = tr [ (Σ hᵀh / (d²σ<sub>d</sub>² + ½σ<sub>d</sub>⁴))⁻¹ ]<sub>position</sub>",
    "What the ranges of a window of length δ tell of the position at its end, with a perfect IMU. Rank 13 is not yet"
    " accuracy: between the two lie metres, or kilometres.",
)
SCALED = Definition(
    "s<sub>i</sub>(W<sup>½</sup> diag(1, δ, δ², δ³, I, δI, δ²I)⁻¹)",
    "The singular values that the rank counts, in units of 1 m and δ. The grey floor is 10⁻¹³ of the largest: below"
    " lies rounding, and those run along it.",
)
FUNCTIONS = Definition(
    "{1, τ, τ²/2, τ³/6, D<sub>i</sub>, τD<sub>i</sub>, ½τ²D<sub>i</sub>}, &nbsp; D = p(t+τ) − p(t) − τv(t) − ½τ²g",
    "On the window of least rank. It is observable exactly when these are linearly independent: where one is a sum of"
    " others, the sentence above says which, and along it nothing can be told.",
)
TWIN_RANGE = Definition(
    "|p + Δp + Δv t − p<sub>anchor</sub>| = |p − p<sub>anchor</sub>|",
    "A second motion with the same gyro, accelerometer, magnetometer and range: turned about the anchor, mirrored, or"
    " found along what the range feels least.",
)
TWIN_APART = Definition(
    "|Δp + Δv t|, &nbsp; | |q + Δp + Δv t| − |q| |, &nbsp; q = p − p<sub>anchor</sub>",
    "The distance between the two motions, and how much their ranges differ: 0, or rounding, if it is exact.",
)
PHI_BOTH = Definition(
    "ä + 2ω×ȧ + ω̇×a + ω×(ω×a), &nbsp; printed: ä − ω×ȧ − 2ω×(ω×a)",
    "The derived one is the snap of the path and does not know how the body turns; the printed one does.",
)
CERTIFICATES = Definition(
    "λ<sub>min</sub> ∫<sub>t</sub><sup>t+δ</sup> φφᵀ ds ≥ μ",
    "As derived; with the printed φ; with the derived φ in body axes; and with both, as the paper has it. Where the"
    " last one stays above μ and the first does not, it certifies what cannot be observed.",
)
EFFORT = Definition(
    "|p̈ − g| / |g|, &nbsp; |ω|",
    "How many times its weight the vehicle must push, and how fast it turns (rad/s); and the most of each that the"
    " chosen vehicle can, with a margin of thrust kept in hand.",
)
NOISELESS = Definition(
    "ė = (𝒜 − K𝒞) e, &nbsp; e(0) = x̂(0) − x(0), &nbsp; K = P𝒞ᵀQ",
    "The position error that the initial error would leave without noise, and the error of this run. What lies between"
    " them at the end is the noise; what the first one takes to fade is the gains' and the motion's.",
)
CONTRACTION = Definition(
    "s<sub>i</sub>(L(t+δ)⁻¹ Ψ(t+δ, t) L(t)), &nbsp; P = LLᵀ",
    "How much of an error is left after the window that starts at t, in the metric in which the observer contracts:"
    " the slowest direction and the fastest. At 1 an error does not fade.",
)
CLOSED_LOOP = Definition(
    "Re eig(𝒜(ω, a) − K𝒞)",
    "The largest and the smallest real part at each moment. For a motion that changes they prove nothing: the largest"
    " may be positive while every error fades, as the contraction shows. In the first quarter P is large, and they may"
    " lie outside the axes.",
)
