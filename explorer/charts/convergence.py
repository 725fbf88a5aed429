"""The plots of the tab "Convergence": functions Picture -> Drawing on the error dynamics, and their sentences."""

import numpy as np

from explorer.charts import curves
from explorer.charts.plots import Drawing
from explorer.model import convergence
from explorer.model.compute import Picture
from rangenav.record import SETTLED_POSITION

BEGINNING = 0.25
"""Share of the flight that sets no axis: while P is large, eigenvalues are thousands of times as fast as later."""
FADED = 1e-4
"""Of the largest error: below it an error without noise counts as gone."""


def noiseless(picture: Picture) -> Drawing:
    """The position error without noise, that of the run, and the limit below which an error counts as settled."""
    time, seen = picture.motion.time, picture.errors.position
    limit, of = np.full(len(time), SETTLED_POSITION), picture.convergence
    alone = seen if of is None else np.interp(time, of.dynamics.time, of.dynamics.position)
    values = np.column_stack([alone, seen, limit])
    axis = curves.decades(np.maximum(values, FADED * float(np.nanmax(seen))))
    drawn = curves.onto_log_axis(values, axis)
    return Drawing(time=time, values=values, drawn=drawn, axis=axis, hidden=(0,) if of is None else ())


def contraction(picture: Picture) -> Drawing:
    """The largest and the smallest singular value of the transition over a window, and 1."""
    of = picture.convergence
    if of is None:
        return _empty(picture, 3)
    values = np.column_stack([of.dynamics.contraction[:, [0, -1]], np.ones(len(of.dynamics.start))])
    axis = curves.decades(values)
    return Drawing(time=of.dynamics.start, values=values, drawn=curves.onto_log_axis(values, axis), axis=axis)


def closed_loop(picture: Picture) -> Drawing:
    """The largest and the smallest real part of the eigenvalues of 𝒜 − K𝒞."""
    of = picture.convergence
    if of is None:
        return _empty(picture, 2)
    values = np.real(of.dynamics.eigenvalues)[:, [0, -1]]
    later = values[int(len(values) * BEGINNING) :]
    return Drawing(time=of.dynamics.time, values=values, drawn=values, axis=curves.even_range(later, symmetric=True))


def describe(picture: Picture) -> tuple[str, ...]:
    """Sentences: when the error settles without noise and in this run, and its rate in the long run."""
    return convergence.sentences(picture.convergence, picture.summary)


def compare(a: Picture, b: Picture) -> tuple[str, ...]:
    """The same sentences of the pinned run A, and which of A and B is faster."""
    first, *others = convergence.sentences(a.convergence, a.summary)
    return (f"A, the pinned run: {first}", *others, *convergence.which_is_faster(a.convergence, b.convergence))


def _empty(picture: Picture, columns: int) -> Drawing:
    values = np.ones((len(picture.motion.time), columns))
    return Drawing(
        time=picture.motion.time, values=values, drawn=values, axis=(0.1, 10.0), hidden=tuple(range(columns))
    )
