"""Calibration from six faces or many poses at rest, and calibration files."""
from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime, timezone
from typing import Any

import numpy as np

from ._arrays import Floats, as_floats, as_path, count, even_step, number, say, series, vector
from ._native import apply as _apply
from ._native import check_calibration as _check_file
from ._native import known_turns as _known_turns
from ._native import multi_pose as _multi_pose
from ._native import six_face as _six_face
from ._native import DomainError, ShapeError

IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
ZERO = (0.0, 0.0, 0.0)


def _matrix(value: Any, name: str) -> tuple[tuple[float, ...], ...]:
    array = as_floats(value, name)
    if array.shape != (3, 3):
        raise ShapeError(say(f"{name} has shape {array.shape} and must be (3, 3)",
                             f"{name} の形は {array.shape} ですが、(3, 3) でなければなりません"))
    return tuple(map(tuple, array.tolist()))


@dataclass(frozen=True)
class Calibration:
    """``corrected = matrix (raw − bias)``, for accelerometer (m/s²) and gyroscope (rad/s).

    Raises ShapeError where a bias is not (3,) or a matrix not (3, 3). Numbers are kept as tuples.
    """

    acc_bias_m_s2: tuple[float, float, float] = ZERO
    acc_matrix: Any = IDENTITY
    """3×3, rows first; the scales on its diagonal."""
    gyro_bias_rad_s: tuple[float, float, float] = ZERO
    gyro_matrix: Any = IDENTITY
    other: dict[str, Any] = field(default_factory=dict)
    """Keys of a calibration file that this class does not know; they are kept."""

    def __post_init__(self) -> None:
        for name in ("acc_bias_m_s2", "gyro_bias_rad_s"):
            object.__setattr__(self, name, tuple(vector(getattr(self, name), 3, name)))
        for name in ("acc_matrix", "gyro_matrix"):
            object.__setattr__(self, name, _matrix(getattr(self, name), name))
        if not isinstance(self.other, dict):
            raise TypeError(say(f"other is {self.other!r}; it must be a dict of keys of the file",
                                f"other が {self.other!r} です。ファイルのキーの dict にしてください"))

    def apply_acc(self, acc_m_s2: Any) -> Floats:
        """Corrected accelerations (N, 3), m/s²."""
        return _apply(series(acc_m_s2, 3, "acc_m_s2"), list(self.acc_bias_m_s2), self.acc_matrix)

    def apply_gyro(self, gyro_rad_s: Any) -> Floats:
        """Corrected rates (N, 3), rad/s."""
        return _apply(series(gyro_rad_s, 3, "gyro_rad_s"), list(self.gyro_bias_rad_s), self.gyro_matrix)

    def text(self, name: str = "calibration") -> str:
        """The text of its file (JSON). ``name`` begins the sentence of a DomainError: a number that is not finite, a
        matrix without an inverse, a covariance that is not whole; TypeError where ``other`` is no JSON."""
        document = {
            "format": "shisei-calibration",
            "version": 1,
            "created": datetime.now(timezone.utc).isoformat(timespec="seconds"),
            "method": "six-face",
            "gravity_m_s2": 9.80665,
            **self.other,
            "accelerometer": {"bias_m_s2": self.acc_bias_m_s2, "matrix": self.acc_matrix},
            "gyroscope": {"bias_rad_s": self.gyro_bias_rad_s, "matrix": self.gyro_matrix},
        }
        try:
            text = json.dumps(document, indent=2, allow_nan=False) + "\n"
        except TypeError as error:
            raise TypeError(say(f"{name}: other holds what JSON cannot ({error}); give numbers, texts, lists and dicts",
                                f"{name}: other に JSON で書けない値があります ({error})。数値、文字列、list、dict にしてください")) from None
        except ValueError as error:
            raise DomainError(say(f"{name}: a number is not finite, or other holds itself ({error})",
                                  f"{name}: 有限でない数値があるか、other が自分自身を含んでいます ({error})")) from None
        _check_file(name, text.encode())
        return text

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a calibration file (JSON), readable by ``shisei apply`` and ``shisei orient --calibration``.

        Raises OSError, and what :meth:`text` raises; a file that was there is replaced only by a whole one.
        """
        name = as_path(path)
        text = self.text(name).encode()
        place = os.path.realpath(name)  # where a link leads, so that it stays a link
        if os.path.exists(place) and not os.path.isfile(place):  # a pipe or a terminal has no place beside it
            with open(place, "wb") as file:
                file.write(text)
            return
        beside = f"{place}.{os.getpid()}.tmp"
        try:
            with open(beside, "xb") as file:
                file.write(text)
            os.replace(beside, place)
        except OSError as error:
            if os.path.exists(beside):
                os.remove(beside)
            raise OSError(error.errno, error.strerror, name) from None

    @staticmethod
    def load(path: str | os.PathLike[str]) -> Calibration:
        """Reads a calibration file; DomainError when it is not one of version 1, or not whole."""
        name = as_path(path)
        with open(name, "rb") as file:
            text = file.read()
        _check_file(name, text)
        document = json.loads(text.decode("utf-8-sig"))
        acc, gyro = document["accelerometer"], document["gyroscope"]
        other = {k: v for k, v in document.items() if k not in ("accelerometer", "gyroscope")}
        return Calibration(tuple(acc["bias_m_s2"]), acc["matrix"], tuple(gyro["bias_rad_s"]), gyro["matrix"], other)


@dataclass(frozen=True)
class Face:
    """What was found of one face."""

    face: str
    """+x, -x, +y, -y, +z or -z: the axis that points up."""
    found: bool
    start_s: float | None
    """Start of its window, or of the best candidate; None when the face never pointed up."""
    worst_variance: float | None
    """Largest variance of an axis, (m/s²)²."""
    tilt_rad: float | None
    mean_norm_m_s2: float | None


@dataclass(frozen=True, eq=False)
class SixFaceResult:
    """A calibration with its uncertainty and where it comes from."""

    calibration: Calibration
    acc_sigma: Floats
    """(6,) standard deviations: bias x, y, z (m/s²), scale x, y, z."""
    gyro_bias_sigma_rad_s: Floats
    """(3,)"""
    faces: list[Face]


def six_face(*, acc_m_s2: Any, gyro_rad_s: Any, rate_hz: float | None = None, time_s: Any = None, dt_s: Any = None,
             window_s: float = 3.0, step_s: float = 0.1, max_tilt_rad: float = np.pi / 12, max_variance: float = 0.01,
             gravity_m_s2: float = 9.80665, min_acc_scale: float = 0.9, max_acc_scale: float = 1.1) -> SixFaceResult:
    """Accelerometer bias and scale, gyroscope bias, from a recording that rests on each of its six faces.

    acc_m_s2, gyro_rad_s: (N, 3). rate_hz, or time_s (N,) or dt_s without gaps. window_s: length of still time looked for on each face. max_variance, (m/s²)²: what
    counts as still. Raises ConditionError when a face is missing; the exception's ``faces`` says what was found.
    """
    acc, gyro = series(acc_m_s2, 3, "acc_m_s2"), series(gyro_rad_s, 3, "gyro_rad_s")
    given = {"window_s": window_s, "step_s": step_s, "max_tilt_rad": max_tilt_rad, "max_variance": max_variance,
             "gravity_m_s2": gravity_m_s2, "min_acc_scale": min_acc_scale, "max_acc_scale": max_acc_scale}
    settings = [number(value, name) for name, value in given.items()]
    found = _six_face(acc, gyro, even_step(len(acc), rate_hz, time_s, dt_s), settings)
    faces = [Face(**f) for f in found["faces"]]
    if "error" in found:
        found["error"].faces = faces
        raise found["error"]
    calibration = Calibration(tuple(found["acc_bias_m_s2"]), found["acc_matrix"], tuple(found["gyro_bias_rad_s"]),
                              found["gyro_matrix"], {"gravity_m_s2": settings[4]})
    sigma = np.sqrt(np.diag(np.array(found["acc_covariance"])))
    return SixFaceResult(calibration, sigma, np.sqrt(np.array(found["gyro_bias_variance"])), faces)


ACC_PARAMETERS = ["bias_x", "bias_y", "bias_z", "m_xx", "m_xy", "m_xz", "m_yy", "m_yz", "m_zz"]
"""The nine parameters of :func:`multi_pose`, in the order of its errors."""


@dataclass(frozen=True, eq=False)
class MultiPoseResult:
    """A calibration from P poses with its uncertainty."""

    calibration: Calibration
    acc_sigma: Floats
    """(9,) standard errors: bias x, y, z (m/s²), then the matrix' xx, xy, xz, yy, yz, zz."""
    residual_rms_m_s2: float
    """Root mean square of |a| − g over the poses."""
    held_out_rms_m_s2: float | None
    """The same of each pose with the calibration of all others; None with fewer than 10 poses."""
    poses_m_s2: Floats
    """(P, 3) mean readings of the poses."""
    rows: list[tuple[int, int]]
    """First row and end row of each pose."""
    suggested_up: Floats
    """(3, 3) the directions (unit vectors in sensor axes) that should point up in poses to add, best first."""
    gyro_sigma: Floats | None
    """(9,) standard errors of the gyroscope's matrix, row by row; None without ``gyro_turns``."""
    turn_residual_rms_rad: float | None
    """How well the gyroscope carries gravity from pose to pose; None without ``gyro_turns``."""


