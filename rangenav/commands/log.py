"""`rangenav log`: whether a recorded flight was informative, and the observers' estimates on its ranges."""

import inspect
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from rangenav import formats
from rangenav.commands.output import print_json
from rangenav.commands.progress import working
from rangenav.formats import log_columns
from rangenav.inputs import Vec3, require, require_within
from rangenav.preset import MAX_DURATION

if TYPE_CHECKING:
    from rangenav.flight_summary import ObserverSummary, WindowSummary  # imported when used: it takes long

Vector = Annotated[Vec3 | None, tyro.conf.arg(metavar="X Y Z")]
if TYPE_CHECKING:
    FormatName = str
else:
    FormatName = Literal[tuple(row.name for row in formats.holding("flight"))]
RANGE_SIGMA = (1e-3, 1e2)
"""m: limits of the noise of ranges, recorded or synthetic."""
WINDOW = (0.1, MAX_DURATION)
"""s: limits of the length of a window."""
SHORTEST_DIRECTION = 1e-3
"""A shorter vector is no direction."""


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
    stamps: Literal["unwrap"] | None = None,
    columns: Annotated[tuple[str, ...], tyro.conf.arg(metavar="QUANTITY=NAME")] = (),
    world: Literal["still", "given"] | None = None,
    gravity: Vector = None,
    magnetic: Vector = None,
    anchor: Vector = None,
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

    Example: rangenav log flight.csv --anchor 0 0 1

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
        stamps: Let the stamps go on where the clock began again.
        columns: Chooses columns where several would do: accel=linear_acceleration.
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
    typed = _typed(locals())
    from rangenav import flight_summary, logs, rest
    from rangenav.commands.text import layout
    from rangenav.commands.text import log as text
    from rangenav.formats import recorded_flight

    confirm = {"time": time_unit, "gyro": gyro_unit, "accel": accel_unit, "mag": mag_unit, "range": range_unit}
    confirm |= {"frame": frame, "lines": lines, "stamps": stamps, **_chosen_columns(columns)}
    answers = {key: value for key, value in confirm.items() if value is not None}
    imported = formats.read(file, from_ or _format(file), confirm=answers)
    vectors = _world_vectors(world, gravity, magnetic)
    flight = formats.settled(imported).flight
    if flight is None:
        raise ValueError(f"{imported.source}: holds a path and no recorded flight: see `rangenav import`")
    if synthetic_ranges is not None:
        flight, range_sigma = _with_ranges(flight, anchor, synthetic_ranges, seed), synthetic_ranges
    require_within("--range-sigma", range_sigma, *RANGE_SIGMA, "m")
    require_within("--window", window, *WINDOW, "s")
    require(position_sigma > 0, f"--position-sigma must be positive, got {position_sigma:g}")
    anchor_position = anchor or flight.anchor
    world_model, questions, world_source = rest.world_of(
        flight, anchor=anchor_position or (0.0, 0.0, 0.0), vectors=vectors, confirmed=world == "still"
    )
    if len(flight.range):
        formats.settled(imported, also=(*questions, *(() if anchor_position is not None else (_anchor_question(),))))
    noise = rest.noise_at_rest(flight)
    if begin is not None or end is not None:
        flight = recorded_flight.between(
            flight, begin if begin is not None else 0.0, end if end is not None else math.inf
        )
    with working(f"judging {imported.source}"):
        informative = logs.informative(
            flight, window=window, range_sigma=range_sigma, requirement=position_sigma, noise=noise
        )
    report = _file_report(imported, flight, world_source) | {
        "informative": windows_report(flight_summary.summarise_windows(informative), informative.summary),
        "verdict": informative.verdict,
    }
    if len(flight.range) and world_model is not None:
        with working(f"running the observers on {imported.source}"):
            observed = logs.observe(flight, world_model, sensors=logs.sensors_of(flight, range_sigma=range_sigma))
        report["world"] = {name: list(getattr(world_model, name)) for name in ("gravity", "magnetic", "anchor")}
        report["observer"] = observer_report(flight_summary.summarise_observer(observed))
    else:
        report["observer"], report["observer_reason"] = None, "null: no ranges (--synthetic-ranges makes some)"
    if json:
        return print_json(report)
    shown = text.report(
        report,
        file=str(file),
        options=typed,
        has_truth=flight.position is not None,
        required=position_sigma,
        sensed=int(informative.rank[informative.worst]),
    )
    return layout.show(shown)


