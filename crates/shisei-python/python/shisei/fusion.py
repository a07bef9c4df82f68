"""A motion capture take without holes, with the help of a sensor on the same object."""
from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, Union

import numpy as np
from numpy.typing import NDArray

from ._arrays import Floats, as_floats, as_path, count, number, say, series, steps, text
from ._native import ShapeError
from ._native import fuse as _fuse
from ._native import read_motive as _read_motive
from ._native import read_recording as _read_recording
from .filters import GRAVITY_M_S2

Source = Literal["optical", "bridged", "inertial", "none"]
Path = Union[str, "os.PathLike[str]"]


@dataclass(frozen=True, eq=False)
class OpticalTake:
    """One body as the cameras saw it, N frames; NaN where it was lost."""

    time_s: Floats
    """(N,) ascending."""
    position_m: Floats
    """(N, 3)"""
    q_wxyz: Floats
    """(N, 4) world from body, w, x, y, z."""
    axes: Literal["y-up", "z-up"] = "y-up"
    """The world: Motive's is y-up unless it was changed."""
    frame: NDArray[np.int64] | None = None
    """(N,) frame numbers."""
    name: str = "body"
    markers_m: Mapping[str, Floats] = field(default_factory=dict)
    """By name, (N, 3) each: the body's own markers in the same world, NaN where one was not seen. Where the body is lost
    and one or more of them are seen, they hold its position."""


@dataclass(frozen=True, eq=False)
class ImuRecording:
    """What a sensor read, N samples, on its own clock. Times, accelerations and rates may be given by hand; the rest is
    there when :func:`read_recording` read it."""

    time_s: Floats
    """(N,) ascending."""
    acc_m_s2: Floats
    """(N, 3)"""
    gyro_rad_s: Floats
    """(N, 3)"""
    assumptions: tuple[str, ...] = ()
    """What the file did not say, a sentence each."""
    warnings: tuple[str, ...] = ()
    """What to know before trusting it, a sentence each."""
    dt_s: Floats | None = None
    """(N,) the time since the sample before, of the first the usual step: what ``orient``, ``estimate`` and the filters
    take as ``dt_s`` to give the bits of the command line."""
    rate_hz: float | None = None
    """One over the usual step, Hz: what ``six_face``, ``multi_pose`` and ``allan_deviation`` take."""


class Gap(NamedTuple):
    """A gap and how it was filled."""

    first: int
    """First lost row."""
    end: int
    """Row after the last lost one."""
    length_s: float
    source: Source
    """How it was filled; "none" where a frame of it has no pose."""
    sigma_rad: float
    """Largest expected errors (one standard deviation)."""
    sigma_m: float


class MarkerPlace(NamedTuple):
    """Where a marker sits on its body."""

    at_m: tuple[float, float, float]
    """Body axes."""
    sigma_m: float
    """Its standard error."""


@dataclass(frozen=True)
class Sync:
    """How the clocks and the mounting of the sensor were found."""

    offset_s: float
    """Sensor time at optical time 0."""
    sigma_offset_s: float
    skew: float
    """Sensor seconds in an optical second, less 1."""
    sigma_skew: float
    body_from_sensor: tuple[float, float, float, float]
    """w, x, y, z."""
    sigma_mounting_rad: tuple[float, float, float]
    explained: float
    """Share of the turns that a common motion explains, 0 … 1."""
    runner_up: float
    """The same for the next best offset: near ``explained`` where the motion repeats itself."""


@dataclass(frozen=True, eq=False)
class Fusion:
    """A pose in every frame, where it comes from, and how far to trust it. N rows, one a frame."""

    frame: NDArray[np.int64]
    time_s: Floats
    position_m: Floats
    """(N, 3) in the take's own world; NaN where the source is "none"."""
    q_wxyz: Floats
    """(N, 4) world from body."""
    source: NDArray[np.str_]
    """(N,) "optical": the cameras' pose, unchanged. "bridged": from the sensor, held at both ends of the gap. "inertial":
    trust the attitude, not the position. "none": neither."""
    gap_s: Floats
    """(N,) time since the cameras last saw the body or a marker that holds it."""
    sigma_rad: Floats
    """(N,) expected error of the attitude, one standard deviation."""
    sigma_m: Floats
    """(N,) expected error of the position."""
    gaps: list[Gap]
    sync: Sync
    lever_arm_m: tuple[float, float, float] | None
    """The sensor in body coordinates; None where there was too little unbroken motion to find it."""
    sigma_lever_arm_m: tuple[float, float, float] | None
    up: tuple[float, float, float]
    """Up in the take's world, as gravity shows it."""
    axes: Literal["y-up", "z-up"]
    name: str
    markers: dict[str, MarkerPlace | None]
    """Where the take's markers sit; None for one that was not seen with the body for long enough, or moves on it."""
    held: NDArray[np.bool_]
    """(N,) True where the body was lost and a marker holds its position."""

    def columns(self) -> dict[str, Any]:
        """The columns that ``shisei fuse`` writes, for a data frame: ``pandas.DataFrame(fusion.columns())``."""
        columns: dict[str, Any] = {"frame": self.frame, "time_s": self.time_s}
        columns.update({f"p_{axis}": self.position_m[:, k] for k, axis in enumerate("xyz")})
        columns.update({f"q_{axis}": self.q_wxyz[:, k] for k, axis in enumerate("wxyz")})
        columns.update(source=self.source, gap_s=self.gap_s, sigma_deg=np.degrees(self.sigma_rad),
                       sigma_mm=self.sigma_m * 1e3, axes=np.full(len(self.frame), self.axes))
        return columns


