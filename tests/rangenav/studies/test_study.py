"""A study's file names its points, their presets and their seeds; what does not fit is refused with its field."""

import contextlib
import re
from pathlib import Path
from typing import get_args

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rangenav import field_path, preset
from rangenav.field_path import value
from rangenav.studies import blocks, differences, parameters, plan, study, study_file, trial, units
from rangenav.studies.estimators import ESTIMATORS
from rangenav.studies.metrics import METRICS
from rangenav.studies.parameters import Linear, Listed, Log, LogNormal, Normal
from rangenav.studies.study_file import LatinHypercube, Sobol, StudyFile
from rangenav.studies.trial import Cost

SLOW = preset.load("paper-slow")
Q, ANCHOR = (
    Log(path="gains.riccati.q", low=1.0, high=1e4, count=3),
    Linear(path="world.anchor.z", low=-1, high=1, count=2),
)


def of(*chosen: parameters.Parameter, **fields) -> study.Study:
    file = StudyFile(**{"title": "x", "presets": ("paper-slow",), "parameters": chosen, "metrics": ("mu",)} | fields)
    return study.of_file(file, (SLOW,))


def test_the_last_dimension_of_a_grid_runs_fastest_and_every_point_has_its_values():
    grid = of(Q, ANCHOR)
    assert (grid.dimensions, grid.shape) == (("gains_riccati_q", "world_anchor_z"), (3, 2))
    points = [(value(p, Q.path), p.world.anchor[2]) for p in map(grid.preset_at, range(grid.count))]
    assert points == [(q, z) for q in Q.grid() for z in (-1.0, 1.0)]


def test_several_presets_are_the_first_dimension():
    file = StudyFile(title="x", presets=("paper-slow", "circle"), parameters=(ANCHOR,), metrics=("mu",))
    both = study.of_file(file, (SLOW, preset.load("circle")))
    assert (both.dimensions, both.shape) == (("preset", "world_anchor_z"), (2, 2))
    assert [both.preset_at(k).title for k in range(4)] == [SLOW.title] * 2 + [preset.load("circle").title] * 2


@pytest.mark.parametrize("design", [Sobol(points=64), LatinHypercube(points=50)])
def test_a_sample_has_as_many_values_in_each_part_of_a_distribution_as_the_part_is_probable(design):
    chosen = (Normal(path="world.anchor.x", mean=2.0, deviation=0.5), Log(path="gains.riccati.q", low=1.0, high=1e4))
    sample = of(*chosen, design=design)
    assert (sample.dimensions, sample.count) == (("point",), design.points)
    x, q = sample.values.values()
    assert np.mean(x < 2.0) == np.mean(q < 1e2) == 0.5
    assert abs(np.mean(np.abs(x - 2.0) < 0.5) - 0.683) < 0.05
    again = of(*chosen, design=design)
    assert all((a == b).all() for a, b in zip(sample.values.values(), again.values.values(), strict=True))
    assert (of(*chosen, design=design, seed=1).values["world_anchor_x"] != x).any()


def test_the_values_of_a_distribution_in_a_grid_are_the_medians_of_equal_parts():
    assert Normal(path="p", mean=1.0, deviation=2.0, count=1).grid() == [1.0]
    low, high = LogNormal(path="p", median=3.0, factor=2.0, count=2).grid()
    assert low * high == pytest.approx(9.0)
    assert low == pytest.approx(3.0 * 2**-0.6745, rel=1e-4)


def test_a_seed_depends_on_the_studys_seed_and_on_both_indices_alone():
    one, other = of(Q), of(Q, ANCHOR, runs=7)
    seeds = [one.seed(point, run) for point in range(50) for run in range(50)]
    assert len(set(seeds)) == 2500
    assert all(0 <= seed < 2**53 for seed in seeds)
    assert other.seed(2, 5) == one.seed(2, 5) != of(Q, seed=1).seed(2, 5)


def test_time_scale_and_size_act_on_the_whole_path():
    scaled = of(Listed(path="time_scale", values=(2.0,)), Listed(path="size", values=(3.0,))).preset_at(0)
    half, middle = np.array([1.0]), SLOW.path(np.linspace(0, 20, 401))
    middle = (middle.min(axis=0) + middle.max(axis=0)) / 2
    assert scaled.path(2 * half) == pytest.approx(middle + 3 * (SLOW.path(half) - middle), abs=1e-9)


def test_a_value_that_does_not_fit_is_refused_with_its_path_and_the_rule():
    with pytest.raises(ValueError, match=r"gains.riccati.q = 1e\+30: .*q must lie between") as refusal:
        of(Listed(path="gains.riccati.q", values=(1e30,))).preset_at(0)
    assert "$" not in str(refusal.value)


