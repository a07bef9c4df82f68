"""Anything array-like to C-contiguous float64, without a copy where it is that already."""
from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ._native import DomainError, ShapeError, doubts, language

Floats = NDArray[np.float64]
Found = TypeVar("Found")


def say(en: str, ja: str) -> str:
    """The sentence of the language in use."""
    return ja if language() == "ja" else en


def as_floats(value: Any, name: str) -> Floats:
    """A C-contiguous float64 array of any shape. What is masked or missing becomes NaN."""
    if isinstance(value, (list, tuple)) and value and all(hasattr(v, "to_numpy") for v in value):
        value = np.column_stack([v.to_numpy() for v in value])  # columns of a pandas or polars frame
    if isinstance(value, np.ma.MaskedArray):
        value = np.ma.filled(value.astype(np.float64), np.nan)
    elif type(value).__module__.startswith("pandas") and hasattr(value, "to_numpy") and hasattr(value, "dtypes"):
        value = _of_pandas(value)
    try:
        array = np.asarray(value)
        if array.dtype.kind in "cmM":
            raise TypeError(array.dtype)
        return np.ascontiguousarray(array, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ShapeError(say(f"{name}: every value must be a real number ({error})",
                             f"{name}: すべての値が実数でなければなりません ({error})")) from None


def _of_pandas(value: Any) -> Any:
    try:
        return value.to_numpy(dtype=np.float64, na_value=np.nan)
    except (TypeError, ValueError):
        return value


def number(value: Any, name: str) -> float:
    """One real number."""
    array = as_floats(value, name)
    if array.size != 1:
        raise ShapeError(say(f"{name} has shape {array.shape} and must be one number",
                             f"{name} の形は {array.shape} ですが、数値 1 つでなければなりません"))
    return float(array.reshape(()))


def series(value: Any, columns: int, name: str) -> Floats:
    """(N, columns); one sample alone becomes one row."""
    if value is None:
        raise ShapeError(say(f"{name} is None and must be (N, {columns}), one sample a row",
                             f"{name} が None です。(N, {columns}) の配列 (1 行に 1 サンプル) を指定してください"))
    array = as_floats(value, name)
    if array.ndim == 1:
        array = array.reshape(1, -1)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ShapeError(say(
            f"{name} has shape {array.shape} and must be (N, {columns}), one sample a row",
            f"{name} の形は {array.shape} ですが、(N, {columns}) (1 行に 1 サンプル) でなければなりません"))
    return array


def vector(value: Any, length: int, name: str) -> list[float]:
    """`length` numbers in a row, a column or flat."""
    array = as_floats(value, name)
    if array.ndim == 0 or array.size != length or max(array.shape, default=0) != length:
        raise ShapeError(say(f"{name} has shape {array.shape} and must be ({length},)",
                             f"{name} の形は {array.shape} ですが、({length},) でなければなりません"))
    return array.ravel().tolist()


def seconds(time_s: Any) -> Floats:
    """Time stamps in seconds; dates and times count from the first."""
    if getattr(getattr(time_s, "dtype", None), "tz", None) is not None:
        time_s = time_s.to_numpy(dtype="datetime64[ns]")  # pandas, with a time zone
    elif hasattr(time_s, "to_numpy"):
        time_s = time_s.to_numpy()
    array = np.asarray(time_s)
    if array.dtype.kind == "O" and array.size and all(hasattr(t, "timestamp") for t in array.ravel()):
        first = array.ravel()[0]  # Python's own dates
        array = np.array([(t - first).total_seconds() for t in array.ravel()])
    if array.dtype.kind == "M":
        array = array - array.ravel()[:1]
    if array.dtype.kind == "m":
        return np.ascontiguousarray(array.ravel() / np.timedelta64(1, "ns") / 1e9)
    return as_floats(array, "time_s").ravel()


def each_step(dt_s: Any) -> float | Floats:
    """One number, or one a sample."""
    if np.ndim(dt_s) == 0:
        return number(dt_s, "dt_s")
    array = as_floats(dt_s, "dt_s")
    if array.size != max(array.shape):
        raise ShapeError(say(f"dt_s has shape {array.shape} and must be one number or (N,)",
                             f"dt_s の形は {array.shape} ですが、数値 1 つまたは (N,) でなければなりません"))
    return array.ravel()


def one_sample(update: Callable[[list[float], list[float], float], Found], gyro_rad_s: Any, acc_m_s2: Any,
               dt_s: Any) -> Found:
    """What ``update`` gives for one sample, in whatever shape its six numbers come."""
    try:
        return update(list(gyro_rad_s), list(acc_m_s2), dt_s)
    except (TypeError, ValueError):  # the usual way is the fast one
        return update(vector(gyro_rad_s, 3, "gyro_rad_s"), vector(acc_m_s2, 3, "acc_m_s2"), number(dt_s, "dt_s"))


def steps(rows: int, rate_hz: float | None, time_s: Any, dt_s: float | None = None) -> float | Floats:
    """The step from the one of `rate_hz`, `time_s` and `dt_s` that is given: one number or one a sample."""
    if sum(x is not None for x in (rate_hz, time_s, dt_s)) != 1:
        raise TypeError(say("give exactly one of rate_hz, time_s and dt_s",
                            "rate_hz、time_s、dt_s のうち 1 つだけを指定してください"))
    if dt_s is not None:
        return number(dt_s, "dt_s")
    if rate_hz is not None:
        rate = number(rate_hz, "rate_hz")
        if not 0 < rate < np.inf:
            raise DomainError(say(f"rate_hz is {rate_hz}; it must be a finite number greater than 0",
                                  f"rate_hz が {rate_hz} です。0 より大きい有限の数値にしてください"))
        return 1.0 / rate
    time = seconds(time_s)
    if time.size != rows:
        raise ShapeError(say(f"time_s has {time.size} values and the readings have {rows} rows",
                             f"time_s は {time.size} 個、計測値は {rows} 行です。同じ数にしてください"))
    if rows < 2:
        raise ShapeError(say("time_s needs at least two samples; give rate_hz for one",
                             "time_s には 2 サンプル以上が必要です。1 サンプルなら rate_hz を指定してください"))
    dt = np.empty(rows)
    np.subtract(time[1:], time[:-1], out=dt[1:])
    if not (dt[1:] > 0).all():
        row = int(np.flatnonzero(~(dt[1:] > 0))[0]) + 1
        raise DomainError(say(f"time_s must rise from row to row; row {row + 1} is {time[row]} after {time[row - 1]}",
                              f"time_s は行ごとに増えなければなりません。{row + 1} 行目は {time[row - 1]} の次が {time[row]} です"))
    dt[0] = np.median(dt[1:])
    return dt


def rest_rows(rest: Any, rows: int) -> tuple[int, int] | None:
    """Rows of the rest as given, the end excluded; None for "auto" and None."""
    if rest is None or isinstance(rest, str) and rest == "auto":
        return None
    try:
        start, end = (int(row) for row in rest)
    except (TypeError, ValueError):
        raise ValueError(say(f"rest is {rest!r}; it must be 'auto', None or (first row, end row)",
                             f"rest が {rest!r} です。'auto'、None、(最初の行, 終わりの行) のいずれかにしてください")) from None
    if not 0 <= start < end <= rows:
        raise DomainError(say(f"rest is ({start}, {end}) and the recording has rows 0 to {rows}",
                              f"rest が ({start}, {end}) ですが、記録の行は 0 から {rows} までです"))
    return start, end


def axis(forward: Any, name: str) -> list[float] | None:
    """A sensor axis: '+x' … '-z' (the plus may be left out), three numbers, or None."""
    if forward is None:
        return None
    if not isinstance(forward, str):
        return vector(forward, 3, name)
    letter = forward[-1:]
    if letter not in ("x", "y", "z") or forward[:-1] not in ("", "+", "-"):
        raise ValueError(say(f"{name} is {forward!r}; it must be '+x', '-x', '+y', '-y', '+z', '-z' or three numbers",
                             f"{name} が {forward!r} です。'+x'、'-x'、'+y'、'-y'、'+z'、'-z' または 3 つの数値にしてください"))
    sign = -1.0 if forward[:-1] == "-" else 1.0
    return [sign if letter == at else 0.0 for at in "xyz"]


def warn_of_doubts(gyro_rad_s: Floats, acc_m_s2: Floats, step: float | Floats) -> None:
    """A UserWarning for every doubt about units and readings, at the caller of the caller."""
    for sentence in doubts(acc_m_s2, gyro_rad_s, step):
        warnings.warn(sentence, UserWarning, stacklevel=3)
