"""Compiled scalar loops, one file per kernel: the only place that imports numba. Tests hold each against numpy."""