def multi_pose(*, acc_m_s2: Any, gyro_rad_s: Any, rate_hz: float | None = None, time_s: Any = None, dt_s: Any = None,
               gravity_m_s2: float = 9.80665, gyro_turns: bool = False) -> MultiPoseResult:
    """Nine accelerometer parameters from poses at rest in all directions, the gyroscope's bias, and its matrix if asked.

    acc_m_s2, gyro_rad_s: (N, 3), a recording with nine poses or more (better twelve), 1 s still each; no equipment
    needed. rate_hz, or time_s (N,) or dt_s without gaps. gyro_turns: also the gyroscope's scale and misalignment from the turns between the poses. gravity_m_s2: local.
    The GIL is released. Raises ShapeError, DomainError (numbers that are not finite, step or gravity not positive) and
    ConditionError (too few poses, or poses or turns that do not determine the answer).
    """
    acc, gyro = series(acc_m_s2, 3, "acc_m_s2"), series(gyro_rad_s, 3, "gyro_rad_s")
    gravity = number(gravity_m_s2, "gravity_m_s2")
    found = _multi_pose(acc, gyro, even_step(len(acc), rate_hz, time_s, dt_s), gravity, bool(gyro_turns))
    other = {"method": "gyro-turns" if gyro_turns else "multi-pose", "gravity_m_s2": gravity,
             "covariance": {"order": [f"acc_{name}" for name in ACC_PARAMETERS], "values": found["acc_covariance"]}}
    calibration = Calibration(tuple(found["acc_bias_m_s2"]), found["acc_matrix"], tuple(found["gyro_bias_rad_s"]),
                              found["gyro_matrix"], other)
    sigma = found.get("gyro_sigma")
    return MultiPoseResult(calibration, np.array(found["acc_sigma"]), found["residual_rms_m_s2"],
                           found["held_out_rms_m_s2"], found["poses_m_s2"], found["rows"], np.array(found["suggested_up"]),
                           None if sigma is None else np.array(sigma), found.get("turn_residual_rms_rad"))


