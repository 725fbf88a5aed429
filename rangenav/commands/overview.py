"""All commands, in the groups that `rangenav --help` shows, each with its summary and one example.

Summary and example are read from the source of a command, so that the overview comes without loading the library.
"""

import ast
import importlib
import re
from collections.abc import Callable, Mapping
from pathlib import Path

from rangenav import python_text
from rangenav.commands.text.lines import COLUMNS, wrapped

Command = Callable[..., None]
GROUPS: Mapping[str, tuple[str, ...]] = {
    "understand a motion": ("presets", "analyze", "explain", "repair"),
    "run the observers": ("simulate", "tune", "study"),
    "state and prove": ("certify", "verify"),
    "exchange files": ("export", "import", "log"),
}
"""The names of all commands."""
NAMES = tuple(name for group in GROUPS.values() for name in group)
SUBCOMMANDS: Mapping[str, tuple[str, ...]] = {"study": ("plan", "run", "show", "export", "copy", "preset")}
"""The names of the commands below a command."""
OTHERWISE = {"presets": "presets.list_presets", "import": "import_.import_"}
"""Module and function of the commands whose name is not that of both."""
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


def command(name: str) -> Command:
    """The function of a command; loads its module."""
    module, function = _place(name)
    return getattr(importlib.import_module(f"rangenav.commands.{module}"), function)


def documentation(name: str) -> str:
    """The docstring of a command's function; loads nothing."""
    module, function = _place(name)
    source = (Path(__file__).parent / f"{module}.py").read_text("utf-8")
    (found,) = (node for node in python_text.statements(source) if getattr(node, "name", "") == function)
    assert isinstance(found, ast.FunctionDef)
    return ast.get_docstring(found) or ""


def summary(name: str) -> str:
    """The first sentence of a command's documentation."""
    return documentation(name).split("\n\n")[0].replace("\n", " ")


def example(name: str) -> str:
    """The example that a command's documentation gives."""
    (line,) = EXAMPLE.findall(documentation(name))
    return line


def _place(name: str) -> tuple[str, str]:
    """Module and function of a command."""
    module, _, function = OTHERWISE.get(name, f"{name}.{name}").partition(".")
    return module, function


def overview() -> str:
    """What `rangenav --help` prints: groups of commands, each with its summary and one example."""
    lines = [START]
    for title, group in GROUPS.items():
        lines.append(title)
        for name in group:
            first, *rest = wrapped(summary(name), COLUMNS - INDENT)
            lines += [f"  {name:<{INDENT - 2}}{first}", *(" " * INDENT + line for line in rest)]
            lines.append(f"{' ' * INDENT}$ {example(name)}")
        lines.append("")
    ends = [part for line in END.strip().splitlines() for part in wrapped(line, COLUMNS)]
    return "\n".join([*lines, *ends])
