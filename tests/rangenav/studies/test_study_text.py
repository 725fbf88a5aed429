"""What `rangenav study` says of a study and of its store: what fails, what is taken, what decides nothing, how long."""

import io
import os
import signal
import time
from pathlib import Path

import pytest
from msgspec.structs import replace
from rich.console import Console

from rangenav.commands import progress, study_answers
from rangenav.commands import study as command
from rangenav.commands.text import layout, study_store
from rangenav.commands.text import study as text
from rangenav.studies import blocks, cluster, creation, plan, running, store, study, tasks
from rangenav.studies.trial import Cost

COST = Cost(point=1e-3, run=4.06e-3, tried=7, invalid=0)


def words(report: layout.Report) -> str:
    """Everything that a report says, on one line."""
    return " ".join([report.answer, *(line for group in report.groups for line in group.lines)])


def planned(of: study.Study, *, workers: int = 2, cores: int = 2, cost: Cost = COST, **more: object) -> str:
    """What `study plan` says."""
    known = plan.of_cost(of, cost, workers=workers)
    answer = study_answers.plan_report(of, known, name="x.toml", workers=workers, cores=cores, without_effect=())
    return words(text.planned(answer | {"store": "x.zarr", "store_taken": None} | more))


@pytest.fixture(scope="module")
def computed(small: study.Study, tmp_path_factory: pytest.TempPathFactory) -> store.Store:
    """The small study, computed in this process."""
    made = creation.created(tmp_path_factory.mktemp("said") / "small.zarr", small, blocks.divided(small.shape, 12))
    for part in range(made.blocks.count):
        tasks.compute(str(made.path), small.digest, part)
    return made


def test_what_fails_at_most_points_is_named_with_who_requires_it(computed: store.Store):
    answer = study_answers.show_report(computed)
    misses = {row["metric"]: row["misses"] for row in answer["metrics"]}
    worst = max(misses, key=lambda name: misses[name])
    assert misses[worst] > 0
    assert f"fails most often, at {misses[worst]} of 12 points: {worst}, " in words(study_store.shown(answer))
    assert [row["bound_of"] for row in answer["metrics"]] == [
        "required by the preset",
        "required by the vehicle",
        "required by the preset",
        "required of every study",
    ]
    everywhere = [row | {"misses": 0, "meets": 12} for row in answer["metrics"]]
    fine = answer | {
        "metrics": everywhere,
        "all_met": [answer["all_met"][0] | {"points": 12, "at": [{"point": 0}] * 3}],
    }
    assert "fails most often" not in words(study_store.shown(fine))


def test_a_box_leaves_out_the_parameters_that_it_does_not_bound(computed: store.Store):
    answer = study_answers.show_report(computed)
    for row in answer["metrics"]:
        row |= {"misses": 6, "meets": 6, "meets_within": {"a": [0.0, 1.0], "b": [2.0, 3.0]}, "meets_across": ["a"]}
    assert "bounding box: b from 2 to 3" in words(study_store.shown(answer))
    assert "a from 0 to 1" not in words(study_store.shown(answer))
    for row in answer["metrics"]:
        row |= {"meets_across": ["a", "b"]}
    assert "6 of 12 points, from end to end of every parameter" in words(study_store.shown(answer))
    assert "box" not in words(study_store.shown(answer))


