"""Prints the lowest version of every direct dependency as constraints for pip: `python .ci/lowest.py quick`.

The arguments name extras whose floors are added to those of the project itself.
"""

import sys
import tomllib
from pathlib import Path

from packaging.requirements import Requirement

OWN_NAME = "rangenav"


def main(extras: list[str]) -> None:
    """One line `name==floor` for each requirement with a floor."""
    project = tomllib.loads((Path(__file__).parent.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = [*project["dependencies"], *(line for name in extras for line in project["optional-dependencies"][name])]
    for requirement in map(Requirement, wanted):
        if requirement.name == OWN_NAME:
            continue
        floors = [part.version for part in requirement.specifier if part.operator in (">=", "==")]
        if len(floors) != 1:
            sys.exit(f"pyproject.toml: {requirement} must state one floor, such as >=1.2")
        print(f"{requirement.name}=={floors[0]}")


if __name__ == "__main__":
    main(sys.argv[1:])
