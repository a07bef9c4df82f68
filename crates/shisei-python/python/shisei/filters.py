"""From readings to attitude and motion."""
from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Literal

from ._arrays import (
    Floats,
    axis,
    finite_vector,
    number,
    one_sample,
    quaternion,
    rest_rows,
    say,
    series,
    steps,
    warn_of_attitudes,
    warn_of_doubts,
)
from ._native import MahonyFilter, run_filter, ypr_rad
from ._native import dead_reckon as _dead_reckon
from ._native import orient as _orient

GRAVITY_M_S2 = 9.80665
Axis = Literal["+x", "-x", "+y", "-y", "+z", "-z"]
IDENTITY = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class AdaptiveGain:
    """kp as a function of |a|, m/s²: ``kp_max`` between the starts, falling to ``kp_min`` at the ends."""

    kp_max: float = 2.0
    kp_min: float = 0.05
    upper_start: float = 10.3
    upper_end: float = 14.7
    lower_start: float = 9.3
    lower_end: float = 4.9


def _numbers(gain: AdaptiveGain) -> list[float]:
    if not isinstance(gain, AdaptiveGain):
        raise TypeError(say("gain must be a shisei.AdaptiveGain, such as shisei.AdaptiveGain(kp_max=2)",
                            "gain には shisei.AdaptiveGain を指定してください (例: shisei.AdaptiveGain(kp_max=2))"))
    return [number(getattr(gain, f.name), f"gain.{f.name}") for f in fields(gain)]


def _run(kind: str, parameters: list[float], start: Any, gyro_rad_s: Any, acc_m_s2: Any, rate_hz: float | None,
         time_s: Any, dt_s: Any) -> Floats:
    gyro = series(gyro_rad_s, 3, "gyro_rad_s")
    acc = None if kind.startswith("gyro") else series(acc_m_s2, 3, "acc_m_s2")
    step = steps(len(gyro), rate_hz, time_s, dt_s)
    return run_filter(kind, parameters, quaternion(start, "start"), gyro, acc, step)


Given = tuple[list[float], float, float, Floats, Floats, float | Floats]


def mahony_given(*, gyro_rad_s: Any, acc_m_s2: Any, rate_hz: float | None = None, time_s: Any = None,
                 dt_s: Any = None, start: Any = IDENTITY, kp: float = 0.2, ki: float = 0.0) -> Given:
    """What :func:`mahony` is given, as the native side takes many of it."""
    gyro, acc = series(gyro_rad_s, 3, "gyro_rad_s"), series(acc_m_s2, 3, "acc_m_s2")
    step = steps(len(gyro), rate_hz, time_s, dt_s)
    return quaternion(start, "start"), number(kp, "kp"), number(ki, "ki"), gyro, acc, step


def mahony(*, gyro_rad_s: Any, acc_m_s2: Any, rate_hz: float | None = None, time_s: Any = None,
           dt_s: Any = None, start: Any = IDENTITY, kp: float = 0.2, ki: float = 0.0) -> Floats:
    """Mahony's filter. Returns (N, 4), ``world_from_body`` after each sample.

    gyro_rad_s, acc_m_s2: (N, 3) in sensor axes. rate_hz, or time_s (N,), or dt_s (one number or (N,)). start: attitude (4,) before the
    first sample. kp, 1/s: how fast tilt follows the accelerometer (1/kp is the time constant; 0.2 suits people's
    movements, larger values trust the accelerometer more). ki, 1/s²: how fast a gyro bias is learnt, 0 for not.
    """
    return _run("mahony", [number(kp, "kp"), number(ki, "ki")], start, gyro_rad_s, acc_m_s2, rate_hz, time_s, dt_s)


def mahony_adaptive(*, gyro_rad_s: Any, acc_m_s2: Any, rate_hz: float | None = None, time_s: Any = None,
                    dt_s: Any = None, start: Any = IDENTITY, gain: AdaptiveGain = AdaptiveGain(),
                    ki: float = 0.0, gravity_m_s2: float = GRAVITY_M_S2) -> Floats:
    """Mahony's filter with a gain that falls while |a| is far from gravity. Arguments as :func:`mahony`."""
    parameters = [*_numbers(gain), number(ki, "ki"), number(gravity_m_s2, "gravity_m_s2")]
    return _run("mahony-adaptive", parameters, start, gyro_rad_s, acc_m_s2, rate_hz, time_s, dt_s)


