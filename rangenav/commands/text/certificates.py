"""`rangenav certify` and `rangenav verify` for a person."""

from collections.abc import Mapping
from pathlib import Path

import msgspec

from rangenav.certificate import Certificate
from rangenav.commands.text import layout
from rangenav.commands.text.layout import SIGNS, Group, Report, group
from rangenav.commands.text.verdict import plus_minus
from rangenav.number_format import quantity, significant

DIGITS = 12
"""Of a SHA-256 that are shown."""
SOURCE = "source"
"""The check whether the path's snap was in its file, which is known and needs no proof."""


def certified(certificate: Certificate, *, name: str, written: Path | None, helps: str | None) -> Report:
    """What was asked of a preset and what it is proven or computed to do; helps: a change that would meet it all."""
    typed = layout.argument(name)
    kept = written or Path(name).with_name(f"{Path(name).stem}.certificate.json")
    following = f"verify {typed}" if written else f"certify {typed} -o {layout.argument(str(kept))}"
    if not certificate.certified:
        of_source = any(one.name == SOURCE and not one.met for one in certificate.checks)
        following = "log RECORD.csv" if of_source else f"repair {typed} -o repaired.toml"
    expected = (
        f", as its preset expects ({certificate.expect})"
        if certificate.certified and certificate.expect != "observable"
        else ""
    )
    return Report(
        subject=layout.subject(name),
        sign="✓" if certificate.certified else "✗",
        answer=f"certified: {certificate.verdict}{expected}"
        if certificate.certified
        else f"NOT certified: {_refusal(certificate)}",
        title=certificate.title,
        groups=(
            *group(
                "requirements",
                (_check(one.met, one.proven and one.name != SOURCE, one.words) for one in certificate.checks),
            ),
            *group("would help", helps),
            *group("what it covers", *coverage(certificate)),
            *group("the file", f"SHA-256 {certificate.artifact.sha256[:DIGITS]}…, {certificate.artifact.bytes} bytes"),
            *group("written", str(written) if written else None),
            *layout.next_commands(following),
        ),
    )


def _refusal(certificate: Certificate) -> str:
    missed = ", ".join(one.name for one in certificate.checks if not one.met)
    return (
        f"{certificate.verdict}; not met: {missed}"
        if missed
        else f"{certificate.verdict}, expected {certificate.expect}"
    )


def _check(met: bool, proven: bool, sentence: str) -> str:
    return f"{'✓' if met else '✗'} {sentence}{' (proven)' if proven else ''}"


def _expectation(certificate: Certificate) -> str:
    if not certificate.certified:
        return f", expected {certificate.expect}"
    return ", as expected" if certificate.expect == certificate.verdict else f", as expected ({certificate.expect})"


def coverage(certificate: Certificate) -> tuple[str, ...]:
    """For which windows, and for which part of an exported file, the certificate speaks."""
    starts = certificate.claim.starts.replace(">=", "≥")
    bounded = "μ is bounded" if certificate.excitation.lower is not None else "μ is sampled"
    windows = f"{bounded} for windows of {quantity(certificate.claim.window, 's')}, {starts}"
    others = (
        f"{name} is {part.scope.basis}, {part.scope.starts.replace('>=', '≥')}"
        for name, part in (("rank", certificate.rank), ("σ", certificate.accuracy))
        if part.scope is not msgspec.UNSET
    )
    covers = certificate.artifact.covers
    return (windows, *others, *(() if covers is msgspec.UNSET else (covers,)))


def claim(certificate: Certificate) -> tuple[Group, ...]:
    """For which windows the certificate speaks, and its figures."""
    excited = certificate.excitation
    mu = excited.lower if excited.lower is not None else excited.found
    figures = f"μ ≥ {quantity(mu, 'm²/s⁷')}" if mu else "μ is 0"
    sigma = certificate.accuracy.lifted.end.position
    return group(
        "what it covers",
        *coverage(certificate),
        f"{figures}, required {significant(excited.required)}; rank {certificate.rank.rank} of {certificate.rank.of}",
        f"position {plus_minus(sigma)}, required ±{quantity(certificate.accuracy.required, 'm')}",
    )


def verified(
    failures: Mapping[str, tuple[str, ...]], stored: Mapping[str, Certificate], missing: Mapping[str, Path]
) -> Report:
    """Whether files are what their certificates say.

    stored: the certificates of the files that hold. missing: where those of the files that have none would lie.
    """
    wrong = sum(bool(sentences) and name not in missing for name, sentences in failures.items())
    following = (
        f"certify {layout.argument(name)} -o {layout.argument(place)}"
        for name, place in missing.items()
        if place.name != name and name.endswith(".toml")
    )
    names = [layout.subject(name) for name in failures]
    if len(names) == 1 and missing:
        return Report(
            subject=names[0],
            sign="?",
            answer="no certificate beside it to compare with",
            groups=layout.next_commands(*following),
        )
    if len(names) == 1:
        holds = "holds: its bytes give the same certificate again"
        answer, subject = "does not hold" if wrong else holds, names[0]
        groups = (
            tuple(
                one
                for certificate in stored.values()
                for one in (
                    *group("verdict", f"{SIGNS[certificate.verdict]} {certificate.verdict}{_expectation(certificate)}"),
                    *claim(certificate),
                )
            )
            if not wrong
            else ()
        )
        return Report(
            subject=subject,
            sign="✗" if wrong else "✓",
            answer=answer,
            title="" if wrong else next((certificate.title for certificate in stored.values()), ""),
            groups=groups,
        )
    return Report(
        subject=f"{len(names)} files",
        sign="✗" if wrong else "?" if missing else "✓",
        answer=_several(wrong, len(missing)),
        groups=(
            *group(
                "files",
                (
                    f"{'?' if name in missing else '✗' if sentences else '✓'} {layout.subject(name)}"
                    for name, sentences in failures.items()
                ),
            ),
            *layout.next_commands(*following),
        ),
    )


def _several(wrong: int, missing: int) -> str:
    """How many of several files do not hold, and how many have no certificate."""
    parts = [f"{wrong} of them {'does' if wrong == 1 else 'do'} not hold"] if wrong else []
    parts += [f"{missing} of them {'has' if missing == 1 else 'have'} no certificate"] if missing else []
    return ", ".join(parts) or "all hold: their bytes give the same certificates again"
