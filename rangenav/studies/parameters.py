"""The parameters of a study: one number or word of a preset each, and the values that it takes.

list · choices      the values themselves
linear · log        from low to high, evenly spaced, or by equal factors
normal · log-normal a distribution: equal shares of its probability in a grid, its quantiles in a sample
"""

import math
from typing import Literal

import numpy as np
from jaxtyping import Float, Shaped
from numpy import ndarray as Array
from scipy.special import ndtri

from rangenav.field_path import COMPONENTS
from rangenav.inputs import Input, require

MAX_VALUES = 100_000
ROUNDING = 4.0
"""A step from end to end is off by so many units in the last place of the larger end, at most."""
TIME_SCALE, SIZE = "time_scale", "size"
DERIVED = {
    SIZE: "size: the path is this many times as large, about the middle of its box",
    TIME_SCALE: "time scale: the path runs this many times slower",
}
"""Parameters that act on the path as a whole, with their titles, in the order in which they act; every other one
is a path into the preset."""


class _Parameter(Input, frozen=True, kw_only=True):
    """What every parameter has."""

    path: str
    """Where the value stands in the preset, such as gains.riccati.q or world.anchor.x; or `time_scale`, or `size`."""
    name: str = ""
    """The name of its dimension in the store; the path with underscores by default."""
    unit: str = ""
    """SI unit, for the store's attributes and for plots; the one that the preset's documentation states by default."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require(self.path != "", "path must not be empty")
        require(self.path != "seed", "path must not be seed: the seeds of a study follow from its own seed")
        rule = f"name must be a word of letters, digits and underscores, got {self.name!r}"
        require(self.name == "" or self.name.isidentifier(), rule)

    @property
    def dimension(self) -> str:
        """The name of its dimension."""
        return self.name or self.path.replace(".", "_").replace("-", "_")

    @property
    def place(self) -> tuple[str, ...]:
        """The path without its spelling: two parameters of one place vary one number, such as world.anchor.x and
        world.anchor.1."""
        return tuple(_numbered(part) for part in self.path.split("."))


class _Given(_Parameter, frozen=True, kw_only=True):
    """A parameter whose values are given one by one."""

    values: tuple[float, ...] | tuple[str, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        _refuse_count(len(self.values), "values must hold")
        require(len(set(self.values)) == len(self.values), "values must differ from one another")

    @property
    def size(self) -> int:
        """How many values a grid has."""
        return len(self.values)


class Listed(_Given, frozen=True, kw_only=True, tag="list", tag_field="kind"):
    """Numbers."""

    values: tuple[float, ...]

    def grid(self) -> Float[Array, "n"]:
        """The values of a grid."""
        return np.array(self.values)

    def quantile(self, share: Float[Array, "m"]) -> Float[Array, "m"]:
        """The values at shares between 0 and 1 of the probability; each value is as probable as every other."""
        return self.grid()[_picked(share, self.size)]


class Choices(_Given, frozen=True, kw_only=True, tag="choices", tag_field="kind"):
    """Words, such as those of gains.mode."""

    values: tuple[str, ...]

    def grid(self) -> Shaped[Array, "n"]:
        """The values of a grid, as objects."""
        return np.array(self.values, dtype=object)

    def quantile(self, share: Float[Array, "m"]) -> Shaped[Array, "m"]:
        """The values at shares between 0 and 1; each value is as probable as every other."""
        return self.grid()[_picked(share, self.size)]


class _Spread(_Parameter, frozen=True, kw_only=True):
    """A parameter whose values are computed: `count` of them in a grid."""

    count: int | None = None
    """Of a grid; a sample states its number of points for all parameters together."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.count is not None:
            _refuse_count(self.count, "count must be")

    @property
    def size(self) -> int | None:
        """How many values a grid has."""
        return self.count


