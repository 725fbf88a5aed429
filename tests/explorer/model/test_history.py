"""Undo and redo after sequences of changes."""

import msgspec
from hypothesis import given
from hypothesis import strategies as st

from explorer.model.history import MAX_STEPS, MOMENT, History, differing
from explorer.model.settings import Settings
from rangenav import preset
from rangenav.motion import World
from rangenav.signals import Formula, Multisine

SLOW = Settings(origin="paper-slow", preset=preset.load("paper-slow"))


def _at(scale: float) -> Settings:
    return msgspec.structs.replace(SLOW, time_scale=scale)


@given(st.lists(st.floats(0.2, 9.0), min_size=1, max_size=12, unique=True))
def test_undo_goes_back_through_every_step_and_redo_forward_again(scales: list[float]):
    history = History()
    for k, scale in enumerate(scales):
        history.record(_at(scale), 10.0 * k)
    for scale in scales[-2::-1]:
        assert history.undo() == _at(scale)
    assert history.undo() is None
    for scale in scales[1:]:
        assert history.redo() == _at(scale)
    assert history.redo() is None


def test_a_step_holds_no_copies_of_what_it_does_not_change():
    copy = msgspec.convert(msgspec.to_builtins(SLOW), Settings)
    path = copy.preset.path
    assert isinstance(path, Multisine)
    assert isinstance(SLOW.preset.path, Multisine)
    first, *others = path.tones
    path = msgspec.structs.replace(path, tones=(msgspec.structs.replace(first, phase=1.0), *others))
    after = msgspec.structs.replace(copy, preset=msgspec.structs.replace(copy.preset, path=path))
    history = History()
    history.record(SLOW, 0.0)
    history.record(after, 10.0)
    kept = history.now
    assert kept is not None
    assert kept == after
    assert isinstance(kept.preset.path, Multisine)
    assert kept.preset.path.tones[1] is SLOW.preset.path.tones[1]
    for part in ("world", "gains", "sensors", "guess", "angular_velocity"):
        assert getattr(kept.preset, part) is getattr(SLOW.preset, part) is not getattr(after.preset, part), part


def test_what_follows_within_a_moment_is_one_step_but_never_the_beginning():
    history = History()
    history.record(_at(1.0), 0.0)
    for k in range(20):
        history.record(_at(2.0 + k / 10), 0.01 + k * MOMENT / 2)
    assert history.undo() == _at(1.0)
    assert history.undo() is None


def test_a_slow_machine_does_not_tear_a_drag_apart():
    history = History()
    history.record(_at(1.0), 0.0)
    for k in range(5):
        history.record(_at(2.0 + k), 10.0 + 3 * k, shown=10.0 + 3 * k + 2.9)
    assert history.undo() == _at(1.0)


def test_what_is_held_is_one_step_however_slowly_it_moves():
    history = History()
    history.record(_at(1.0), 0.0)
    for k in range(4):
        history.record(_at(2.0 + k), 10.0 * (k + 1), drag=3)
    history.record(_at(8.0), 60.0, drag=4)
    assert history.undo() == _at(5.0)
    assert history.undo() == _at(1.0)


def test_two_things_moved_within_a_moment_are_two_steps():
    history = History()
    slow = SLOW.preset
    seeded = msgspec.structs.replace(SLOW, preset=msgspec.structs.replace(slow, seed=7))
    history.record(SLOW, 0.0)
    history.record(_at(2.0), 0.01)
    history.record(seeded, 0.02)
    assert history.undo() == _at(2.0)
    assert history.undo() == SLOW


def test_what_differs_is_named_to_the_innermost_table():
    slow = SLOW.preset
    path = slow.path
    assert isinstance(path, Multisine)
    first = msgspec.structs.replace(path.tones[0], amplitude=7.0, phase=0.1)
    moved = msgspec.structs.replace(path, tones=(first, *path.tones[1:]))

    def parts(**changes: object) -> set[str]:
        return set(differing(SLOW, msgspec.structs.replace(SLOW, preset=msgspec.structs.replace(slow, **changes))))

    assert parts(path=moved) == {".preset.path.tones.0"}
    assert parts(path=Formula()) == {".preset"}
    assert parts(path=msgspec.structs.replace(path, tones=path.tones[1:])) == {".preset.path"}
    assert parts(world=World(anchor=(1.0, 0.0, 0.0)), seed=9) == {".preset", ".preset.world"}
    assert parts() == set()


def test_a_step_apart_stays_apart_however_soon_the_next_one_comes():
    history = History()
    history.record(_at(1.0), 0.0)
    history.record(_at(2.0), 0.01, separate=True)
    history.record(_at(3.0), 0.02)
    assert history.undo() == _at(2.0)
    assert history.undo() == _at(1.0)


def test_a_drag_that_goes_on_after_undo_or_after_a_step_apart_is_another_step():
    history = History()
    for k, scale in enumerate((1.0, 2.0)):
        history.record(_at(scale), 10.0 * k)
    history.record(_at(3.0), 20.0, drag=0)
    assert history.undo() == _at(2.0)
    history.record(_at(4.0), 30.0, drag=0)
    assert history.undo() == _at(2.0)
    history.record(_at(5.0), 40.0, separate=True, drag=0)
    history.record(_at(6.0), 50.0, drag=0)
    history.record(_at(7.0), 60.0, drag=0)
    assert [history.undo() for _ in range(3)] == [_at(5.0), _at(2.0), _at(1.0)]


def test_a_change_after_undo_forgets_what_was_undone():
    history = History()
    for k, scale in enumerate((1.0, 2.0, 3.0)):
        history.record(_at(scale), 10.0 * k)
    history.undo()
    history.record(_at(5.0), 100.0)
    assert history.redo() is None
    assert history.undo() == _at(2.0)


def test_the_same_again_is_no_step():
    history = History()
    history.record(_at(1.0), 0.0)
    history.record(_at(1.0), 50.0)
    assert history.depth == (0, 0)


def test_the_number_of_steps_is_bounded():
    history = History()
    for k in range(3 * MAX_STEPS):
        history.record(_at(1.0 + k * 1e-3), 10.0 * k)
    assert history.depth[0] == MAX_STEPS - 1


def test_restored_steps_are_undone_and_redone_as_before():
    history, restored = History(), History()
    for k in range(4):
        history.record(_at(1.0 + k), 10.0 * k)
    history.undo()
    past, future = history.steps(2)
    assert (past, future) == ((_at(2.0), _at(3.0)), (_at(4.0),))
    restored.restore(past, future)
    assert restored.redo() == _at(4.0)
    assert [restored.undo() for _ in range(3)] == [_at(3.0), _at(2.0), None]