@dataclass(frozen=True, eq=False)
class KnownTurnsResult:
    """A calibration from six faces and three known turns with its uncertainty. Biases and their errors are in the raw unit."""

    calibration: Calibration
    acc_bias_sigma: Floats
    """(3,)"""
    acc_matrix_sigma: Floats
    """(3, 3), unit of the matrix."""
    gyro_bias_sigma: Floats
    """(3,)"""
    gyro_matrix_sigma: Floats
    """(3, 3) standard errors from the noise; they do not know of faces and turns that are not true."""
    gyro_per_acceleration: Floats
    """(3, 3) raw gyro reading per m/s², column: axis of the acceleration."""


PARTS = ("+x", "+y", "+z", "-x", "-y", "-z", "turn x", "turn y", "turn z")
"""The nine parts of :func:`known_turns`: the axis that points up, then the axis turned about."""


def known_turns(*, acc_m_s2: Any, gyro_rad_s: Any, rate_hz: float | None = None, time_s: Any = None, dt_s: Any = None,
                turn_rad: float = 2 * np.pi, signed: bool = False, gravity_m_s2: float = 9.80665,
                parts: dict[str, tuple[int, int]] | None = None) -> KnownTurnsResult:
    """Bias and full matrix of both sensors from six faces and a turn of a known angle about each axis.

    acc_m_s2, gyro_rad_s: (N, 3); raw counts do as well, the result then turns counts into m/s² and rad/s. rate_hz,
    or time_s (N,) or dt_s without gaps. turn_rad: the angle of each turn; with ``signed`` right-handed about the axis, else its direction is taken from the reading. parts:
    first row and end row of each of :data:`PARTS`; without it they are found: a face is the longest rest on it, a turn
    lies between two rests on the same face. Faces and turns are taken as true. The GIL is released. Raises ShapeError,
    DomainError and ConditionError (a face or a turn is missing, faces mixed up).
    """
    acc, gyro = series(acc_m_s2, 3, "acc_m_s2"), series(gyro_rad_s, 3, "gyro_rad_s")
    if len(acc) != len(gyro):
        raise ShapeError(say(f"acc_m_s2 has {len(acc)} rows and gyro_rad_s {len(gyro)}",
                             f"acc_m_s2 は {len(acc)} 行、gyro_rad_s は {len(gyro)} 行です。同じ行数にしてください"))
    given = None
    if parts is not None:
        if not isinstance(parts, Mapping) or set(parts) != set(PARTS):
            raise ShapeError(say(f"parts must be a dict with the keys {', '.join(PARTS)}",
                                 f"parts には {'、'.join(PARTS)} のキーを持つ dict が必要です"))
        pairs = {name: vector(parts[name], 2, f"parts[{name!r}]") for name in PARTS}
        given = [(count(start, name, 0), count(end, name, 0)) for name, (start, end) in pairs.items()]
        if not all(0 <= start < end <= len(acc) for start, end in given):
            raise ShapeError(say(f"every part must be (start, end) with 0 ≤ start < end ≤ {len(acc)}",
                                 f"各部分は 0 ≤ start < end ≤ {len(acc)} の (start, end) でなければなりません"))
    gravity = number(gravity_m_s2, "gravity_m_s2")
    found = _known_turns(acc, gyro, even_step(len(acc), rate_hz, time_s, dt_s), number(turn_rad, "turn_rad"), bool(signed),
                         gravity, given)
    calibration = Calibration(tuple(found["acc_bias"]), found["acc_matrix"], tuple(found["gyro_bias"]),
                              found["gyro_matrix"], {"method": "gyro-turns", "gravity_m_s2": gravity})
    names = ("acc_bias_sigma", "acc_matrix_sigma", "gyro_bias_sigma", "gyro_matrix_sigma", "gyro_per_acceleration")
    return KnownTurnsResult(calibration, *(np.array(found[name]) for name in names))
