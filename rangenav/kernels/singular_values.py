"""Singular values of many small matrices, side by side: Householder's bidiagonal form, then qd steps with shifts.

    B = UᵀAV has the diagonal √q and the off-diagonal √e.  A step from q, e to those of BᵀB − s:
    d₀ = q₀ − s,  q̂ᵢ = dᵢ + eᵢ,  êᵢ = eᵢ qᵢ₊₁/q̂ᵢ,  dᵢ₊₁ = dᵢ qᵢ₊₁/q̂ᵢ − s

No step subtracts from q or e but the shift, so small singular values of B keep their digits; of A they have an error of
some 1e-16 of the largest, as by LAPACK. A shift above the least eigenvalue makes some d negative, and is taken back. If
it is the last d alone, s + d is a shift below the least eigenvalue that is nearly as large (Rutishauser 1960).
"""

import numpy as np

from rangenav.kernels.householder import reflector
from rangenav.kernels.jit import kernel
from rangenav.kernels.vectors import at, choose, everywhere

LANES = 16
"""Matrices side by side: each step of one matrix waits for a division, so that eight would wait most of the time."""
STEPS = 150
"""At most. The rows of windows take some forty; a matrix that falls apart into blocks can take thousands."""
TINY = 1e-60
"""Least q, as a share of the sum: squares of what lies far below the rounding."""
LARGEST = 1e120
"""Of the sum: what is larger is left to LAPACK."""
RETRIES = 3.0
"""Shifts that are taken back one after the other, before the step is made without one."""
EPS = 2.0**-52
SMALL = EPS**2
"""An e below this share of an eigenvalue is zero."""


MOST = 13
"""Rows of a matrix."""
Q_AT, E_AT, NEW_Q_AT, NEW_E_AT, END_AT = (MOST * (MOST + k) for k in range(5))
WORK = END_AT + 1
"""Places of the work space, each a number of every matrix."""


@kernel
def decompose(w, n, first, count, values, found):
    """values[first + c] ← singular values of matrix c, descending; found[first + c] ← whether there are any.

    w begins with the matrices of n rows, which are lost. None are found of what is zero, not finite, or above 1e60.
    """
    A, q, e = at(w, 0, LANES), at(w, LANES * Q_AT, LANES), at(w, LANES * E_AT, LANES)
    q_new, e_new, end = at(w, LANES * NEW_Q_AT, LANES), at(w, LANES * NEW_E_AT, LANES), at(w, LANES * END_AT, LANES)
    _bidiagonal(A, q, e, n)
    end[0] = _eigenvalues(q, e, q_new, e_new, n)
    for c in range(count):
        row = values[first + c]
        for i in range(n):
            row[i] = np.sqrt(w[LANES * (Q_AT + i) + c])
        _descending(row)
        found[first + c] = w[LANES * END_AT + c] < -0.5


@kernel
def _bidiagonal(A, q, e, n):
    """Reflect columns and rows in turn; only the squares of what remains are kept."""
    for j in range(n):
        square = A[(n + 1) * j] * 0.0
        for i in range(j + 1, n):
            square += A[n * i + j] * A[n * i + j]
        A[(n + 1) * j], share, q[j], _ = reflector(A[(n + 1) * j], square)
        for k in range(j + 1, n):
            dot = A[(n + 1) * j] * A[n * j + k]
            for i in range(j + 1, n):
                dot += A[n * i + j] * A[n * i + k]
            dot *= share
            for i in range(j, n):
                A[n * i + k] -= A[n * i + j] * dot
        if j == n - 1:
            e[j] = square * 0.0
            break
        square = square * 0.0
        for k in range(j + 2, n):
            square += A[n * j + k] * A[n * j + k]
        A[n * j + j + 1], share, e[j], _ = reflector(A[n * j + j + 1], square)
        for i in range(j + 1, n):
            dot = A[n * j + j + 1] * A[n * i + j + 1]
            for k in range(j + 2, n):
                dot += A[n * j + k] * A[n * i + k]
            dot *= share
            for k in range(j + 1, n):
                A[n * i + k] -= A[n * j + k] * dot


@kernel
def _eigenvalues(q, e, q_new, e_new, n):
    """q ← eigenvalues of BᵀB; below 0 if all of them were found."""
    total = q[0]
    for i in range(1, n):
        total += q[i]
    for i in range(n):
        q[i] = choose(q[i] < TINY * total, TINY * total, q[i])
    none = total * 0.0
    there = choose(total > 0.0, total, none + LARGEST) < LARGEST
    end, shift, s, retries = choose(there, none + (n - 1.0), -1.0), none, none, none
    for _ in range(STEPS):
        low, last, gap = _step(q, e, q_new, e_new, n, s, end)
        least = choose(last < low, last, low)
        taken = least > 0.0
        value = shift + s + last
        found = choose(taken, gap - SMALL * value, 1.0 + none) < 0.0
        left = choose(found, end - 1.0, end)
        for i in range(n):
            kept = i < left + 0.5
            q[i] = choose(kept, choose(taken, q_new[i], q[i]), choose(i < end + 0.5, value, q[i]))
            e[i] = choose(taken, choose(i < left - 0.5, e_new[i], none), e[i])
        shift = choose(taken, shift + s, shift)
        late = choose(low > 0.0, s + last, none)
        smaller = choose(late > 0.0, late * (1 - 2 * EPS), choose(retries < RETRIES, s / 4, none))
        s = choose(taken, choose(found, low, least), smaller)
        s = choose(s < EPS * shift, none, s)  # no digit of a value would change
        retries = choose(taken, none, retries + 1.0)
        end = left
        if everywhere(end < -0.5):
            break
    return choose(there, end, 0.0)


@kernel
def _step(q, e, q_new, e_new, n, s, end):
    """A step with the shift s of the first `end` + 1 numbers: the least d but the last, the last d, and the last ê."""
    d = q[0] - s
    low, last, gap = d * 0.0 + 1e300, d, d * 0.0
    for i in range(n - 1):
        inside = i < end - 0.5
        low = choose(inside, choose(d < low, d, low), low)
        q_new[i] = d + e[i]
        ratio = q[i + 1] / q_new[i]
        e_new[i] = e[i] * ratio
        d = d * ratio - s
        last, gap = choose(inside, d, last), choose(inside, e_new[i], gap)
    q_new[n - 1], e_new[n - 1] = d, gap * 0.0
    return low, last, gap


@kernel
def _descending(row):
    for i in range(1, len(row)):
        value, j = row[i], i
        while j > 0 and row[j - 1] < value:
            row[j] = row[j - 1]
            j -= 1
        row[j] = value
