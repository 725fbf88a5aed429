"""The compiled kernels, made by one process for all that test at once: `python -m tests.support.compiled_kernels`.

numba keeps what it has compiled in a folder, and locks nothing: workers that began together would each compile it all.
"""

from filelock import FileLock

from rangenav.kernels import cache, precompile


def make() -> None:
    """Compile the kernels, or read them if they were compiled before."""
    with _lock():
        _all()


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


def _say_nothing(fraction: float, name: str) -> None: ...


if __name__ == "__main__":
    make()