def complementary(*, gyro_rad_s: Any, acc_m_s2: Any, rate_hz: float | None = None, time_s: Any = None,
                  dt_s: Any = None, start: Any = IDENTITY, alpha: float = 0.98,
                  gravity_m_s2: float = GRAVITY_M_S2) -> Floats:
    """Complementary filter: ``alpha`` of the gyro, 1 − ``alpha`` of the accelerometer while 0.5 < |a|/g < 1.5.

    The time constant is about dt alpha / (1 − alpha). Other arguments and result as :func:`mahony`.
    """
    parameters = [number(alpha, "alpha"), number(gravity_m_s2, "gravity_m_s2")]
    return _run("complementary", parameters, start, gyro_rad_s, acc_m_s2, rate_hz, time_s, dt_s)


def integrate_gyro(*, gyro_rad_s: Any, rate_hz: float | None = None, time_s: Any = None, dt_s: Any = None,
                   start: Any = IDENTITY, method: Literal["exact", "rk4"] = "exact") -> Floats:
    """Integrates rates (N, 3), rad/s, alone. Returns (N, 4). ``exact`` holds each rate over its step."""
    if method not in ("exact", "rk4"):
        raise ValueError(say(f"method is {method!r}; it must be 'exact' or 'rk4'",
                             f"method が {method!r} です。'exact' か 'rk4' にしてください"))
    return _run("gyro" if method == "exact" else "gyro-rk4", [], start, gyro_rad_s, None, rate_hz, time_s, dt_s)


class Mahony:
    """Mahony's filter, one sample at a time; the same bits as :func:`mahony`. Threads may share one: they take turns."""

    def __init__(self, start: Any = IDENTITY, *, kp: float = 0.2, ki: float = 0.0) -> None:
        self._filter = MahonyFilter(quaternion(start, "start"), number(kp, "kp"), number(ki, "ki"))

    def update(self, gyro_rad_s: Any, acc_m_s2: Any, dt_s: float) -> tuple[float, float, float, float]:
        """One sample (3,), (3,) and the time since the one before, s. Returns w, x, y, z.

        A sample that is not finite leaves the attitude unchanged; a zero acceleration is a step by the gyro alone.
        """
        w, x, y, z = one_sample(self._filter.update, gyro_rad_s, acc_m_s2, dt_s)
        return w, x, y, z

    @property
    def world_from_body(self) -> tuple[float, float, float, float]:
        """The attitude now, w, x, y, z."""
        w, x, y, z = self._filter.world_from_body
        return w, x, y, z

    @property
    def gyro_bias_rad_s(self) -> tuple[float, float, float]:
        """The bias learnt so far (with ki > 0), rad/s in sensor axes."""
        x, y, z = self._filter.integral_rad_s
        return -x, -y, -z


_TAKES: dict[str, tuple[str, ...]] = {
    "shisei": (), "shisei-online": (), "mahony": ("kp", "ki"), "mahony-adaptive": ("ki", "gain"),
    "complementary": ("alpha",), "gyro": (), "gyro-rk4": (),
}
"""Filters and the settings that they take."""
Filter = Literal["shisei", "shisei-online", "mahony", "mahony-adaptive", "complementary", "gyro", "gyro-rk4"]


@dataclass(frozen=True, eq=False)
class Orientation:
    """Orientation of a recording."""

    world_from_body: Floats
    """(N, 4), w, x, y, z after each sample."""
    start: tuple[float, float, float, float]
    """Attitude at the rest."""
    rest: tuple[int, int] | None
    """Rows of the rest, the end excluded."""
    gyro_bias_rad_s: tuple[float, float, float]
    """The bias that was removed."""
    sigma_tilt_rad: Floats | None = None
    """(N,) standard deviation of the tilt; None with the classic filters."""
    sigma_heading_rad: Floats | None = None
    """(N,) standard deviation of the heading since the start; None with the classic filters."""

    def ypr_rad(self, relative: Literal["world", "body", "none"] = "world") -> Floats:
        """(N, 3) yaw, pitch, roll: of the turn since the start in world or sensor axes, or of the attitude itself."""
        if relative not in ("world", "body", "none"):
            raise ValueError(say(f"relative is {relative!r}; it must be 'world', 'body' or 'none'",
                                 f"relative が {relative!r} です。'world'、'body'、'none' のいずれかにしてください"))
        return ypr_rad(self.world_from_body, self.start, relative)


