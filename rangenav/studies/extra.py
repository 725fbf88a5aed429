"""The packages of the extra `studies`, imported where they are used: `import rangenav` does not grow."""

from types import ModuleType

SENTENCE = 'studies need the extra "studies": pip install "rangenav[studies]"'


def zarr() -> ModuleType:
    """zarr. Raises ValueError, in one sentence with the command that installs it, where it is not installed."""
    try:
        import zarr as module
    except ModuleNotFoundError:
        raise ValueError(SENTENCE) from None
    return module


def distributed() -> ModuleType:
    """dask.distributed. Raises ValueError as `zarr` does."""
    try:
        import distributed as module
    except ModuleNotFoundError:
        raise ValueError(SENTENCE) from None
    return module


def parquet() -> tuple[ModuleType, ModuleType]:
    """pyarrow and pyarrow.parquet. Raises ValueError as `zarr` does."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ModuleNotFoundError:
        raise ValueError(SENTENCE) from None
    return pyarrow, pyarrow.parquet
