"""How far an estimate is from the truth: norms of vectors and angles of rotations, sample by sample."""

import numpy as np

from rangenav.kernels import rotation as rot
from rangenav.kernels.jit import kernel


@kernel
def norms(state, truth, out):
    """out[k, b] ← the length of the difference of block b (position, velocity, gravity) of two 13-states."""
    for k in range(len(state)):
        for b in range(3):
            o = 4 + 3 * b
            x, y, z = state[k, o] - truth[k, o], state[k, o + 1] - truth[k, o + 1], state[k, o + 2] - truth[k, o + 2]
            out[k, b] = np.sqrt(x * x + y * y + z * z)


@kernel
def angles(found, truth, out):
    """out[j, k] ← the angle of R R̂ᵀ for R̂ = found[j, k] and R = truth[k], accurate at both ends: atan2(sin, cos)."""
    for j in range(len(found)):
        for k in range(len(truth)):
            out[j, k] = rot.angle(rot.load(truth[k]), rot.load(found[j, k]))
