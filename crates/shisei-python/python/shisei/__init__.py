"""shisei: attitude, calibration and motion from accelerometer and gyroscope readings.

Conventions, everywhere:

- quaternions are Hamilton's, w, x, y, z, of unit norm; ``world_from_body`` turns sensor coordinates into world
  coordinates (``v_world = q v_body q*``);
- the world is right-handed with z up; a level accelerometer at rest reads (0, 0, +9.80665) m/s²;
- SI units: m/s², rad/s, s, rad. Yaw, pitch, roll are Z-Y-X intrinsic;
- a series has one sample a row, and row k of a result is the state after sample k.

Arrays may be NumPy arrays, nested lists, pandas or polars frames, or a list of columns. A C-contiguous float64
array is used as it stands, without a copy, and the GIL is released while the core works.

The worksheet functions are in :mod:`shisei.sheet`.
"""
from . import sheet
from ._native import ConditionError, DomainError, ShapeError, __version__, set_language
from .calibration import (
    Calibration,
    Face,
    KnownTurnsResult,
    MultiPoseResult,
    SixFaceResult,
    known_turns,
    multi_pose,
    six_face,
)
from .estimator import Estimate, Estimator, EstimatorState, EstimatorStates, FixedLag, estimate
from .filters import (
    AdaptiveGain,
    Mahony,
    Motion,
    Orientation,
    complementary,
    dead_reckon,
    integrate_gyro,
    mahony,
    mahony_adaptive,
    orient,
)
from .fusion import Fusion, Gap, ImuRecording, MarkerPlace, OpticalTake, Sync, fuse, read_motive, read_recording
from .many import many
from .measure import (
    AllanDeviation,
    EarthRate,
    MeanRate,
    Measured,
    SphereFit,
    allan_deviation,
    earth_rate,
    fit_sphere,
    mean_rate,
)
from .motion import Track, foot_motion, rest_to_rest
from .rotations import (
    conjugate,
    from_axis_angle,
    from_matrix,
    from_ypr,
    initial_attitude,
    multiply,
    normalize,
    relative,
    rotate,
    slerp,
    to_matrix,
    to_rotation_vector,
    to_ypr,
)

__all__ = [
    "AdaptiveGain", "AllanDeviation", "Calibration", "ConditionError", "DomainError", "EarthRate", "Estimate",
    "Estimator", "EstimatorState", "EstimatorStates", "Face", "FixedLag", "Fusion", "Gap", "ImuRecording", "KnownTurnsResult", "Mahony", "MarkerPlace", "MeanRate", "Measured",
    "Motion", "MultiPoseResult", "OpticalTake",
    "Orientation", "ShapeError", "SixFaceResult", "SphereFit", "Sync", "Track", "__version__", "allan_deviation",
    "complementary", "conjugate", "dead_reckon", "earth_rate", "estimate", "fit_sphere", "foot_motion",
    "from_axis_angle", "from_matrix", "from_ypr", "fuse", "initial_attitude", "integrate_gyro", "known_turns", "mahony", "mahony_adaptive", "many", "mean_rate", "multi_pose",
    "multiply", "normalize", "orient", "read_motive", "read_recording", "relative", "rest_to_rest", "rotate", "set_language", "sheet", "six_face",
    "slerp", "to_matrix", "to_rotation_vector", "to_ypr",
]
