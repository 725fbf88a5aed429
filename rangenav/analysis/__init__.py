"""Observability of a preset's motion from one range: sliding windows, the worst of them, blind directions, verdict.

analyse(preset)     the worst of all windows, as certificates have it: what `analyze` and the page at rest show
sampled(preset)     the worst of fewer windows, several times as fast: for a page while a hand moves, and for studies
how_long(preset)    rank and position error against the length of a window
shortest(preset)    the shortest windows that meet the requirement, with the ranges as they come
"""

from rangenav.analysis.values import Analysis
from rangenav.analysis.window_lengths import how_long, shortest
from rangenav.analysis.worst_windows import analyse, analysis, sampled

__all__ = ["Analysis", "analyse", "analysis", "how_long", "sampled", "shortest"]
