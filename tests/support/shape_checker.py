"""The checker of shapes and types that conftest wraps around every function: numbers of numpy count as Python's."""

import numpy as np
from beartype import BeartypeConf, FrozenDict, beartype

checked = beartype(
    conf=BeartypeConf(
        hint_overrides=FrozenDict(
            {bool: bool | np.bool_, int: int | np.integer, float: float | int | np.floating | np.integer}
        )
    )
)
"""Arrays are checked by jaxtyping's shapes. A scalar of numpy is accepted in place of one of Python."""
