"""The summary of a preset: drawings of its path, its badge, its story, and figures of its certificate.

All text of the preset is escaped."""

import html
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from explorer.model import palette
from explorer.model.certificate_text import certificate_sentence
from explorer.storage.certifier import CertificateOrReason
from explorer.widgets.html import escaped, folded, upper_first
from rangenav.certificate import Certificate
from rangenav.number_format import quantity, significant
from rangenav.preset import Preset

SIDE, MARGIN, POINTS = 92, 7, 240
"""px of one drawing and of the space around its path; points along it."""
CACHED_DRAWINGS = 64
"""The largest number of drawings in the cache."""
BADGES = {
    "observable": ("●", palette.GOOD, "CERTIFIED OBSERVABLE"),
    "weak": ("▲", palette.WARNING, "CERTIFIED WEAK"),
    "unobservable": ("✕", palette.UNOBSERVABLE, "CERTIFIED UNOBSERVABLE"),
}
"""Shape, colour (on white, on black) and text of the badge of a certified preset, by the verdict it expects."""
UNCERTIFIED = ("◌", palette.ERROR, "UNCERTIFIED")
BEING_CERTIFIED = ("◌", palette.NEUTRAL, "BEING CERTIFIED …")
EXPECTED_TEXTS = {
    "observable": "● expected observable",
    "weak": "▲ expected weak",
    "unobservable": "✕ expected unobservable",
}
CHANGED = (
    "Changed since it was opened. The verdict over the scene is about this motion; saving or exporting certifies it."
)
DIMMED = f"color:{palette.CAPTION_TEXT}"
LINE = f'<polyline points="{{}}" fill="none" stroke="{palette.THUMBNAIL_LINE}" stroke-width="1.5"'
LINE += ' stroke-linejoin="round"/>'
START = f'<circle cx="{{:.1f}}" cy="{{:.1f}}" r="2.5" fill="{palette.THUMBNAIL_LINE}"/>'
ANCHOR = f'<path d="M{{x:.1f}} {{y:.1f}}m0-4l4 7h-8z" fill="{palette.THUMBNAIL_ANCHOR}"/>'
STYLE = "font-size:0.85em;line-height:1.45;padding:0 0.9em 0.6em;overflow-wrap:anywhere"
CAPTION = f'<figcaption style="{DIMMED};font-size:max(0.8em, var(--rn-least, 0px))">{{}}</figcaption>'
FIGURE = f'<figure style="margin:0;text-align:center">{{}}{CAPTION}</figure>'
FRAME = f"border:1px solid {palette.THUMBNAIL_FRAME};border-radius:4px"
BOX = f'<svg width="{{0}}" height="{{0}}" style="{FRAME}" role="img" aria-label="{{1}}">'
AXES = np.eye(3)


def card(preset: Preset, certificate_or_reason: CertificateOrReason | None) -> str:
    """The summary of a preset as it was opened, as HTML. None in place of a certificate: it is being computed."""
    certified = isinstance(certificate_or_reason, Certificate) and certificate_or_reason.certified
    known = certified or preset.source is not None  # the badge says it; and an imported file expects nothing
    expected = "" if known else f"<b>{EXPECTED_TEXTS[preset.expect]}</b><br>"
    parts = (
        _badge(preset, certificate_or_reason),
        _story(preset),
        f'<div style="{DIMMED}">{expected}{_figures(preset, certificate_or_reason)}</div>',
    )
    return _framed(preset, html.escape(preset.title), *parts)


def card_of_changed(shown: Preset, opened: Preset, certificate_or_reason: CertificateOrReason | None) -> str:
    """The summary of what is on the page, which was `opened` and changed. The badge of the file is dimmed and short:
    its colour and its reasons belong to a motion that is not on the page any more."""
    shape, _, text = badge(opened, certificate_or_reason)
    as_opened = f'<div style="{DIMMED}">As opened: {shape} {text.lower()}.{_story(opened)}</div>'
    return _framed(shown, f"{html.escape(opened.title)} • changed, not saved", f"<div>{CHANGED}</div>", as_opened)


def _framed(preset: Preset, title: str, *parts: str) -> str:
    """A title and parts below the drawings of a preset."""
    pictures = f'<div style="display:flex;gap:0.8em;padding:0.3em 0">{drawings(preset)}</div>'
    return f'<div style="{STYLE}">{pictures}<div style="font-weight:600">{title}</div>{"".join(parts)}</div>'


def _story(preset: Preset) -> str:
    return f"<div>{escaped(preset.story)}</div>" if preset.story else ""


