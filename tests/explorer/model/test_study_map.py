"""A map's cells, its contour and its place, each against what the preset of a cell computes without any map."""

import math

import msgspec
import numpy as np
import pytest

from explorer.model import study_axes, study_judgement
from explorer.model.settings import Settings, effective
from explorer.model.study_map import READY, Axis, Place, metrics_with, study_of, taken, values_at
from rangenav import analysis, field_path
from rangenav.preset import Preset
from rangenav.studies import maps, metrics
from rangenav.studies.maps import StudyMap
from rangenav.studies.parameters import SIZE, TIME_SCALE, Linear, Log
from rangenav.studies.requirements import Bound
from rangenav.studies.study import Study
from tests.support.page_settings import SHIPPED

SLOW = Settings(origin="paper-slow", preset=SHIPPED["paper-slow"])
SLOWER = msgspec.structs.replace(SLOW, time_scale=2.0)
X, Y = (Linear(path=f"world.anchor.{axis}", low=-2.0, high=1.0, count=4) for axis in "xy")
SIZES, TIMES = Log(path=SIZE, low=0.5, high=2.0, count=3), Log(path=TIME_SCALE, low=0.5, high=2.0, count=3)
AMPLITUDE = Linear(path="path.tones.1.amplitude", low=0.5, high=1.5, count=3)


def small(settings: Settings, first: Axis, second: Axis, metric: str = "sigma_lifted") -> Study:
    return study_of(settings, (first, second), metric, 1, file="paper-slow")


def filled(values: np.ndarray, *, metric: str = "sigma_lifted", reason: str = "") -> StudyMap:
    """A complete map with these values."""
    n, m = values.shape
    reasons = np.where(np.isnan(values), reason, "").astype(object)
    return StudyMap(
        first=np.arange(float(n)),
        second=np.arange(float(m)),
        values={metric: values, "flyable": np.where(np.isnan(values), np.nan, 1.0)},
        computed=np.ones((n, m), dtype=bool),
        reason=reasons,
        step=1,
    )


@pytest.mark.parametrize("settings", [SLOW, SLOWER], ids=["as it is", "slowed on the page"])
@pytest.mark.parametrize(
    "axes",
    [(X, Y), (SIZES, TIMES), (TIMES, X), (AMPLITUDE, X), (SIZES, AMPLITUDE)],
    ids=["anchor", "size and time scale", "time scale", "a tone", "size and a tone"],
)
def test_a_taken_cell_computes_the_preset_of_that_point_of_the_study(settings: Settings, axes: tuple[Axis, Axis]):
    of = small(settings, *axes)
    place = Place(settings, of)
    for cell in ((0, 0), (2, 1)):  # the second one from where the first one has led
        values = values_at(of, cell)
        settings = place.take(settings, values)
        index = int(np.ravel_multi_index(cell, of.shape))
        assert effective(settings) == of.preset_at(index)
        assert place.values(settings) == pytest.approx(tuple(values.values()))


def test_a_taken_time_scale_stands_on_the_pages_own_slider():
    after = taken(SLOWER, {TIME_SCALE: 0.5, "gains.riccati.q": 7.0})
    assert (after.time_scale, after.preset.gains.riccati.q) == (0.5, 7.0)
    assert after.preset.path == SLOW.preset.path


def test_a_map_is_of_the_design_until_something_else_than_its_parameters_changes():
    of = small(SLOW, X, SIZES)
    place = Place(SLOW, of)
    assert place.values(SLOW) == (0.0, 1.0)
    moved = msgspec.structs.replace(SLOW, preset=field_path.replaced(SLOW.preset, {"world.anchor.x": 0.7}))
    renamed = msgspec.structs.replace(moved, preset=msgspec.structs.replace(moved.preset, title="another title"))
    assert place.values(renamed) == (0.7, 1.0)
    for path, value in (("world.anchor.y", 0.1), ("path.tones.1.amplitude", 2.0), ("sensors.noise.range", 0.3)):
        other = msgspec.structs.replace(SLOW, preset=field_path.replaced(SLOW.preset, {path: value}))
        assert place.values(other) is None, path
    assert place.values(SLOWER) is None


@pytest.mark.parametrize("log", [False, True])
def test_the_contour_crosses_each_edge_between_two_neighbours_on_both_sides_and_no_other(log: bool):
    metric = "sigma_lifted" if log else "speed"
    rng = np.random.default_rng(4)
    values = rng.uniform(0.1, 10.0, (9, 7))
    values[4, 3], values[7, 1] = np.nan, np.inf
    bound = Bound(2.0, True, "wanted")
    ends = np.concatenate(study_judgement.contour(filled(values, metric=metric), metric, bound))
    crossed = {tuple(point) for point in np.round(ends, 9).tolist()}
    expected = set()
    for i, j in np.ndindex(values.shape):
        for k, step in ((i + 1, (1, 0)), (j + 1, (0, 1))):
            if k < values.shape[step[1]]:
                a, b = values[i, j], values[i + step[0], j + step[1]]
                if (a <= bound.level) != (b <= bound.level) and not math.isnan(a + b):
                    expected.add((i, j, *step))
    found = set()
    for x, y in crossed:
        i, j = math.floor(x + 1e-9), math.floor(y + 1e-9)
        found.add((i, j, 1, 0) if abs(x - i) > 1e-9 else (i, j, 0, 1))
    beside = {(4, 3), (3, 3), (4, 2), (3, 2), (5, 3), (4, 4), (5, 2), (3, 4), (5, 4)}  # squares with the invalid corner
    sure = {edge for edge in expected if edge[:2] not in beside}
    assert sure <= found <= expected
    assert len(sure) > 20