def orient(*, gyro_rad_s: Any, acc_m_s2: Any, rate_hz: float | None = None, time_s: Any = None,
           dt_s: Any = None, filter: Filter = "shisei",
           kp: float | None = None, ki: float | None = None, gain: AdaptiveGain | None = None,
           alpha: float | None = None, rest: Literal["auto"] | tuple[int, int] | None = "auto",
           forward: Axis | Any = None, gravity_m_s2: float = GRAVITY_M_S2) -> Orientation:
    """A whole recording, as ``shisei orient`` does it: finds the first rest, removes the gyro bias measured there,
    starts from its attitude.

    gyro_rad_s, acc_m_s2: (N, 3). rate_hz, or time_s (N,), or dt_s (one number or (N,)). filter: "shisei", the estimator's smoother (every attitude from the whole recording);
    "shisei-online", the estimator as it runs live; or one of the classic filters: "mahony" with kp (0.2) and ki (0),
    "mahony-adaptive" with gain and ki (0), "complementary" with alpha (0.98), "gyro", "gyro-rk4". rest: "auto", (first
    row, end row), or None to start at once with no bias removed; without a rest the estimator goes on, and the classic
    filters raise ConditionError. forward: the sensor axis that, laid flat at the start, shall point along world x:
    "+x" … "-z" or (3,). :func:`shisei.estimate` tells more and takes a calibration. With the arrays and ``dt_s`` of
    :func:`shisei.read_recording` the result has the bits of the command line.

    Readings in g or deg/s, values that no sensor gives, a start without a heading where no ``forward`` is given, and a
    gravity not of this Earth bring a UserWarning.
    """
    gyro, acc = series(gyro_rad_s, 3, "gyro_rad_s"), series(acc_m_s2, 3, "acc_m_s2")
    given = {"kp": kp, "ki": ki, "gain": gain, "alpha": alpha}
    if not isinstance(filter, str) or filter not in _TAKES:
        raise ValueError(say(f"filter is {filter!r}; it must be one of {', '.join(_TAKES)}",
                             f"filter が {filter!r} です。{'、'.join(_TAKES)} のいずれかにしてください"))
    for name, value in given.items():
        if value is not None and name not in _TAKES[filter]:
            raise ValueError(say(f"{name} has no meaning for filter {filter!r}; leave it out",
                                 f"{name} は filter {filter!r} では使えません。外してください"))
    gravity, integral = number(gravity_m_s2, "gravity_m_s2"), 0.0 if ki is None else number(ki, "ki")
    gain = AdaptiveGain() if gain is None else gain
    parameters = {"mahony": [0.2 if kp is None else number(kp, "kp"), integral],
                  "mahony-adaptive": [*_numbers(gain), integral, gravity],
                  "complementary": [0.98 if alpha is None else number(alpha, "alpha"), gravity]}.get(filter, [])
    rows, step = rest_rows(rest, len(gyro)), steps(len(gyro), rate_hz, time_s, dt_s)
    found = _orient(filter, parameters, gyro, acc, step, isinstance(rest, str), rows, axis(forward), gravity)
    warn_of_doubts(gyro, acc, step)
    warn_of_attitudes(found["start"], forward, gravity)
    return Orientation(found["world_from_body"], tuple(found["start"]), found["rest"], tuple(found["gyro_bias_rad_s"]),
                       found.get("sigma_tilt_rad"), found.get("sigma_heading_rad"))


@dataclass(frozen=True, eq=False)
class Motion:
    """Attitude, velocity and position in world axes after each sample."""

    world_from_body: Floats
    """(N, 4), w, x, y, z."""
    velocity_m_s: Floats
    """(N, 3)."""
    position_m: Floats
    """(N, 3), from the start."""


def dead_reckon(*, gyro_rad_s: Any, acc_m_s2: Any, start: Any, rate_hz: float | None = None, time_s: Any = None,
                dt_s: Any = None, gyro_bias_rad_s: Any = (0.0, 0.0, 0.0), gravity_m_s2: float = GRAVITY_M_S2,
                scheme: Literal["semi-implicit", "euler", "trapezoid"] = "trapezoid") -> Motion:
    """Velocity and position from rest. The error grows with the square of the time: metres after ten seconds.

    gyro_rad_s, acc_m_s2: (N, 3). rate_hz, or time_s (N,), or dt_s (one number or (N,)). start: attitude (4,) before the first sample. gravity_m_s2: mean |a| at rest of
    the same sensor.
    """
    if scheme not in ("semi-implicit", "euler", "trapezoid"):
        raise ValueError(say(f"scheme is {scheme!r}; it must be 'semi-implicit', 'euler' or 'trapezoid'",
                             f"scheme が {scheme!r} です。'semi-implicit'、'euler'、'trapezoid' のいずれかにしてください"))
    gyro, acc = series(gyro_rad_s, 3, "gyro_rad_s"), series(acc_m_s2, 3, "acc_m_s2")
    out = _dead_reckon(quaternion(start, "start"), gyro, acc, steps(len(gyro), rate_hz, time_s, dt_s),
                       finite_vector(gyro_bias_rad_s, 3, "gyro_bias_rad_s"), number(gravity_m_s2, "gravity_m_s2"), scheme)
    return Motion(out[:, :4], out[:, 4:7], out[:, 7:])
