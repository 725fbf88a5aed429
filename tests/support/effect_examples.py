"""An example value, different from the default, for every sensor effect that the paper does not model."""

from typing import Any

from rangenav.sensors import MODELLED, Effects, effects


def example(field: str) -> Any:
    """A number or a vector within the field's limits that is not its default."""
    row = effects.rows()[field]
    most = row.limits[1]
    if isinstance(getattr(MODELLED, field), tuple):
        return 0.001 * most, -0.002 * most, 0.003 * most
    return 0.25 if row.percent else 0.0005 * most


EVERYTHING = Effects(**{field: example(field) for field in effects.rows()})
"""All effects at once."""
