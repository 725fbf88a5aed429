"""What is said of a motion is true of the windows, the bound and the requirement that the sentence names."""

import math
from dataclasses import replace as with_fields
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from rangenav import analysis, certificate, preset, sensors, verdict, window_text
from rangenav.certificate import Certificate, advice, requirements, sections, tone_search
from rangenav.certificate.figures import figures, shortfall
from rangenav.commands.text.certificates import coverage
from rangenav.observability.worst_excitation import EVERY, FLIGHT, worst_excitation
from rangenav.preset import Preset, Requirement
from rangenav.signals import Multisine, Tone

SOFT = preset.load("soft")


def certified(p: Preset) -> Certificate:
    return certificate.certify(preset.dumps(p).encode(), source="x")


def words(issued: Certificate, name: str) -> str:
    (found,) = (check.words for check in issued.checks if check.name == name)
    return found


def tones(*given: tuple[str, float, float, float]) -> Multisine:
    return Multisine(
        tones=tuple(Tone(axis=axis, amplitude=a, frequency=w, phase=phase) for axis, a, w, phase in given)  # pyright: ignore
    )


BEATING = replace(
    SOFT,
    path=tones(
        ("x", 1.0, 3.0, 0.0), ("y", 1.0, 2.0, 0.0), ("z", 0.5, 4.0, 0.0), ("z", 0.5, 4.1, 0.0), ("x", 0.2, 3.1, 0.0)
    ),
    angular_velocity=Multisine(),
    duration=20.0,
    requirement=Requirement(window=8.0, mu=1.0, position_sigma=2.0),
)
"""Its tones along z cancel at 31.4 s, and its loop takes 62.8 s; the flight ends before."""


def test_a_weakest_window_that_the_flight_has_not_is_said_to_be_of_a_later_round(run, tmp_path: Path):
    short = replace(BEATING, duration=24.0)
    seen = analysis.analyse(short)
    assert seen.proof is not None
    assert seen.proof.rank.starts == EVERY
    assert seen.gramian_at > 16.0
    preset.save(short, tmp_path / "short.toml")
    for command in ("analyze", "explain"):
        said = " ".join(run(command, tmp_path / "short.toml")[1].split())
        assert "in every window of 8 s of the repeated path; the weakest starts at " in said
        assert " s, outside this flight" in said
    mu = words(certified(replace(short, requirement=Requirement(window=8.0, mu=1e9))), "excitation")
    assert ", in a later round than this flight's is " in mu


def test_a_weakest_window_within_the_flight_is_named_without_a_round():
    assert window_text.later_round(14.0, 6.0, 20.0) == ""
    assert window_text.one(14.0, 6.0, 20.0) == "the 6 s from t = 14 s"
    assert window_text.later_round(14.1, 6.0, 20.0)


def test_a_certificate_says_of_every_figure_which_windows_it_is_of():
    issued = certificate.certify_file("soft")
    assert words(issued, "excitation").startswith("no window of 12 s at any t ≥ 0 has an excitation below ")
    assert words(issued, "rank") == "the rank is 13 of 13 on every window of 12 s at every t ≥ 0"
    assert " after every window of 12 s of this 20 s flight, 0.5 m required of the prediction" in words(
        issued, "accuracy"
    )


def test_an_error_beyond_all_positions_at_one_range_is_weak_whatever_is_required():
    """Nearly planar: 7 m across, and the prediction is off by kilometres."""
    flat = tones(("x", 1.0, 2.0, 0.0), ("y", 1.0, 4.0, 0.5), ("z", 1e-5, 6.0, 1.0))
    absurd = replace(SOFT, path=flat, requirement=Requirement(window=6.0, mu=1e-9, position_sigma=1e7))
    seen, issued = analysis.analyse(absurd), certified(absurd)
    error, across = seen.lifted_end.position, verdict.sphere(seen.farthest)
    assert across < 20.0 < error < 1e7
    assert (seen.verdict.word, seen.verdict.sign, issued.verdict) == ("weak", "!", "weak")
    assert not issued.certified
    assert [check.name for check in issued.checks if not check.met] == ["accuracy"]
    assert "the sphere on which a single range leaves the position" in words(issued, "accuracy")
    assert certified(replace(absurd, expect="weak")).certified
    assert shortfall(figures(absurd), absurd)["accuracy"] > 0  # so a repair knows it, too
    useful = certified(replace(SOFT, requirement=Requirement(window=12.0, mu=50.0, position_sigma=1e7)))
    assert useful.meets


@pytest.mark.parametrize(
    ("sigma", "required", "word"), [(1.0, 2.0, "observable"), (3.0, 2.0, "weak"), (7.0, 1e9, "weak")]
)
def test_a_verdict_knows_how_far_the_anchor_is(sigma: float, required: float, word: str):
    judged = verdict.judge(13, sigma, required, farthest=3.0)
    assert judged.word == word
    assert bool(judged.reason) == (sigma > 6.0)


