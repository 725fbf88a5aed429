"""Fuzzing: `python -m tests.fuzz --seconds 60 --target formula` throws strings at the library until the time is up.

A reader is an ordinary function: a random generator in, nothing out; it fails by raising. What the library refuses, it
refuses with a ValueError of one line. Every case has a deadline and a limit of memory, warnings are errors, and nothing
may ever be run by Python's exec or eval. A failing case is printed with its seed: `--seed N --cases 1` runs it alone.
A target is a reader, or several that take turns.
"""
