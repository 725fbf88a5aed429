"""What a preset's certificate says against its export, in one clause that a pilot understands."""

import numpy as np

from rangenav.certificate.schema import Certificate
from rangenav.observability import blindness


def in_short(issued: Certificate) -> str | None:
    """What a preset's certificate says against its export, as a pilot would; None where its own sentence is short."""
    missed = {check.name: check for check in issued.checks if not check.met}
    window, sigma = f"{issued.claim.window:g} s", issued.accuracy.lifted.end.position
    if "source" in missed or "smooth" in missed:
        return None
    if "rank" in missed or ("excitation" in missed and issued.excitation.found is None):
        along = blindness.name(np.asarray(issued.excitation.direction))
        where = f" along {along}" if issued.excitation.found is None else ""
        return f"on this motion the ranges of {window} do not tell the position{where}"
    if "excitation" in missed:
        return f"this motion is too gentle: {missed['excitation'].words}"
    if "accuracy" in missed and sigma is not None:
        needed = issued.accuracy.required
        return f"the ranges of {window} tell the position to ±{sigma:.2g} m, and ±{needed:.2g} m are required"
    return None
