"""What is proven of a motion is proven once in each process: many test files analyse the same shipped presets.

The caches of these modules hold a few results, for a page with many visitors. Here they hold all of the suite.
"""

import functools
import sys
from collections.abc import Callable

KEPT = (
    "rangenav.analysis",
    "rangenav.certificate.advice",
    "rangenav.certificate.certified_export",
    "rangenav.certificate.certify",
    "rangenav.certificate.exports",
    "rangenav.observability.horizon",
    "rangenav.observability.worst_accuracy",
    "rangenav.observability.worst_excitation",
    "rangenav.observability.worst_rank",
    "rangenav.signals.checks",
)
"""Modules and packages. Their results are small, and take tenths of a second each."""
MANY = 256


def keep() -> None:
    """Must come before the modules are imported."""
    assert not any(name.startswith(KEPT) for name in sys.modules)
    functools.lru_cache = _kept(functools.lru_cache)


def _kept(lru_cache: Callable) -> Callable:
    def cache(maxsize=128, typed=False):
        def decorate(function):
            return lru_cache(MANY if function.__module__.startswith(KEPT) else maxsize, typed)(function)

        return lru_cache(maxsize) if callable(maxsize) else decorate

    return cache
