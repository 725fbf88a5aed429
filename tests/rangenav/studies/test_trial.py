"""What a trial says of a study's time, beside the time of all its points by a clock that the test moves itself."""

from types import SimpleNamespace

import numpy as np
import pytest

from rangenav import preset
from rangenav.studies import evaluation, parameters, plan, study, trial
from rangenav.studies.parameters import Choices, Linear, Log, Normal
from rangenav.studies.study_file import Stop, StudyFile

SLOW = preset.load("paper-slow")
PACE, ANCHOR = (
    Log(path="time_scale", low=0.5, high=2.0, count=5),
    Linear(path="world.anchor.z", low=-1, high=1, count=12),
)


def of(*chosen: parameters.Parameter, **fields) -> study.Study:
    given = {"title": "x", "presets": ("paper-slow",), "parameters": chosen, "metrics": ("mu", "settled")} | fields
    return study.of_file(StudyFile(**given), (SLOW,))


class Clock:
    """A machine on which a path takes 16 ms, an anchor 3 ms, 3 to 8 runs together 8 ms, and one run alone 4 ms."""

    def __init__(self) -> None:
        self.now, self.row, self.index, self.asked = 0.0, -1, -1, []

    def point(self, asked: study.Study, index: int, *, runs: int | None = None) -> evaluation.PointResult:
        row, most = index // asked.shape[-1], asked.file.most_runs if runs is None else runs
        self.now += 0.0 if index == self.index else 3e-3 if row == self.row else 16e-3
        self.row, self.index = row, index
        together = [len(group) for groups in evaluation.rounds(asked.file, most) for group in groups]
        self.now += sum(8e-3 if count >= 3 else 4e-3 * count for count in together)
        self.asked.append(index)
        return evaluation.PointResult(point=np.zeros(1), runs=np.zeros((1, most, 1)), reason="")

    def of_all(self, asked: study.Study) -> float:
        """The time of all points in their order."""
        began = self.now
        for index in range(asked.count):
            self.point(asked, index)
        return self.now - began


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(evaluation, "point", clock.point)
    monkeypatch.setattr(trial, "time", SimpleNamespace(thread_time=lambda: clock.now))
    return clock


@pytest.mark.parametrize("runs", [1, 2, 7, 8, 12, 20, 40])
def test_a_trial_knows_which_runs_are_made_together_and_what_neighbours_share(runs: int, clock: Clock):
    asked = of(PACE, ANCHOR, runs=runs)
    expected = plan.of_cost(asked, trial.cost(asked)).seconds
    assert expected == pytest.approx(clock.of_all(asked), rel=1e-9)


@pytest.mark.parametrize("least", [2, 8, 10])
def test_the_rounds_of_a_stopping_rule_are_timed_as_they_are_made(least: int, clock: Clock):
    asked = of(PACE, ANCHOR, runs=40, stop=Stop(metric="settled", half_width=0.01, least=least))
    expected = plan.of_cost(asked, trial.cost(asked)).seconds
    assert expected == pytest.approx(clock.of_all(asked), rel=1e-9)


def test_a_trial_of_slow_points_ends_after_a_few(clock: Clock):
    of_point = clock.point

    def slow(asked: study.Study, index: int, *, runs: int | None = None) -> evaluation.PointResult:
        clock.now += 5.0
        return of_point(asked, index, runs=runs)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(evaluation, "point", slow)
        trial.cost(of(PACE, ANCHOR, runs=8))
    assert len(set(clock.asked)) <= 2 * trial.TRIALS + 1


def test_the_kernels_of_every_word_and_preset_are_loaded_before_anything_is_timed(clock: Clock):
    mode = Choices(path="gains.mode", values=("constant", "noise-matched"))
    asked = study.of_file(
        StudyFile(title="x", presets=("slow", "fast"), parameters=(ANCHOR, mode), metrics=("settled",)), (SLOW, SLOW)
    )
    trial.warm_up(asked)
    warmed = [asked.place(index) for index in clock.asked]
    assert {one["gains.mode"] for one in warmed} == set(mode.values)
    assert {one["preset"] for one in warmed} == {"slow", "fast"}


def test_all_points_of_a_small_study_are_looked_at():
    asked = of(PACE, ANCHOR)
    assert sorted(trial._places(asked, 100)) == list(range(asked.count))


def test_invalid_points_are_expected_to_have_no_runs(clock: Clock):
    tail = Normal(path="sensors.noise.range", mean=0.05, deviation=0.1, count=60)
    asked = of(tail, runs=8)
    valid = [not reason for reason in map(_reason, [asked] * asked.count, range(asked.count))]
    cost = trial.cost(asked)
    assert cost.valid == np.mean(valid)
    assert plan.of_cost(asked, cost).seconds == pytest.approx(sum(valid) * (8e-3 + cost.point / cost.valid))


def _reason(asked: study.Study, index: int) -> str:
    try:
        asked.preset_at(index)
    except ValueError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("count", [4, 8, 30])
@pytest.mark.parametrize("most", [16, 100])
def test_the_first_places_of_a_study_lie_in_every_part_of_each_dimension(count: int, most: int):
    asked = of(Log(path="time_scale", low=0.5, high=2.0, count=count), Linear(path="size", low=1, high=2, count=40))
    places = trial._places(asked, most)
    assert len(places) == len(set(places)) <= most
    for along in np.array(np.unravel_index(places[:16], asked.shape)) / np.array(asked.shape)[:, None]:
        assert (np.histogram(along, bins=4, range=(0.0, 1.0))[0] >= 2).all()
