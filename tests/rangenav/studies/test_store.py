"""A store holds each part once, whole or not at all; xarray reads it; what is damaged is computed again.

The clusters are of threads in this process; test_faults has processes.
"""

import resource
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from rangenav.progress import CancelledError
from rangenav.studies import blocks, creation, evaluation, export, receipts, running, store, study, summary, tasks
from rangenav.studies.parameters import Listed
from rangenav.studies.stopping import Stop

pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")


@pytest.fixture(scope="module")
def client():
    """A dask client of two threads in this process."""
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, dashboard_address="127.0.0.1:0", protocol="inproc"
        ) as cluster,
        distributed.Client(cluster) as made,
    ):
        yield made


@pytest.fixture(scope="module")
def whole(small: study.Study, client, tmp_path_factory: pytest.TempPathFactory) -> store.Store:
    """The small study, computed in six parts."""
    path = tmp_path_factory.mktemp("whole") / "small.zarr"
    creation.created(path, small, blocks.divided(small.shape, 2))
    running.run(small, path, client=client)
    return store.opened(path)


@pytest.fixture
def copy(whole: store.Store, tmp_path: Path) -> Path:
    """A copy of its store, to be damaged."""
    return Path(shutil.copytree(whole.path, tmp_path / "small.zarr"))


def loaded(path: Path) -> Any:
    """The store as xarray reads it."""
    return pytest.importorskip("xarray").open_zarr(path).load()


def same(path: Path, other: Path) -> bool:
    """Whether two stores hold the same bytes, but for the receipts, which say how long the parts took."""

    def files(of: Path) -> dict[str, bytes]:
        return {str(f.relative_to(of)): f.read_bytes() for f in of.rglob("*") if f.is_file() and "/c/" in str(f)}

    return files(path) == files(other)


def test_xarray_opens_a_store_with_its_dimensions_coordinates_units_and_the_studys_file(
    whole: store.Store, small: study.Study
):
    opened = loaded(whole.path)
    block = evaluation.block(small, range(small.count))
    assert dict(opened.sizes) == {"world_anchor_x": 4, "time_scale": 3, "estimator": 1, "run": 4}
    assert opened.world_anchor_x.values.tolist() == np.linspace(-2, 2, 4).tolist()
    assert (opened.sigma_lifted.units, opened.world_anchor_x.units) == ("m", "m")
    assert opened.sigma_lifted.values.ravel().tolist() == block.point[:, 0].tolist()
    assert opened.steady_position.values.reshape(12, 1, 4).tolist() == block.runs[..., 0].tolist()
    assert opened.runs.values.tolist() == [[4] * 3] * 4
    (opened.steady_position.mean("run").sel(estimator="cascade") - opened.sigma_lifted).sel(time_scale=1.0)
    assert study.study_file.loads(opened.attrs["study"], source="x") == small.file


def test_a_coordinate_has_its_unit_and_no_unit_where_none_is_known_and_one_only_without_dimension(
    small: study.Study, tmp_path: Path
):
    wanted = {"gains.riccati.q": "1/(m⁴ s)", "gains.riccati.v.xi": None, "time_scale": "1", "sensors.noise.mag": "1"}
    chosen = tuple(Listed(path=path, values=(1.0, 2.0)) for path in wanted)
    of = study.of_file(replace(small.file, parameters=chosen), small.bases)
    opened = loaded(creation.created(tmp_path / "units.zarr", of, blocks.divided(of.shape, 99)).path)
    assert [opened[one.dimension].attrs.get("units") for one in chosen] == list(wanted.values())


def test_a_table_says_which_windows_were_judged_only_if_it_has_a_metric_of_windows(
    small: study.Study, whole: store.Store, tmp_path: Path
):
    parquet = pytest.importorskip("pyarrow.parquet")
    of = study.of_file(replace(small.file, metrics=("speed",)), small.bases)
    speeds = creation.created(tmp_path / "speeds.zarr", of, blocks.divided(of.shape, 99))
    tasks.compute(str(speeds.path), of.digest, 0)
    for one, said in ((whole, whole.study.file.windows_judged.encode()), (speeds, None)):
        export.to_parquet(one, tmp_path / "table.parquet")
        metadata = parquet.read_schema(tmp_path / "table.parquet").metadata or {}
        assert metadata.get(b"observability") == said


