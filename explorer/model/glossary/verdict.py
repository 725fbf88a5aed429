"""Terms of the verdict: what can be seen, how well, whether the observer gets there, and whether it can be flown."""

from explorer.model.glossary.term import Term

VERDICT = {
    "verdict": Term(
        label="verdict",
        meaning="Whether one range determines the position on this motion: observable, weak, blind, or not judged.",
    ),
    "observable": Term(
        label="observable",
        meaning="Every window determines all 13 quantities, and its predicted error meets the requirement.",
    ),
    "weak": Term(
        label="weak",
        meaning="Every window determines all 13 quantities, but the predicted error is larger than required.",
    ),
    "blind": Term(
        label="blind",
        meaning="Some window leaves a direction of the state undetermined, however exact the ranges are.",
    ),
    "not judged": Term(
        label="not judged",
        meaning="The snap of the path comes from a fit, or the path jumps, so its excitation proves nothing.",
    ),
    "rank": Term(
        label="quantities determined",
        meaning="How many of the 13 quantities the ranges of one window determine: ξ, position, velocity, gravity.",
        formula="rank W",
        place="paper, uniform observability",
    ),
    "excitation": Term(
        label="excitation μ",
        unit="m²/s⁷",
        meaning="How much the path snaps along its least excited direction, over one window.",
        formula="μ = λ_min ∫ p⁗p⁗ᵀ dτ",
        place="paper, PE lemma; errata: inertial axes",
    ),
    "weakest direction": Term(
        label="weakest direction",
        meaning="The least eigenvalue of the Gramian W, in SI units; below the noise floor it is rounding.",
        formula="λ_min(W)",
    ),
    "window accuracy": Term(
        label="best error from one window",
        unit="m",
        meaning="The 1-σ position error that the ranges of one window allow, with a perfect IMU and no initial guess.",
        formula="√tr of the position block of σ²W⁻¹ (Cramér–Rao)",
        advice="The observer also uses earlier windows, and has a noisy IMU.",
    ),
    "wanted error": Term(
        label="position error wanted",
        unit="m",
        meaning="The largest error from one window that counts as observable; above it a motion is weak.",
        fields=("requirement.position_sigma",),
    ),
    "wanted excitation": Term(
        label="excitation μ wanted",
        unit="m²/s⁷",
        meaning="The least excitation that every window must have.",
        fields=("requirement.mu",),
    ),
    "linear model": Term(
        label="linear model",
        meaning="The paper's 13 quantities, counted as independent of each other, in which the system is linear.",
        place="paper, eq. 6–7",
    ),
    "true model": Term(
        label="true model",
        meaning="Position, velocity and gravity alone, 9 quantities, whose ranges are not linear in the state.",
    ),
    "expected error": Term(
        label="error the observer expects (1 σ)",
        unit="m",
        meaning="The square root of the trace of the position block of the observer's covariance P.",
    ),
    "settled": Term(
        label="settled",
        unit="s",
        meaning="From when the error stays below 0.3 m, or 5°, to the end, for a tenth of the run or longer.",
    ),
    "steady error": Term(
        label="steady error",
        unit="m",
        meaning="The root mean square of the error over the last quarter of the run.",
    ),
    "diverged": Term(
        label="diverged",
        meaning="The observer's own 1 σ of the position exceeds 100 m, its innovations are 3 times too large, or its "
        "distance from the anchor is wrong by 3 times the longest range and does not come back.",
    ),
    "range fit": Term(
        label="fit to the ranges",
        meaning="Whether measured minus expected ranges have no mean and are white and, with noise-matched gains, are "
        "as small as they should be; it does not judge the covariance of constant gains.",
    ),
    "initial guess": Term(
        label="initial guess",
        meaning="Where the observer starts; along a blind direction the error at the end depends on it alone.",
    ),
    "model": Term(
        label="model",
        meaning="What the observer assumes of motion and sensors; a sensor with another effect leaves a lasting error.",
    ),
    "misprint": Term(
        label="the paper's misprinted model",
        meaning="C₅ = 0 and B with |g|², as printed; derived are C₅ = 6 on g and 3|g|² into ξ₄.",
        place="paper, eq. 6–7",
    ),
    "vehicle limits": Term(
        label="vehicle limits",
        meaning="The largest thrust, speed, tilt and turn rate of the vehicle, with 35 % of the thrust in reserve.",
    ),
    "thrust": Term(
        label="thrust over weight",
        meaning="The largest thrust that the motion needs, in multiples of the vehicle's weight.",
        formula="|p̈ − g|/|g|",
    ),
    "jump": Term(
        label="jump",
        meaning="A place where position, velocity or acceleration of the path changes at once; no vehicle follows it.",
    ),
    "evil twin": Term(
        label="evil twin",
        meaning="Another motion with the same ranges, IMU readings and magnetometer readings.",
    ),
    "consistency": Term(
        label="consistency (NIS, NEES)",
        meaning="Whether errors and innovations are as large as the observer's covariance says.",
        formula="NIS = ν²/S, NEES = eᵀP⁻¹e",
    ),
}
COMPARE = {
    "runs": Term(
        label="runs",
        meaning="How many noise seeds are run, 1 to 100, counted up from the noise seed.",
    ),
    "ekf": Term(
        label="extended Kalman filter (EKF)",
        meaning="A filter on position, velocity and attitude with the range itself, from the same start.",
        advice="It is better near the truth, and lost from a start that is too wrong.",
    ),
    "refinement": Term(
        label="refinement afterwards",
        meaning="An iterated smoother of the whole record, started by the observer: the best that all ranges allow.",
    ),
    "exactness": Term(
        label="settle soon ⟷ err less, w",
        meaning="What the search of gains prefers: 0 settles soonest, 1 is most exact afterwards.",
        formula="J = (1 − w) ln(settling time) + w ln(steady error)",
    ),
    "tuning runs": Term(
        label="runs per try",
        meaning="On how many noise seeds each set of gains is tried, 1 to 32; the result is judged on as many others.",
    ),
    "tries": Term(
        label="sets of gains to try",
        meaning="How many sets of gains the search tries, 1 to 2000.",
    ),
}