class Linear(_Spread, frozen=True, kw_only=True, tag="linear", tag_field="kind"):
    """Evenly spaced from low to high, both included."""

    low: float
    high: float

    def __post_init__(self) -> None:
        super().__post_init__()
        require(self.low < self.high, f"low must lie below high, got {self.low:g} and {self.high:g}")

    def grid(self) -> Float[Array, "n"]:
        """The values of a grid. One that is nearer to zero than the ends are rounded is zero."""
        values = np.linspace(self.low, self.high, self.count or 0)
        resolution = ROUNDING * np.finfo(float).eps * max(abs(self.low), abs(self.high))
        inner = values[1:-1]
        inner[np.abs(inner) < resolution] = 0.0
        return values

    def quantile(self, share: Float[Array, "m"]) -> Float[Array, "m"]:
        """The values at shares between 0 and 1 of the way from low to high."""
        return self.low + share * (self.high - self.low)


class Log(_Spread, frozen=True, kw_only=True, tag="log", tag_field="kind"):
    """By equal factors from low to high, both included."""

    low: float
    high: float

    def __post_init__(self) -> None:
        super().__post_init__()
        rule = f"low must be positive and lie below high, got {self.low:g} and {self.high:g}"
        require(0 < self.low < self.high, rule)

    def grid(self) -> Float[Array, "n"]:
        """The values of a grid."""
        return np.geomspace(self.low, self.high, self.count or 0)

    def quantile(self, share: Float[Array, "m"]) -> Float[Array, "m"]:
        """The values at shares between 0 and 1 of the way from ln low to ln high."""
        return self.low * (self.high / self.low) ** share


class Normal(_Spread, frozen=True, kw_only=True, tag="normal", tag_field="kind"):
    """A normal distribution."""

    mean: float
    deviation: float
    """The standard deviation."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require(self.deviation > 0, f"deviation must be positive, got {self.deviation:g}")

    def grid(self) -> Float[Array, "n"]:
        """The medians of `count` parts of equal probability."""
        return self.quantile(_middles(self.count or 0))

    def quantile(self, share: Float[Array, "m"]) -> Float[Array, "m"]:
        """The values below which so large a share of the probability lies."""
        return self.mean + self.deviation * ndtri(_inside(share))


class LogNormal(_Spread, frozen=True, kw_only=True, tag="log-normal", tag_field="kind"):
    """A number whose logarithm has a normal distribution."""

    median: float
    factor: float
    """The 1-σ factor: 68 % of the values lie between median / factor and median × factor."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require(self.median > 0, f"median must be positive, got {self.median:g}")
        require(self.factor > 1, f"factor must be larger than 1, got {self.factor:g}")

    def grid(self) -> Float[Array, "n"]:
        """The medians of `count` parts of equal probability."""
        return self.quantile(_middles(self.count or 0))

    def quantile(self, share: Float[Array, "m"]) -> Float[Array, "m"]:
        """The values below which so large a share of the probability lies."""
        return self.median * np.exp(math.log(self.factor) * ndtri(_inside(share)))


Parameter = Listed | Choices | Linear | Log | Normal | LogNormal
Scale = Literal["linear", "log"]


def scale(parameter: Parameter) -> Scale:
    """The scale of an axis on which the values are evenly spaced."""
    return "log" if isinstance(parameter, Log | LogNormal) else "linear"


def _numbered(part: str) -> str:
    """An entry's number from 1, without leading zeros; a name as it is. x, y and z are the entries 1, 2 and 3."""
    if part in COMPONENTS:
        return str(COMPONENTS[part] + 1)
    return str(int(part)) if part.isdecimal() else part


def _refuse_count(count: int, words: str) -> None:
    require(1 <= count <= MAX_VALUES, f"{words} 1 to {MAX_VALUES} values, got {count}")


def _picked(share: Array, count: int) -> Array:
    return np.minimum((share * count).astype(int), count - 1)


def _middles(count: int) -> Array:
    return (np.arange(count) + 0.5) / count


def _inside(share: Array) -> Array:
    """Without 0 and 1, whose quantiles are infinite."""
    return np.clip(share, 1e-12, 1 - 1e-12)
