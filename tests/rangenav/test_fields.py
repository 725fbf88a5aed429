"""The entry in a field's annotation: limits with the field's name and unit, and no field without an entry."""

from typing import Annotated

import pytest

from rangenav import fields
from rangenav.fields import SIGNAL_UNIT, NumberField
from rangenav.inputs import Vec3
from rangenav.signals import Multisine, Tone
from rangenav.signals.base import SignalBase
from tests.support.refusals import exactly

RADIUS = NumberField(label="radius", unit=SIGNAL_UNIT, limits=(0.0, 100.0), step=0.01, hint="The circle's radius.")
RATE = NumberField(label="rate", unit="rad/s", limits=(0.1, 50.0), step=0.01, dial=(0.1, 10.0), hint="The rate.")
CENTRE = NumberField(label="centre", unit=SIGNAL_UNIT, limits=(0.0, 1000.0), step=0.01, hint="The centre.")


class Circle(SignalBase, frozen=True, kw_only=True, tag="circle", tag_field="kind"):
    """A family of numbers."""

    radius: Annotated[float, RADIUS] = 1.0
    rate: Annotated[float, RATE] = 2.0
    centre: Annotated[Vec3, CENTRE] = (0.0, 0.0, 0.0)

    def equivalent(self) -> Multisine:
        """Its two tones, of which one is enough here."""
        return Multisine(tones=(Tone(axis="y", amplitude=self.radius, frequency=self.rate),), offset=self.centre)


class Unlabelled(Circle, frozen=True, kw_only=True, tag="unlabelled", tag_field="kind"):
    """A family with a field that has no entry."""

    climb: float = 0.0


def test_the_entries_of_a_family_stand_in_the_order_of_its_fields():
    assert dict(fields.of_all(Circle, NumberField)) == {"radius": RADIUS, "rate": RATE, "centre": CENTRE}
    assert fields.types(Circle) == {"radius": float, "rate": float, "centre": Vec3}


def test_a_value_within_the_limits_is_accepted_and_the_limits_themselves_are():
    assert Circle(radius=100.0, rate=0.1, centre=(0.0, 0.0, -1000.0)).radius == 100.0


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"radius": -1.0}, "radius must lie between 0 and 100, got -1"),
        ({"rate": 51.0}, "rate must lie between 0.1 and 50 rad/s, got 51"),
        ({"centre": (0.0, 800.0, 800.0)}, "centre must not be longer than 1000, got 1131.37"),
    ],
)
def test_a_value_beyond_its_limits_is_refused_with_name_and_unit(values, sentence):
    with pytest.raises(ValueError, match=exactly(sentence)):
        Circle(**values)


def test_a_field_without_an_entry_is_named():
    with pytest.raises(TypeError, match=exactly("Unlabelled.climb: a field needs NumberField(…) in its annotation")):
        fields.of_all(Unlabelled, NumberField)
