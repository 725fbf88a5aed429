"""The parts of a study: blocks of neighbouring points, each one task's work and one chunk of every array."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Int
from numpy import ndarray as Array


@dataclass(frozen=True)
class Blocks:
    """How the points of a study are divided; parts are counted as points are, the last dimension fastest."""

    shape: tuple[int, ...]
    """Of the points."""
    chunk: tuple[int, ...]
    """Points of one part along each dimension; the last part along one may have fewer."""

    @cached_property
    def parts(self) -> tuple[int, ...]:
        """How many parts there are along each dimension."""
        return tuple(-(-length // size) for length, size in zip(self.shape, self.chunk, strict=True))

    @property
    def count(self) -> int:
        """How many parts there are."""
        return math.prod(self.parts)

    def place(self, part: int) -> tuple[int, ...]:
        """Where a part lies among the parts."""
        return tuple(int(k) for k in np.unravel_index(part, self.parts))

    def region(self, part: int) -> tuple[slice, ...]:
        """The points of a part along each dimension."""
        return tuple(
            slice(k * size, min((k + 1) * size, length))
            for k, size, length in zip(self.place(part), self.chunk, self.shape, strict=True)
        )

    def indices(self, part: int) -> Int[Array, "p"]:
        """The points of a part, in their order."""
        ranges = [np.arange(one.start, one.stop) for one in self.region(part)]
        return np.ravel_multi_index(np.meshgrid(*ranges, indexing="ij"), self.shape).ravel()

    def extent(self, part: int) -> tuple[int, ...]:
        """How many points a part has along each dimension."""
        return tuple(one.stop - one.start for one in self.region(part))


def divided(shape: tuple[int, ...], points: int) -> Blocks:
    """Blocks of at most so many points: whole rows of the last dimensions where they fit, else equal pieces of one."""
    left, chunk = max(1, points), []
    for length in reversed(shape):
        pieces = -(-length // min(length, left))
        chunk.append(-(-length // pieces))
        left = max(1, left // length)
    return Blocks(shape, tuple(reversed(chunk)))
