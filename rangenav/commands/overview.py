"""All commands, in the groups that `rangenav --help` shows, each with its summary and one example."""

import inspect
import re
from collections.abc import Callable, Mapping

from rangenav.commands.analyze import analyze
from rangenav.commands.certify import certify
from rangenav.commands.explain import explain
from rangenav.commands.export import export
from rangenav.commands.import_ import import_
from rangenav.commands.log import log
from rangenav.commands.presets import list_presets
from rangenav.commands.repair import repair
from rangenav.commands.simulate import simulate
from rangenav.commands.text.layout import COLUMNS, wrapped
from rangenav.commands.tune import tune
from rangenav.commands.verify import verify

Command = Callable[..., None]
GROUPS: Mapping[str, Mapping[str, Command]] = {
    "understand a motion": {"presets": list_presets, "analyze": analyze, "explain": explain, "repair": repair},
    "run the observers": {"simulate": simulate, "tune": tune},
    "state and prove": {"certify": certify, "verify": verify},
    "exchange files": {"export": export, "import": import_, "log": log},
}
"""Every command by its name."""
START = """rangenav: what one range can tell of a motion, and the observers that use it.

Usage: rangenav COMMAND [arguments]       rangenav COMMAND --help
"""
END = """
A PRESET is a shipped preset's name or the path of a TOML file. --json prints one JSON object.
Exit 0: done. Exit 1: a check failed. Exit 2: bad input, one line on stderr.
rangenav --version prints the version.
rangenav --tyro-print-completion bash (or zsh, fish) prints a completion script for the shell.
The page: rangenav-explorer."""
EXAMPLE = re.compile(r"^Example: (.+)$", re.MULTILINE)
INDENT = 12
"""Columns of a command's name and the blanks around it."""


def commands() -> dict[str, Command]:
    """Every command by its name."""
    return {name: command for group in GROUPS.values() for name, command in group.items()}


def summary(command: Command) -> str:
    """The first sentence of a command's documentation."""
    return (inspect.getdoc(command) or "").split("\n\n")[0].replace("\n", " ")


def example(command: Command) -> str:
    """The example that a command's documentation gives."""
    (line,) = EXAMPLE.findall(inspect.getdoc(command) or "")
    return line


def overview() -> str:
    """What `rangenav --help` prints: groups of commands, each with its summary and one example."""
    lines = [START]
    for title, group in GROUPS.items():
        lines.append(title)
        for name, command in group.items():
            first, *rest = wrapped(summary(command), COLUMNS - INDENT)
            lines += [f"  {name:<{INDENT - 2}}{first}", *(" " * INDENT + line for line in rest)]
            lines.append(f"{' ' * INDENT}$ {example(command)}")
        lines.append("")
    ends = [part for line in END.strip().splitlines() for part in wrapped(line, COLUMNS)]
    return "\n".join([*lines, *ends])
