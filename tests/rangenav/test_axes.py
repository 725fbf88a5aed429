"""z down or z up: another name for the same thing."""

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rangenav import analysis, axes, preset, record
from rangenav.sensors import Effects, Noise
from rangenav.signals import Flown, Polynomials, Sum
from tests.support.signal_examples import EXAMPLES, MULTISINE, POLYNOMIALS

SHIPPED = preset.shipped()
FLIP = np.diag([1.0, -1.0, -1.0])


@pytest.mark.parametrize("name", SHIPPED)
def test_naming_the_axes_twice_anew_changes_nothing(name: str):
    assert axes.flipped(axes.flipped(SHIPPED[name])) == SHIPPED[name]


@pytest.mark.parametrize("family", EXAMPLES)
def test_every_family_is_described_in_the_other_axes(family: str):
    time = np.linspace(0.1, 5, 40)
    for order in range(5):
        expected = EXAMPLES[family](time, order) @ FLIP
        computed = axes.flipped_signal(EXAMPLES[family])(time, order)
        assert np.allclose(computed, expected, rtol=1e-9, atol=1e-9 * (1 + np.abs(expected).max()))


def test_nothing_that_can_be_measured_changes():
    """Without noise the sensors' body components turn with the body axes; ranges and errors stay what they are."""
    p = SHIPPED["paper-slow"]
    quiet = msgspec.structs.replace(p.sensors, noise=Noise(gyro=0.0, accel=0.0, mag=0.0, range=0.0))
    known = Effects(gyro_bias=(0.01, 0.02, -0.03), accel_bias=(0.1, 0.2, 0.3), lever_arm=(0.1, -0.2, 0.3))
    quiet = msgspec.structs.replace(quiet, unmodelled=known)
    p = msgspec.structs.replace(p, sensors=quiet, initial_rotation=(0.3, -0.2, 0.9), duration=8.0)
    here, there = record.run(p), record.run(axes.flipped(p))
    assert np.allclose(there.measurements.range, here.measurements.range, rtol=1e-12)
    assert np.allclose(there.measurements.gyro, here.measurements.gyro @ FLIP, atol=1e-12)
    assert np.allclose(there.measurements.accel, here.measurements.accel @ FLIP, atol=1e-9)
    assert np.allclose(there.errors.position, here.errors.position, atol=1e-6)
    assert np.allclose(there.errors.attitude, here.errors.attitude, atol=1e-6)


def test_the_analysis_is_the_same():
    here, there = analysis.analyse(SHIPPED["lissajous"]), analysis.analyse(axes.flipped(SHIPPED["lissajous"]))
    assert there.mu == pytest.approx(here.mu, rel=1e-9)
    assert there.rank == here.rank
    assert there.lifted_end.position == pytest.approx(here.lifted_end.position, rel=1e-6)


def test_a_flown_body_turns_with_its_axes():
    soft = msgspec.structs.replace(SHIPPED["soft"], angular_velocity=Flown(yaw="0.4*sin(t)"))
    here = record.simulated(record.truth_inputs(soft)).motion
    there = record.simulated(record.truth_inputs(axes.flipped(soft))).motion
    assert np.allclose(there.rotation, FLIP @ here.rotation @ FLIP, atol=1e-12)
    assert np.allclose(there.angular_velocity, here.angular_velocity @ FLIP, atol=1e-12)


def test_the_yaw_of_pieces_and_biases_turn_with_their_axes_and_upright_is_the_same_turn():
    pieces = msgspec.structs.replace(POLYNOMIALS.pieces[0], yaw=(0.5, -0.25, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0))
    path = msgspec.structs.replace(POLYNOMIALS, pieces=(pieces, *POLYNOMIALS.pieces[1:]))
    for signal in (path, Sum(base=path, wiggle=MULTISINE)):
        turned = axes.flipped_signal(signal)
        computed = turned.base if isinstance(turned, Sum) else turned
        assert isinstance(computed, Polynomials)
        assert computed.pieces[0].yaw == (-0.5, 0.25, 0.0, 0.0, 0.0, 0.0, 0.0, -3.0)
        assert axes.flipped_signal(turned) == signal
    biased = Effects(gyro_bias=(0.01, 0.02, -0.03), lever_arm=(0.1, -0.2, 0.3))
    p = SHIPPED["soft"]
    down = msgspec.structs.replace(p, sensors=msgspec.structs.replace(p.sensors, unmodelled=biased))
    assert down.world.gravity[2] > 0
    assert axes.upright(down).sensors.unmodelled.gyro_bias == (0.01, -0.02, 0.03)
    assert axes.upright(down) == axes.flipped(down)
    assert axes.upright(axes.upright(down)) == axes.upright(down)


@given(st.sampled_from(["sin(t)", "-(t)", "-(t) + (2)", "(t)", "-t", "0", " cos(t) "]))
def test_a_yaw_negated_twice_is_the_yaw(formula: str):
    assert axes.negated(axes.negated(formula)) == formula.strip()
