"""One step of the complementary filter on SO(3): Heun's method on the group, order 2."""

import numpy as np

from rangenav.kernels import rotation as rot
from rangenav.kernels.compiled import kernel


@kernel
def correction(R, mag, gravity, p):
    """k1 (ρ1 m_y × R̂ᵀm + ρ2 ĝ_B × R̂ᵀg), body axes; p holds k1, rho1, rho2, magnetic and gravity."""
    mx = R[0, 0] * p.magnetic[0] + R[1, 0] * p.magnetic[1] + R[2, 0] * p.magnetic[2]
    my = R[0, 1] * p.magnetic[0] + R[1, 1] * p.magnetic[1] + R[2, 1] * p.magnetic[2]
    mz = R[0, 2] * p.magnetic[0] + R[1, 2] * p.magnetic[1] + R[2, 2] * p.magnetic[2]
    gx = R[0, 0] * p.gravity[0] + R[1, 0] * p.gravity[1] + R[2, 0] * p.gravity[2]
    gy = R[0, 1] * p.gravity[0] + R[1, 1] * p.gravity[1] + R[2, 1] * p.gravity[2]
    gz = R[0, 2] * p.gravity[0] + R[1, 2] * p.gravity[1] + R[2, 2] * p.gravity[2]
    c1, c2 = p.k1 * p.rho1, p.k1 * p.rho2
    return (
        c1 * (mag[1] * mz - mag[2] * my) + c2 * (gravity[1] * gz - gravity[2] * gy),
        c1 * (mag[2] * mx - mag[0] * mz) + c2 * (gravity[2] * gx - gravity[0] * gz),
        c1 * (mag[0] * my - mag[1] * mx) + c2 * (gravity[0] * gy - gravity[1] * gx),
    )


@kernel
def step(R, gyro0, gyro1, mag0, mag1, gravity0, gravity1, h, p):
    """R ← R̂ after h seconds, from the signals at both ends."""
    increment, trial = np.empty((3, 3)), R.copy()
    sx, sy, sz = correction(R, mag0, gravity0, p)
    sx, sy, sz = gyro0[0] + sx, gyro0[1] + sy, gyro0[2] + sz
    rot.exp(h * sx, h * sy, h * sz, increment)
    rot.turn(trial, increment)
    ex, ey, ez = correction(trial, mag1, gravity1, p)
    ex, ey, ez = gyro1[0] + ex, gyro1[1] + ey, gyro1[2] + ez
    rot.exp(h / 2 * (sx + ex), h / 2 * (sy + ey), h / 2 * (sz + ez), increment)
    rot.turn(R, increment)
    rot.orthonormalise(R)
