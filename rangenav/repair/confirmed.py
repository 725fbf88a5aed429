"""The smallest change that a certificate confirms: a search by samples, corrected by what certificates refuse."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.repair.change import Change
from rangenav.repair.export_target import ExportTarget
from rangenav.repair.outcome import Refused, certificate_of, missed
from rangenav.repair.search import NOWHERE, Budget, Search, Trial, least

MARGINS, MORE = (0.05, 0.12, 0.25), 0.01
"""log; the least margins by which samples must exceed the requirement, tried in this order until a certificate
confirms, and what is added to a certificate's shortfall."""


def smallest(
    changes: Iterable[Change],
    budget: Budget,
    *,
    target: ExportTarget | None,
    nearest_trials: list[Trial],
    refused: list[Refused],
) -> tuple[Change, Float[Array, "n"]] | None:
    """The change and its θ, None if no certificate confirms one: of the preset, and of the file it is exported to.

    What a certificate misses more than samples did is added to the margin, of what was tried already, too. The nearest
    trial of every change and what certificates refuse are added to the two lists.
    """
    for change in changes:
        search = Search(change=change, budget=budget, margin=MARGINS[0])
        judged: set[bytes] = set()
        for margin in MARGINS:
            search.require(max(search.margin, margin))
            theta = least(search)
            theta = _nearest(search, judged) if theta is None else _rounded(search, theta)
            if theta is None:
                break
            judged.add(theta.tobytes())
            changed = change.make(theta)
            stated = certificate_of(changed)
            sentences = tuple(one.words for one in stated.checks if not one.met)
            if stated.meets:
                against = None if target is None else target.refusal(changed)
                if against is None:
                    return change, theta
                sentences = (against,)
            refused.append(Refused(description=change.description(theta), sentences=sentences))
            sampled = search.evaluate(theta).figures
            search.margin += MORE + (0.0 if sampled is None else missed(stated, sampled))
        nearest_trials.append(min(search.trials.values(), key=lambda trial: trial.violation, default=NOWHERE))
    return None


def _rounded(search: Search, theta: Float[Array, "n"]) -> Float[Array, "n"]:
    """θ in numbers that a person would write, if it meets everything then, too."""
    rounded = search.change.rounded(theta)
    return rounded if search.evaluate(rounded).violation <= search.margin / 2 else theta


def _nearest(search: Search, judged: set[bytes]) -> Float[Array, "n"] | None:
    """Of what meets everything, yet without the margin, the θ with the most of it; None if all of them are judged."""
    meeting = [(trial.violation, key) for key, trial in search.trials.items() if trial.meets and key not in judged]
    return np.frombuffer(min(meeting)[1]) if meeting else None
