"""A result prints as a few lines, however many numbers it holds, and every array in it by its shape and span."""

import dataclasses

import numpy as np
import pytest
from jaxtyping import Float

from rangenav import analysis, cascade, ensemble, preset, record, refine
from rangenav.results import result

SHORT = preset.load("paper-slow")


@result
class Curve:
    """Some values."""

    time: Float[np.ndarray, "n"]
    """s, the IMU's clock."""
    rate: Float[np.ndarray, "n"]
    """(rad/s)²/Hz"""
    value: Float[np.ndarray, "n 3"]
    """Metres, not a unit in short."""
    good: np.ndarray
    mu: float
    """m²/s⁷"""
    words: str = "one sentence"
    parts: tuple = ()


def curve() -> Curve:
    value = np.linspace(-1, 2, 30).reshape(10, 3)
    value[0, 1] = np.nan
    return Curve(
        time=np.arange(10.0), rate=np.full(10, 0.5), value=value, good=np.arange(10) > 6, mu=np.pi, parts=(1.0, None)
    )


def test_shapes_spans_units_and_what_is_missing_stand_for_the_numbers():
    assert repr(curve()) == (
        "Curve(time (10) 0 … 9 s, rate (10) 0.5 (rad/s)²/Hz, value (10, 3) -1 … 2 (1 not finite), good (10) 3 true,\n"
        "    mu 3.14159 m²/s⁷, words 'one sentence', parts (1, None))"
    )


def test_a_result_is_frozen_and_compared_by_identity():
    computed = curve()
    assert computed == computed
    assert computed != dataclasses.replace(computed)
    with pytest.raises(dataclasses.FrozenInstanceError):
        computed.mu = 1.0  # pyright: ignore[reportAttributeAccessIssue]


@pytest.mark.parametrize("field", [np.zeros(0), np.full(3, np.nan), np.array(["a", "b"])])
def test_arrays_without_a_finite_number_print_too(field):
    assert repr(dataclasses.replace(curve(), good=field)).startswith("Curve(time (10) 0 … 9 s")


def test_every_result_of_a_run_is_at_most_a_dozen_lines_that_fit_a_terminal():
    run = record.run(SHORT)
    config = cascade.ObserverConfig(world=SHORT.world, sensors=SHORT.sensors, gains=SHORT.gains)
    analysed = analysis.analyse(SHORT)
    results = [
        run, run.truth, run.truth.motion, run.measurements, run.estimate, run.errors, analysed, analysed.windows,
        refine.refine(run.measurements, run.estimate, config), ensemble.seeds(SHORT, 2),
    ]  # fmt: skip
    for one in results:
        lines = repr(one).splitlines()
        assert lines[0].startswith(f"{type(one).__name__}(")
        assert len(lines) <= 12
        assert max(map(len, lines)) <= 120
    assert f"time ({len(run.estimate.time)}) 0 … {SHORT.duration:g} s" in repr(run.estimate)