def test_the_unit_of_a_parameter_is_that_of_its_field():
    paths = ("world.anchor.x", "duration", "path.tones.1.frequency", "time_scale", "guess.attitude_angle")
    found = [units.of(Listed(path=path, values=(1.0,)), SLOW) for path in paths]
    assert found == ["m", "s", "rad/s", "", "rad"]


UNITS = {
    "gains.riccati.q": "1/(m⁴ s)",
    "gains.attitude.k1": "1/s",
    "gains.attitude.rho2": "s⁴/m²",
    "sensors.range_rate": "Hz",
    "gains.riccati.p0.velocity": "m²/s²",
    "gains.riccati.v.gravity": "m²/s⁵",
    "path.tones.1.amplitude": "m",
    "path.drift.x": "m/s",
    "angular_velocity.tones.1.amplitude": "rad/s",
    "angular_velocity.drift.x": "rad/s²",
    "gains.riccati.v.xi": None,
}
"""By hand: K = P𝒞ᵀQ is applied to ½d² (m²) and P(p) is in m², so Q is in 1/(m⁴ s); σ = … + ρ2 g × ĝ has no unit."""


def test_the_unit_of_a_parameter_is_the_one_that_its_equation_gives_it_and_a_density_says_so():
    circle = preset.load("circle")
    assert {path: units.of(Listed(path=path, values=(1.0,)), circle) for path in UNITS} == UNITS
    noise = Listed(path="sensors.noise.gyro", values=(1.0,))
    dense = msgspec.structs.replace(SLOW.sensors.noise, imu_unit="density")
    dense = msgspec.structs.replace(SLOW, sensors=msgspec.structs.replace(SLOW.sensors, noise=dense))
    assert [units.of(noise, one) for one in (SLOW, dense)] == ["rad/s", "rad/s/√Hz"]


def test_every_number_of_every_shipped_preset_has_a_unit_or_is_one_of_the_few_that_have_several():
    several = re.compile(r"version|gains\.riccati\.(v|p0)\.xi")
    without = set()
    for file in preset.shipped_files():
        one = preset.load(file.stem)
        for path in {re.sub(r"\.\d+\.", ".1.", path) for path in field_path.paths(one)} - {"seed"}:
            with contextlib.suppress(ValueError):  # words
                field_path.value(one, path)
                if units.of(Listed(path=path, values=(1.0,)), one) is None:
                    without.add(path)
    assert {path for path in without if not several.fullmatch(path)} == set()


def test_a_file_is_written_and_read_without_loss():
    file = of(Q, ANCHOR, runs=8).file
    assert study_file.loads(study_file.dumps(file), source="x") == file


BROKEN = {
    'metrics = ["mo"]': "metrics: there is no mo; did you mean mu",
    'metrics = ["mu"]\nestimators = ["kf"]': "estimators: there is no kf; did you mean ekf? There are cascade,",
    'metrics = ["mu"]\npresets = ["nowhere"]': "presets: there is no nowhere; did you mean hover? There are barrel",
    'metrics = ["mu"]\nruns = 0': "runs must lie between 1 and 10000, got 0",
    'metrics = ["mu"]\ncolour = 1': "no key is named colour; the keys are version, title",
    'metrics = ["mu"]\n[stop]\nmetric = "mu"\nhalf_width = 0.1': "stop.metric: mu is no metric of a run",
    'metrics = ["mu"]\n[design]\nkind = "sobol"\npoints = 12': "points must be a power of two, got 12",
    'metrics = ["mu"]\n[design]\nkind = "sobol"\npoints = 8': "a sample needs one parameter or more",
}


def test_a_value_that_is_zero_but_for_rounding_is_zero_and_the_ends_are_as_written():
    values = Linear(path="world.anchor.y", low=-1.8, high=1.8, count=7).grid()
    assert values[3] == 0.0
    assert values.tolist() == pytest.approx([-1.8, -1.2, -0.6, 0.0, 0.6, 1.2, 1.8])
    assert Linear(path="world.anchor.y", low=1e-20, high=1.0, count=3).grid()[0] == 1e-20
    assert Linear(path="world.anchor.y", low=-1e-20, high=1e-20, count=5).grid()[1] == -5e-21


