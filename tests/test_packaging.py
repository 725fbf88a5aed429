"""What a person installs: the wheel holds both packages and the presets, and works from any folder."""

import json
import os
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow


SOURCE = Path(__file__).parent.parent
BUILD_SECONDS = 300
RUN_SECONDS = 120
SLOW_IMPORTS = (
    "control",
    "matplotlib",
    "numba",
    "viser",
    "explorer",
    "scipy.signal",
    "sympy",
    "playwright",
    "dask",
    "zarr",
    "xarray",
)
"""None of these may be loaded by importing the library; some take seconds, others are no business of it."""


def _run(*command: object, cwd: Path, seconds: float = RUN_SECONDS) -> subprocess.CompletedProcess[str]:
    """Run a command as a user would: no source on the path, standard input closed. It has to succeed."""
    environment = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "PYTHONWARNINGS")}
    finished = subprocess.run(
        [str(part) for part in command],
        cwd=cwd,
        env=environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=seconds,
        check=False,
    )
    assert finished.returncode == 0, finished.stderr
    return finished


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel built from the source tree."""
    folder = tmp_path_factory.mktemp("wheel")
    options = ("--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", folder)
    _run(sys.executable, "-m", "pip", "wheel", *options, SOURCE, cwd=folder, seconds=BUILD_SECONDS)
    return next(folder.glob("rangenav-*.whl"))


@pytest.fixture(scope="module")
def scripts(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of scripts of a fresh environment that has the wheel, and borrows the dependencies installed here.

    Borrowing saves downloading half a gigabyte; a .pth file shows them, but not the source tree's editable install.
    """
    folder = tmp_path_factory.mktemp("fresh") / "venv"
    venv.create(folder, with_pip=False, symlinks=True)
    library = f"lib/python{sys.version_info.major}.{sys.version_info.minor}/site-packages"
    _run(
        sys.executable,
        "-m",
        "pip",
        "--python",
        folder / "bin" / "python",
        "install",
        "--quiet",
        "--no-deps",
        wheel,
        cwd=folder,
    )
    borrowed = [path for path in sys.path if path.endswith(("site-packages", "dist-packages"))]
    (folder / library / "borrowed.pth").write_text("\n".join(borrowed) + "\n")
    return folder / "bin"


def test_the_wheel_holds_both_packages_every_preset_and_the_licence(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    for module in (
        "rangenav/__init__.py",
        "rangenav/kernels/cascade.py",
        "explorer/__init__.py",
        "explorer/model/compute.py",
    ):
        assert module in names
    presets = {Path(name).name for name in names if name.startswith("rangenav/presets/")}
    assert presets == {path.name for path in (SOURCE / "presets").iterdir()}
    lessons = [path for path in (SOURCE / "explorer" / "lessons").glob("[0-9]*/*") if path.is_file()]
    assert {str(path.relative_to(SOURCE)) for path in lessons} <= set(names)
    assert lessons
    assert any(name.endswith("/LICENSE") for name in names)
    assert not [name for name in names if name.startswith(("tests/", "benchmarks/", "presets/"))]


def test_an_installed_wheel_lists_its_presets_from_any_folder(scripts: Path, tmp_path: Path) -> None:
    answer = json.loads(_run(scripts / "rangenav", "presets", "--json", cwd=tmp_path).stdout)
    assert answer
    shown = _run(scripts / "python", "-c", "import rangenav; print(rangenav.__file__)", cwd=tmp_path).stdout
    assert Path(shown.strip()).is_relative_to(scripts.parent)


def test_an_installed_wheel_explains_its_page_from_any_folder(scripts: Path, tmp_path: Path) -> None:
    assert "--port" in _run(scripts / "rangenav-explorer", "--help", cwd=tmp_path).stdout


def test_the_version_is_the_same_in_the_package_and_in_its_metadata(scripts: Path, tmp_path: Path) -> None:
    code = "import importlib.metadata, rangenav; print(rangenav.__version__, importlib.metadata.version('rangenav'))"
    package, metadata = _run(scripts / "python", "-c", code, cwd=tmp_path).stdout.split()
    assert package == metadata


def test_importing_the_library_loads_nothing_slow_and_no_page() -> None:
    modules = [f"rangenav.{path.stem}" for path in (SOURCE / "rangenav").glob("*.py") if not path.stem.startswith("__")]
    modules += [f"rangenav.studies.{name}" for name in ("store", "running", "export", "summary", "maps")]
    code = f"import sys, {', '.join(modules)}; print([name for name in {SLOW_IMPORTS} if name in sys.modules])"
    assert _run(sys.executable, "-c", code, cwd=SOURCE).stdout.strip() == "[]"
