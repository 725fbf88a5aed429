"""The command line: everything the page does without a browser. Each command is a file in `commands`.

`--help` and `--version` answer without loading the library, which takes most of a second.
"""

import os
import signal
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
        begun = signal.getsignal(signal.SIGINT)
        if begun is not signal.SIG_IGN:
            signal.signal(signal.SIGINT, _stop)  # in the middle of an import
        from rangenav.commands import typed

        signal.signal(signal.SIGINT, begun)
        typed.run_command()


def _stop(_number: int, _frame: object) -> None:
    """Ctrl+C before the command has begun: one sentence, and the exit code of such a stop."""
    os.write(2, b"rangenav: stopped\n")
    os._exit(130)


if __name__ == "__main__":
    main()