PARAMETER = 'metrics = ["mu"]\n[[parameters]]\nkind = "linear"\n'
VALUES = "low = 1\nhigh = 2\ncount = 2\n"
AGAIN = (
    f'{PARAMETER}path = "world.anchor.x"\n{VALUES}[[parameters]]\nkind = "linear"\npath = "{{}}"\nname = "b"\n{VALUES}'
)
BROKEN |= {
    'metrics = ["mu"]\npresets = ["barel"]': "presets: there is no barel; did you mean barrel or",
    'metrics = ["mu"]\npresets = ["none.toml"]': "none.toml: no such file",
    'metrics = ["mu"]\npresets = ["mine.toml"]': "broken.toml: presets: mine.toml: ",
    PARAMETER.replace("linear", "list") + 'path = "size"\nvalues = [1]\ncount = 2': "count is a key of linear, log,",
    'metrics = ["mu"]\n[design]\nkind = "grid"\npoints = 8': "points is a key of sobol, latin-hypercube, not of grid",
    PARAMETER + 'path = "gains.k9"\nlow = 0\nhigh = 1\ncount = 2': "parameters.1: path gains.k9: there is no k9",
    PARAMETER + 'path = "world.anchor.0"\nlow = 0\nhigh = 1\ncount = 2': "0 must lie between 1 and 3, or be x, y or z",
    PARAMETER + 'path = "gains.mode"\nlow = 0\nhigh = 1\ncount = 2': 'gains.mode: a word; kind = "choices"',
    PARAMETER + 'path = "seed"\nlow = 0\nhigh = 1\ncount = 2': "path must not be seed",
    PARAMETER + 'path = "time_scale"\nlow = 2\nhigh = 1\ncount = 2': "low must lie below high, got 2 and 1",
    PARAMETER + 'path = "time_scale"\nlow = 1\nhigh = 2': "parameters.1: count is missing; a grid needs it",
    PARAMETER + 'path = "range"\nlow = 0\nhigh = 1\ncount = 2': "there is no range; did you mean sensors.range",
    PARAMETER + 'path = "size"\nlow = -1\nhigh = 1\ncount = 2': "parameters.1: size must be positive, got -1",
    PARAMETER
    + 'path = "size"\nlow = 1\nhigh = 2\ncuont = 2': "parameters.1: no key is named cuont; did you mean count",
    PARAMETER.replace("linear", "lin") + 'path = "size"': "parameters.1.kind: there is no lin; did you mean linear",
    PARAMETER.replace("linear", "choices") + 'path = "gains.mode"\nvalues = [1.0]': 'kind = "list" takes numbers',
    'metrics = ["mu"]\nversion = 2': "version: must be 1, got 2",
    'metrics = ["mu]\n': "the line ends within a text (at line",
    PARAMETER + 'path = "vehicle.tilt"\nlow = 0\nhigh = 1\ncount = 2': "states none; write a value into its file",
    PARAMETER.replace("linear", "choices")
    + 'path = "gains.mode"\nvalues = ["constnt"]': "there is no constnt; did you",
    PARAMETER.replace("linear", "choices") + 'path = "gains.riccati.q"\nvalues = ["a"]': 'a number; kind = "list"',
    'metrics = ["mu"]\npreset = "paper-slow"': "no key is named preset; did you mean presets",
    'metrics = ["mu"]\npresets = ["mine"]': 'to use the file beside this one, write "mine.toml"',
    AGAIN.format("world.anchor.x"): "parameters.2: path world.anchor.x is varied by parameters.1 already; give",
    AGAIN.format("world.anchor.1"): "world.anchor.1 is varied by parameters.1 already, as world.anchor.x",
    AGAIN.format("world.anchor.01"): "world.anchor.01 is varied by parameters.1 already, as world.anchor.x",
    AGAIN.replace("world.anchor.x", "path.tones.1.phase").format("path.tones.x.phase"): "is varied by parameters.1",
    AGAIN.replace("world.anchor.x", "size").format("size"): "parameters.2: path size is varied by parameters.1 already",
    PARAMETER + 'path = "size"\nname = "runs"\nlow = 1\nhigh = 2\ncount = 2': "name must not be runs",
}


@pytest.mark.parametrize("text", BROKEN)
def test_what_does_not_fit_in_a_file_is_refused_with_file_field_and_rule(text: str, tmp_path: Path):
    presets = "" if "presets" in text else 'presets = ["paper-slow"]\n'
    (tmp_path / "mine.toml").touch()
    (tmp_path / "broken.toml").write_text(f'title = "x"\n{presets}{text}')
    with pytest.raises(ValueError, match=r"^broken.toml: ") as refusal:
        study.load(tmp_path / "broken.toml")
    assert BROKEN[text] in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_a_preset_in_place_of_a_study_and_a_study_in_place_of_a_preset_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    preset.save(SLOW, tmp_path / "slow.toml")
    with pytest.raises(ValueError, match=r'slow.toml: a preset, and no study; .*presets = \["slow.toml"\]'):
        study.load(tmp_path / "slow.toml")
    (tmp_path / "mine.toml").write_text(study_file.dumps(of(Q).file))
    with pytest.raises(ValueError, match=r"mine.toml: a study, and no preset"):
        preset.load(tmp_path / "mine.toml")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=r"mine: no such study; did you mean mine.toml"):
        study.load("mine")


