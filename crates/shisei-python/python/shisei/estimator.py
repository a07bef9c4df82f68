"""The estimator: attitude with its uncertainty, of a recording or sample by sample."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._arrays import (
    Floats,
    axis,
    each_step,
    number,
    one_sample,
    rest_rows,
    say,
    series,
    steps,
    warn_of_attitudes,
    warn_of_doubts,
)
from ._native import EstimatorFilter, FixedLagFilter, ypr_rad
from ._native import estimate as _estimate
from .calibration import Calibration
from .filters import GRAVITY_M_S2, Axis

LEARNT_ORDER = [
    "gyro_bias_x", "gyro_bias_y", "gyro_bias_z", "acc_bias_x", "acc_bias_y", "acc_bias_z", "gyro_matrix_xx",
    "gyro_matrix_xy", "gyro_matrix_xz", "gyro_matrix_yx", "gyro_matrix_yy", "gyro_matrix_yz", "gyro_matrix_zx",
    "gyro_matrix_zy", "gyro_matrix_zz", "acc_scale_x", "acc_scale_y", "acc_scale_z",
]
"""Rows and columns of the covariance in a calibration that the estimator learnt."""


def _known(calibration: Calibration | None) -> str | None:
    """The text of its file."""
    if calibration is None:
        return None
    if not isinstance(calibration, Calibration):
        raise TypeError(say("calibration must be a shisei.Calibration; read a file with shisei.Calibration.load(path)",
                            "calibration には shisei.Calibration を指定してください。ファイルは shisei.Calibration.load(path) で読めます"))
    return calibration.text("calibration")


def _is_learnt(calibration: Calibration) -> bool:
    covariance = calibration.other.get("covariance")
    return covariance is not None and list(covariance["order"]) == LEARNT_ORDER


def _learnt(found: Any, before: Calibration | None, gravity_m_s2: float) -> Calibration:
    gyro_bias, gyro_matrix, acc_bias, acc_matrix, covariance = found
    if before is not None and not _is_learnt(before):  # it corrected the readings; what was learnt comes after it
        gyro_bias, gyro_matrix = _after(before.gyro_bias_rad_s, before.gyro_matrix, gyro_bias, gyro_matrix)
        acc_bias, acc_matrix = _after(before.acc_bias_m_s2, before.acc_matrix, acc_bias, acc_matrix)
    other = {"method": "estimator", "gravity_m_s2": gravity_m_s2,
             "covariance": {"order": LEARNT_ORDER, "values": covariance}}
    return Calibration(tuple(acc_bias), acc_matrix, tuple(gyro_bias), gyro_matrix, other)


def _after(first_bias: Any, first_matrix: Any, bias: Any, matrix: Any) -> tuple[list[float], list[list[float]]]:
    """``matrix (first_matrix (raw − first_bias) − bias)`` as one bias and matrix."""
    total = np.asarray(first_bias, float) + np.linalg.solve(np.asarray(first_matrix, float), np.asarray(bias, float))
    return total.tolist(), (np.asarray(matrix, float) @ np.asarray(first_matrix, float)).tolist()


@dataclass(frozen=True, eq=False)
class Estimate:
    """Attitude of a recording, and how sure it is. N rows, one a sample; standard deviations are 1 sigma."""

    q_wxyz: Floats
    """(N, 4) ``world_from_body``, w, x, y, z; yaw is 0 at the start, or as ``forward`` says."""
    ypr_rad: Floats
    """(N, 3) yaw, pitch, roll of ``q_wxyz`` (Z-Y-X intrinsic)."""
    sigma_tilt_rad: Floats
    """(N,) standard deviation of the tilt: the angle between the true and the stated vertical."""
    sigma_heading_rad: Floats
    """(N,) standard deviation of the heading since the start."""
    rest: NDArray[np.bool_]
    """(N,) True where the sensor is at rest."""
    gyro_bias_rad_s: Floats
    """(3,) gyroscope bias as learnt by the end, sensor axes."""
    start: tuple[float, float, float, float]
    """Attitude at the start: at the first rest, or at the first sample where there is none."""
    rest_rows: tuple[int, int] | None
    """Rows of the first rest, the end excluded; None when none was found or looked for."""
    calibration: Calibration
    """What was learnt of the sensor, to save or to give to the next :func:`estimate` as ``calibration``."""

    def relative_ypr_rad(self, relative: Literal["world", "body"] = "world") -> Floats:
        """(N, 3) yaw, pitch, roll of the turn since ``start``, in world axes or in the sensor's axes at the start."""
        if relative not in ("world", "body"):
            raise ValueError(say(f"relative is {relative!r}; it must be 'world' or 'body'",
                                 f"relative が {relative!r} です。'world' か 'body' にしてください"))
        return ypr_rad(self.q_wxyz, self.start, relative)