def test_an_error_above_the_distance_to_the_anchor_is_a_caveat():
    assert analysis.analyse(SOFT).caveats(SOFT) == ()
    (said,) = verdict.caveats((0, 0, 9.81), 0.1, position_sigma=1.8, farthest=1.0)
    assert said == "The predicted error, 1.8 m, exceeds the largest distance to the anchor, 1 m."
    assert verdict.caveats((0, 0, 9.81), 0.1, position_sigma=math.inf, farthest=1.0) == ()


def test_an_imu_whose_noise_is_far_above_the_predicted_error_is_a_caveat():
    """The drift against 400 integrations of drawn noise."""
    drawn = np.random.default_rng(0).standard_normal((400, 1200)) * SOFT.sensors.sigma.accel
    moved = np.cumsum(np.cumsum(drawn, axis=1), axis=1)[:, -1] / SOFT.sensors.imu_rate**2
    assert sensors.drift(SOFT.sensors, 6.0) == pytest.approx(np.std(moved), rel=0.1)
    noisy = replace(SOFT, sensors=replace(SOFT.sensors, noise=replace(SOFT.sensors.noise, accel=2.0)))
    (said,) = analysis.analyse(noisy).caveats(noisy)
    assert "IMU's noise alone moves the position by 3.39 m within 12 s" in said
    assert certified(noisy).caveats == (said,)
    blind = preset.load("circle")
    assert analysis.analyse(blind).caveats(blind) == ()


def test_a_certificate_with_a_caveat_states_it_and_has_no_tick(run):
    code, out, _ = run("certify", "paper-slow")
    assert (code, out.splitlines()[0]) == (0, "paper-slow   ! certified, with a reservation: observable")
    assert "! The predicted error, 1.81 m, exceeds the largest distance" in " ".join(out.split())
    said = " ".join(run("verify", "paper-slow")[1].split())
    assert "✓ holds" in said
    assert "certified, with a reservation: observable ! The predicted error, 1.81 m" in said


def test_a_bound_of_nothing_is_no_proof(run, tmp_path: Path):
    found = worst_excitation(SOFT.path, 12.0, 20.0, 50.0)
    assert found.bounds is not None
    useless = with_fields(found, bounds=with_fields(found.bounds, lower=0.0))
    assert found.proven(50.0)
    assert not useless.proven(50.0)
    assert useless.proven(1e9)  # that it is missed is proven by the upper bound
    preset.save(replace(preset.load("circle")), tmp_path / "c.toml")
    assert "μ is at least 0" not in run("analyze", tmp_path / "c.toml")[1]


def test_of_a_bound_of_nothing_the_numbers_are_null_and_the_reason_is_given(answer):
    excitation = answer("analyze", "circle")["excitation"]
    assert (excitation["lower"], excitation["bound_for_all_t"]) == (None, None)
    assert excitation["proven"]
    assert excitation["reason"] == (
        "lower: null, no bound of μ above 0 is known; a computed window proves that the required μ is missed"
    )


def test_a_required_excitation_that_a_computed_window_misses_is_missed_whatever_is_known_of_the_others():
    found = worst_excitation(SOFT.path, 12.0, 20.0, 1e9)
    sampled = with_fields(found, bounds=None)
    assert sampled.proven(1e9)
    assert not sampled.proven(found.mu)
    asked = replace(SOFT, requirement=replace(SOFT.requirement, mu=1e9))
    excited = sections.excitation_section(sampled, 1e9)
    issued = certified(asked)
    checks = requirements.requirements(excited, issued.rank, issued.accuracy, issued.jumps, issued.vehicle, asked)
    assert (checks[0].met, checks[0].proven) == (False, True)
    assert "μ is bounded" not in coverage(replace(issued, excitation=excited))[0]


def test_a_change_is_named_only_if_its_certificate_misses_nothing(monkeypatch: pytest.MonkeyPatch):
    circle = preset.load("circle")
    said = advice.change(circle)
    assert said is not None
    assert said.startswith("add for example a tone of ")
    smallest = tone_search.smallest_tones

    def half(p: Preset, at: float):
        added = smallest(p, at)
        return (
            None if added is None else tone_search.attempt(p, added.directions, added.frequencies, added.amplitude / 2)
        )

    monkeypatch.setattr(tone_search, "smallest_tones", half)
    advice.change.cache_clear()
    assert advice.change(circle) is None
    advice.change.cache_clear()


def test_a_preset_that_meets_its_requirement_needs_no_repair(run):
    code, said, _ = run("repair", "soft")
    assert code == 0
    assert "✓ nothing needs repair: every requirement is met" in said
    assert "rangenav repair" not in said


def test_a_vehicle_without_limits_is_no_merit(run):
    assert "– no vehicle limits stated" in run("certify", "soft")[1]


def test_starts_are_named_as_they_are_claimed():
    assert window_text.every(6.0, 20.0, EVERY) == "every window of 6 s at every t ≥ 0"
    assert window_text.every(6.0, 20.0, FLIGHT) == "every window of 6 s of this 20 s flight"
    assert window_text.none(6.0, 20.0, EVERY) == "no window of 6 s at any t ≥ 0"
