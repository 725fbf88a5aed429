"""The compiled kernels, made by one process for all that test at once: `python -m tests.support.compiled_kernels`.

numba keeps what it has compiled in a folder, and locks nothing: workers that began together would each compile it all.
"""

from filelock import FileLock
from msgspec.structs import replace

from rangenav.kernels import cache, precompile

RUNS = 4
"""So many are computed side by side and not one after the other."""


def make() -> None:
    """Compile the kernels, or read them if they were compiled before."""
    with _lock():
        _all()
        _side_by_side()


def read() -> None:
    """Read the kernels once the process that compiles has ended; workers do so at the same time."""
    with _lock():
        pass
    _all()


def _lock() -> FileLock:
    cache.folder().parent.mkdir(parents=True, exist_ok=True)
    return FileLock(cache.folder().with_suffix(".lock"))


def _all() -> None:
    precompile.compile_all(_say_nothing)
    precompile.compile_estimators(_say_nothing)


def _side_by_side() -> None:
    """Several runs at once, whose kernel the program compiles when it is first needed: workers would all do so."""
    from rangenav import ensemble, preset  # not in a worker, before conftest has its checks in place

    paper = preset.load("paper")
    ensemble.seeds(replace(paper, duration=paper.requirement.window + 0.5), RUNS)


def _say_nothing(fraction: float, name: str) -> None: ...


if __name__ == "__main__":
    make()
