"""Quaternions, yaw, pitch, roll and vectors."""
from __future__ import annotations

from typing import Any, Literal

import numpy as np

from . import sheet
from ._arrays import Floats, as_floats, series, vector
from ._native import multiply as _multiply
from ._native import slerp as _slerp


def _alike(result: Floats, given: Any) -> Floats:
    """One row back for one row in."""
    return result[0] if np.ndim(given) == 1 else result


def normalize(q: Any) -> Floats:
    """Unit quaternions. ``q``: (4,) or (N, 4), w, x, y, z. Returns the same shape."""
    rows = series(q, 4, "q")
    return _alike(sheet.Quats2WorldQuats(rows, sheet.IdentityQuat()), q)


def conjugate(q: Any) -> Floats:
    """w, −x, −y, −z: the inverse rotation. ``q``: (4,) or (N, 4)."""
    return _alike(series(q, 4, "q") * np.array([1.0, -1.0, -1.0, -1.0]), q)


def multiply(a: Any, b: Any) -> Floats:
    """Hamilton product: first ``b``, then ``a``. Each (4,) or (N, 4); one serves all rows of the other."""
    left, right = series(a, 4, "a"), series(b, 4, "b")
    rows = max(len(left), len(right))
    both = [np.ascontiguousarray(np.broadcast_to(x, (rows, 4))) if len(x) == 1 else x for x in (left, right)]
    out = _multiply(*both)
    return out[0] if np.ndim(a) == 1 and np.ndim(b) == 1 else out


def rotate(q: Any, v: Any) -> Floats:
    """``q v q*``: sensor to world coordinates. ``q``: (4,) or (N, 4); ``v``: (3,). Returns (3,) or (N, 3)."""
    return _alike(sheet.QuatsRotateVec3(series(q, 4, "q"), v), q)


def to_ypr(q: Any) -> Floats:
    """Yaw, pitch, roll, rad. ``q``: (4,) or (N, 4). At pitch ±π/2 roll is 0. Returns (3,) or (N, 3)."""
    return _alike(sheet.Quats2Yprs(series(q, 4, "q")), q)


def from_ypr(ypr_rad: Any) -> Floats:
    """Quaternions of yaw, pitch, roll, rad. ``ypr_rad``: (3,) or (N, 3). Returns (4,) or (N, 4)."""
    return _alike(sheet.Yprs2Quats(series(ypr_rad, 3, "ypr_rad")), ypr_rad)


def from_axis_angle(axis: Any, angle_rad: float) -> Floats:
    """The quaternion (4,) of a turn by ``angle_rad`` about ``axis`` (3,) of any length but zero."""
    x, y, z = vector(axis, 3, "axis")
    return sheet.AxisAngle2Quat(x, y, z, angle_rad)


def slerp(a: Any, b: Any, t: Any) -> Floats:
    """Spherical interpolation on the shorter arc: ``a`` (4,) at t = 0, ``b`` (4,) at 1. Returns (4,) or (N, 4)."""
    out = _slerp(vector(a, 4, "a"), vector(b, 4, "b"), as_floats(t, "t").ravel().tolist())
    return out[0] if np.ndim(t) == 0 else out


def relative(q: Any, start: Any, *, frame: Literal["world", "body"] = "world") -> Floats:
    """The turn since ``start`` (4,): ``q start*`` in world axes or ``start* q`` in the sensor's axes at the start.

    ``q``: (4,) or (N, 4). Returns the same shape.
    """
    functions = {"world": sheet.Quats2WorldQuats, "body": sheet.Quats2BodyQuats}
    if frame not in functions:
        raise ValueError(f"frame is {frame!r}; it must be 'world' or 'body'")
    return _alike(functions[frame](series(q, 4, "q"), start), q)


def initial_attitude(acc_m_s2: Any, *, max_variance: float | None = None, gravity_m_s2: float = 9.80665,
                     norm_tolerance: float = 0.05) -> Floats:
    """Attitude (4,) at rest from accelerations (N, 3), with yaw 0.

    With ``max_variance``, (m/s²)², the samples must be at rest: every axis' variance at most that and the mean norm
    within ``norm_tolerance`` (a share) of gravity, else ConditionError.
    """
    acc = series(acc_m_s2, 3, "acc_m_s2")
    if max_variance is None:
        return sheet.Accs2InitialQuat(acc, 1e300, 0.0, 1e300)
    low, high = gravity_m_s2 * (1 - norm_tolerance), gravity_m_s2 * (1 + norm_tolerance)
    return sheet.Accs2InitialQuat(acc, max_variance, low, high)
