"""Paths of pieces that jump: every derivative from position to snap is named, and nothing flies what is not C²."""

import msgspec
import numpy as np
from scipy.interpolate import CubicSpline

from rangenav import analysis, certificate, continuity, preset, report
from rangenav.preset import Preset, Requirement
from rangenav.signals import Multisine, Piece, Polynomials
from rangenav.vehicle import CRAZYFLIE
from tests.support.present import present
from tests.support.signal_examples import POLYNOMIALS, WAYPOINTS

COUNT = 12
POINTS = np.random.default_rng(3).standard_normal((COUNT + 1, 3)) * 0.4 + [0.0, 0.0, 1.5]


def pieces(*, bent: float) -> Polynomials:
    """The cubic spline through random points a second apart, which is C²; `bent` (m/s²) is how far
    the acceleration along x jumps at the ends of each second piece."""
    spline = CubicSpline(np.arange(COUNT + 1.0), POINTS)
    made = []
    for k in range(COUNT):
        x, y, z = (tuple(np.pad(spline.c[::-1, k, axis], (0, 4)).tolist()) for axis in range(3))
        if k % 2 and bent:  # ½ bent t²(1 − t)² changes neither position nor velocity at the ends
            x = (x[0], x[1], x[2] + bent / 2, x[3] - bent, x[4] + bent / 2, *x[5:])
        made.append(Piece(duration=1.0, x=x, y=y, z=z))
    return Polynomials(pieces=tuple(made))


CUBIC = pieces(bent=0.0)


def along(path: Polynomials) -> Preset:
    """A body that follows the path and does not turn."""
    soft = preset.load("soft")
    return msgspec.structs.replace(
        soft,
        path=path,
        duration=float(COUNT),
        angular_velocity=Multisine(),
        requirement=Requirement(window=6.0),
        vehicle=CRAZYFLIE,
    )


def test_a_cubic_spline_has_jumps_of_the_jerk_alone_and_they_are_named_with_the_largest():
    (sentence,) = continuity.jump_sentences(CUBIC, COUNT)
    third = np.diff([6 * np.array([piece.x[3], piece.y[3], piece.z[3]]) for piece in CUBIC.pieces], axis=0)
    sizes = np.linalg.norm(third, axis=-1)
    largest = int(np.argmax(sizes))
    assert sentence.startswith("jerk jumps at ")
    assert sentence.endswith(f"at most by {sizes[largest]:.2g} m/s³ at t = {largest + 1} s")
    assert continuity.discontinuity(CUBIC, COUNT) is None


def test_why_mu_is_0_beside_rank_13_is_said_of_pieces_without_snap():
    made = along(CUBIC)
    analysed = analysis.analyse(made)
    assert (analysed.mu, analysed.rank) == (0.0, 13)
    said = report.analysis_report(made, analysed, name="cubic")["excitation_counts"]
    assert said.startswith("the jerk jumps at knots, and μ counts the pieces between them alone")
    assert "have no snap, so μ is 0" in said


def test_a_smooth_path_has_nothing_said_of_its_knots():
    for path in (POLYNOMIALS, WAYPOINTS):
        assert continuity.jump_sentences(path, 12.0) == ()
        assert continuity.pieces_alone(path, 12.0) is None


def test_an_acceleration_that_jumps_is_not_judged_and_not_flown():
    path = pieces(bent=2.0)
    assert present(continuity.discontinuity(path, COUNT)).endswith("which nothing can follow")
    made = along(path)
    assert analysis.analyse(made).verdict.reason == continuity.discontinuity(path, COUNT)
    issued = certificate.certify(preset.dumps(made).encode(), source="x")
    assert not issued.vehicle.flyable
    smooth = next(check for check in issued.checks if check.name == "smooth")
    assert (smooth.met, smooth.words) == (False, "the acceleration jumps by 2 m/s², which nothing can follow")