def test_a_folder_a_store_and_nothing_at_all_are_told_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    for name in ("sub", "sub.toml", "here/sub", "s.zarr", "here/s.zarr"):
        (tmp_path / name).mkdir(parents=True)
    for name in ("sub", "sub.toml", "here/sub", str(tmp_path)):
        with pytest.raises(ValueError, match=f"^{re.escape(name)}: a folder, and no study's file"):
            study.find(name)
    for name in ("s.zarr", "here/s.zarr"):
        with pytest.raises(ValueError, match=f"^{name}: a store; study show reads it"):
            study.find(name)
    with pytest.raises(ValueError, match=r"^here/none.toml: no such file"):
        study.find("here/none.toml")
    with pytest.raises(ValueError, match=r"anchor-mp: no such study; did you mean anchor-map\? Shipped are anchor-map"):
        study.find("anchor-mp")


def test_what_differs_is_named_with_its_field_and_both_values():
    other = msgspec.structs.replace(Q, count=4)
    assert differences.between(of(Q), of(other)) == "parameters.1.count is 3 there, and 4 here"
    gains = msgspec.structs.replace(SLOW, duration=21.0)
    changed = study.of_file(of(Q).file, (gains,))
    assert differences.between(of(Q), changed) == "in the preset paper-slow, duration is 20.0 there, and 21.0 here"


def test_a_parameter_that_changes_no_metric_is_named_and_no_other():
    matched = field_path.replaced(SLOW, {"gains.mode": "noise-matched", "duration": 4.0, "requirement.window": 2.0})
    file = StudyFile(title="x", presets=("p",), parameters=(Q, ANCHOR), metrics=("steady_position",))
    assert plan.without_effect(study.of_file(file, (matched,))) == (Q.path,)
    constant = field_path.replaced(matched, {"gains.mode": "constant"})
    assert plan.without_effect(study.of_file(file, (constant,))) == ()
    never = msgspec.structs.replace(file, metrics=("settled",))  # 0 for every value, but not for want of an effect
    assert plan.without_effect(study.of_file(never, (constant,))) == ()


def test_a_plan_says_why_a_tail_is_invalid():
    tail = Normal(path="sensors.noise.range", mean=0.05, deviation=0.1, count=30)
    cost = trial.cost(of(tail))
    assert cost.invalid > 0
    assert "sensors.noise.range = -" in cost.reason


@given(st.lists(st.integers(1, 9), min_size=1, max_size=3), st.integers(1, 60))
def test_the_parts_hold_every_point_once_and_none_has_too_many(shape: list[int], points: int):
    divided = blocks.divided(tuple(shape), points)
    parts = [divided.indices(part) for part in range(divided.count)]
    assert sorted(np.concatenate(parts).tolist()) == list(range(int(np.prod(shape))))
    assert max(map(len, parts)) <= points


@given(st.integers(1, 3000), st.floats(1e-4, 20.0), st.integers(1, 8))
def test_parts_are_shared_as_evenly_as_their_size_allows_and_are_not_much_smaller(count: int, run: float, workers: int):
    many = of(Linear(path="world.anchor.z", low=-1, high=1, count=count), metrics=("settled",))
    one, shared = (plan.divided(many, Cost(point=0.0, run=run, tried=1, invalid=0), workers=n) for n in (1, workers))
    longest = [-(-parts.count // workers) * parts.chunk[0] for parts in (one, shared)]
    assert longest[1] <= longest[0]
    assert shared.chunk[0] >= 0.5 * one.chunk[0]


def test_the_page_about_studies_names_every_metric_estimator_and_kind():
    page = (Path(__file__).parents[3] / "docs" / "how-to" / "studies.md").read_text(encoding="utf-8")
    kinds = [kind.__struct_config__.tag for kind in (*get_args(parameters.Parameter), *get_args(study_file.Design))]
    assert [name for name in (*METRICS, *ESTIMATORS, *kinds) if f"`{name}`" not in page] == []


def test_every_shipped_study_is_named_on_that_page_and_its_first_point_is_valid():
    page = (Path(__file__).parents[3] / "docs" / "how-to" / "studies.md").read_text(encoding="utf-8")
    for name in study.shipped():
        assert f"`{name}`" in page
        study.load(name).preset_at(0)
