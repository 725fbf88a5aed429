"""A proof that is no longer wanted stops between its steps, and leaves nothing half done behind."""

import pytest
from msgspec.structs import replace

from rangenav import analysis, preset
from rangenav.preset import Preset, Requirement
from rangenav.progress import CancelledError, stop_if_unwanted, stopping
from rangenav.signals import Multisine, Tone

TONES = (("x", 0.7, 5.6), ("y", 0.9, 7.3), ("z", 0.4, 4.1), ("x", 0.3, 7.9), ("y", 0.5, 3.3), ("z", 0.6, 6.7))
LONG = replace(
    preset.load("soft"),
    path=Multisine(tones=tuple(Tone(axis=a, amplitude=b, frequency=w) for a, b, w in TONES)),  # pyright: ignore
    duration=120.0,
    angular_velocity=Multisine(),
    requirement=Requirement(window=2.0, mu=1.0),
)


class Visitor:
    """Counts how often a proof asks, and no longer wants it after so many times."""

    def __init__(self, patience: float) -> None:
        self.asked, self.patience = 0, patience

    def __call__(self) -> bool:
        self.asked += 1
        return self.asked > self.patience


def fresh(p: Preset, k: int) -> Preset:
    """The same, a little elsewhere, so that no cache has it."""
    return replace(p, path=p.path.slowed(1 + 1e-6 * (k + 1)))


def test_a_proof_stops_the_first_time_it_asks_after_it_is_no_longer_wanted():
    patient = Visitor(float("inf"))
    with stopping(patient):
        analysis.analyse(fresh(LONG, 0))
    assert patient.asked > 20  # some hundredths of a second from one to the next
    for k, patience in enumerate((0, 1, patient.asked // 2, patient.asked - 2)):
        visitor = Visitor(patience)
        with stopping(visitor), pytest.raises(CancelledError):
            analysis.analyse(fresh(LONG, k + 1))
        assert visitor.asked == patience + 1


def test_a_proof_that_was_stopped_is_made_again_when_it_is_wanted():
    p = fresh(LONG, 9)
    with stopping(lambda: True), pytest.raises(CancelledError):
        analysis.analyse(p)
    assert analysis.analyse(p).proof is not None


def test_outside_of_the_block_nothing_stops():
    with stopping(lambda: True), pytest.raises(CancelledError):
        stop_if_unwanted()
    stop_if_unwanted()