def _file(path: Path) -> tuple[str, bytes]:
    name = as_path(path)
    with open(name, "rb") as file:
        return name, file.read()


def read_motive(path: Path, *, body: str | None = None, frozen: int = 3) -> OpticalTake:
    """Reads one body of a take that Motive exported as CSV (versions 1.21 to 1.25).

    body: name of a rigid body, or SKELETON:BONE, where the take has several. frozen: a pose repeated bit for bit so
    often counts as lost; 0 leaves such poses alone. Raises OSError, and DomainError where the file is no take.
    """
    often = count(frozen, "frozen", 0)
    if body is not None:
        text(body, "body")
    name, content = _file(path)
    return OpticalTake(**_read_motive(content, name, body, often))


def read_recording(*paths: Path, units: str | None = None, columns: str | None = None, axes: str | None = None,
                   scale: str | None = None, rate_hz: float | None = None, sensor: str | None = None,
                   skip_bad_rows: bool = False) -> ImuRecording:
    """Reads an inertial recording of any dialect that the command line reads, or the accelerometer's and the
    gyroscope's files of one recording. :func:`orient` and :func:`estimate` of its arrays and its ``dt_s`` give the bits
    of the command line.

    What is not guessed right is said as on the command line: units "acc=g,gyr=deg/s"; columns "acc_x=Ax,acc_y=Ay,…";
    axes "x,-y,-z"; scale "acc=16384,gyr=131" (counts per g and per deg/s); rate_hz, with which the stamps are left
    aside; sensor, part of a sensor's name where the file has several; skip_bad_rows leaves out rows that cannot be
    read. Doubts bring a UserWarning. Raises OSError, and DomainError where it is no recording.
    """
    said = {"units": units, "columns": columns, "axes": axes, "scale": scale}
    given = {name: text(value, name) for name, value in said.items() if value is not None}
    return _recording(paths, given, rate_hz, None if sensor is None else text(sensor, "sensor"), bool(skip_bad_rows))


def _recording(paths: tuple[Path, ...], said: dict[str, str], rate_hz: float | None = None, sensor: str | None = None,
               skip_bad_rows: bool = False, level: int = 3) -> ImuRecording:
    """Warns so many calls up."""
    if not paths:
        raise TypeError(say("give the path of a recording, or the two paths of one",
                            "記録のファイル名を 1 つ (または対になる 2 つ) 指定してください"))
    if rate_hz is not None:
        steps(1, rate_hz, None)  # refuses what is no rate
        rate_hz = number(rate_hz, "rate_hz")
    found = _read_recording([_file(path) for path in paths], list(said.items()), rate_hz, sensor, skip_bad_rows)
    for sentence in found["warnings"]:
        warnings.warn(sentence, UserWarning, stacklevel=level)
    return ImuRecording(found["time_s"], found["acc_m_s2"], found["gyro_rad_s"], tuple(found["assumptions"]),
                        tuple(found["warnings"]), found["dt_s"], found["rate_hz"])


def _column(frame: Any, name: str) -> Any:
    try:
        return frame[name]
    except (KeyError, IndexError, TypeError, ValueError):
        raise ShapeError(say(f"the recording has no {name}", f"記録に {name} がありません")) from None


