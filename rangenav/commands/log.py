"""`rangenav log`: whether a recorded flight was informative, and the observers' estimates on its ranges."""

import dataclasses
import inspect
import shlex
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
from rangenav.preset import MAX_DURATION

if TYPE_CHECKING:
    from rangenav.formats.recorded_flight import Flight
    from rangenav.motion import World

    FormatName = str
else:
    FormatName = Literal[tuple(row.name for row in formats.holding("flight"))]
WINDOW = (0.1, MAX_DURATION)
"""s: limits of the length of a window."""
NO_ANSWERS = Answers()
ORIGIN: Vec3 = (0.0, 0.0, 0.0)
"""m; stands for the anchor where a record has no ranges, and none is used."""


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
    from rangenav import logs, record_questions, rest
    from rangenav.commands import log_inputs
    from rangenav.commands.text import layout
    from rangenav.commands.text import log as text
    from rangenav.flight_summary import ranges_source, summarise_windows

    vectors = log_inputs.world_vectors(world, gravity, magnetic)
    _check_numbers(range_sigma, window, position_sigma, seed, synthetic_ranges)
    format_name = from_ or _format(file)
    if list_columns:
        return _list_columns(file, format_name, answers.confirm(), json=json)
    limits, measured = (begin, end), synthetic_ranges is None
    asked = log_inputs.checked(file, format_name, answers, vectors, anchor, limits, measured=measured)
    imported, still, synthetic = asked.imported, world == "still", synthetic_ranges is not None
    of_world = record_questions.of_world(asked, vectors=vectors, still=still, synthetic=synthetic)
    flight = formats.settled(imported, also=of_world).flight
    assert flight is not None
    assert asked.whole is not None
    if synthetic_ranges is not None:
        flight, range_sigma = log_inputs.with_ranges(flight, anchor, synthetic_ranges, seed), synthetic_ranges
    stands = flight.anchor or ORIGIN
    world_model, _, world_source = rest.world_of(asked.whole, anchor=stands, vectors=vectors, confirmed=still)
    noise = log_inputs.noise(rest.noise_at_rest(asked.whole), gyro_noise, accel_noise, gyro_bias)
    source = ranges_source(flight, stands, synthetic=synthetic_ranges, anchor_given=anchor is not None)
    judged_by = {"range_sigma": range_sigma, "requirement": position_sigma, "noise": noise}
    with working(f"judging {imported.source}"):
        informative = logs.informative(flight, window=window, restriction=imported.unjudged, **judged_by)
        whole = logs.whole(flight, restriction=imported.unjudged, **judged_by)
    report = (
        file_report(imported, flight, world_source)
        | ranges_report(source)
        | {"whole": whole_report(whole)}
        | {"informative": windows_report(summarise_windows(informative), informative)}
        | verdict_report(whole)
    )
    if len(flight.range) and world_model is not None:
        with working(f"running the observers on {imported.source}"):
            report |= _observer(flight, world_model, range_sigma, position_sigma, blind=whole.blind)
    else:
        report["observer"], report["observer_reason"] = None, "null: no ranges (--synthetic-ranges makes some)"
    if json:
        return print_json(report)
    known = {"has_truth": flight.position is not None, "required": position_sigma}
    return layout.show(text.report(report, whole=whole, file=str(file), options=typed, **known))


def _check_numbers(
    range_sigma: float, window: float, position_sigma: float, seed: int, synthetic_ranges: float | None
) -> None:
    """Raises ValueError, by the option, for a number that is out of range."""
    from rangenav.commands.log_inputs import RANGE_SIGMA

    require_within("--range-sigma", range_sigma, *RANGE_SIGMA, "m")
    require_within("--window", window, *WINDOW, "s")
    require(position_sigma > 0, f"--position-sigma must be positive, got {position_sigma:g}")
    require(seed >= 0, f"--seed must not be negative, got {seed}")
    if synthetic_ranges is not None:
        require_within("--synthetic-ranges", synthetic_ranges, *RANGE_SIGMA, "m")


def _observer(
    flight: "Flight", world: "World", range_sigma: float, position_sigma: float, *, blind: bool
) -> dict[str, Any]:
    """What the observers estimate from the ranges of a flight, and the world that they assume."""
    from rangenav import logs
    from rangenav.flight_summary import failure, summarise_observer

    observed = logs.observe(flight, world, sensors=logs.sensors_of(flight, range_sigma=range_sigma))
    summary = summarise_observer(observed)
    failed = failure(summary, position_sigma)
    return {
        "world": {name: list(getattr(world, name)) for name in ("gravity", "magnetic", "anchor")},
        "observer": observer_report(summary, blind=blind, failure=failed),
    }


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
    return " ".join(f"{one:.10g}" if isinstance(one, float) else shlex.quote(str(one)) for one in values)


def _format(file: Path) -> str:
    """The format of a flight by its file's name: that of the suffix, that of folders, else the CSV of any logger."""
    flights = formats.holding("flight")
    by_suffix = [row.name for row in flights if file.suffix in row.read_suffixes]
    by_folder = [row.name for row in flights if row.folder_reader is not None and file.is_dir()]
    return [*by_suffix, *by_folder, "log"][0]
