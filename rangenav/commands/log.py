"""`rangenav log`: a recorded flight: was it informative, and what do the observers make of it?"""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
import tyro

from rangenav import formats
from rangenav.commands.output import print_json, print_table
from rangenav.inputs import Vec3, require

Given = Annotated[Vec3 | None, tyro.conf.arg(metavar="X Y Z")]
if TYPE_CHECKING:
    FormatName = str
else:
    FormatName = Literal[tuple(row.name for row in formats.holding("flight"))]
TAIL = 4
"""The steady errors are of the last quarter, as in `rangenav simulate`."""
SYNTHETIC = (1e-3, 1e2)
"""m of noise on ranges that are made up."""
EARTH = 1e-3
"""A direction shorter than this is no direction."""


def log(
    file: tyro.conf.Positional[Path],
    *,
    from_: Annotated[FormatName | None, tyro.conf.arg(name="from")] = None,
    time_unit: Literal["s", "ms", "us", "ns"] | None = None,
    gyro_unit: Literal["rad/s", "deg/s"] | None = None,
    accel_unit: Literal["m/s2", "g", "mg"] | None = None,
    mag_unit: Literal["1", "T", "mT", "uT", "nT", "G"] | None = None,
    range_unit: Literal["m", "cm", "mm"] | None = None,
    frame: Literal["z-up", "z-down"] | None = None,
    lines: Literal["drop"] | None = None,
    world: Literal["still", "given"] | None = None,
    gravity: Given = None,
    magnetic: Given = None,
    anchor: Given = None,
    range_sigma: float = 0.1,
    synthetic_ranges: float | None = None,
    seed: int = 0,
    begin: float | None = None,
    end: float | None = None,
    window: float = 6.0,
    position_sigma: float = 0.5,
    json: bool = False,
) -> None:
    """Say whether a recorded flight was informative, and run the observers on its ranges.

    What the file leaves open is asked, with what the data suggest and why; nothing is converted unasked.

    Args:
        file: A csv with t, gyro, accel and what else there is (mag, range, truth), a .mat file, or a EuRoC folder.
        from_: Its format; by its suffix if not said.
        time_unit: Confirms the unit of the stamps.
        gyro_unit: Confirms the unit of the gyro.
        accel_unit: Confirms the unit of the accelerometer.
        mag_unit: Confirms the unit of the magnetometer.
        range_unit: Confirms the unit of the ranges.
        frame: Confirms which way z of the inertial frame points.
        lines: Drop lines with missing numbers or repeated stamps.
        world: Take gravity and field from the still start, or as given.
        gravity: Gravity vector (m/s²), inertial.
        magnetic: Direction of the magnetic field, inertial.
        anchor: Where the anchor stands (m), inertial.
        range_sigma: Noise of the ranges (m).
        synthetic_ranges: Make ranges with this noise (m) from the file's true position.
        seed: Of that noise.
        begin: Use the record from here (s).
        end: Use the record to here (s).
        window: Length of the windows that are judged (s).
        position_sigma: Predicted position error (m) above which a window is weak.
        json: Print one JSON object.
    """
    from rangenav import logs, rest
    from rangenav.formats import recorded_flight

    confirm = {"time": time_unit, "gyro": gyro_unit, "accel": accel_unit, "mag": mag_unit, "range": range_unit}
    answers = {key: value for key, value in {**confirm, "frame": frame, "lines": lines}.items() if value is not None}
    found = formats.read(file, from_ or _format(file), confirm=answers)
    given = _given(world, gravity, magnetic)
    flight = formats.settled(found).flight
    if flight is None:
        raise ValueError(f"{found.source}: holds a path and no recorded flight: see `rangenav import`")
    if synthetic_ranges is not None:
        flight, range_sigma = _with_ranges(flight, anchor, synthetic_ranges, seed), synthetic_ranges
    require(range_sigma > 0, f"--range-sigma must be positive, got {range_sigma:g}")
    place = anchor or flight.anchor
    around, questions, told = rest.world_of(
        flight, anchor=place or (0.0, 0.0, 0.0), given=given, confirmed=world == "still"
    )
    if len(flight.range):
        formats.settled(found, also=(*questions, *(() if place is not None else (_where(),))))
    noise = noise_at_rest(flight)
    if begin is not None or end is not None:
        flight = recorded_flight.between(
            flight, begin if begin is not None else 0.0, end if end is not None else math.inf
        )
    seen = logs.informative(flight, window=window, range_sigma=range_sigma, requirement=position_sigma, noise=noise)
    report = _understood(found, flight, told) | {"informative": informative_report(seen), "verdict": seen.verdict}
    if len(flight.range) and around is not None:
        observed = logs.observe(flight, around, sensors=logs.sensors_of(flight, range_sigma=range_sigma))
        report["world"] = {name: list(getattr(around, name)) for name in ("gravity", "magnetic", "anchor")}
        report["observer"] = observer_report(observed)
    else:
        report["observer"], report["observer_reason"] = None, "null: no ranges (--synthetic-ranges makes some)"
    return print_json(report) if json else print_table(f"{found.source}: {seen.words}", report)


