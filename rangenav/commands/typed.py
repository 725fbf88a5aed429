"""Run the command that was typed: its answer on stdout, and whatever goes wrong as one line on stderr.

Exit 0: done. Exit 1: a check failed. Exit 2: bad input, one line that names file, field and rule.
"""

import contextlib
import difflib
import io
import os
import shlex
import sys
import warnings
from collections.abc import Iterable, Iterator
from typing import Any, NoReturn

import tyro

from rangenav.commands import numbers, output, overview
from rangenav.commands.text.lines import COLUMNS, CONTINUED, folded_command, wrapped
from rangenav.formats import OpenQuestionsError, Question, typed_flag
from rangenav.motion import DirectionWarning

PROGRAM = "rangenav"
COLUMNS_FLAG = "--columns"
"""The option that several questions have."""
MISSING, REQUIRED, UNKNOWN = "Missing from", "(required)", "Unrecognized options:"
"""Words of the parser."""
IN_ONE = "in one command, with the suggested answers:"
"""Before the command that answers several questions."""


def fail(sentence: str) -> NoReturn:
    """Bad input: one line on stderr, which a terminal shows broken between words; exit 2."""
    lines = [" ".join(sentence.split())]
    print(*(wrapped(lines[0], COLUMNS, CONTINUED) if sys.stderr.isatty() else lines), sep="\n", file=sys.stderr)
    raise SystemExit(2)


def ask(error: OpenQuestionsError) -> NoReturn:
    """Open questions about a file: one line on stderr, or one paragraph for each on a terminal; exit 2.

    Several questions end with the command that answers all of them as suggested.
    """
    several = len(error.questions) > 1
    kept = _without_flags(sys.argv[1:], {question.flag for question in error.questions})
    command = shlex.join([PROGRAM, *kept]) + "".join(f" {one}" for one in answers(error.questions))
    if not sys.stderr.isatty():
        fail(f"{error}; {IN_ONE} {command}" if several else str(error))
    for sentence in (error.rule, *(question.text for question in error.questions)):
        print(*wrapped(sentence, COLUMNS, CONTINUED), sep="\n", file=sys.stderr)
    if several:
        print(IN_ONE, *folded_command(command, COLUMNS), sep="\n", file=sys.stderr)
    raise SystemExit(2)


def _without_flags(typed: list[str], flags: set[str]) -> list[str]:
    """What was typed without flags whose values were no answer, so that the command does not have them twice."""
    kept, dropping = [], False
    for one in typed:
        if one.startswith("--"):
            dropping = one.partition("=")[0] in flags and one.partition("=")[0] != "--columns"
        if not dropping:
            kept.append(one)
    return kept


def answers(questions: Iterable[Question]) -> list[str]:
    """The flags that answer questions as suggested; ANSWER stands for what only a person knows."""
    typed: dict[str, list[str]] = {}
    for question in questions:
        own = question.options[0] if len(question.options) == 1 and not question.as_it_is else "ANSWER"
        typed.setdefault(question.flag, []).append(question.suggestion or own)
    return [typed_flag(flag, " ".join(values)) for flag, values in typed.items()]


def run_command() -> None:
    """Run the command that was typed; whatever goes wrong is one line on stderr and an exit code."""
    messages = io.StringIO()
    try:
        _refuse_unknown()
        with said_on_stderr(), contextlib.redirect_stderr(messages), numbers.registry:
            _parser().cli(prog=PROGRAM, args=joined(sys.argv[1:]))
            sys.stdout.flush()
    except OpenQuestionsError as error:
        ask(error)
    except ValueError as error:
        fail(str(error))
    except BrokenPipeError:  # the reader of the output, `head` say, has closed it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        fail(f"{error.filename or PROGRAM}: {error.strerror}")
    except KeyboardInterrupt:
        print(f"{PROGRAM}: stopped", file=sys.stderr, flush=True)
        os._exit(output.STOPPED)  # without what libraries do at the end, which fails in the middle of their work
    except SystemExit as stop:
        if stop.code == 2:
            fail(usage_error(messages.getvalue()))
        print(messages.getvalue(), end="", file=sys.stderr)  # a check failed, and the command has said which
        if stop.code == output.STOPPED:
            sys.stderr.flush()
            os._exit(output.STOPPED)
        raise


