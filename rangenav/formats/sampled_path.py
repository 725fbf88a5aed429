"""From numpy arrays to a path: samples of a motion at times t become a signal whose every derivative is known.

    imported = sampled_path.from_arrays(time, position)                    a smooth curve near the samples
    imported = sampled_path.from_arrays(time, position, velocity=v, acceleration=a, jerk=j, snap=s)
    imported.path                                                          a signal, for simulation and observability
    path_preset.as_preset(imported, anchor=(0.0, 0.0, 1.0))                a preset that knows its path's source

Samples of the position do not hold its fourth derivative: a curve near them has a snap of its own, which is the fit's
and not the motion's. So excitation, rank and accuracy of a fitted path are computed but not judged; `unjudged` says
why. With velocity, acceleration and jerk the path is made of pieces of degree 7 through them, without jerk of degree 5.
It is judged if its snap agrees with the snap that was given. Whoever wants to fly the curve as it is has a design,
which is judged: `msgspec.structs.replace(preset, source=None)`, or `signals.Waypoints` through a few timed points.
"""

import hashlib
from typing import Any

import numpy as np
from numpy import ndarray as Array

from rangenav.arguments import finite_array, increasing_array
from rangenav.formats import reference, reference_fit
from rangenav.formats.import_result import GAP, ImportResult
from rangenav.formats.recorded_flight import Frame
from rangenav.inputs import require

DERIVATIVES = ("velocity", "acceleration", "jerk", "snap")


def from_arrays(
    time: Any,
    position: Any,
    *,
    velocity: Any = None,
    acceleration: Any = None,
    jerk: Any = None,
    snap: Any = None,
    frame: Frame = "z-up",
    knots: float | None = None,
    name: str = "arrays",
) -> ImportResult:
    """The path that n samples of a motion stand for. It begins at t = 0 with the first sample.

    time: n stamps in s, increasing; they need not be even.
    position: n × 3 in m, inertial axes.
    velocity, acceleration: n × 3 in m/s and m/s², both or none.
    jerk, snap: n × 3 in m/s³ and m/s⁴, if they are known; each needs the derivatives below it.
    frame: which way z points.
    knots: seconds between the knots of the curve, where only the position is given; chosen if it is None.
    name: what messages and the preset's source call these samples.

    Raises ValueError in one sentence for arrays of other shapes, stamps that do not increase, numbers that are not
    finite, an incomplete set of derivatives, or samples that no curve can follow.
    """
    require(frame in ("z-up", "z-down"), f"frame must be z-up or z-down, got {frame!r}")
    time = increasing_array("time", time, ("n",))
    require(len(time) >= reference.LEAST_ROWS, f"{len(time)} samples are no path: at least {reference.LEAST_ROWS}")
    samples = _samples(len(time), (position, velocity, acceleration, jerk, snap))
    findings = [f"{len(time)} samples over {time[-1] - time[0]:.4g} s", *_gaps(time)]
    if time[0] != 0:
        findings.append(f"the first sample is at {time[0]:.6g} s, which is t = 0 of the path")
    path, largest, fitted, unjudged = reference_fit.path_through(
        time - time[0], samples[0], list(samples[1:]), knots, name, findings
    )
    return ImportResult(
        source=name,
        format="arrays",
        rows=len(time),
        rate=1 / float(np.median(np.diff(time))),
        duration=float(time[-1] - time[0]),
        frame=frame,
        findings=tuple(findings),
        path=path,
        derivatives="file" if unjudged is None else "fit",
        fitted=fitted,
        fit_error=largest,
        unjudged=unjudged,
        sha256=hashlib.sha256(b"".join(part.tobytes() for part in (time, *samples) if part is not None)).hexdigest(),
    )


def _samples(rows: int, values: tuple[Any, ...]) -> tuple[Any, ...]:
    """Position and its derivatives as arrays, None where one was not given."""
    checked = [finite_array("position", values[0], (rows, 3))]
    checked += [
        None if value is None else finite_array(name, value, (rows, 3))
        for name, value in zip(DERIVATIVES, values[1:], strict=True)
    ]
    absent = [name for name, value in zip(DERIVATIVES, checked[1:], strict=True) if value is None]
    complete = absent in ([], ["snap"], ["jerk", "snap"], list(DERIVATIVES))
    require(complete, f"velocity and acceleration are needed together, got no {' and no '.join(absent)}")
    largest = max(float(np.abs(value).max()) for value in checked if value is not None)
    require(largest <= reference.LARGEST, f"position or a derivative exceeds {reference.LARGEST:g} (SI)")
    return tuple(checked)


def _gaps(time: Array) -> list[str]:
    """A sentence if samples are missing: a curve over a gap is the fit's alone."""
    steps = np.diff(time)
    usual = float(np.median(steps))
    gaps = np.flatnonzero(steps > GAP * usual)
    if len(gaps) == 0:
        return []
    worst = int(gaps[np.argmax(steps[gaps])])
    count = "1 gap" if len(gaps) == 1 else f"{len(gaps)} gaps"
    return [f"{count}, the longest {steps[worst]:.3g} s after {time[worst]:.6g} s (usual {usual:.3g} s)"]
