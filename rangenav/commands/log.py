"""`rangenav log`: whether a recorded flight was informative, and the observers' estimates on its ranges."""

import dataclasses
import inspect
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from rangenav import formats
from rangenav.commands.log_answers import Answers, Vector
from rangenav.commands.log_report import (
    file_report,
    observer_report,
    ranges_report,
    verdict_report,
    whole_report,
    windows_report,
)
from rangenav.commands.output import print_json
from rangenav.commands.progress import working
from rangenav.inputs import Vec3, require, require_within
from rangenav.number_format import vector
from rangenav.preset import MAX_DURATION

if TYPE_CHECKING:
    FormatName = str
else:
    FormatName = Literal[tuple(row.name for row in formats.holding("flight"))]
RANGE_SIGMA = (1e-3, 1e2)
"""m: limits of the noise of ranges, recorded or synthetic."""
WINDOW = (0.1, MAX_DURATION)
"""s: limits of the length of a window."""
MOST_NOISE = 100.0
"""rad/s or m/s², per sample."""
NO_ANSWERS = Answers()
ROUNDED = 1e-5
"""Vectors that differ by less are the same: a direction is made a unit vector."""
ORIGIN: Vec3 = (0.0, 0.0, 0.0)
"""m; stands for the anchor where a record has no ranges, and none is used."""
SHORTEST_DIRECTION = 1e-3
"""A shorter vector is no direction."""


def log(
    file: tyro.conf.Positional[Path],
    *,
    from_: Annotated[FormatName | None, tyro.conf.arg(name="from")] = None,
    answers: Annotated[Answers, tyro.conf.arg(name="")] = NO_ANSWERS,
    world: Literal["still", "given"] | None = None,
    gravity: Vector = None,
    magnetic: Vector = None,
    anchor: Vector = None,
    gyro_noise: float | None = None,
    accel_noise: float | None = None,
    gyro_bias: float | None = None,
    range_sigma: float = 0.1,
    synthetic_ranges: float | None = None,
    seed: int = 0,
    begin: float | None = None,
    end: float | None = None,
    window: float = 6.0,
    position_sigma: float = 0.5,
    list_columns: bool = False,
    json: bool = False,
) -> None:
    """Say whether a recorded flight was informative, and run the observers on its ranges.

    Example: rangenav log flight.csv --anchor 0 0 1

    What the file leaves open is asked, and so is what its sensors contradict, with what the data suggest and why;
    nothing is converted unasked.

    Args:
        file: A csv with t, gyro, accel and what else there is (mag, range, truth), a .mat file, or a EuRoC folder.
        from_: Its format; by its suffix if not said.
        answers: Answers to the questions about the file.
        world: Take gravity and field from the still start, or as given.
        gravity: Gravity vector (m/s²), inertial.
        magnetic: Direction of the magnetic field, inertial.
        anchor: Where the anchor stands (m), inertial.
        gyro_noise: Noise of the gyro per sample (rad/s); by default that of the rest at the start.
        accel_noise: Noise of the accelerometer per sample (m/s²), likewise.
        gyro_bias: Size of the gyro's bias (rad/s), likewise.
        range_sigma: Noise of the ranges (m).
        synthetic_ranges: Make ranges with this noise (m) from the file's true position.
        seed: Of that noise.
        begin: Use the record from here (s).
        end: Use the record to here (s).
        window: Length of the windows that are judged (s).
        position_sigma: Predicted position error (m) above which a window is weak.
        list_columns: List every column of the file and what it is used for, and stop.
        json: Print one JSON object.
    """
    typed = _typed(locals())
    from rangenav import flight_summary, logs, range_fit, record_checks, rest
    from rangenav.commands.text import layout
    from rangenav.commands.text import log as text
    from rangenav.formats import recorded_flight

    confirm, vectors = answers.confirm(), _world_vectors(world, gravity, magnetic)
    require_within("--range-sigma", range_sigma, *RANGE_SIGMA, "m")
    require_within("--window", window, *WINDOW, "s")
    require(position_sigma > 0, f"--position-sigma must be positive, got {position_sigma:g}")
    if list_columns:
        return _list_columns(file, from_ or _format(file), confirm, json=json)
    imported = formats.read(file, from_ or _format(file), confirm=confirm)
    imported = _as_given(imported, vectors, measured=synthetic_ranges is None)
    with working(f"checking {imported.source}"):
        imported = record_checks.checked(imported, confirm, anchor=anchor)
    asked = _open_anchor(imported)
    flight = formats.settled(imported, also=asked if imported.questions else ()).flight
    assert flight is not None
    if synthetic_ranges is not None:
        flight, range_sigma = _with_ranges(flight, anchor, synthetic_ranges, seed), synthetic_ranges
    world_model, questions, world_source = rest.world_of(
        flight, anchor=flight.anchor or ORIGIN, vectors=vectors, confirmed=world == "still"
    )
    if len(flight.range):
        formats.settled(imported, also=(*questions, *asked))
    noise = _noise(rest.noise_at_rest(flight), gyro_noise, accel_noise, gyro_bias)
    if begin is not None or end is not None:
        flight = recorded_flight.between(
            flight, begin if begin is not None else 0.0, end if end is not None else math.inf
        )
    ranges_source = flight_summary.ranges_source(
        flight, flight.anchor or ORIGIN, synthetic=synthetic_ranges, anchor_given=anchor is not None
    )
    judged_by = {
        "range_sigma": range_sigma,
        "requirement": position_sigma,
        "noise": noise,
        "restriction": imported.unjudged,
    }
    with working(f"judging {imported.source}"):
        informative = logs.informative(flight, window=window, **judged_by)
        whole = logs.whole(flight, **judged_by)
    report = (
        file_report(imported, flight, world_source)
        | ranges_report(ranges_source)
        | {"whole": whole_report(whole)}
        | {"informative": windows_report(flight_summary.summarise_windows(informative), informative)}
        | verdict_report(whole)
    )
    if len(flight.range) and world_model is not None:
        with working(f"running the observers on {imported.source}"):
            observed = logs.observe(flight, world_model, sensors=logs.sensors_of(flight, range_sigma=range_sigma))
        report["world"] = {name: list(getattr(world_model, name)) for name in ("gravity", "magnetic", "anchor")}
        report["observer"] = observer_report(flight_summary.summarise_observer(observed))
        fit = range_fit.of(observed.estimate)
        report["observer"]["fit"] = fit.report(blind=informative.verdict == "blind")
    else:
        report["observer"], report["observer_reason"] = None, "null: no ranges (--synthetic-ranges makes some)"
    if json:
        return print_json(report)
    return layout.show(
        text.report(
            report,
            whole=whole,
            file=str(file),
            options=typed,
            has_truth=flight.position is not None,
            required=position_sigma,
        )
    )