def _chosen_columns(columns: tuple[str, ...]) -> dict[str, str]:
    """Answers to the questions which columns hold a quantity, from `accel=linear_acceleration`."""
    for chosen in columns:
        kind, sign, _ = chosen.partition("=")
        known = ", ".join(log_columns.NAMES)
        require(bool(sign) and kind in log_columns.NAMES, f"--columns must be QUANTITY=NAME of {known}, got {chosen!r}")
    return {log_columns.columns_key(chosen.partition("=")[0]): chosen for chosen in columns}


def _typed(arguments: Mapping[str, Any]) -> dict[str, str]:
    """The options of `log` that differ from their defaults, each flag with its values as they are typed."""
    options = {}
    for name, parameter in inspect.signature(log).parameters.items():
        value = arguments[name]
        if name not in ("file", "json") and value != parameter.default:
            values = value if isinstance(value, tuple) else (value,)
            flag = f"--{name.rstrip('_').replace('_', '-')}"
            options[flag] = " ".join(f"{one:.10g}" if isinstance(one, float) else str(one) for one in values)
    return options


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
    require_within("--synthetic-ranges", sigma, *RANGE_SIGMA, "m")
    require(seed >= 0, f"--seed must not be negative, got {seed}")
    return recorded_flight.with_ranges(flight, anchor, sigma=sigma, seed=seed)


def _file_report(imported: Any, flight: Any, world_source: str) -> dict[str, Any]:
    """Format, rate, frame and findings of the file, as a JSON object; the source of the world is one more finding."""
    return {
        "file": imported.source,
        "format": imported.format,
        "rows": imported.rows,
        "rate": imported.rate,
        "duration": float(flight.time[-1] - flight.time[0]),
        "frame": imported.frame,
        "findings": [*imported.findings, *([world_source] if world_source else [])],
    }


def _world_vectors(world: str | None, gravity: Vec3 | None, magnetic: Vec3 | None) -> tuple[Vec3, Vec3] | None:
    if world != "given":
        require(gravity is None and magnetic is None, "--gravity and --magnetic are used with --world given")
        return None
    if gravity is None or magnetic is None:
        raise ValueError("--world given needs --gravity X Y Z and --magnetic X Y Z")
    length = math.hypot(*magnetic)
    require(math.isfinite(length) and length > SHORTEST_DIRECTION, f"--magnetic must be a direction, got {magnetic}")
    x, y, z = (value / length for value in magnetic)
    return gravity, (x, y, z)


def _anchor_question() -> Any:
    from rangenav.formats import Question

    return Question(
        key="anchor",
        flag="--anchor",
        asks="where does the anchor stand",
        options=("X Y Z",),
        suggestion=None,
        evidence="the file does not say",
    )


def windows_report(windows: "WindowSummary", words: str) -> dict[str, Any]:
    """Observability of the record's windows, as a JSON object."""
    report: dict[str, Any] = {
        "window": windows.window,
        "windows": windows.counts,
        "at": windows.worst_start,
        "rank": windows.worst_rank,
        "eigenvalues": list(windows.worst_eigenvalues),
        "position": windows.worst_position,
        "position_median": windows.median_position,
        "words": words,
    }
    if windows.worst_position is None:
        report["reason"] = "null: blind there, or without ranges"
    return report


def observer_report(observer: "ObserverSummary") -> dict[str, Any]:
    """The observers' estimates as a JSON object; errors by quarters where the file has the true motion."""
    report: dict[str, Any] = {
        "final_position": list(observer.final_position),
        "innovation_rms": observer.innovation_rms,
    }
    for name, errors in (("position", observer.position), ("attitude_deg", observer.attitude)):
        if errors is None:
            report[name], report[f"{name}_reason"] = None, "null: no truth in the file"
            continue
        report[name] = {"quarters_rmse": list(errors.quarters), "median": errors.median}
        if not errors.complete:
            report[name]["reason"] = "null: the estimate overflowed, or no truth there"
    if not observer.complete:
        report["reason"] = "null: the estimate overflowed"
    return report
