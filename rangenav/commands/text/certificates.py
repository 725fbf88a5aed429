"""`rangenav certify` and `rangenav verify` for a person."""

from collections.abc import Mapping
from pathlib import Path

import msgspec

from rangenav import window_text
from rangenav.certificate import Certificate, Outcome, Verification, path_for, verdict_of
from rangenav.certificate.requirements import NO_LIMITS
from rangenav.certificate.schema import Check
from rangenav.commands.text import layout
from rangenav.commands.text.layout import Group, Report, group
from rangenav.commands.text.verdict import plus_minus
from rangenav.number_format import quantity, shortened, significant
from rangenav.preset import find
from rangenav.verdict import Sign

DIGITS = 12
"""Of a SHA-256 that are shown."""
SOURCE = "source"
"""The check whether the path's snap was in its file, which is known and needs no proof."""


def certified(certificate: Certificate, *, name: str, written: Path | None, helps: str | None) -> Report:
    """What is required of a preset, and what is proven or computed of it. helps: a change that would meet every
    requirement."""
    typed = layout.argument(name)
    kept = written or Path(name).with_name(f"{Path(name).stem}.certificate.json")
    following = f"certify {typed} -o {layout.argument(str(kept))}" if written is None else _verifying(name, written)
    if not certificate.certified:
        of_source = any(one.name == SOURCE and not one.met for one in certificate.checks)
        following = "log RECORD.csv" if of_source else f"repair {typed} -o repaired.toml"
    return Report(
        subject=layout.subject(name),
        sign="✗" if not certificate.certified else "!" if caveats(certificate) else "✓",
        answer=intended(certificate) if certificate.certified else f"NOT certified: {_refusal(certificate)}",
        title=certificate.title,
        groups=(
            *group(
                "requirements",
                (_check(one, certificate) for one in certificate.checks),
            ),
            *group("reservations", caveats(certificate)),
            *group("would help", helps),
            *group("what it covers", *coverage(certificate)),
            *group("the file", f"SHA-256 {certificate.artifact.sha256[:DIGITS]}…, {certificate.artifact.bytes} bytes"),
            *group("written", str(written) if written else None),
            *layout.next_commands(following),
        ),
    )


def _verifying(name: str, written: Path) -> str:
    """The command that verifies a certificate where it was written: `verify NAME` finds it beside its preset alone."""
    beside = path_for(find(name)).resolve() == written.resolve()
    return f"verify {layout.argument(name)}" + ("" if beside else f" --certificate {layout.argument(str(written))}")


def _refusal(certificate: Certificate) -> str:
    judged, missed = verdict_of(certificate), [one.name for one in certificate.checks if not one.met]
    if not missed:
        return f"{judged.summary}, expected {certificate.expect}"
    others = ", ".join(name for name in missed if not (name == "excitation" and judged.unmet))
    return f"{judged.summary}; not met: {others}" if others else judged.summary


def _check(one: Check, certificate: Certificate) -> str:
    """A requirement with its sign. The certificate's own sentence keeps its bytes; here it is worded for a person."""
    sign = "–" if one.words == NO_LIMITS else "✓" if one.met else "✗"
    asked = certificate.accuracy
    stored = f"{asked.required:.3g} m required of the prediction, by {asked.noise}"
    ranges = asked.noise.replace("ranges at", "ranges alone, at", 1).replace(", no IMU noise", ", and a perfect IMU")
    said = one.words.replace(stored, f"{asked.required:.3g} m required; predicted from {ranges}")
    return f"{sign} {shortened(said, 4)}{' (proven)' if one.proven and one.name != SOURCE else ''}"


def intended(certificate: Certificate) -> str:
    """The verdict of a certificate that is true of its preset: "certified: blind, as intended"."""
    reserved = ", with a reservation" if caveats(certificate) else ""
    said = f"certified{reserved}: {verdict_of(certificate).summary}"
    return said if certificate.expect == "observable" else f"{said}, as intended"


def caveats(certificate: Certificate) -> list[str]:
    """Why the verdict is of little use, one sentence each, as `analyze` has them."""
    return [] if certificate.caveats is msgspec.UNSET else [f"! {sentence}" for sentence in certificate.caveats]


def coverage(certificate: Certificate) -> tuple[str, ...]:
    """For which windows, and for which part of an exported file, the certificate speaks."""
    window, flown = certificate.claim.window, certificate.claim.duration
    excited, rank, accuracy = certificate.excitation, certificate.rank, certificate.accuracy
    bounded = excited.lower is not None if excited.scope is msgspec.UNSET else bool(excited.lower)
    missed = excited.scope is not msgspec.UNSET and excited.scope.basis == "proven" and not bounded
    every = window_text.every(window, flown, certificate.claim.starts)
    lines = [f"μ is bounded on {every}" if bounded else f"μ is sampled on windows of {quantity(window, 's')}"]
    if missed:
        lines = ["a window has a lower μ than required (proven), and no bound of μ above 0 is known"]
    if rank.scope is not msgspec.UNSET:
        none = window_text.none(window, flown, rank.scope.starts)
        proven = rank.scope.basis == "proven"
        lines.append(f"{none} has a lower rank (proven)" if proven else "the rank is that of sampled windows")
    if accuracy.scope is not msgspec.UNSET and accuracy.bound is not None:
        lines.append(f"{window_text.none(window, flown, accuracy.scope.starts)} has a larger σ (proven)")
    covers = certificate.artifact.covers
    return (*lines, *(() if covers is msgspec.UNSET else (covers,)))


