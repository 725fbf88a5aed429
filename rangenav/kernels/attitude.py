"""One step of the complementary filter on SO(3): Heun's method on the group, order 2."""

from rangenav.kernels import rotation as rot
from rangenav.kernels.compiled import kernel


@kernel
def rate(r, gyro, mag, gravity, p):
    """ω_y + k1 (ρ1 m_y × R̂ᵀm + ρ2 ĝ_B × R̂ᵀg), body axes; gyro, mag and gravity (ĝ_B) are tuples or arrays of three."""
    mx, my, mz = rot.apply_inverse(r, p.magnetic[0], p.magnetic[1], p.magnetic[2])
    gx, gy, gz = rot.apply_inverse(r, p.gravity[0], p.gravity[1], p.gravity[2])
    c1, c2 = p.k1 * p.rho1, p.k1 * p.rho2
    return (
        gyro[0] + c1 * (mag[1] * mz - mag[2] * my) + c2 * (gravity[1] * gz - gravity[2] * gy),
        gyro[1] + c1 * (mag[2] * mx - mag[0] * mz) + c2 * (gravity[2] * gx - gravity[0] * gz),
        gyro[2] + c1 * (mag[0] * my - mag[1] * mx) + c2 * (gravity[0] * gy - gravity[1] * gx),
    )


@kernel
def step(r, gyro0, gyro1, mag0, mag1, gravity0, gravity1, h, p):
    """R̂ after h seconds, from the signals at both ends."""
    sx, sy, sz = rate(r, gyro0, mag0, gravity0, p)
    trial = rot.multiply(r, rot.exp(h * sx, h * sy, h * sz))
    ex, ey, ez = rate(trial, gyro1, mag1, gravity1, p)
    turn = rot.exp(h / 2 * (sx + ex), h / 2 * (sy + ey), h / 2 * (sz + ez))
    return rot.orthonormal(rot.multiply(r, turn))