def test_a_sample_has_its_parameters_as_coordinates_of_its_points_and_an_invalid_point_its_reason(
    small: study.Study, client, tmp_path: Path
):
    rates = Listed(path="sensors.imu_rate", values=(-5.0, 400.0))
    design = study.study_file.LatinHypercube(points=4)
    of = study.of_file(replace(small.file, parameters=(rates,), design=design, metrics=("rank",)), small.bases)
    state = running.run(of, tmp_path / "sample.zarr", client=client)
    opened = loaded(tmp_path / "sample.zarr")
    assert (state.points, state.invalid, state.runs) == (4, 2, 0)
    wrong = opened.sensors_imu_rate.values == -5
    assert opened["rank"].dims == ("point",)
    assert "sensors_imu_rate" in opened.coords
    assert all(("imu_rate" in words) == bad for words, bad in zip(opened.reason.values, wrong, strict=True))
    assert np.isnan(opened["rank"].values[wrong]).all()


def test_a_damaged_part_is_computed_again_and_no_other(whole: store.Store, small: study.Study, client, copy: Path):
    shutil.rmtree(copy / "receipts")
    shutil.copytree(whole.path / "receipts", copy / "receipts")
    chunk = copy / next(iter(whole.chunks(1)))
    chunk.write_bytes(chunk.read_bytes()[:-1] + b"?")
    (copy / "receipts" / "00000000.json").write_text('{"receipt": "{}"')
    assert sorted(set(range(whole.blocks.count)) - set(store.opened(copy).done())) == [0, 1]
    state = running.run(small, copy, client=client)
    assert (state.computed, state.done, state.runs) == (2, whole.blocks.count, 48)
    assert same(copy, whole.path)


def test_the_store_is_the_same_for_other_parts_in_another_order(whole: store.Store, small: study.Study, tmp_path: Path):
    path = tmp_path / "one.zarr"
    made = creation.created(path, small, blocks.divided(small.shape, 5))
    for part in reversed(range(made.blocks.count)):
        tasks.compute(str(path), small.digest, part)
    one, two = loaded(path), loaded(whole.path)
    assert one.drop_attrs().identical(two.drop_attrs())


def test_another_study_and_a_second_program_are_refused(small: study.Study, whole: store.Store, client, copy: Path):
    other = study.of_file(replace(small.file, seed=4), small.bases)
    with pytest.raises(
        ValueError, match=r"small.zarr: holds another study, a small study \(seed is 3 there, and 4 here\)"
    ):
        running.run(other, copy, client=client)
    with store.opened(copy).locked(), pytest.raises(ValueError, match="another program is computing this study"):
        running.run(small, copy, client=client)
    with pytest.raises(ValueError, match=r"must end in .zarr"):
        running.run(small, copy.parent / "small.nc", client=client)
    (copy.parent / "empty.zarr").mkdir()
    with pytest.raises(ValueError, match="no zarr group"):
        store.opened(copy.parent / "empty.zarr")


def test_a_disk_that_refuses_leaves_no_receipt_and_the_same_call_goes_on(
    small: study.Study, whole: store.Store, client, copy: Path
):
    for file in (copy / "receipts").glob("*.json"):
        file.unlink()
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (16, limits[1]))  # bytes of a file, for every process alike
    try:
        with pytest.raises(running.StoppedError, match=r"0 of \d+ parts are kept, and the same command goes on"):
            running.run(small, copy, client=client)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert store.opened(copy).receipts() == {}
    assert running.run(small, copy, client=client).runs == 48
    assert same(copy, whole.path)


