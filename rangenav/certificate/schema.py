"""What a certificate says: finite numbers, or null and the reason.

Lengths in m, times in s, frequencies in rad/s, μ in m²/s⁷ unless a field says otherwise; figures have eight digits, and
bounds are rounded to the side on which they stay true.
"""

import math
from typing import Literal

import msgspec

from rangenav.inputs import Vec3

FORMAT, VERSION = "rangenav-certificate", 2
DIGITS = 8
"""Of every figure: more would differ between processors, fewer would not tell presets apart."""
Expectation = Literal["observable", "weak", "unobservable"]
Starts = Literal["every t >= 0", "every t in [0, duration - window]"]
Names = Literal["excitation", "rank", "accuracy", "smooth", "vehicle", "source"]


class Part(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Base of every part: keys that are not known are refused."""


class Loop(Part, frozen=True, kw_only=True):
    """The part of a file that is flown again and again."""

    begin: float
    """s, in the file."""
    end: float


class Artifact(Part, frozen=True, kw_only=True):
    """The file that is certified, by its bytes."""

    format: str
    """"preset", or the exchange format it was written in."""
    sha256: str
    bytes: int
    covers: str | msgspec.UnsetType = msgspec.UNSET
    """The part of the file that is certified, where that is not the whole file."""
    loop: Loop | msgspec.UnsetType = msgspec.UNSET
    """The loop of a file that is certified for being flown again and again; other files are flown once."""


class Tool(Part, frozen=True, kw_only=True):
    """The versions that computed the certificate. Verification reports other versions and does not fail."""

    rangenav: str
    python: str
    numpy: str


class Frame(Part, frozen=True, kw_only=True):
    """Axes, and the sign of gravity as it enters v̇ = g + R a."""

    gravity: Vec3
    """m/s²"""
    up: str
    """The axis that points away from gravity: "-z" where z points down, or the vector itself."""
    body: str
    """Where the attitude comes from: flown along the path, or an angular velocity of its own."""


class Claim(Part, frozen=True, kw_only=True):
    """For which windows the excitation is bounded."""

    starts: Starts
    window: float
    duration: float
    period: float | None
    reason: str | msgspec.UnsetType = msgspec.UNSET


class Scope(Part, frozen=True, kw_only=True):
    """Which windows a figure speaks of, and whether it is proven of all of them. Version 1 has none."""

    basis: Literal["proven", "sampled"]
    """Sampled: between the starts that were evaluated nothing is claimed."""
    starts: Starts
    reason: str | msgspec.UnsetType = msgspec.UNSET
    """Why it is not said of every t >= 0."""


class Excitation(Part, frozen=True, kw_only=True):
    """λ_min of ∫p⁗p⁗ᵀ over the windows of the claim."""

    required: float
    lower: float | None
    """No window has less: a bound between grid points too."""
    upper: float | None
    """The worst window has no more."""
    upper_everywhere: float | None
    """No window has more."""
    found: float | None
    """On the worst window of the grid; null where it lies below the floor of rounding."""
    floor: float
    at: float
    """Where the worst window starts."""
    direction: Vec3
    """Along it that window is excited least."""
    starts: int
    """Points of the grid between which the bound holds."""
    scope: Scope | msgspec.UnsetType = msgspec.UNSET
    reason: str | msgspec.UnsetType = msgspec.UNSET


class Rank(Part, frozen=True, kw_only=True):
    """Of the lifted Gramian, on the window where it is least. In version 1 it is that of sampled windows."""

    rank: int
    of: int
    tolerance: float
    """A scaled singular value counts above this share of the largest."""
    rounded: bool | msgspec.UnsetType = msgspec.UNSET
    """True if the rank there is 13, as a longer window shows, and `rank` is lower because of rounding alone."""
    smallest_singular: float | None
    """The thirteenth on the worst window, in units of 1 m and δ; null where it does not count."""
    smallest_bound: float | msgspec.UnsetType | None = msgspec.UNSET
    """No window has a smaller thirteenth singular value."""
    at: float
    nonlinear: int
    """Rank of the nonlinear problem, of 9, on its worst window."""
    windows: int
    """Evaluated: windows in version 1, windows and their cores from version 2 on. The nonlinear rank is sampled."""
    blind: tuple[str, ...]
    """What the worst window cannot tell, in words."""
    scope: Scope | msgspec.UnsetType = msgspec.UNSET
    """Of the rank."""
    reason: str | msgspec.UnsetType = msgspec.UNSET


class Sigma(Part, frozen=True, kw_only=True):
    """Predicted 1-σ as sqrt(trace)."""

    position: float | None
    """m"""
    velocity: float | None
    """m/s"""
    gravity: float | None
    """m/s²"""
    reason: str | msgspec.UnsetType = msgspec.UNSET


class Ends(Part, frozen=True, kw_only=True):
    """At the start and at the end of the window."""

    start: Sigma
    end: Sigma


class Accuracy(Part, frozen=True, kw_only=True):
    """Predicted on the window worst for the lifted position at its end, from its ranges alone.

    In version 1 that is the worst sampled window, with a range at its start.
    """

    required: float
    """m, of the lifted position at the window's end."""
    at: float
    ranges: int | msgspec.UnsetType = msgspec.UNSET
    """In that window, of those that are measured at k / range_rate."""
    bound: float | msgspec.UnsetType | None = msgspec.UNSET
    """m; no window predicts more for the lifted position at its end."""
    rounded: bool | msgspec.UnsetType = msgspec.UNSET
    """True if the ranges of the worst window leave the position undetermined because of rounding alone, as far as is
    known."""
    scope: Scope | msgspec.UnsetType = msgspec.UNSET
    """Of the bound."""
    sphere: float | msgspec.UnsetType = msgspec.UNSET
    """m; the diameter of the largest sphere on which a range leaves the position. A larger error says nothing, and
    misses any requirement."""
    range_sigma: float
    range_rate: float
    """Hz"""
    noise: str
    reason: str | msgspec.UnsetType = msgspec.UNSET
    lifted: Ends
    nonlinear: Ends


class Extremes(Part, frozen=True, kw_only=True):
    """The extremes of the motion on the IMU's samples in [0, duration]."""

    speed: float
    acceleration: float
    jerk: float
    snap: float
    thrust_to_weight: float
    tilt_deg: float
    body_rate: float
    height_min: float
    height_max: float
    """Above the origin of the inertial frame, against gravity."""
    anchor_distance_min: float
    rate: float
    """Hz, of the samples."""


class Flyability(Part, frozen=True, kw_only=True):
    """Whether the preset's vehicle can do that."""

    name: str
    flyable: bool
    thrust_margin: float
    """The share of its thrust that is kept in hand."""
    broken: tuple[str, ...]
    """A sentence for each limit that is broken."""


class Jumps(Part, frozen=True, kw_only=True):
    """The largest jump of each derivative at any knot in [0, duration]."""

    knots: int
    position: float
    velocity: float
    acceleration: float
    jerk: float
    snap: float


class SourceFile(Part, frozen=True, kw_only=True):
    """The file that the path was imported from."""

    file: str
    sha256: str
    format: str
    derivatives: Literal["file", "fit"]
    """Whether the derivatives up to snap stood in that file, or come from fitting."""
    fitted: str
    edited: bool
    """The path was changed since, and is a design."""


class Check(Part, frozen=True, kw_only=True):
    """One requirement."""

    name: Names
    met: bool
    proven: bool
    """Met or missed by a bound, and not by samples."""
    words: str


class Certificate(Part, frozen=True, kw_only=True):
    """All that was recomputed from the bytes of one file."""

    format: Literal["rangenav-certificate"] = FORMAT
    version: Literal[1, 2] = VERSION
    """Version 1 sampled the rank and the accuracy; it is verified by what it claimed."""
    title: str
    expect: Expectation
    certified: bool
    """The checks come out as `expect` says."""
    meets: bool
    """Whether all requirements are met, whatever the preset expects. An export needs this."""
    verdict: Literal["blind", "weak", "observable", "not judged"]
    """Not judged: what the figures below say is about a fit, or about a path that jumps."""
    caveats: tuple[str, ...] | msgspec.UnsetType = msgspec.UNSET
    """Why the verdict holds of no real flight, a sentence each."""
    verdict_reason: str | msgspec.UnsetType = msgspec.UNSET
    """Why it is not judged, or blind although its rank is 13."""
    checks: tuple[Check, ...]
    failures: tuple[str, ...]
    """Why it is not certified, a sentence each."""
    remedy: str | msgspec.UnsetType = msgspec.UNSET
    """Version 1 only: a change that would meet the requirements. A search found it; no certificate proves it."""
    claim: Claim
    excitation: Excitation
    rank: Rank
    accuracy: Accuracy
    limits: Extremes
    vehicle: Flyability
    jumps: Jumps
    frame: Frame
    source: SourceFile | msgspec.UnsetType = msgspec.UNSET
    """Of a path that was imported; a design has none."""
    artifact: Artifact
    context: str | msgspec.UnsetType = msgspec.UNSET
    """A preset's TOML text that says what the file itself does not hold (world, sensors, requirement, vehicle)."""
    tool: Tool


def figure(value: float, *, toward: Literal[-1, 0, 1] = 0) -> float:
    """The value to eight digits: the nearest, or the next one below (−1) or above (1), where a bound stays a bound."""
    if value == 0 or not math.isfinite(value):
        return value
    rounded = float(f"{value:.{DIGITS - 1}e}")
    if toward == 0 or (rounded - value) * toward >= 0:
        return rounded
    unit = 10.0 ** (math.floor(math.log10(abs(value))) - DIGITS + 1)
    return float(f"{rounded + toward * unit:.{DIGITS - 1}e}")


def known(value: float) -> float | None:
    """The figure, None where it is not finite."""
    return figure(value) if math.isfinite(value) else None