def _list_columns(file: Path, format_name: str, confirm: Mapping[str, str], *, json: bool) -> None:
    """Print what every column of a file is used for; also of a table in which columns of a flight are missing."""
    from rangenav.commands.text import layout
    from rangenav.commands.text import log as text
    from rangenav.formats import log as tables

    if format_name == "log" and file.is_file():
        uses = tables.uses(formats.text.contents(file), source=file.name, confirm=confirm)
    else:
        uses = formats.read(file, format_name, confirm=confirm).columns
    return print_json({"columns": dict(uses)}) if json else layout.show(text.columns(uses, file))


def _noise(
    at_rest: tuple[float, float, float] | None, gyro: float | None, accel: float | None, bias: float | None
) -> tuple[float, float, float] | None:
    """The IMU's noise: what was typed, else that of the rest at the start; None if nothing is known."""
    from rangenav.logs import USUAL_NOISE

    typed = (gyro, accel, bias)
    for name, value in zip(("--gyro-noise", "--accel-noise", "--gyro-bias"), typed, strict=True):
        require(value is None or 0 <= value <= MOST_NOISE, f"{name} must lie between 0 and {MOST_NOISE:g}, got {value}")
    if typed == (None, None, None):
        return at_rest
    usual = at_rest or (*USUAL_NOISE, 0.0)
    first, second, third = (known if value is None else value for value, known in zip(typed, usual, strict=True))
    return first, second, third


def _typed(arguments: Mapping[str, Any]) -> dict[str, str]:
    """The options of `log` that differ from their defaults, each flag with its values as they are typed."""
    options = {}
    for name, parameter in inspect.signature(log).parameters.items():
        value = arguments[name]
        if name == "answers":
            given = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
            options |= {_flag(name): _value(one) for name, one in given.items() if one not in (None, ())}
        elif name not in ("file", "json", "list_columns") and value != parameter.default:
            options[_flag(name)] = _value(value)
    return options


def _flag(name: str) -> str:
    return f"--{name.rstrip('_').replace('_', '-')}"


def _value(value: Any) -> str:
    values = value if isinstance(value, tuple) else (value,)
    return " ".join(f"{one:.10g}" if isinstance(one, float) else str(one) for one in values)


def _format(file: Path) -> str:
    """The format of a flight by its file's name: that of the suffix, that of folders, else the CSV of any logger."""
    flights = formats.holding("flight")
    by_suffix = [row.name for row in flights if file.suffix in row.read_suffixes]
    by_folder = [row.name for row in flights if row.folder_reader is not None and file.is_dir()]
    return [*by_suffix, *by_folder, "log"][0]


def _as_given(
    imported: formats.ImportResult, vectors: tuple[Vec3, Vec3] | None, *, measured: bool
) -> formats.ImportResult:
    """The file with gravity and field as a person gives them, and without its ranges where synthetic ones are wanted.

    Raises ValueError for a file that holds no flight.
    """
    flight = imported.flight
    if flight is None:
        rule = f"{imported.source}: holds a path and no recorded flight: see `rangenav import`"
        require(bool(imported.questions), rule)
        return imported
    findings = [*imported.findings]
    if vectors is not None:
        for name, given in zip(("gravity", "magnetic"), vectors, strict=True):
            stated = getattr(flight, name)
            if stated is not None and math.dist(stated, given) > ROUNDED:
                unit = " m/s²" if name == "gravity" else ""
                findings.append(f"{name} {vector(given)}{unit}, given instead of {vector(stated)}{unit} in the file")
        flight = dataclasses.replace(flight, gravity=vectors[0], magnetic=vectors[1])
    if not measured:
        flight = dataclasses.replace(flight, range_time=flight.range_time[:0], range=flight.range[:0], range_lines=None)
    return dataclasses.replace(imported, flight=flight, findings=tuple(findings))


def _open_anchor(imported: formats.ImportResult) -> tuple[formats.Question, ...]:
    """The question where the anchor stands, if there are ranges and nothing says it."""
    flight = imported.flight
    known = flight is None or flight.anchor is not None or not len(flight.range)
    return () if known else (_anchor_question(),)


def _with_ranges(flight: Any, anchor: Vec3 | None, sigma: float, seed: int) -> Any:
    from rangenav.formats import recorded_flight

    if anchor is None:
        raise ValueError("--synthetic-ranges needs --anchor X Y Z")
    require_within("--synthetic-ranges", sigma, *RANGE_SIGMA, "m")
    require(seed >= 0, f"--seed must not be negative, got {seed}")
    return recorded_flight.with_ranges(flight, anchor, sigma=sigma, seed=seed)


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