def test_what_is_stopped_is_kept(small: study.Study, whole: store.Store, client, copy: Path):
    for file in list((copy / "receipts").glob("*.json"))[1:]:
        file.unlink()
    states = []
    with pytest.raises(CancelledError):
        running.run(small, copy, client=client, shown=states.append, cancelled=lambda: states[-1].computed > 0)
    kept = store.opened(copy).done()
    assert 2 <= len(kept) < whole.blocks.count  # the one that was there, and those that were computed
    state = running.run(small, copy, client=client)
    assert state.computed == whole.blocks.count - len(kept)
    assert same(copy, whole.path)


def test_a_table_has_a_row_for_each_point_or_for_each_run(whole: store.Store, tmp_path: Path):
    parquet = pytest.importorskip("pyarrow.parquet")
    assert export.to_csv(whole, tmp_path / "points.csv") == 12
    assert export.to_parquet(whole, tmp_path / "runs.parquet", every_run=True) == 48
    table = parquet.read_table(tmp_path / "runs.parquet").to_pydict()
    opened = loaded(whole.path)
    row = table["seed"].index(whole.study.seed(5, 2))
    assert table["steady_position"][row] == opened.steady_position.values[1, 2, 0, 2]
    head, *lines = (tmp_path / "points.csv").read_text().splitlines()
    values = dict(zip(head.split(","), lines[5].split(","), strict=True))
    assert float(values["steady_position"]) == pytest.approx(opened.steady_position.values[1, 2].mean())
    assert float(values["time_scale"]) == opened.time_scale.values[2]


def test_a_summary_says_at_how_many_points_a_requirement_is_met_and_between_which_values(whole: store.Store):
    steady = loaded(whole.path).steady_position.mean("run").sel(estimator="cascade").to_series()
    met = steady <= whole.study.bases[0].requirement.position_sigma
    of = summary.summary(whole).metrics["steady_position", "cascade"]
    assert 0 < of.meets == met.sum() < len(met)
    times = met[met].index.get_level_values("time_scale")
    assert of.within["time_scale"] == (times.min(), times.max())


def test_a_summary_has_the_points_that_meet_everything_and_the_best_of_them(whole: store.Store):
    of, opened = summary.summary(whole), loaded(whole.path)
    steady = opened.steady_position.mean("run").sel(estimator="cascade").values.ravel()
    sigma, needed = opened.sigma_lifted.values.ravel(), whole.study.bases[0].requirement.position_sigma
    settled = opened.settled.mean("run").values.ravel() >= 0.5
    every = (steady <= needed) & (sigma <= needed) & settled & (opened.flyable.values.ravel() == 1)
    assert of.together["cascade"].count == every.sum()
    assert of.metrics["sigma_lifted", ""].missed.count == (sigma > needed).sum()
    best = of.metrics["sigma_lifted", ""].best
    assert best == sigma[every].min() if every.any() else np.isnan(best)


def test_a_scheduler_that_does_not_answer_leaves_no_store(small: study.Study, tmp_path: Path):
    pytest.importorskip("distributed")
    with pytest.raises(ValueError, match="is no address"):
        running.run(small, tmp_path / "none.zarr", scheduler="nonsense://")
    assert list(tmp_path.iterdir()) == []


def test_a_receipt_has_how_many_points_meet_the_stopping_rule(small: study.Study, tmp_path: Path):
    stop = Stop(metric="steady_position", half_width=0.3, least=4)
    of = study.of_file(replace(small.file, stop=stop, runs=12), small.bases)
    made = creation.created(tmp_path / "stop.zarr", of, blocks.divided(of.shape, 3))
    tasks.compute(str(made.path), of.digest, 1)
    values = made.read(1)["steady_position"].reshape(3, 12)
    met = sum(stop.met(row[None, ~np.isnan(row)]) for row in values)
    assert made.done()[1].met == summary.summary(made).stopped == met


def test_a_receipt_with_one_changed_digit_counts_as_none(whole: store.Store, tmp_path: Path):
    text = receipts.path(whole.path, 0).read_text()
    (tmp_path / "0.json").write_text(text.replace('\\"runs\\":', '\\"runs\\":1'))
    assert receipts.read(receipts.path(whole.path, 0)) is not None
    assert receipts.read(tmp_path / "0.json") is None
