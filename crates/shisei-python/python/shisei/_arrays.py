"""Anything array-like to C-contiguous float64, without a copy where it is that already."""
from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._native import DomainError, ShapeError

Floats = NDArray[np.float64]


def as_floats(value: Any, name: str) -> Floats:
    """A C-contiguous float64 array of any shape."""
    if isinstance(value, (list, tuple)) and value and all(hasattr(v, "to_numpy") for v in value):
        value = np.column_stack([v.to_numpy() for v in value])  # columns of a pandas or polars frame
    try:
        return np.ascontiguousarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ShapeError(f"{name}: every value must be a number ({error})") from None


def series(value: Any, columns: int, name: str) -> Floats:
    """(N, columns); one sample alone becomes one row."""
    array = as_floats(value, name)
    if array.ndim == 1:
        array = array.reshape(1, -1)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ShapeError(f"{name} has shape {array.shape} and must be (N, {columns}), one sample a row")
    return array


def vector(value: Any, length: int, name: str) -> list[float]:
    """`length` numbers in a row, a column or flat."""
    array = as_floats(value, name)
    if array.size != length or max(array.shape, default=0) != length:
        raise ShapeError(f"{name} has shape {array.shape} and must be ({length},)")
    return array.ravel().tolist()


def steps(rows: int, rate_hz: float | None, time_s: Any, dt_s: float | None = None) -> float | Floats:
    """The step from the one of `rate_hz`, `time_s` and `dt_s` that is given: one number or one a sample."""
    if sum(x is not None for x in (rate_hz, time_s, dt_s)) != 1:
        raise TypeError("give exactly one of rate_hz, time_s and dt_s")
    if dt_s is not None:
        return float(dt_s)
    if rate_hz is not None:
        if not rate_hz > 0:
            raise DomainError(f"rate_hz is {rate_hz}; it must be greater than 0")
        return 1.0 / float(rate_hz)
    time = as_floats(time_s, "time_s").ravel()
    if time.size != rows:
        raise ShapeError(f"time_s has {time.size} values and the readings have {rows} rows")
    if rows < 2:
        raise ShapeError("time_s needs at least two samples; give rate_hz for one")
    dt = np.empty(rows)
    np.subtract(time[1:], time[:-1], out=dt[1:])
    dt[0] = np.median(dt[1:])
    return dt
