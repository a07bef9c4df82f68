from collections.abc import Sequence
from typing import Any

from numpy import float64
from numpy.typing import NDArray

__version__: str

class ShapeError(ValueError): ...
class DomainError(ValueError): ...

class ConditionError(Exception):
    faces: Sequence[Any]
    """Of six_face: what was found of each face. Of all others: empty."""

def set_language(lang: str) -> None:
    """Language of the sentences of exceptions: "en" or "ja"."""

def language() -> str: ...
def functions() -> list[dict[str, Any]]: ...
def call(index: int, given: list[Any]) -> Any: ...
def run_filter(
    kind: str,
    parameters: list[float],
    start: list[float],
    gyro_rad_s: NDArray[float64],
    acc_m_s2: NDArray[float64] | None,
    dt_s: float | NDArray[float64],
) -> NDArray[float64]: ...
def run_mahony_many(
    recordings: list[
        tuple[list[float], float, float, NDArray[float64], NDArray[float64], float | NDArray[float64]]
    ],
) -> list[NDArray[float64]]: ...
def orient(
    kind: str,
    parameters: list[float],
    gyro_rad_s: NDArray[float64],
    acc_m_s2: NDArray[float64],
    dt_s: float | NDArray[float64],
    auto_rest: bool,
    rest_rows: tuple[int, int] | None,
    forward_axis_body: list[float] | None,
    gravity_m_s2: float,
) -> dict[str, Any]: ...
def normalize(q: NDArray[float64]) -> NDArray[float64]: ...
def to_ypr(q: NDArray[float64]) -> NDArray[float64]: ...
def from_ypr(ypr_rad: NDArray[float64]) -> NDArray[float64]: ...
def relative(q: NDArray[float64], start: list[float], in_body: bool) -> NDArray[float64]: ...
def from_axis_angle(axis: list[float], angle_rad: float) -> NDArray[float64]: ...
def initial_attitude(
    acc_m_s2: NDArray[float64], max_variance: float, norm_limits: tuple[float, float]
) -> NDArray[float64]: ...
def multiply(a: NDArray[float64], b: NDArray[float64]) -> NDArray[float64]: ...
def rotate(q: NDArray[float64], v: NDArray[float64]) -> NDArray[float64]: ...
def to_matrix(q: NDArray[float64]) -> NDArray[float64]: ...
def from_matrix(matrix: NDArray[float64]) -> NDArray[float64]: ...
def to_rotation_vector(q: NDArray[float64]) -> NDArray[float64]: ...
def slerp(a: list[float], b: list[float], t: list[float]) -> NDArray[float64]: ...
def ypr_rad(world_from_body: NDArray[float64], start: tuple[float, float, float, float], relative: str) -> NDArray[float64]: ...
def dead_reckon(
    start: list[float],
    gyro_rad_s: NDArray[float64],
    acc_m_s2: NDArray[float64],
    dt_s: float | NDArray[float64],
    gyro_bias_rad_s: list[float],
    gravity_m_s2: float,
    scheme: str,
) -> NDArray[float64]: ...
def six_face(
    acc_m_s2: NDArray[float64], gyro_rad_s: NDArray[float64], dt_s: float, settings: list[float]
) -> dict[str, Any]: ...
def check_calibration(name: str, text: bytes) -> None: ...
def doubts(acc_m_s2: NDArray[float64], gyro_rad_s: NDArray[float64], dt_s: float | NDArray[float64]) -> list[str]: ...
def doubts_of_attitudes(start: list[float], forward_said: bool, gravity_m_s2: float) -> list[str]: ...
def apply(raw: NDArray[float64], bias: list[float], matrix: Any) -> NDArray[float64]: ...

class MahonyFilter:
    def __init__(self, start: list[float], kp: float, ki: float) -> None: ...
    def update(self, gyro_rad_s: list[float], acc_m_s2: list[float], dt_s: float) -> list[float]: ...
    @property
    def world_from_body(self) -> list[float]: ...
    @property
    def integral_rad_s(self) -> list[float]: ...

def estimate(
    gyro_rad_s: NDArray[float64],
    acc_m_s2: NDArray[float64],
    dt_s: float | NDArray[float64],
    online: bool,
    auto_rest: bool,
    rest_rows: tuple[int, int] | None,
    forward_axis_body: list[float] | None,
    gravity_m_s2: float,
    calibration: str | None,
) -> dict[str, Any]: ...

class EstimatorFilter:
    def __init__(self, gravity_m_s2: float, calibration: str | None) -> None: ...
    def update(self, gyro_rad_s: list[float], acc_m_s2: list[float], dt_s: float) -> Any: ...
    def update_all(
        self, gyro_rad_s: NDArray[float64], acc_m_s2: NDArray[float64], dt_s: float | NDArray[float64]
    ) -> dict[str, Any]: ...
    @property
    def state(self) -> Any: ...
    @property
    def learnt(self) -> Any: ...

class FixedLagFilter:
    def __init__(self, lag_s: float, gravity_m_s2: float, calibration: str | None) -> None: ...
    def update(self, gyro_rad_s: list[float], acc_m_s2: list[float], dt_s: float) -> list[Any]: ...
    def update_all(
        self, gyro_rad_s: NDArray[float64], acc_m_s2: NDArray[float64], dt_s: float | NDArray[float64]
    ) -> dict[str, Any]: ...
    def finish(self) -> dict[str, Any]: ...

def allan_deviation(data: NDArray[float64], dt_s: float) -> dict[str, Any]: ...
def fit_sphere(points: NDArray[float64]) -> Any: ...
def earth_rate(
    gyro_rad_s: NDArray[float64],
    sigma_rad_s: NDArray[float64] | None,
    acc_m_s2: NDArray[float64] | None,
    latitude_rad: float | None,
) -> dict[str, Any]: ...
def navigate(
    on_foot: bool,
    gyro_rad_s: NDArray[float64],
    acc_m_s2: NDArray[float64],
    dt_s: float | NDArray[float64],
    gravity_m_s2: float,
    max_without_rest_s: float,
    max_hole_s: float,
    max_end_distance: float,
    end: tuple[list[float], float] | None,
) -> dict[str, Any]: ...
def multi_pose(
    acc_m_s2: NDArray[float64], gyro_rad_s: NDArray[float64], dt_s: float, gravity_m_s2: float, gyro_from_turns: bool
) -> dict[str, Any]: ...
def known_turns(
    acc: NDArray[float64],
    gyro: NDArray[float64],
    dt_s: float,
    turn_rad: float,
    signed: bool,
    gravity_m_s2: float,
    parts: list[tuple[int, int]] | None,
) -> dict[str, Any]: ...
def mean_rate(
    gyro_rad_s: NDArray[float64],
    acc_m_s2: NDArray[float64] | None,
    dt_s: float | NDArray[float64],
    as_measured: bool,
) -> dict[str, Any]: ...
def read_motive(content: bytes, name: str, body: str | None, frozen: int) -> dict[str, Any]: ...
def read_recording(
    files: list[tuple[str, bytes]],
    said: list[tuple[str, str]],
    rate_hz: float | None,
    sensor: str | None,
    skip_bad_rows: bool,
) -> dict[str, Any]: ...
def fuse(
    optical_s: NDArray[float64],
    position_m: NDArray[float64],
    q_wxyz: NDArray[float64],
    sensor_s: NDArray[float64],
    acc_m_s2: NDArray[float64],
    gyro_rad_s: NDArray[float64],
    axes: str,
    gravity_m_s2: float,
    near_s: float | None,
    markers_m: list[NDArray[float64]],
) -> dict[str, Any]: ...
