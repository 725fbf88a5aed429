"""Text in Python's grammar as syntax trees, one text at a time.

CPython 3.11 counts the depth of the trees of all threads together: while two threads make trees, one of them may get a
SystemError. Everything here that reads Python's grammar reads it through this room.
"""

import ast
import inspect
import textwrap
import threading

_turn = threading.Lock()


def statements(text: str) -> list[ast.stmt]:
    """The statements of a program. Raises SyntaxError, ValueError, RecursionError or MemoryError."""
    with _turn:
        return ast.parse(text).body


def class_statements(kind: type) -> list[ast.stmt]:
    """The statements in the body of a class, from its file, which `inspect` reads as a tree, too."""
    with _turn:
        source = textwrap.dedent(inspect.getsource(kind))
        (defined,) = ast.parse(source).body
    assert isinstance(defined, ast.ClassDef)
    return defined.body


def expression(text: str) -> ast.expr:
    """One expression. Raises what `statements` raises."""
    with _turn:
        return ast.parse(text, mode="eval").body
