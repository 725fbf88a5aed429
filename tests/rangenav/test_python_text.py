"""Python's grammar is read by one thread at a time."""

import ast
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from rangenav import cascade, python_text, results
from rangenav.signals import expressions

THREADS = 4


def test_texts_of_many_threads_become_trees_one_after_the_other(monkeypatch):
    inside, most, gate, parse = [], [], threading.Lock(), ast.parse

    def watched(*arguments, **keywords):
        with gate:
            inside.append(None)
            most.append(len(inside))
        tree = parse(*arguments, **keywords)
        threading.Event().wait(0.002)  # so that another thread would come in
        with gate:
            inside.pop()
        return tree

    monkeypatch.setattr(ast, "parse", watched)
    results.units.cache_clear()
    expressions.parse.cache_clear()
    readers = (
        lambda: results.units(cascade.Estimate),
        lambda: expressions.parse("sin(t)"),
        lambda: python_text.statements("a = 1"),
        lambda: python_text.expression("a + 1"),
    )
    with ThreadPoolExecutor(THREADS) as pool:
        for job in [pool.submit(reader) for reader in readers * 2]:
            job.result()
    assert len(most) >= len(readers)
    assert max(most) == 1


def test_what_is_no_python_is_refused():
    for read in (python_text.statements, python_text.expression):
        with pytest.raises(SyntaxError):
            read("a +")
