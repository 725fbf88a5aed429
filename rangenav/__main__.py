"""The command line: everything the page does without a browser. Each command is a file in `commands`.

`--help` and `--version` answer without loading the library, which takes most of a second.
"""

import sys

import rangenav
from rangenav.commands import overview

HELP = (["-h"], ["--help"])


def main() -> None:
    """Entry point of the `rangenav` script and of `python -m rangenav`."""
    if sys.argv[1:] in HELP:
        print(overview.overview())
    elif sys.argv[1:] == ["--version"]:
        print(f"rangenav {rangenav.__version__}")
    else:
        from rangenav.commands import typed

        typed.run_command()


if __name__ == "__main__":
    main()