def _parser() -> tyro.extras.SubcommandApp:
    """The parser of the command that was typed; of all commands if there is none of that name."""
    named = [name for name in sys.argv[1:2] if name in overview.NAMES]
    parser = tyro.extras.SubcommandApp()
    for name in named or overview.NAMES:
        parser.command(name=name)(overview.command(name))
    return parser


def joined(arguments: list[str]) -> list[str]:
    """The arguments with the values of every `--columns` behind the first one, of which the parser takes the last."""
    values, others, inside, first = [], [], False, -1
    for one in arguments:
        flag, sign, value = one.partition("=")
        if flag == COLUMNS_FLAG:
            first = len(others) if first < 0 else first
            inside = not sign
            values += [value] if sign else []
        elif inside and not one.startswith("-"):
            values.append(one)
        else:
            inside = False
            others.append(one)
    return arguments if first < 0 else [*others[:first], COLUMNS_FLAG, *values, *others[first:]]


@contextlib.contextmanager
def said_on_stderr() -> Iterator[None]:
    """Say once, as a line on stderr, what the library has rounded."""
    said: dict[str, None] = {}
    with warnings.catch_warnings():
        usual = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *place: Any) -> None:
            if issubclass(category, DirectionWarning):
                said[str(message)] = None
            else:
                usual(message, category, *place)

        warnings.simplefilter("always", DirectionWarning)
        warnings.showwarning = show
        try:
            yield
        finally:
            for sentence in said:
                print(sentence, file=sys.stderr)


def usage_error(box: str) -> str:
    """The first paragraph of the parser's framed message, as one line."""
    lines = [line.lstrip("│╭╰").rstrip("│╮╯─ \n") for line in box.splitlines()]
    paragraph: list[str] = []
    for line in lines[1:]:
        if line.strip("-─ "):  # a terminal without box characters draws its rules with hyphens
            paragraph.append(line.lstrip("| ") if not paragraph else line.removeprefix("|"))
        elif paragraph:
            break
    first = paragraph[0].strip() if paragraph else ""
    said = _missing(paragraph) if first.startswith(MISSING) else " ".join(line.strip() for line in paragraph)
    return said.replace(UNKNOWN, "not understood:") + f" (see {' '.join([PROGRAM, *_named()])} --help)"


def _missing(paragraph: list[str]) -> str:
    """What is missing, each with its meaning in brackets; the parser has the names to the left of the meanings."""
    first, *rest = paragraph
    left = min((len(line) - len(line.lstrip()) for line in rest), default=0)
    entries: list[tuple[list[str], list[str]]] = []
    for line in rest:
        name = len(line) - len(line.lstrip()) == left
        if name and (not entries or entries[-1][1]):
            entries.append(([], []))
        entries[-1][0 if name else 1].append(line.strip())
    meant = [(" ".join(names), " ".join(words).removesuffix(REQUIRED).rstrip(". ")) for names, words in entries]
    return f"{first.strip()} " + ", ".join(f"{n} ({w[:1].lower()}{w[1:]})" if w else n for n, w in meant)


def _refuse_unknown() -> None:
    """Raise ValueError for a command, or a command below one, that there is not, with the nearest name."""
    typed, known, after = sys.argv[1:], overview.NAMES, PROGRAM
    while typed and not typed[0].startswith("-") and known:
        if typed[0] not in known:
            near = difflib.get_close_matches(typed[0], known, 1)
            meant = f"did you mean {near[0]}? There" if near else "there"
            raise ValueError(
                f"{after} {typed[0]}: no such command; {meant} are {', '.join(known)} (see {after} --help)"
            )
        after += f" {typed[0]}"
        known, typed = overview.SUBCOMMANDS.get(typed[0], ()), typed[1:]


def _named() -> list[str]:
    """The command that was typed, and its subcommand."""
    named = [name for name in sys.argv[1:2] if name in overview.NAMES]
    inner = overview.SUBCOMMANDS.get(named[0], ()) if named else ()
    return named + [name for name in sys.argv[2:3] if name in inner]
