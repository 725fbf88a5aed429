"""'Show me' changes one control at a time, each step is a valid input, and the last one has all of the solution."""

import msgspec

from explorer.lessons import demonstration
from explorer.model.settings import Settings, effective
from rangenav import preset
from rangenav.signals import Multisine, Tone

HOVER = Settings(origin="hover", preset=preset.load("hover"))


def with_preset(**changes: object) -> Settings:
    return msgspec.structs.replace(HOVER, preset=msgspec.structs.replace(HOVER.preset, **changes))


def test_each_differing_control_is_a_step_of_its_own():
    world = msgspec.structs.replace(HOVER.preset.world, anchor=(1.0, 0.0, 0.0))
    guess = msgspec.structs.replace(HOVER.preset.guess, attitude_angle=0.5)
    steps = demonstration.steps(HOVER, with_preset(world=world, guess=guess, seed=7))
    assert len(steps) == 3
    assert steps[-1].settings == with_preset(world=world, guess=guess, seed=7)
    assert steps[0].settings != steps[1].settings


def test_changes_that_are_valid_only_together_are_one_step():
    # a window of 30 s does not fit into the 20 s of the flight until the flight is longer
    longer = msgspec.structs.replace(HOVER.preset.requirement, window=30.0)
    wanted = with_preset(duration=40.0, requirement=longer)
    for settings in (wanted, HOVER):
        other = HOVER if settings is wanted else wanted
        steps = demonstration.steps(other, settings)
        assert effective(steps[-1].settings) == effective(settings)


def test_another_path_is_one_step_and_nothing_to_show_is_none():
    tone = Tone(axis="x", amplitude=1.0, frequency=2.0, phase=0.0)
    moving = with_preset(path=Multisine(tones=(tone,)))
    assert [step.settings for step in demonstration.steps(HOVER, moving)][-1] == moving
    assert demonstration.steps(HOVER, HOVER) == ()
