"""Velocity and position with an error band: between rests, and walking with the sensor on a foot."""
from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import Floats, finite_vector, number, say, series, steps, warn_of_doubts
from ._native import DomainError
from ._native import navigate
from .filters import GRAVITY_M_S2


@dataclass(frozen=True, eq=False)
class Track:
    """Motion of a recording, N rows. World: z up, yaw 0 and position 0 at the first rest."""

    world_from_body: Floats
    """(N, 4), w, x, y, z."""
    velocity_m_s: Floats
    """(N, 3)."""
    position_m: Floats
    """(N, 3)."""
    sigma_position_m: Floats
    """(N, 3) standard deviation of the position along each axis."""
    rest: NDArray[np.bool_]
    """(N,) True where the sensor was taken to be at rest."""
    stance: NDArray[np.bool_]
    """(N,) True where the foot stood (:func:`foot_motion` only)."""
    longest_without_rest_s: float
    gyro_bias_rad_s: tuple[float, float, float]
    """At the end, sensor axes."""
    acc_bias_m_s2: tuple[float, float, float]
    """At the end, sensor axes."""
    holes: list[tuple[int, float]]
    """Holes in the samples that were bridged: the row after each and its length, s. The band is widened by them."""
    passed_over: int
    """Samples that are no readings (more than 2000 m/s² or 100 rad/s, or no acceleration at all)."""


def _positive(value: Any, name: str) -> float:
    """A number greater than 0, which may be infinite."""
    found = number(value, name)
    if not found > 0:
        raise DomainError(say(f"{name} is {found}; it must be greater than 0",
                              f"{name} が {found} です。0 より大きい値にしてください"))
    return found


def _track(on_foot: bool, gyro_rad_s: Any, acc_m_s2: Any, rate_hz: float | None, time_s: Any, dt_s: Any,
           gravity_m_s2: float, max_without_rest_s: float, max_hole_s: float, max_end_distance: float, end_m: Any,
           end_sigma_m: float) -> Track:
    gyro, acc = series(gyro_rad_s, 3, "gyro_rad_s"), series(acc_m_s2, 3, "acc_m_s2")
    end = None
    if end_m is not None:
        end = finite_vector(end_m, 3, "end_m"), _positive(end_sigma_m, "end_sigma_m")
        if end[1] == np.inf:
            raise DomainError(say("end_sigma_m is inf; leave end_m out where the end is not known",
                                  "end_sigma_m が inf です。終点が不明なら end_m を省いてください"))
    limits = (_positive(max_without_rest_s, "max_without_rest_s"), _positive(max_hole_s, "max_hole_s"),
              _positive(max_end_distance, "max_end_distance"))
    gravity, step = number(gravity_m_s2, "gravity_m_s2"), steps(len(gyro), rate_hz, time_s, dt_s)
    found = navigate(on_foot, gyro, acc, step, gravity, *limits, end)
    warn_of_doubts(gyro, acc, step, level=4)
    doubtful = found.pop("doubtful_end")
    if doubtful is not None:
        off, sigma, distance = doubtful
        warnings.warn(say(f"end_m is {off:.3f} m from where the readings lead to within {sigma:.3f} m ({distance:.1f} "
                          "standard deviations): one of the two is wrong; end_m was believed",
                          f"end_m は、計測値から求めた終点 (標準偏差 {sigma:.3f} m) から {off:.3f} m (標準偏差の {distance:.1f} 倍) "
                          "離れています。どちらかが誤りです。計算では end_m を採用しました"), UserWarning, stacklevel=3)
    for name in ("gyro_bias_rad_s", "acc_bias_m_s2"):
        found[name] = tuple(found[name])
    return Track(**found)


def rest_to_rest(*, acc_m_s2: Any, gyro_rad_s: Any, rate_hz: float | None = None, time_s: Any = None,
                 dt_s: Any = None, gravity_m_s2: float = GRAVITY_M_S2, max_without_rest_s: float = 20.0,
                 max_hole_s: float = 0.5, max_end_distance: float = 10.0, end_m: Any = None,
                 end_sigma_m: float = 0.005) -> Track:
    """Velocity and position of a movement that begins (and, for a good result, ends) at rest.

    acc_m_s2, gyro_rad_s: (N, 3) in sensor axes. rate_hz, or time_s (N,), or dt_s (one number or (N,)). Rests are found; at each the tilt and
    the biases are taken anew, the velocity is zero, and what did not fit is distributed over the movement before.
    end_m: (3,) where the sensor ends, if known ((0, 0, 0): where it began), to within end_sigma_m. max_without_rest_s:
    longer movements are refused, for their error grows with the cube of the time; max_hole_s: longer holes in the
    samples are, shorter ones widen the band; max_end_distance: an end_m further from where the readings lead than this
    many standard deviations is. ``math.inf`` insists.

    The GIL is released. Raises ShapeError, DomainError (numbers that are not finite, steps or limits not positive) and
    ConditionError (no rest, too long without one, a hole too long, an end that contradicts the readings). A UserWarning
    says that an end is unlikely, or what is odd about the readings.
    """
    return _track(False, gyro_rad_s, acc_m_s2, rate_hz, time_s, dt_s, gravity_m_s2, max_without_rest_s, max_hole_s,
                  max_end_distance, end_m, end_sigma_m)


def foot_motion(*, acc_m_s2: Any, gyro_rad_s: Any, rate_hz: float | None = None, time_s: Any = None,
                dt_s: Any = None, gravity_m_s2: float = GRAVITY_M_S2, max_without_rest_s: float = 5.0,
                max_hole_s: float = 0.15, max_end_distance: float = 10.0, end_m: Any = None,
                end_sigma_m: float = 0.005) -> Track:
    """Velocity and position of a walk with the sensor on a foot: at every step it stands for a moment.

    100 Hz or more, beginning with the foot at rest for half a second. Arguments, result and exceptions as
    :func:`rest_to_rest`; max_without_rest_s counts from stance to stance.
    """
    return _track(True, gyro_rad_s, acc_m_s2, rate_hz, time_s, dt_s, gravity_m_s2, max_without_rest_s, max_hole_s,
                  max_end_distance, end_m, end_sigma_m)
