"""Quaternions, yaw, pitch, roll and vectors."""
from __future__ import annotations

from typing import Any, Literal

import numpy as np

from . import _native
from ._arrays import Floats, as_floats, finite_vector, number, quaternion, say, series
from ._native import DomainError, ShapeError


def _alike(result: Floats, given: Any) -> Floats:
    """One row back for one row in."""
    return result[0] if np.ndim(given) == 1 else result


def _as_many(*given: Floats) -> list[Floats]:
    """One row alone serves as many as the other has."""
    rows = max(len(x) for x in given)
    return [np.ascontiguousarray(np.broadcast_to(x, (rows, x.shape[1]))) if len(x) == 1 else x for x in given]


def normalize(q: Any) -> Floats:
    """Unit quaternions. ``q``: (4,) or (N, 4), w, x, y, z. Returns the same shape."""
    return _alike(_native.normalize(series(q, 4, "q")), q)


def conjugate(q: Any) -> Floats:
    """w, −x, −y, −z: the inverse rotation. ``q``: (4,) or (N, 4)."""
    return _alike(series(q, 4, "q") * np.array([1.0, -1.0, -1.0, -1.0]), q)


def multiply(a: Any, b: Any) -> Floats:
    """Hamilton product: first ``b``, then ``a``. Each (4,) or (N, 4); one serves all rows of the other."""
    out = _native.multiply(*_as_many(series(a, 4, "a"), series(b, 4, "b")))
    return out[0] if np.ndim(a) == 1 and np.ndim(b) == 1 else out


def rotate(q: Any, v: Any) -> Floats:
    """``q v q*``: sensor to world coordinates. ``q``: (4,) or (N, 4); ``v``: (3,) or (N, 3), a vector for each; one
    serves all rows of the other. Returns (3,) or (N, 3)."""
    quats, vectors = series(q, 4, "q"), series(v, 3, "v")
    out = _native.rotate(*_as_many(quats, vectors))
    return out[0] if np.ndim(q) == 1 and np.ndim(v) == 1 else out


def to_matrix(q: Any) -> Floats:
    """Rotation matrices, world from body, rows first. ``q``: (4,) or (N, 4). Returns (3, 3) or (N, 3, 3)."""
    return _alike(_native.to_matrix(series(q, 4, "q")).reshape(-1, 3, 3), q)


def from_matrix(matrix: Any) -> Floats:
    """Quaternions of rotation matrices (3, 3) or (N, 3, 3), which may be off by rounding; DomainError for others.
    Returns (4,) or (N, 4), w ≥ 0."""
    array = as_floats(matrix, "matrix")
    if array.ndim not in (2, 3) or array.shape[-2:] != (3, 3):
        raise ShapeError(say(f"matrix has shape {array.shape} and must be (3, 3) or (N, 3, 3)",
                             f"matrix の形は {array.shape} ですが、(3, 3) または (N, 3, 3) でなければなりません"))
    out = _native.from_matrix(array.reshape(-1, 9))
    return out[0] if array.ndim == 2 else out


def to_rotation_vector(q: Any) -> Floats:
    """Axis times angle, rad, the angle from 0 to π. ``q``: (4,) or (N, 4). Returns (3,) or (N, 3)."""
    return _alike(_native.to_rotation_vector(series(q, 4, "q")), q)


def to_ypr(q: Any) -> Floats:
    """Yaw, pitch, roll, rad. ``q``: (4,) or (N, 4). At pitch ±π/2 roll is 0. Returns (3,) or (N, 3)."""
    return _alike(_native.to_ypr(series(q, 4, "q")), q)


def from_ypr(ypr_rad: Any) -> Floats:
    """Quaternions of yaw, pitch, roll, rad. ``ypr_rad``: (3,) or (N, 3). Returns (4,) or (N, 4)."""
    return _alike(_native.from_ypr(series(ypr_rad, 3, "ypr_rad")), ypr_rad)


def from_axis_angle(axis: Any, angle_rad: float) -> Floats:
    """The quaternion (4,) of a turn by ``angle_rad`` about ``axis`` (3,) of any length but zero."""
    angle = number(angle_rad, "angle_rad")
    if not np.isfinite(angle):
        raise DomainError(say(f"angle_rad is {angle}; it must be a finite number",
                              f"angle_rad が {angle} です。有限の数値にしてください"))
    return _native.from_axis_angle(finite_vector(axis, 3, "axis"), angle)


def slerp(a: Any, b: Any, t: Any) -> Floats:
    """Spherical interpolation on the shorter arc: ``a`` (4,) at t = 0, ``b`` (4,) at 1. Returns (4,) or (N, 4)."""
    at = as_floats(t, "t").ravel()
    if not np.isfinite(at).all():
        raise DomainError(say("t: every value must be a finite number", "t: すべて有限の数値にしてください"))
    out = _native.slerp(quaternion(a, "a"), quaternion(b, "b"), at.tolist())
    return out[0] if np.ndim(t) == 0 else out


def relative(q: Any, start: Any, *, frame: Literal["world", "body"] = "world") -> Floats:
    """The turn since ``start`` (4,): ``q start*`` in world axes or ``start* q`` in the sensor's axes at the start.

    ``q``: (4,) or (N, 4). Returns the same shape.
    """
    if frame not in ("world", "body"):
        raise ValueError(say(f"frame is {frame!r}; it must be 'world' or 'body'",
                             f"frame が {frame!r} です。'world' か 'body' にしてください"))
    return _alike(_native.relative(series(q, 4, "q"), quaternion(start, "start"), frame == "body"), q)


def initial_attitude(acc_m_s2: Any, *, max_variance: float | None = None, gravity_m_s2: float = 9.80665,
                     norm_tolerance: float = 0.05) -> Floats:
    """Attitude (4,) at rest from accelerations (N, 3), with yaw 0.

    With ``max_variance``, (m/s²)², the samples must be at rest: every axis' variance at most that and the mean norm
    within ``norm_tolerance`` (a share) of gravity, else ConditionError.
    """
    acc = series(acc_m_s2, 3, "acc_m_s2")
    if max_variance is None:
        return _native.initial_attitude(acc, 1e300, (0.0, 1e300))
    gravity, tolerance = number(gravity_m_s2, "gravity_m_s2"), number(norm_tolerance, "norm_tolerance")
    if not (0 < gravity < np.inf and 0 <= tolerance < np.inf):
        raise DomainError(say(
            f"gravity_m_s2 is {gravity} and norm_tolerance {tolerance}; give a gravity greater than 0 and a tolerance of 0 or more",
            f"gravity_m_s2 が {gravity}、norm_tolerance が {tolerance} です。前者は 0 より大きく、後者は 0 以上にしてください"))
    limits = max(gravity * (1 - tolerance), 0.0), gravity * (1 + tolerance)
    return _native.initial_attitude(acc, number(max_variance, "max_variance"), limits)