def _imu(imu: Any) -> ImuRecording:
    if isinstance(imu, (str, os.PathLike)):
        return _recording((imu,), {}, level=4)
    if isinstance(imu, ImuRecording):
        parts = (imu.time_s, imu.acc_m_s2, imu.gyro_rad_s)
    elif isinstance(imu, Mapping) and "acc_m_s2" in imu:
        parts = (_column(imu, "time_s"), imu["acc_m_s2"], _column(imu, "gyro_rad_s"))
    else:  # a data frame with the columns of a recording
        def three(name: str) -> Any:
            return np.column_stack([as_floats(_column(imu, f"{name}_{axis}"), name).ravel() for axis in "xyz"])

        parts = (_column(imu, "time_s"), three("acc"), three("gyr"))
    return ImuRecording(as_floats(parts[0], "time_s").ravel(), series(parts[1], 3, "acc_m_s2"),
                        series(parts[2], 3, "gyro_rad_s"))


def fuse(optical: OpticalTake | Path, imu: ImuRecording | Mapping[str, Any] | Path | Any, *, body: str | None = None,
         frozen: int = 3, gravity_m_s2: float = GRAVITY_M_S2, near_offset_s: float | None = None) -> Fusion:
    """Fills the gaps of a take from the recording of a sensor on the same object.

    optical: an :class:`OpticalTake`, or the path of Motive's CSV (then ``body`` and ``frozen`` as in
    :func:`read_motive`). imu: an :class:`ImuRecording`, a mapping or data frame (``time_s``, and ``acc_m_s2``,
    ``gyro_rad_s`` (N, 3), or ``acc_x`` … ``gyr_z``), or a path. Clock offset, clock skew, mounting and lever arm are
    found from the data; labelled markers that are seen while the body is lost hold its position; near_offset_s: the offset where it is known to 0.1 s, as from a common trigger. gravity_m_s2:
    local. The GIL is released. Raises OSError, ShapeError, DomainError (numbers that are not finite, times that do not
    ascend, files that are no takes) and ConditionError (no common motion, rotation about one axis only, too little).
    """
    if isinstance(optical, (str, os.PathLike)):
        optical = read_motive(optical, body=body, frozen=frozen)
    elif body is not None:
        raise TypeError(say("body is for a path; an OpticalTake is of one body",
                            "body はファイルを指定するときだけ使えます。OpticalTake は 1 つの剛体です"))
    if not isinstance(optical, OpticalTake):
        raise TypeError(say("optical must be a shisei.OpticalTake or the path of Motive's CSV",
                            "optical には shisei.OpticalTake か Motive の CSV のファイル名を指定してください"))
    if optical.axes not in ("y-up", "z-up"):
        raise ValueError(say(f"axes is {optical.axes!r}; it must be 'y-up' or 'z-up'",
                             f"axes が {optical.axes!r} です。'y-up' か 'z-up' にしてください"))
    markers = dict(optical.markers_m or {})
    gravity = number(gravity_m_s2, "gravity_m_s2")
    near = None if near_offset_s is None else number(near_offset_s, "near_offset_s")
    recording = _imu(imu)
    time_s = as_floats(optical.time_s, "time_s").ravel()
    if optical.frame is not None and np.shape(optical.frame) != time_s.shape:
        raise ShapeError(say(f"frame has shape {np.shape(optical.frame)} and time_s {time_s.shape}; give one a row",
                             f"frame の形が {np.shape(optical.frame)}、time_s の形が {time_s.shape} です。1 行に 1 つにしてください"))
    found = _fuse(time_s, series(optical.position_m, 3, "position_m"), series(optical.q_wxyz, 4, "q_wxyz"),
                  recording.time_s, recording.acc_m_s2, recording.gyro_rad_s, optical.axes, gravity, near,
                  [series(marker, 3, f"markers_m[{name!r}]") for name, marker in markers.items()])
    frame = np.arange(len(time_s), dtype=np.int64) if optical.frame is None else np.asarray(optical.frame, np.int64)
    sync: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in found["sync"].items()}
    return Fusion(frame=frame, time_s=time_s, position_m=found["position_m"], q_wxyz=found["q_wxyz"],
                  source=np.array(found["source"]), gap_s=found["gap_s"], sigma_rad=found["sigma_rad"],
                  sigma_m=found["sigma_m"], gaps=[Gap(*gap) for gap in found["gaps"]], sync=Sync(**sync),
                  lever_arm_m=_tuple(found["lever_arm_m"]), sigma_lever_arm_m=_tuple(found["sigma_lever_arm_m"]),
                  up=tuple(found["up"]), axes=optical.axes, name=optical.name,
                  markers={name: place and MarkerPlace(tuple(place[0]), place[1])
                           for name, place in zip(markers, found["places"])},
                  held=np.array(found["held"], dtype=bool))


def _tuple(values: Any) -> Any:
    return None if values is None else tuple(values)
