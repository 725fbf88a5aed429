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
            e, r = rot.load(found[j, k]), rot.load(truth[k])
            x = r[6] * e[3] + r[7] * e[4] + r[8] * e[5] - (r[3] * e[6] + r[4] * e[7] + r[5] * e[8])
            y = r[0] * e[6] + r[1] * e[7] + r[2] * e[8] - (r[6] * e[0] + r[7] * e[1] + r[8] * e[2])
            z = r[3] * e[0] + r[4] * e[1] + r[5] * e[2] - (r[0] * e[3] + r[1] * e[4] + r[2] * e[5])
            trace = r[0] * e[0] + r[1] * e[1] + r[2] * e[2] + r[3] * e[3] + r[4] * e[4] + r[5] * e[5]
            trace += r[6] * e[6] + r[7] * e[7] + r[8] * e[8]
            out[j, k] = np.arctan2(np.sqrt(x * x + y * y + z * z), trace - 1)
