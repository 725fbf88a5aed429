"""Terms of the gains, in the paper's letters and in physical quantities, and of the initial estimate."""

from explorer.model.glossary.term import Term

RICCATI = "Ṗ = 𝒜P + P𝒜ᵀ − P𝒞ᵀq𝒞P + V"
BLOCKS = {"xi": ("ξ", "ξ"), "position": ("p", "position"), "velocity": ("v", "velocity"), "gravity": ("g", "gravity")}
"""The block of the 13-state → its letter and its name."""


def _process(key: str, letter: str, name: str) -> Term:
    return Term(
        label=f"process noise V({letter})",
        meaning=f"How much {name} may drift in a second, squared: larger forgets faster and is noisier.",
        place="paper, eq. 8",
        fields=(f"gains.riccati.v.{key}",),
    )


def _initial(key: str, letter: str, name: str) -> Term:
    return Term(
        label=f"initial variance P₀({letter})",
        meaning=f"How wrong {name} may be at the start, squared.",
        place="paper, eq. 8",
        fields=(f"gains.riccati.p0.{key}",),
    )


PAPER_GAINS = {
    "gain units": Term(
        label="show gains as",
        meaning="The same gains in the paper's letters or as physical quantities; switching changes none of them.",
    ),
    "gain mode": Term(
        label="kind of gains",
        meaning="Constant q and V as set (the paper's theorem), or worked out from the noise at every sample.",
        fields=("gains.mode",),
    ),
    "q": Term(
        label="range weight q",
        unit="1/(m⁴ s)",
        meaning="How strongly a range corrects the estimate: the inverse noise density of y = ½d².",
        formula=RICCATI,
        place="paper, eq. 8",
        advice="Larger trusts the ranges more.",
        fields=("gains.riccati.q",),
    ),
    **{f"v {key}": _process(key, letter, name) for key, (letter, name) in BLOCKS.items()},
    **{f"p0 {key}": _initial(key, letter, name) for key, (letter, name) in BLOCKS.items()},
    "k1": Term(
        label="attitude gain k1",
        unit="1/s",
        meaning="How fast the attitude filter turns the estimate towards its two measured directions.",
        formula="σ = k1 (ρ1 m × R̂ᵀm + ρ2 ĝ × R̂ᵀg)",
        place="paper, eq. 9",
        fields=("gains.attitude.k1",),
    ),
    "rho1": Term(
        label="trust in the magnetometer ρ1",
        meaning="The weight of the magnetic direction, a vector of length 1, in the attitude filter.",
        place="paper, eq. 9",
        fields=("gains.attitude.rho1",),
    ),
    "rho2": Term(
        label="trust in gravity ρ2",
        unit="s⁴/m²",
        meaning="The weight of the estimated gravity in the attitude filter; it multiplies |g|² ≈ 96.",
        place="paper, eq. 9",
        advice="A weight of 1 makes the filter stiff at a low IMU rate.",
        fields=("gains.attitude.rho2",),
    ),
    "schedule": Term(
        label="scheduled k1",
        meaning="k1 is high while measured and expected directions differ, and low afterwards; the paper's theorem "
        "does not cover it.",
        fields=("gains.attitude.schedule",),
    ),
    "steady": Term(
        label="final k1",
        unit="1/s",
        meaning="k1 once the directions agree; not above the attitude gain itself.",
        fields=("gains.attitude.schedule.steady", "schedule.steady"),
    ),
    "halfway": Term(
        label="misalignment at half way",
        meaning="The misalignment, 0 to 2, at which k1 is the geometric mean of its highest and its lowest value.",
        fields=("gains.attitude.schedule.halfway",),
    ),
    "memory": Term(
        label="smoothing time",
        unit="s",
        meaning="The time constant that takes the magnetometer's noise out of the misalignment.",
        fields=("gains.attitude.schedule.memory",),
    ),
}
PHYSICAL_GAINS = {
    "range_sigma": Term(
        label="assumed range noise",
        unit="m",
        meaning="The standard deviation of a range for which q is made.",
        formula="q = rate/(d²σ² + ½σ⁴)",
    ),
    "accel_sigma": Term(
        label="assumed accelerometer noise",
        unit="m/s²",
        meaning="The standard deviation of an accelerometer sample, which decides V(ξ).",
    ),
    "gyro_sigma": Term(
        label="assumed gyro noise",
        unit="rad/s",
        meaning="The standard deviation of a gyro sample, which decides V(g).",
        formula="V(g) = ⅔|g|²σ²/rate",
    ),
    "position_factor": Term(
        label="position drift factor",
        meaning="V(p) divided by the V(p) that the gyro's noise alone causes; at 1 there is nothing else.",
    ),
    "velocity_factor": Term(
        label="velocity drift factor",
        meaning="V(v) divided by the V(v) that the noise of gyro and accelerometer causes; at 1 there is nothing else.",
    ),
    "position_box": Term(
        label="initial position error ±",
        unit="m",
        meaning="By how much the start may be wrong on each axis.",
        formula="P₀(p) = b²/3",
    ),
    "velocity_box": Term(
        label="initial velocity error ±",
        unit="m/s",
        meaning="By how much the initial velocity may be wrong on each axis.",
        formula="P₀(v) = b²/3",
    ),
    "gravity_box": Term(
        label="initial gravity error ±",
        unit="m/s²",
        meaning="By how much the initial gravity may be wrong on each body axis.",
        formula="P₀(g) = b²/3",
    ),
    "xi_factor": Term(
        label="initial ξ factor",
        meaning="P₀(ξ) divided by the mean variance that ξ₁…ξ₄ have for the three initial errors ± above.",
    ),
    "attitude_time": Term(
        label="slowest time constant T",
        unit="s",
        meaning="How long the slowest part of a small attitude error takes to fall to a third; it decides k1.",
    ),
    "gravity_weight": Term(
        label="gravity over magnetometer weight",
        meaning="How much the direction of gravity counts, as a multiple of the magnetic direction; it decides ρ2.",
        formula="ρ2|g|²/(ρ1|m|²)",
    ),
}
START = {
    "initial estimate": Term(
        label="initial estimate x̂(0)",
        meaning="Zero as in the paper's scenario, the true state, or the truth plus the offsets below.",
        fields=("guess.state",),
    ),
    "initial angle": Term(
        label="initial attitude error",
        unit="°",
        meaning="The angle between the true and the first estimated attitude; near 180° the filter lingers.",
        formula="R̃(0) = R(0)R̂(0)ᵀ",
        place="paper, U_π",
        fields=("guess.attitude_angle",),
    ),
    "initial axis": Term(
        label="axis of the attitude error",
        meaning="The axis of the initial attitude error in inertial axes, of any length but zero.",
        fields=("guess.attitude_axis",),
    ),
    "position offset": Term(
        label="position offset",
        unit="m",
        meaning="Added to the true position, in inertial axes, if the estimate starts from the truth plus offsets.",
        fields=("guess.position_offset",),
    ),
    "velocity offset": Term(
        label="velocity offset",
        unit="m/s",
        meaning="Added to the true velocity, in inertial axes, if the estimate starts from the truth plus offsets.",
        fields=("guess.velocity_offset",),
    ),
    "gravity offset": Term(
        label="gravity offset",
        unit="m/s²",
        meaning="Added to the true gravity, in inertial axes, if the estimate starts from the truth plus offsets.",
        fields=("guess.gravity_offset",),
    ),
}