def test_a_store_that_holds_another_study_is_named_before_it_is_computed_and_another_name_is_given(
    small: study.Study, computed: store.Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    more = study.of_file(replace(small.file, runs=6), small.bases)
    taken = command._refused(more, computed.path)
    assert taken == f"{computed.path}: holds another study, a small study (runs is 4 there, and 6 here)"
    assert command._refused(small, computed.path) is None
    with pytest.raises(ValueError, match=r"runs is 4 there, and 6 here\); -o OTHER.zarr chooses another store"):
        running._opened(more, computed.path, 1)
    assert f"{taken} study run x.toml -o x-2.zarr" in planned(more, store="x-2.zarr", store_taken=taken).replace(
        "rangenav ", ""
    )
    monkeypatch.chdir(tmp_path)
    assert [str(command._store("x.toml", free=free)) for free in (True, False)] == ["x.zarr", "x.zarr"]
    for name in ("x.zarr", "x-2.zarr"):
        Path(name).mkdir()
    assert [str(command._store("x.toml", free=free)) for free in (True, False)] == ["x-3.zarr", "x.zarr"]
    assert command._refused(small, Path("x.zarr")) == "x.zarr: no zarr group, so no store of a study"


def test_a_stop_says_what_the_store_holds_and_not_what_the_program_has_counted(small: study.Study, tmp_path: Path):
    made = creation.created(tmp_path / "part.zarr", small, blocks.divided(small.shape, 4))
    assert running.stopped(made.path) == "stopped; 0 of 4 parts are kept, and the same command goes on"
    tasks.compute(str(made.path), small.digest, 2)  # by a worker whose program has not heard of it
    assert running.stopped(made.path) == "stopped; 1 of 4 parts is kept, and the same command goes on"
    assert running.stopped(tmp_path / "none.zarr") == "stopped before anything was computed"


def test_an_estimate_has_two_digits_and_says_what_limits_it(small: study.Study):
    many = study.of_file(replace(small.file, runs=10_000), small.bases)  # 12 points of 40.6 s and some, one a part
    said = planned(many)
    assert "12 points, about 8.1 min of one core" in said
    assert "about 4.1 min with 2 workers and" in said
    assert "about 1 ms for each point" in said
    assert "about 4.1 ms for each run" in said
    said = planned(many, workers=1_000_000)
    assert "about 41 s with 1 000 000 workers, if each has a core of its own: this machine has 2" in said
    assert "no more than 12 workers have something to do" in said
    assert "deal out" not in said
    wide = replace(small.file.parameters[0], count=100_000)
    wide = study.of_file(replace(small.file, parameters=(wide,), runs=1000), small.bases)
    said = planned(wide, workers=1_000_000)  # 4.06e5 s in parts of 6 s or less: 27 000 workers, 250 parts a second
    assert "one program and its scheduler deal out no more parts in this time" in said


def test_a_plan_names_keys_that_decide_nothing_and_every_kind_of_reason(small: study.Study):
    idle = replace(small.file, metrics=("flyable",), every_window=True, windows=50, estimators=("ekf",))
    assert [one.split(":")[0] for one in idle.unused] == ["runs", "estimators", "windows", "every_window"]
    assert "runs: no metric is of a run" in planned(study.of_file(idle, small.bases))
    assert small.file.unused == ()
    reasons = ("a = 1: too low", "b = 2: too high")
    said = planned(small, cost=replace_cost(invalid=3, reason=reasons[0], reasons=reasons))
    assert f"3 of 7 points that were tried {reasons[0]} {reasons[1]}" in said
    assert "not known: no point that was tried is valid" in planned(small, cost=replace_cost(invalid=7))


def replace_cost(**changes: object) -> Cost:
    """The cost above with changes."""
    return Cost(**{"point": 1e-3, "run": 4e-3, "tried": 7, "invalid": 0} | changes)  # pyright: ignore[reportArgumentType]


def test_progress_on_80_columns_is_folded_and_nothing_of_it_is_cut(monkeypatch: pytest.MonkeyPatch):
    file = io.StringIO()
    monkeypatch.setattr(progress, "_terminal", lambda: Console(file=file, force_terminal=True, width=80))
    said = "4/33 parts · 59 runs/s · 4.92 min left · steady_position ±5% (95 %, a typical point)"
    with progress.describing("computing gains-of-the-soft-path") as say:
        say(0.1, said)
        shown = file.getvalue()
        for _ in range(100):
            say(0.1, said)
    shown = file.getvalue()
    assert "…" not in shown
    for word in ("gains-of-the-soft-path", "4/33", "steady_position", "typical"):
        assert word in shown


def test_ctrl_c_is_answered_while_workers_start():
    answered: list[float] = []
    before = signal.signal(signal.SIGINT, lambda *_: answered.append(time.monotonic()))

    def start() -> float:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1.0)  # ten looks of the main thread
        return time.monotonic()

    try:
        started = cluster._aside(start)
    finally:
        signal.signal(signal.SIGINT, before)
    assert len(answered) == 1
    assert answered[0] < started
    with pytest.raises(OSError, match="no port is free"):
        cluster._aside(lambda: (_ for _ in ()).throw(OSError("no port is free")))
