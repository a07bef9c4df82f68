"""Long measurements at rest: Allan deviation, spheres, the Earth's rotation."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from ._arrays import Floats, as_floats, even_step, number, say, series, steps
from ._native import DomainError, ShapeError
from ._native import allan_deviation as _allan
from ._native import earth_rate as _earth_rate
from ._native import fit_sphere as _fit_sphere
from ._native import mean_rate as _mean_rate


class Measured(NamedTuple):
    """A number with its standard error."""

    value: float
    sigma: float


def _measured(pair: Any) -> Measured | None:
    return None if pair is None else Measured(*pair)


@dataclass(frozen=True, eq=False)
class AllanDeviation:
    """The curve of one axis, K averaging times, and its noise. U is the unit of the readings."""

    tau_s: Floats
    """(K,) averaging times."""
    deviation: Floats
    """(K,) overlapping Allan deviation, U."""
    low: Floats
    """(K,) lower end of the 68 % interval, U."""
    high: Floats
    """(K,) its upper end, U."""
    degrees_of_freedom: Floats
    """(K,) equivalent degrees of freedom."""
    quantisation: Measured
    """U s; 0 where the data show none, as the three below."""
    random_walk: Measured
    """U √s: rad/√s for a gyroscope (angle random walk)."""
    bias_instability: Measured
    """U, from the fit."""
    rate_random_walk: Measured
    """U/√s."""
    floor: float
    """The curve's smallest deviation divided by √(2 ln 2/π), U: the bias instability as data sheets read it."""
    floor_tau_s: float
    floor_reached: bool
    """False where the recording is too short to show the curve rise again; then ``floor`` is an upper limit."""
    recommended_s: float
    """Averaging longer than this gains nothing that these data can show."""


def allan_deviation(data: Any, *, rate_hz: float | None = None, time_s: Any = None, dt_s: Any = None) -> AllanDeviation:
    """Overlapping Allan deviation of one axis at rest: how much averaging helps, and when it stops helping.

    data: (N,), 30 readings or more without gaps, in any unit. rate_hz, or time_s (N,), or dt_s. The GIL is released. Raises ShapeError
    (not one axis), DomainError (numbers that are not finite, step not positive, gaps) and ConditionError (too few
    readings, all alike). Noise coefficients are those of IEEE Std 952; intervals those of NIST SP 1065.
    """
    array = as_floats(data, "data")
    if array.ndim == 2 and array.shape[1] == 1:
        array = array[:, 0].copy()
    if array.ndim != 1:
        raise ShapeError(say(f"data has shape {array.shape} and must be (N,): one axis; give each axis by itself",
                             f"data の形は {array.shape} ですが、(N,) でなければなりません。軸を 1 つずつ指定してください"))
    found = _allan(array, even_step(len(array), rate_hz, time_s, dt_s))
    for name in ("quantisation", "random_walk", "bias_instability", "rate_random_walk"):
        found[name] = Measured(*found[name])
    return AllanDeviation(**found)


@dataclass(frozen=True)
class SphereFit:
    """The sphere nearest to points, in their unit."""

    center: tuple[float, float, float]
    radius: float
    residual_rms: float
    """Root mean square of |point − centre| − radius."""
    radius_sigma: float | None
    """Standard error of the radius; None for four points, which leave no residual."""
    condition: float
    """Condition number: above 100 the points lie nearly in one plane and the sphere says little."""
    plane_rms: float
    """Root mean square distance of the points from their best plane."""


def fit_sphere(points: Any) -> SphereFit:
    """The least-squares sphere (algebraic) through points (N, 3), four or more.

    Of mean rates in several directions its centre is the gyroscope's bias and its radius the Earth's rate. Raises
    ShapeError, DomainError (numbers that are not finite) and ConditionError (fewer than four points, or all in one
    plane).
    """
    center, *others = _fit_sphere(series(points, 3, "points"))
    return SphereFit(tuple(center), *others)


@dataclass(frozen=True, eq=False)
class MeanRate:
    """One recording at rest, averaged: a row for :func:`earth_rate`."""

    gyro_rad_s: Floats
    """(3,) mean weighted by time."""
    sigma_rad_s: Floats | None
    """(3,) its standard error, from the scatter of 20 blocks; None with fewer than 60 readings."""
    acc_m_s2: Floats | None
    """(3,) mean acceleration; None where none was given."""
    span_s: float
    long_steps: int
    """Steps longer than 1.5 median steps: gaps."""