def badge(preset: Preset, certificate_or_reason: CertificateOrReason | None) -> tuple[str, str, str]:
    """Shape, colour and text of a preset's badge: certified, not certified, or being certified."""
    if certificate_or_reason is None:
        return BEING_CERTIFIED
    return (
        BADGES[preset.expect]
        if not isinstance(certificate_or_reason, str) and certificate_or_reason.certified
        else UNCERTIFIED
    )


@lru_cache(maxsize=CACHED_DRAWINGS)
def drawings(preset: Preset) -> str:
    """The path over its period or the flight, from above and from the side where it is longer, as inline SVG."""
    positions = _positions(preset, POINTS)
    wide = int(np.ptp(positions[:, 1]) > np.ptp(positions[:, 0]))
    extent = " × ".join(significant(size, 2) for size in np.ptp(positions, axis=0))
    return "".join(
        FIGURE.format(picture(preset, AXES[:, axes], SIDE, POINTS, text), caption)
        for axes, text, caption in (
            ([0, 1], "the path from above", "from above"),
            ([wide, 2], "the path from the side", f"from the side; {extent} m"),
        )
    )


def picture(preset: Preset, view: Float[Array, "3 2"], side: int, points: int, text: str) -> str:
    """The path and the anchor from one side (the columns of `view` point right and up), as inline SVG."""
    positions, anchor = (
        _positions(preset, points) @ view,
        np.asarray(preset.world.anchor) * (1.0, 1.0, _up(preset)) @ view,
    )
    low, high = positions.min(axis=0), positions.max(axis=0)
    size = max(float((high - low).max()), 1e-6)
    scale, middle = (side - 2 * MARGIN) / size, (low + high) / 2

    def pixel(point: Float[Array, "... 2"]) -> Float[Array, "... 2"]:
        return side / 2 + (point - middle) * (scale, -scale)

    line = LINE.format(" ".join(f"{x:.1f},{y:.1f}" for x, y in pixel(positions)))
    x, y = pixel(anchor)
    anchor_sign = ANCHOR.format(x=x, y=y) if 0 <= x <= side and 0 <= y <= side else ""
    x, y = pixel(positions[0])
    return f"{BOX.format(side, text)}{anchor_sign}{line}{START.format(x, y)}</svg>"


def _positions(preset: Preset, points: int) -> Float[Array, "n 3"]:
    """Positions (m) along the path, z up."""
    length = min(preset.duration, preset.path.period or preset.duration)
    return preset.path(np.linspace(0.0, length, points)) * (1.0, 1.0, _up(preset))


def _up(preset: Preset) -> float:
    return -1.0 if preset.world.gravity[2] > 0 else 1.0


def _badge(preset: Preset, certificate_or_reason: CertificateOrReason | None) -> str:
    shape, colour, text = badge(preset, certificate_or_reason)
    reasons: tuple[str, ...] = ()
    if isinstance(certificate_or_reason, str):
        reasons = (certificate_or_reason,)
    elif certificate_or_reason is not None and not certificate_or_reason.certified:
        reasons = certificate_or_reason.failures
    chip = f'<span style="color:{colour};border:1px solid;border-radius:3px;padding:0 0.4em;font-weight:600">'
    return f'<div style="padding:0.15em 0 0.3em">{chip}{shape} {text}</span></div>{_reasons(reasons)}'


def _reasons(reasons: tuple[str, ...]) -> str:
    """Sentences of a certificate, with readable numbers; all but the first are folded."""
    if not reasons:
        return ""
    first, *others = (f"{upper_first(certificate_sentence(reason))}." for reason in reasons)
    count = "1 more reason" if len(others) == 1 else f"{len(others)} more reasons"
    return f"<div>{escaped(first)}</div>{folded(count, others) if others else ''}"


def _figures(preset: Preset, certificate_or_reason: CertificateOrReason | None) -> str:
    """μ and σ as the certificate has them."""
    if certificate_or_reason is None or isinstance(certificate_or_reason, str):
        return ""
    excitation, sigma = certificate_or_reason.excitation, certificate_or_reason.accuracy.lifted.end.position
    requirement = preset.requirement
    unit = f"m²/s⁷ over {quantity(requirement.window, 's', digits=4)} (required {significant(requirement.mu)})"
    if excitation.found is None:
        mu = f"μ = 0 {unit}: not above rounding errors"
    elif excitation.lower:
        mu = f"μ ≥ {significant(excitation.lower)} {unit}"
    else:
        mu = f"μ = {significant(excitation.found)} {unit}, on the evaluated windows"
    sigma_text = quantity(sigma, "m")
    return f"{mu}<br>predicted σ {sigma_text} (required {significant(requirement.position_sigma)} m)"