def test_the_best_cell_can_be_flown_and_the_share_counts_what_meets_both():
    values = np.array([[1.0, 2.0], [3.0, np.nan]])
    of = filled(values, reason="no such motion")
    of.values["flyable"][0, 0] = 0.0
    verdict = study_judgement.judged(of, "sigma_lifted", Bound(2.5, True, "wanted"))
    assert (verdict.best, verdict.meeting, verdict.flyable) == ((0, 1), 0.25, 0.5)


def test_of_equally_good_cells_the_nearest_to_the_present_design_is_named():
    verdict = study_judgement.judged(filled(np.array([[1.0, 1.0, 1.0, 2.0]])), "sigma_lifted", None, (0.0, 2.6))
    assert (verdict.best, verdict.equal) == ((0, 2), 3)


def test_light_is_the_best_value_and_what_lies_beyond_four_decades_has_the_dark_end():
    share, ends = study_judgement.shares(filled(np.array([[1.0, 10.0], [1e4, 1e9]])), "sigma_lifted")
    assert share == pytest.approx(np.array([[0.0, 0.25], [1.0, 1.0]]))
    assert ends == pytest.approx((1.0, 1e4))
    share, ends = study_judgement.shares(filled(np.array([[1.0, 2.0], [3.0, np.inf]]), metric="rank"), "rank")
    assert ends == (3.0, 1.0)
    assert share[0].tolist() == [1.0, 0.5]


def test_every_parameter_that_is_offered_has_a_label_and_a_range_whose_ends_a_study_takes():
    design: Preset = SHIPPED["minimum-snap"]
    rows = study_axes.candidates(design)
    paths = {one.path for one in rows}
    assert {"world.anchor.x", SIZE, TIME_SCALE, "gains.riccati.q", "path.points.2.value.z"} <= paths
    assert not {"seed", "version", "requirement.mu"} & paths
    for one in rows:
        axis = study_axes.usual(design, one.path)
        assert one.label
        assert axis.low < axis.high
        if one.path in ("gains.riccati.q", "world.anchor.x"):
            field_path.replaced(design, {one.path: axis.high})


def test_an_entry_of_a_list_is_offered_with_its_axis_and_its_unit():
    labels = {one.path: one.caption for one in study_axes.candidates(SHIPPED["paper-slow"])}
    assert labels["path.tones.2.amplitude"] == "path, tone 2 along y, amplitude (m)"
    assert labels["angular_velocity.tones.1.amplitude"] == "angular velocity, tone 1 about x, amplitude (rad/s)"
    assert labels["path.drift.x"] == "path, drift x (m/s)"
    assert labels["initial_rotation.x"] == "initial attitude x (rad)"
    assert labels["sensors.unmodelled.outlier_probability"] == "probability of outliers"


def test_a_parameter_without_any_effect_on_a_metric_is_found_and_one_with_a_little_is_not():
    rows = np.array([[1.0, 1.0, 1.0], [2.0, 2.0, 2.0]])
    assert study_judgement.without_effect(filled(rows), "sigma_lifted") == (1,)
    assert study_judgement.without_effect(filled(rows.T), "sigma_lifted") == (0,)
    assert study_judgement.without_effect(filled(np.ones((2, 3))), "sigma_lifted") == (0, 1)
    rows[1, 2] = np.nextafter(2.0, 3.0)
    assert study_judgement.without_effect(filled(rows), "sigma_lifted") == ()
    rows[1, 2] = np.inf
    assert study_judgement.without_effect(filled(rows), "sigma_lifted") == ()
    only = np.array([[1.0, np.nan], [np.nan, 2.0]])  # no two of them can be compared
    assert study_judgement.without_effect(filled(only), "sigma_lifted") == ()


def test_a_cell_that_cannot_be_flown_names_the_limits_that_it_breaks():
    design = SHIPPED["barrel"]
    limits = study_judgement.limits_of(design, (X, Y))
    assert {"speed", "thrust_to_weight"} <= set(limits)
    of = filled(np.array([[1.0, 1.0]]))
    speed = design.vehicle.speed
    assert speed is not None
    of.values["speed"] = np.array([[0.99 * speed, 1.01 * speed]])
    assert study_judgement.broken_limits(of, limits, (0, 0)) == ()
    assert study_judgement.broken_limits(of, limits, (0, 1)) == ("largest speed",)
    varied = Linear(path="vehicle.speed", low=1.0, high=2.0, count=2)
    assert study_judgement.limits_of(design, (varied, Y)) == {}


def test_the_map_has_the_value_that_the_page_computes_for_the_present_design():
    axes = (
        Linear(path="world.anchor.x", low=0.0, high=1.0, count=2),
        Linear(path="world.anchor.y", low=0.0, high=1.0, count=2),
    )
    of = study_of(SLOW, axes, "sigma_lifted", 1, file="paper-slow")
    *_, complete = maps.coarse_to_fine(of)
    assert complete.values["sigma_lifted"][0, 0] == analysis.sampled(SLOW.preset).lifted_end.position
    assert set(complete.values) == {row.name for row in metrics.ROWS if row.needs in ("analysis", "motion")}
    assert {"observable", "sigma_lifted"} <= set(metrics_with("observable"))


def test_every_ready_map_has_a_range_that_holds_the_present_design():
    for ready in READY:
        axes = tuple(study_axes.usual(SLOW.preset, path) for path in ready.paths)
        place = Place(SLOW, small(SLOW, *axes, metric=ready.metric))
        values = place.values(SLOW)
        assert values is not None
        assert all(axis.low <= value <= axis.high for axis, value in zip(axes, values, strict=True))