def claim(certificate: Certificate) -> tuple[Group, ...]:
    """For which windows the certificate speaks, and its figures."""
    excited = certificate.excitation
    relation = "=" if not excited.lower else "≥"
    mu = excited.lower or excited.found
    figures = f"μ {relation} {quantity(mu, 'm²/s⁷')}" if mu else "μ is 0"
    sigma = certificate.accuracy.lifted.end.position
    return group(
        "what it covers",
        *coverage(certificate),
        f"{figures}, required {significant(excited.required)}; rank {certificate.rank.rank} of {certificate.rank.of}",
        f"position {plus_minus(sigma)}, required of this prediction ±{quantity(certificate.accuracy.required, 'm')}",
    )


HEADLINES: dict[Outcome, str] = {
    "holds": "holds: its bytes give the same certificate again",
    "changed": "the file has changed since it was certified",
    "differs": "the certificate states what the file does not give",
    "missed": "the file is unchanged, but a requirement is not met",
    "no certificate": "no certificate beside it to compare with",
    "not read": "cannot be verified",
}
"""The first line on one file."""


def verified(
    checked: Mapping[str, Verification], stored: Mapping[str, Certificate], missing: Mapping[str, Path]
) -> Report:
    """Whether files are what their certificates say.

    stored: the certificates of the files that hold. missing: where those of the files that have none would lie.
    """
    following = [command for name, one in checked.items() for command in _way_out(name, one, missing.get(name))]
    if len(checked) == 1:
        ((name, one),) = checked.items()
        return Report(
            subject=layout.subject(name),
            sign=_sign(one),
            answer=HEADLINES[one.outcome],
            title="" if name not in stored else stored[name].title,
            groups=(
                *group("the file", None if one.path is None else str(one.path)),
                *(() if name not in stored else _certified_figures(stored[name])),
                *layout.next_commands(*following),
            ),
        )
    signs = {_sign(one) for one in checked.values()}
    longest = max(len(layout.subject(name)) for name in checked)
    return Report(
        subject=f"{len(checked)} files",
        sign="✗" if "✗" in signs else "?" if "?" in signs else "✓",
        answer=_several([one.outcome for one in checked.values()]),
        groups=(
            *group(
                "files",
                (
                    f"{_sign(one)} {layout.subject(name):<{longest}}  "
                    f"{intended(stored[name]) if name in stored else HEADLINES[one.outcome]}{_elsewhere(name, one)}"
                    for name, one in checked.items()
                ),
            ),
            *layout.next_commands(*following),
        ),
    )


def _elsewhere(name: str, checked: Verification) -> str:
    """The path of the file that was checked, unless it is the one that was named."""
    return "" if checked.path is None or checked.path == Path(name) else f" ({checked.path})"


def _certified_figures(certificate: Certificate) -> tuple[Group, ...]:
    return (*group("verdict", intended(certificate), caveats(certificate)), *claim(certificate))


def _sign(checked: Verification) -> Sign:
    return "✓" if checked.outcome == "holds" else "?" if checked.outcome == "no certificate" else "✗"


def _way_out(name: str, checked: Verification, missing: Path | None) -> tuple[str, ...]:
    """What a person may type after a verification that failed; only a preset can be certified or repaired."""
    typed = layout.argument(name)
    if Path(name).suffix == ".json" and checked.outcome == "changed" and checked.path is not None:
        certified = layout.argument(str(checked.path))
        return (f"certify {certified} -o {typed}",) if checked.path.suffix == ".toml" else ()
    if checked.outcome in ("holds", "not read") or Path(name).suffix not in (".toml", ""):
        return ()
    if checked.outcome == "missed":
        return (f"repair {typed} -o repaired.toml",)
    if checked.outcome == "no certificate":
        beside = missing is not None and Path(name).suffix
        return (f"certify {typed} -o {layout.argument(str(missing))}",) if beside else ()
    return (f"certify {typed} -o {layout.argument(str(path_for(Path(name))))}",) if Path(name).suffix else ()


def _several(outcomes: list[Outcome]) -> str:
    """How many of several files do not hold, and how many have no certificate."""
    missing = outcomes.count("no certificate")
    wrong = len(outcomes) - missing - outcomes.count("holds")
    parts = [f"{wrong} of them {'does' if wrong == 1 else 'do'} not hold"] if wrong else []
    parts += [f"{missing} of them {'has' if missing == 1 else 'have'} no certificate"] if missing else []
    return ", ".join(parts) or "all hold: their bytes give the same certificates again"