def mean_rate(*, gyro_rad_s: Any, acc_m_s2: Any = None, rate_hz: float | None = None, time_s: Any = None,
              dt_s: Any = None, weights: Literal["capped", "as-measured"] = "capped") -> MeanRate:
    """The mean of a recording at rest in one direction, with its standard error.

    gyro_rad_s, acc_m_s2: (N, 3). rate_hz, time_s (N,) or dt_s. weights: what a step longer than 1.5 median steps counts:
    one median step, or its whole length as the published measurement has it. The GIL is released. Raises ShapeError
    or DomainError (numbers that are not finite, steps not positive).
    """
    if weights not in ("capped", "as-measured"):
        raise ValueError(say(f"weights is {weights!r}; it must be 'capped' or 'as-measured'",
                             f"weights が {weights!r} です。'capped' か 'as-measured' にしてください"))
    gyro = series(gyro_rad_s, 3, "gyro_rad_s")
    acc = None if acc_m_s2 is None else series(acc_m_s2, 3, "acc_m_s2")
    found = _mean_rate(gyro, acc, steps(len(gyro), rate_hz, time_s, dt_s), weights == "as-measured")
    for name in ("gyro_rad_s", "sigma_rad_s", "acc_m_s2"):
        found[name] = None if found[name] is None else np.array(found[name])
    return MeanRate(**found)


@dataclass(frozen=True, eq=False)
class EarthRate:
    """The Earth's rotation as a gyroscope saw it; None where the directions do not determine a number."""

    fit: Literal["sphere", "levelled", "circle"]
    """What the result stands on: a sphere, a fit levelled by the accelerations, or a circle in one plane."""
    rate_rad_s: Measured | None
    horizontal_rad_s: Measured | None
    """Its horizontal part: rate times the cosine of the latitude."""
    latitude_rad: Measured | None
    """As given, or found. From a circle alone north and south look alike."""
    sidereal_day_h: Measured | None
    gyro_bias_rad_s: tuple[float, float, float]
    heading_rad: Floats | None
    """(N, 2) heading of the sensor's x axis (y where x stands upright) clockwise from true north, and its error."""
    flat: bool
    """True where the directions lie in one plane to within their noise: a sphere through them is arbitrary."""
    condition: float
    """Condition number of the sphere; above 100 the directions count as flat."""
    flat_probability: float | None
    """Chance of such distances from the plane if the directions do lie in it; None without ``sigma_rad_s``."""


def earth_rate(*, gyro_rad_s: Any, sigma_rad_s: Any = None, acc_m_s2: Any = None,
               latitude_rad: float | None = None) -> EarthRate:
    """The Earth's rotation, the latitude and true north from mean rates in several directions.

    gyro_rad_s: (N, 3), one direction a row, three or more, sensor axes; averaged over minutes at rest each (:func:`mean_rate`). sigma_rad_s:
    (N, 3) their standard errors. acc_m_s2: (N, 3) mean accelerations, which say where up was. latitude_rad: of the place,
    north positive, where known. Raises ShapeError, DomainError (numbers that are not finite, errors below 0, latitude beyond ±π/2) and
    ConditionError (fewer than three directions, or all alike).
    """
    latitude = None if latitude_rad is None else number(latitude_rad, "latitude_rad")
    if latitude is not None and not abs(latitude) < np.pi / 2:
        raise DomainError(say(f"latitude_rad is {latitude_rad}; it must lie between -π/2 and π/2, as np.radians(35.7) does",
                              f"latitude_rad が {latitude_rad} です。np.radians(35.7) のように -π/2 から π/2 の間にしてください"))
    found = _earth_rate(series(gyro_rad_s, 3, "gyro_rad_s"),
                        None if sigma_rad_s is None else series(sigma_rad_s, 3, "sigma_rad_s"),
                        None if acc_m_s2 is None else series(acc_m_s2, 3, "acc_m_s2"), latitude)
    for name in ("rate_rad_s", "horizontal_rad_s", "latitude_rad", "sidereal_day_h"):
        found[name] = _measured(found[name])
    return EarthRate(**{**found, "gyro_bias_rad_s": tuple(found["gyro_bias_rad_s"])})
