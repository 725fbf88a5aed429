"""The headless command line, everything the page does without a browser; each command is a file in `commands`.

Exit 0: done. Exit 1: a check failed. Exit 2: bad input, one line on stderr naming file, field and rule. `--json` prints
one object on stdout.
"""

import contextlib
import io
import os
import sys
from typing import NoReturn

import tyro

from rangenav.commands.analyze import analyze
from rangenav.commands.certify import certify
from rangenav.commands.explain import explain
from rangenav.commands.export import export
from rangenav.commands.import_ import import_
from rangenav.commands.log import log
from rangenav.commands.presets import list_presets
from rangenav.commands.repair import repair
from rangenav.commands.simulate import simulate
from rangenav.commands.tune import tune
from rangenav.commands.verify import verify

app = tyro.extras.SubcommandApp()
app.command(name="presets")(list_presets)
app.command(analyze)
app.command(explain)
app.command(simulate)
app.command(certify)
app.command(verify)
app.command(repair)
app.command(export)
app.command(name="import")(import_)
app.command(log)
app.command(tune)


def fail(sentence: str) -> NoReturn:
    """Bad input: one line on stderr, exit 2."""
    print(" ".join(sentence.split()), file=sys.stderr)
    raise SystemExit(2)


def main() -> None:
    """Entry point of the `rangenav` script."""
    complaint = io.StringIO()
    try:
        with contextlib.redirect_stderr(complaint):
            app.cli(prog="rangenav", description=__doc__)
            sys.stdout.flush()
    except ValueError as error:
        fail(str(error))
    except BrokenPipeError:  # whoever reads, `head` say, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        fail(f"{error.filename or 'rangenav'}: {error.strerror}")
    except SystemExit as stop:
        if stop.code == 2:
            fail(usage_error(complaint.getvalue()))
        print(complaint.getvalue(), end="", file=sys.stderr)  # a check failed, and the command has said which
        raise


def usage_error(box: str) -> str:
    """The first paragraph of the parser's framed complaint, as one line."""
    lines = [line.strip("│╭╰╮╯─ \n") for line in box.splitlines()]
    paragraph: list[str] = []
    for line in lines[1:]:
        if line.strip("-"):  # a terminal without box characters draws its rules with hyphens
            paragraph.append(line)
        elif paragraph:
            break
    return " ".join(paragraph).strip() + " (see rangenav --help)"


if __name__ == "__main__":
    main()
