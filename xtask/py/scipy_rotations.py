"""Writes fixtures/scipy/rotations.f64le: 10,000 random rotations as SciPy's Rotation sees them.

Run with SciPy and NumPy installed: python xtask/py/scipy_rotations.py
The file is little-endian float64, COLUMNS numbers a case, in the order of the names below.
Cases: 0-5999 uniform; 6000-7999 pitch within 1e-3 rad of +-pi/2 (down to 1e-9); 8000-8999 small turns
(1e-12 to 1e-2 rad); 9000-9999 turns within 1e-3 rad of pi.
"""

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

NAMES = (
    ["q_w", "q_x", "q_y", "q_z"]  # the first rotation, w >= 0 or not
    + ["p_w", "p_x", "p_y", "p_z"]  # the second
    + ["v_x", "v_y", "v_z"]  # a vector
    + [f"r{i}{j}" for i in range(3) for j in range(3)]  # matrix of q
    + ["yaw", "pitch", "roll"]  # ZYX of q
    + ["qp_w", "qp_x", "qp_y", "qp_z"]  # q after p
    + ["qv_x", "qv_y", "qv_z"]  # v turned by q
    + ["rv_x", "rv_y", "rv_z"]  # rotation vector of q
    + ["s_w", "s_x", "s_y", "s_z"]  # slerp from q to p at t = (case mod 101)/100
)
CASES = 10_000


def wxyz(rotation):
    return np.roll(rotation.as_quat(), 1, axis=-1)


def main():
    rng = np.random.default_rng(20260131)
    q = Rotation.random(CASES, rng)
    near_lock = slice(6000, 8000)
    off = 10.0 ** rng.uniform(-9, -3, 2000)
    angles = np.column_stack(
        [
            rng.uniform(-np.pi, np.pi, 2000),
            rng.choice([-1.0, 1.0], 2000) * (np.pi / 2 - off),
            rng.uniform(-np.pi, np.pi, 2000),
        ]
    )
    axis = rng.normal(size=(2000, 3))
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    size = np.concatenate([10.0 ** rng.uniform(-12, -2, 1000), np.pi - 10.0 ** rng.uniform(-9, -3, 1000)])
    quats = q.as_quat()
    quats[near_lock] = Rotation.from_euler("ZYX", angles).as_quat()
    quats[8000:] = Rotation.from_rotvec(axis * size[:, None]).as_quat()
    quats *= rng.choice([-1.0, 1.0], (CASES, 1))
    q = Rotation.from_quat(quats)
    p = Rotation.random(CASES, rng)
    v = rng.normal(size=(CASES, 3)) * 10.0 ** rng.uniform(-3, 3, (CASES, 1))
    t = (np.arange(CASES) % 101) / 100
    slerp = [Slerp([0, 1], Rotation.concatenate([q[k], p[k]]))(t[k]) for k in range(CASES)]
    # the quaternion exactly as SciPy holds it, in w, x, y, z
    table = np.column_stack(
        [
            wxyz(q),
            wxyz(p),
            v,
            q.as_matrix().reshape(CASES, 9),
            q.as_euler("ZYX"),
            wxyz(q * p),
            q.apply(v),
            q.as_rotvec(),
            np.array([wxyz(s) for s in slerp]),
        ]
    )
    assert table.shape == (CASES, len(NAMES)), table.shape
    folder = Path(__file__).resolve().parents[2] / "fixtures" / "scipy"
    folder.mkdir(parents=True, exist_ok=True)
    table.astype("<f8").tofile(folder / "rotations.f64le")
    print(table.shape, (folder / "rotations.f64le").stat().st_size)


main()