def estimate(*, acc_m_s2: Any, gyro_rad_s: Any, rate_hz: float | None = None, time_s: Any = None,
             dt_s: Any = None, online: bool = False, forward: Axis | Any = None,
             gravity_m_s2: float = GRAVITY_M_S2, rest: Literal["auto"] | tuple[int, int] | None = "auto",
             calibration: Calibration | None = None) -> Estimate:
    """Attitude of a whole recording by the estimator, which also says how sure it is.

    acc_m_s2, gyro_rad_s: (N, 3) in sensor axes, as measured or corrected. rate_hz, or time_s (N,) ascending, or dt_s
    (one number or (N,)); with the arrays and ``dt_s`` of :func:`read_recording` the result has the bits of the command
    line. online: False smooths (every attitude from the whole recording); True uses only the samples before each row, as
    :class:`Estimator` does live. forward: the sensor axis that, laid flat at the start, points along world x: "+x" …
    "-z" or (3,). gravity_m_s2: local gravity. rest: "auto" (the first rest; without one it goes on without),
    (first row, end row), or None. calibration: what is known of the sensor; give raw readings with it.

    The GIL is released. Raises ShapeError (wrong shapes, unequal lengths), DomainError (numbers that are not finite,
    steps or gravity not positive) and ConditionError (the forward axis is near the vertical, the given rest is too
    short). Readings in g or deg/s, values that no sensor gives, a start without a heading where no ``forward`` is given,
    and a gravity not of this Earth bring a UserWarning.
    """
    gyro, acc = series(gyro_rad_s, 3, "gyro_rad_s"), series(acc_m_s2, 3, "acc_m_s2")
    rows = rest_rows(rest, len(gyro))
    step = steps(len(gyro), rate_hz, time_s, dt_s)
    gravity = number(gravity_m_s2, "gravity_m_s2")
    found = _estimate(gyro, acc, step, bool(online), isinstance(rest, str), rows, axis(forward), gravity,
                      _known(calibration))
    if calibration is None:
        warn_of_doubts(gyro, acc, step)
    warn_of_attitudes(found["start"], forward, gravity)
    learnt = _learnt(found["learnt"], calibration, gravity)
    q = found["q_wxyz"]
    return Estimate(q, ypr_rad(q, found["start"], "none"), found["sigma_tilt_rad"], found["sigma_heading_rad"], found["rest"],
                    np.array(learnt.gyro_bias_rad_s), tuple(found["start"]), found["rest_rows"], learnt)


class EstimatorState(NamedTuple):
    """What is known after a sample."""

    q_wxyz: tuple[float, float, float, float]
    """``world_from_body``, w, x, y, z; yaw is 0 at the start."""
    rate_rad_s: tuple[float, float, float]
    """Rate without bias, scale and misalignment, sensor axes."""
    gyro_bias_rad_s: tuple[float, float, float]
    """Gyroscope bias, sensor axes; with a calibration, what is left of it."""
    sigma_tilt_rad: float
    """Standard deviation of the tilt."""
    sigma_heading_rad: float
    """Standard deviation of the heading since the start."""
    covariance_rad2: tuple[tuple[float, float, float], ...]
    """3×3 covariance of the attitude's error, world axes."""
    rest: bool
    """True while the sensor is at rest."""


class EstimatorStates(NamedTuple):
    """What is known after each of N samples: the fields of :class:`EstimatorState` but its covariance."""

    q_wxyz: Floats
    """(N, 4)"""
    rate_rad_s: Floats
    """(N, 3)"""
    gyro_bias_rad_s: Floats
    """(N, 3)"""
    sigma_tilt_rad: Floats
    """(N,)"""
    sigma_heading_rad: Floats
    """(N,)"""
    rest: NDArray[np.bool_]
    """(N,)"""