def _format(file: Path) -> str:
    """The format of a flight by its file's name: that of the suffix, that of folders, else the CSV of any logger."""
    flights = formats.holding("flight")
    by_suffix = [row.name for row in flights if file.suffix in row.read_suffixes]
    by_folder = [row.name for row in flights if row.folder_reader is not None and file.is_dir()]
    return [*by_suffix, *by_folder, "log"][0]


def _with_ranges(flight: Any, anchor: Vec3 | None, sigma: float, seed: int) -> Any:
    from rangenav.formats import recorded_flight

    if anchor is None:
        raise ValueError("--synthetic-ranges needs --anchor X Y Z")
    low, high = SYNTHETIC
    require(low <= sigma <= high, f"--synthetic-ranges must lie between {low:g} m and {high:g} m, got {sigma:g}")
    return recorded_flight.with_ranges(flight, anchor, sigma=sigma, seed=seed)


def _understood(found: Any, flight: Any, told: str) -> dict[str, Any]:
    """What the file was understood to be."""
    return {
        "file": found.source,
        "format": found.format,
        "rows": found.rows,
        "rate": found.rate,
        "duration": float(flight.time[-1] - flight.time[0]),
        "frame": found.frame,
        "findings": [*found.findings, *([told] if told else [])],
    }


def _given(world: str | None, gravity: Vec3 | None, magnetic: Vec3 | None) -> tuple[Vec3, Vec3] | None:
    if world != "given":
        require(gravity is None and magnetic is None, "--gravity and --magnetic are used with --world given")
        return None
    if gravity is None or magnetic is None:
        raise ValueError("--world given needs --gravity X Y Z and --magnetic X Y Z")
    length = math.hypot(*magnetic)
    require(math.isfinite(length) and length > EARTH, f"--magnetic must be a direction, got {magnetic}")
    x, y, z = (value / length for value in magnetic)
    return gravity, (x, y, z)


def _where() -> Any:
    from rangenav.formats import Question

    return Question(
        key="anchor",
        flag="--anchor",
        asks="where does the anchor stand",
        options=("X Y Z",),
        suggestion=None,
        evidence="the file does not say",
    )


def noise_at_rest(flight: Any) -> tuple[float, float, float] | None:
    """Noise and bias of the IMU at rest, None if the record does not start still."""
    from rangenav import rest

    seconds = rest.still_seconds(flight)
    if seconds == 0 or flight.mag is None:
        return None
    try:
        still = rest.still(flight, seconds)
    except ValueError:
        return None
    return still.gyro_noise, still.accel_noise, float(np.linalg.norm(still.gyro_bias))


def informative_report(seen: Any) -> dict[str, Any]:
    """What windows of the record could tell: counts of verdicts, and the worst one."""
    k = seen.worst
    sigma = float(seen.sigma[k])
    known = seen.sigma[np.isfinite(seen.sigma)]
    report: dict[str, Any] = {
        "window": seen.window,
        "windows": {verdict: seen.each.count(verdict) for verdict in ("observable", "weak", "rank 13", "blind")},
        "at": float(seen.start[k]),
        "rank": int(seen.rank[k]),
        "eigenvalues": seen.eigenvalues[k].tolist(),
        "position": sigma if math.isfinite(sigma) else None,
        "position_median": float(np.median(known)) if len(known) else None,
        "words": seen.words,
    }
    if report["position"] is None:
        report["reason"] = "null: blind there, or without ranges"
    return report


def observer_report(observed: Any) -> dict[str, Any]:
    """What the observers made of the record; errors by quarters where the file has a truth."""
    time = observed.estimate.time
    report: dict[str, Any] = {
        "final_position": [_finite(value) for value in observed.position[-1]],
        "innovation_rms": _rms(observed.estimate.innovation[:, 0]),
    }
    for name, error, factor in (
        ("position", observed.position_error, 1.0),
        ("attitude_deg", observed.attitude_error, 180 / math.pi),
    ):
        if error is None:
            report[name], report[f"{name}_reason"] = None, "null: no truth in the file"
            continue
        quarters = [factor * error[k * len(time) // TAIL : (k + 1) * len(time) // TAIL] for k in range(TAIL)]
        report[name] = {
            "quarters_rmse": [_rms(part) for part in quarters],
            "median": _finite(np.nanmedian(factor * error)),
        }
        if None in report[name]["quarters_rmse"] or report[name]["median"] is None:
            report[name]["reason"] = "null: the estimate overflowed, or no truth there"
    if None in report["final_position"] or report["innovation_rms"] is None:
        report["reason"] = "null: the estimate overflowed"
    return report


def _rms(values: Any) -> float | None:
    known = values[~np.isnan(values)]
    return _finite(np.sqrt(np.mean(known**2))) if len(known) else None


def _finite(value: Any) -> float | None:
    return float(value) if math.isfinite(value) else None
