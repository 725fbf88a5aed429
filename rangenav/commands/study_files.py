"""`rangenav study export|copy|preset`: what a study gives away as a file: a table, a study's file, a point's preset."""

from pathlib import Path
from typing import Annotated

import tyro

from rangenav.commands.output import print_json, require_place
from rangenav.commands.progress import working
from rangenav.inputs import require

FileName = Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="STUDY")]
"""A shipped study's name or a path to a TOML file."""
StoreName = Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="STORE.zarr")]
Toml = Annotated[Path, tyro.conf.arg(aliases=["-o"], metavar="FILE.toml")]


def export(
    store: StoreName,
    *,
    csv: Annotated[Path | None, tyro.conf.arg(metavar="TABLE.csv")] = None,
    parquet: Annotated[Path | None, tyro.conf.arg(metavar="TABLE.parquet")] = None,
    every_run: bool = False,
    overwrite: bool = False,
    json: bool = False,
) -> None:
    """Write a store as a table: a row for each point and estimator, or for each run.

    Args:
        store: The store.
        csv: Write a CSV file.
        parquet: Write a Parquet file.
        every_run: A row for each run, with its seed.
        overwrite: Replace the file if it exists.
        json: Print one JSON object.
    """
    from rangenav.commands.text import layout
    from rangenav.commands.text import study as text
    from rangenav.studies import export as exporting
    from rangenav.studies import store as stores

    of, files = stores.opened(store), {}
    wanted = ((csv, exporting.to_csv, "--csv"), (parquet, exporting.to_parquet, "--parquet"))
    require(csv is not None or parquet is not None, "give --csv TABLE.csv or --parquet TABLE.parquet, or both")
    for path, _, flag in wanted:
        require_place(flag, path, f".{flag[2:]}")
        _refuse_existing(flag, path, overwrite=overwrite)
    with working(f"writing {store.name}"):
        for path, write, _ in wanted:
            if path is not None:
                files[str(path)] = write(of, path, every_run=every_run)
    done = of.done()
    answer = {
        "store": str(store),
        "files": [{"file": name, "rows": rows} for name, rows in files.items()],
        "parts": of.blocks.count,
        "parts_missing": of.blocks.count - len(done),
        "points_missing": of.study.count - sum(receipt.points for receipt in done.values()),
    }
    return print_json(answer) if json else layout.show(text.exported(answer))


def copy(study: FileName, *, output: Toml, overwrite: bool = False, json: bool = False) -> None:
    """Write the file of a study, to be changed: of a shipped one by its name.

    Example: rangenav study copy anchor-map -o mine.toml

    Args:
        study: A shipped study's name or a path to a TOML file.
        output: The file that is written.
        overwrite: Replace the file if it exists.
        json: Print one JSON object.
    """
    from rangenav.commands.text import layout
    from rangenav.commands.text import study as text
    from rangenav.studies import study as studies

    require_place("--output", output, ".toml")
    _refuse_existing("--output", output, overwrite=overwrite)
    source = studies.find(study)
    output.write_text(source.read_text(encoding="utf-8"), encoding="utf-8")
    answer = {"study": study, "file": str(output)}
    return print_json(answer) if json else layout.show(text.copied(answer))


def preset(
    store: StoreName,
    point: Annotated[tyro.conf.Positional[int], tyro.conf.arg(metavar="POINT")],
    *,
    output: Toml,
    overwrite: bool = False,
    json: bool = False,
) -> None:
    """Write the preset of one point of a store, to simulate, certify or repair it.

    Example: rangenav study preset gains-map.zarr 12 -o point.toml

    Args:
        store: The store.
        point: The point's number, as in the first column of the table that export writes.
        output: The preset's file.
        overwrite: Replace the file if it exists.
        json: Print one JSON object.
    """
    from rangenav import preset as presets
    from rangenav.commands.text import layout
    from rangenav.commands.text import study as text
    from rangenav.studies import store as stores

    of = stores.opened(store).study
    require(0 <= point < of.count, f"POINT must lie between 0 and {of.count - 1}, got {point}")
    require_place("--output", output, ".toml")
    _refuse_existing("--output", output, overwrite=overwrite)
    presets.save(of.preset_at(point), output)
    answer = {"store": str(store), "point": point, "values": of.at(point), "file": str(output)}
    return print_json(answer) if json else layout.show(text.saved(answer))


def _refuse_existing(flag: str, path: Path | None, *, overwrite: bool) -> None:
    taken = path is not None and path.exists()
    require(overwrite or not taken, f"{flag} {path}: exists already; --overwrite replaces it")