def _state(found: Any) -> EstimatorState:
    q, rate, bias, tilt, heading, covariance, rest = found
    return EstimatorState(tuple(q), tuple(rate), tuple(bias), tilt, heading, tuple(map(tuple, covariance)), rest)


class Estimator:
    """The estimator live: one sample in, one state out, in constant time and memory.

    gravity_m_s2: local gravity. calibration: what is known of the sensor; give raw readings with it. Raises DomainError
    where one of them is out of range. Threads may share one: each call takes its turn, a stretch as a whole.
    """

    def __init__(self, *, gravity_m_s2: float = GRAVITY_M_S2, calibration: Calibration | None = None) -> None:
        self._gravity = number(gravity_m_s2, "gravity_m_s2")
        self._filter = EstimatorFilter(self._gravity, _known(calibration))
        self._given = calibration

    def update(self, *, acc_m_s2: Any, gyro_rad_s: Any, dt_s: float) -> EstimatorState:
        """One sample: (3,) m/s², (3,) rad/s, and the time since the one before (of the first: the usual step), s.

        Never NaN and never an exception for what a sensor reads: readings that are not finite, too large or stuck are
        bridged while the stated uncertainty grows; a sample without a usable step leaves all as it is.
        """
        return _state(one_sample(self._filter.update, gyro_rad_s, acc_m_s2, dt_s))

    def update_all(self, *, acc_m_s2: Any, gyro_rad_s: Any, dt_s: Any) -> EstimatorStates:
        """A stretch of samples (N, 3), (N, 3); dt_s: one number or (N,). The same bits as one by one; the GIL is released.

        Raises ShapeError for wrong shapes or unequal lengths.
        """
        gyro, acc = series(gyro_rad_s, 3, "gyro_rad_s"), series(acc_m_s2, 3, "acc_m_s2")
        found = self._filter.update_all(gyro, acc, each_step(dt_s, len(gyro)))
        return EstimatorStates(*(found[name] for name in EstimatorStates._fields))

    @property
    def state(self) -> EstimatorState:
        """What is known now."""
        return _state(self._filter.state)

    @property
    def calibration(self) -> Calibration:
        """What has been learnt of the sensor by now, to save or to start from next time."""
        return _learnt(self._filter.learnt, self._given, self._gravity)


class FixedLag:
    """The estimator live with a delay: each state waits for the samples of the next ``lag_s``, 0 to 10 s, which say
    more about its tilt than those before it. Heading, rate and bias are those of :class:`Estimator`.

    States come out in order, one for each sample, in bunches of about 0.14 s. gravity_m_s2: local gravity.
    calibration: what is known of the sensor; give raw readings with it. Raises DomainError where one of them is out
    of range. Threads may share one, as an :class:`Estimator`.
    """

    def __init__(self, lag_s: float = 1.0, *, gravity_m_s2: float = GRAVITY_M_S2,
                 calibration: Calibration | None = None) -> None:
        lag, gravity = number(lag_s, "lag_s"), number(gravity_m_s2, "gravity_m_s2")
        self._filter = FixedLagFilter(lag, gravity, _known(calibration))

    def update(self, *, acc_m_s2: Any, gyro_rad_s: Any, dt_s: float) -> list[EstimatorState]:
        """One sample, as :meth:`Estimator.update`; gives the states that have now waited long enough, often none."""
        return [_state(found) for found in one_sample(self._filter.update, gyro_rad_s, acc_m_s2, dt_s)]

    def update_all(self, *, acc_m_s2: Any, gyro_rad_s: Any, dt_s: Any) -> EstimatorStates:
        """A stretch of samples (N, 3), (N, 3); dt_s: one number or (N,). Gives the states that have waited long
        enough by its end: the same bits as one by one; the GIL is released. Raises ShapeError for wrong shapes."""
        gyro, acc = series(gyro_rad_s, 3, "gyro_rad_s"), series(acc_m_s2, 3, "acc_m_s2")
        found = self._filter.update_all(gyro, acc, each_step(dt_s, len(gyro)))
        return EstimatorStates(*(found[name] for name in EstimatorStates._fields))

    def finish(self) -> EstimatorStates:
        """The states that still wait, at the end of the samples. After it every call raises ValueError."""
        found = self._filter.finish()
        return EstimatorStates(*(found[name] for name in EstimatorStates._fields))
