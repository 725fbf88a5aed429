"""A point of a study is what the library computes for its preset and its seeds, one call at a time."""

import numpy as np
import pytest
from msgspec.structs import replace

from rangenav import analysis, comparison, preset, record
from rangenav.progress import CancelledError
from rangenav.studies import evaluation, intervals, maps, study
from rangenav.studies.estimators import ESTIMATORS
from rangenav.studies.metrics import METRICS
from rangenav.studies.parameters import Listed
from rangenav.studies.stopping import Stop


def changed(of: study.Study, **fields) -> study.Study:
    return study.of_file(replace(of.file, **fields), of.bases)


def test_every_run_is_the_run_of_its_preset_with_its_seed_to_the_last_bit(small: study.Study):
    done, chosen = evaluation.point(small, 5), small.preset_at(5)
    runs = [record.run_seed(chosen, small.seed(5, run)).summary.steady_position for run in range(4)]
    assert done.runs[0, :, 0].tolist() == runs
    assert done.point.tolist() == [analysis.sampled(chosen).lifted_end.position, 1.0]


def test_estimators_share_the_record_of_a_run(small: study.Study):
    one = evaluation.point(changed(small, estimators=tuple(ESTIMATORS), runs=1), 5)
    of = record.run_seed(small.preset_at(5), small.seed(5, 0))
    steady = dict(zip(ESTIMATORS, one.runs[:, 0, 0], strict=True))
    assert steady["ekf"] == comparison.filtered(of).summary.steady_position
    assert steady["refinement"] == comparison.refined(of).summary.steady_position
    assert steady["cascade"] == steady["schedule"]  # its k1 turns the attitude only
    assert len(set(steady.values())) == len(ESTIMATORS) - 1


def test_every_metric_is_a_number_of_a_usual_motion(small: study.Study):
    of = changed(small, metrics=tuple(METRICS), runs=1)
    one = evaluation.point(of, 5)
    assert np.isfinite(one.point).all()
    late = [name for name, value in zip(of.file.run_metrics, one.runs[0, 0], strict=True) if not np.isfinite(value)]
    assert set(late) <= {"settle_position", "settle_attitude"}


def test_observable_is_the_verdict_over_all_windows_also_where_the_sampled_ones_are_good_enough(small: study.Study):
    slow = preset.load("paper-slow")
    of = changed(small, metrics=("sigma_lifted", "observable"), parameters=())
    sampled, exact = (f(slow).lifted_end.position for f in (analysis.sampled, analysis.analyse))
    assert sampled < exact
    required = replace(slow, requirement=replace(slow.requirement, position_sigma=(sampled + exact) / 2))
    between = study.of_file(of.file, (required,))
    assert analysis.sampled(required).verdict.word == "observable"
    assert evaluation.point(between, 0).point.tolist() == [sampled, 0.0]
    every = study.of_file(replace(of.file, every_window=True), (required,))
    assert evaluation.point(every, 0).point.tolist() == [exact, 0.0]


def test_a_value_that_does_not_fit_makes_the_point_invalid_with_its_reason_and_no_other(small: study.Study):
    parameter = Listed(path="sensors.imu_rate", values=(200.0, -5.0, 400.0))
    block = evaluation.block(changed(small, parameters=(parameter,)), range(3))
    assert block.count.tolist() == [4, 0, 4]
    assert np.isnan(block.point[1]).all()
    assert np.isnan(block.runs[1]).all()
    assert [bool(words) for words in block.reason] == [False, True, False]
    assert "sensors.imu_rate = -5" in block.reason[1]


def test_a_point_ends_when_the_interval_is_narrow_and_not_before(small: study.Study):
    stop = Stop(metric="steady_position", half_width=0.3, least=4)
    ended = evaluation.block(changed(small, stop=stop, runs=24), [0, 5])
    for row, count in zip(ended.runs[:, 0, :, 0], ended.count, strict=True):
        widths = [intervals.relative_half_width(row[None, :n], "mean")[0] for n in range(4, count + 1, 4)]
        assert all(width > 0.3 for width in widths[:-1])
        assert widths[-1] <= 0.3 or count == 24
    all_runs = evaluation.block(changed(small, runs=24), [0, 5])
    for k, count in enumerate(ended.count):
        assert (ended.runs[k, :, :count] == all_runs.runs[k, :, :count]).all()
        assert np.isnan(ended.runs[k, :, count:]).all()


@pytest.mark.parametrize(
    ("kind", "right", "held"), [("mean", 3.0, 0.95), ("median", 3.0, 0.977), ("share", 0.5, 0.923)]
)
def test_the_interval_holds_the_right_value_in_95_of_100_cases_as_nearly_as_ranks_and_counts_allow(
    kind: intervals.Middle, right: float, held: float
):
    values = np.random.default_rng(0).normal(3.0, 1.0, (4000, 16))
    low, high = intervals.interval((values > 3.0).astype(float) if kind == "share" else values, kind)
    assert np.mean((low <= right) & (right <= high)) == pytest.approx(held, abs=0.01)


def test_a_median_is_finite_if_more_than_half_of_the_runs_are():
    times = np.array([[1.0, 2.0, np.inf, np.nan], [np.inf, 2.0, np.inf, 5.0]])
    assert intervals.middle(times, "median").tolist() == [2.0, np.inf]
    assert intervals.middle(times, "mean").tolist() == [np.inf, np.inf]


def test_points_with_common_seeds_share_their_noise_and_others_do_not(small: study.Study):
    common = changed(small, common_seeds=True)
    assert common.seed(0, 3) == common.seed(11, 3) != common.seed(11, 2)
    assert small.seed(0, 3) != small.seed(11, 3)


def test_a_map_comes_from_coarse_to_fine_and_ends_with_the_values_of_the_points(small: study.Study):
    of, shares = changed(small, runs=1), []
    pictures = list(maps.coarse_to_fine(of, every=0.0, progress=shares.append))
    assert shares == sorted(shares)
    assert shares[-1] == pictures[-1].share == pictures[-1].step == 1
    points = [evaluation.point(of, k).point[0] for k in range(of.count)]
    assert pictures[-1].values["sigma_lifted"].ravel().tolist() == points
    first = pictures[0]
    assert (first.filled("sigma_lifted") == first.values["sigma_lifted"][0, 0]).all()


def test_a_map_that_was_stopped_goes_on_without_computing_its_points_again(
    small: study.Study, monkeypatch: pytest.MonkeyPatch
):
    of, indices = changed(small, runs=1), []
    *_, whole = maps.coarse_to_fine(of)
    begun = next(maps.coarse_to_fine(of, every=0.0))
    point = evaluation.point
    monkeypatch.setattr(evaluation, "point", lambda one, k, **more: indices.append(k) or point(one, k, **more))
    first, *_, last = maps.coarse_to_fine(of, begun=begun)
    assert sorted(indices) == np.flatnonzero(~begun.computed.ravel()).tolist()
    assert first.computed[begun.computed].all()
    assert last.values["sigma_lifted"].tolist() == whole.values["sigma_lifted"].tolist()
    assert last.step == 1


def test_a_map_that_is_not_wanted_stops(small: study.Study):
    with pytest.raises(CancelledError):
        list(maps.coarse_to_fine(small, cancelled=lambda: True))
