"""Anything array-like to C-contiguous float64, without a copy where it is that already."""
from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ._native import DomainError, ShapeError, doubts, doubts_of_attitudes, language

Floats = NDArray[np.float64]
Found = TypeVar("Found")


def say(en: str, ja: str) -> str:
    """The sentence of the language in use."""
    return ja if language() == "ja" else en


def as_floats(value: Any, name: str) -> Floats:
    """A C-contiguous float64 array of any shape. What is masked or missing becomes NaN."""
    if isinstance(value, (list, tuple)) and value and all(hasattr(v, "to_numpy") for v in value):
        value = np.column_stack([v.to_numpy() for v in value])  # columns of a pandas or polars frame
    if isinstance(value, (list, tuple)) and any(isinstance(v, np.ma.MaskedArray) for v in value):
        value = [np.ma.filled(np.ma.asarray(v).astype(np.float64), np.nan) for v in value]
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
    """One real number, which may be NaN or infinite."""
    if value is None or isinstance(value, (str, bytes)):
        raise ShapeError(say(f"{name} is {value!r} and must be one number",
                             f"{name} が {value!r} です。数値 1 つでなければなりません"))
    array = as_floats(value, name)
    if array.size != 1:
        raise ShapeError(say(f"{name} has shape {array.shape} and must be one number",
                             f"{name} の形は {array.shape} ですが、数値 1 つでなければなりません"))
    return float(array.reshape(()))


def count(value: Any, name: str, least: int) -> int:
    """A whole number of at least so many."""
    found = number(value, name)
    if not (found >= least and found == round(found) < 2**31):
        raise DomainError(say(f"{name} is {value}; it must be a whole number, {least} or more",
                              f"{name} が {value} です。{least} 以上の整数にしてください"))
    return round(found)


def text(value: Any, name: str) -> str:
    """A text."""
    if not isinstance(value, str):
        raise TypeError(say(f"{name} is {value!r} and must be a text", f"{name} が {value!r} です。文字列で指定してください"))
    return value


def as_path(value: Any) -> str:
    """A file's name."""
    if not isinstance(value, (str, bytes, os.PathLike)):
        raise TypeError(say(f"{value!r} is no path; give each file by its name",
                            f"{value!r} はファイル名ではありません。ファイルを 1 つずつ名前で指定してください"))
    return os.fsdecode(value)


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


def finite_vector(value: Any, length: int, name: str) -> list[float]:
    """`length` finite numbers."""
    found = vector(value, length, name)
    if not np.isfinite(found).all():
        raise DomainError(say(f"{name} is {found}; every number must be finite",
                              f"{name} が {found} です。すべて有限の数値にしてください"))
    return found


def quaternion(value: Any, name: str) -> list[float]:
    """w, x, y, z of a rotation, of any norm but zero."""
    found = finite_vector(value, 4, name)
    if not any(found):
        raise DomainError(say(f"{name} is zero and has no direction; give w, x, y, z of a rotation",
                              f"{name} がゼロで、向きが決まりません。回転を表す w, x, y, z を指定してください"))
    return found


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
        if np.datetime_data(array.dtype)[0] in ("Y", "M"):
            array = array.astype("datetime64[s]")
        array = array - array.ravel()[:1]
    if array.dtype.kind == "m":
        if np.datetime_data(array.dtype)[0] in ("Y", "M", "generic"):
            raise ShapeError(say("time_s counts in years, months or nothing; give seconds, or dates",
                                 "time_s の単位が年、月、またはなしです。秒または日時で指定してください"))
        return np.ascontiguousarray(array.ravel() / np.timedelta64(1, "ns") / 1e9)
    return as_floats(array, "time_s").ravel()


def each_step(dt_s: Any, rows: int) -> float | Floats:
    """One number, or one for each of so many samples."""
    if dt_s is None or np.ndim(dt_s) == 0:
        return number(dt_s, "dt_s")
    array = as_floats(dt_s, "dt_s")
    if array.size == 1:
        return float(array.reshape(()))
    if array.size != rows or array.size != max(array.shape):
        raise ShapeError(say(f"dt_s has shape {array.shape} and must be one number or ({rows},), one a sample",
                             f"dt_s の形は {array.shape} ですが、数値 1 つまたは ({rows},) (1 サンプルに 1 つ) でなければなりません"))
    return array.ravel()


def one_sample(update: Callable[[list[float], list[float], float], Found], gyro_rad_s: Any, acc_m_s2: Any,
               dt_s: Any) -> Found:
    """What ``update`` gives for one sample, in whatever shape its six numbers come."""
    try:
        return update(list(gyro_rad_s), list(acc_m_s2), dt_s)
    except (TypeError, ValueError):  # the usual way is the fast one
        return update(vector(gyro_rad_s, 3, "gyro_rad_s"), vector(acc_m_s2, 3, "acc_m_s2"), number(dt_s, "dt_s"))


def steps(rows: int, rate_hz: float | None, time_s: Any, dt_s: Any = None) -> float | Floats:
    """The step from the one of `rate_hz`, `time_s` and `dt_s` that is given: one number or one a sample."""
    if sum(x is not None for x in (rate_hz, time_s, dt_s)) != 1:
        raise TypeError(say("give exactly one of rate_hz, time_s and dt_s",
                            "rate_hz、time_s、dt_s のうち 1 つだけを指定してください"))
    if dt_s is not None:
        step = each_step(dt_s, rows)
        usable = (step > 0) & (step < np.inf)
        if not np.all(usable):
            row = int(np.flatnonzero(~np.atleast_1d(usable))[0])
            value = np.atleast_1d(step)[row]
            raise DomainError(say(f"dt_s must be finite and greater than 0; row {row + 1} is {value}",
                                  f"dt_s は 0 より大きい有限の数値でなければなりません。{row + 1} 行目が {value} です"))
        return step
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
    rising = (dt[1:] > 0) & (dt[1:] < np.inf)
    if not rising.all():
        row = int(np.flatnonzero(~rising)[0]) + 1
        raise DomainError(say(f"time_s must rise from row to row; row {row + 1} is {time[row]} after {time[row - 1]}",
                              f"time_s は行ごとに増えなければなりません。{row + 1} 行目は {time[row - 1]} の次が {time[row]} です"))
    dt[0] = np.median(dt[1:])
    return dt


def even_step(rows: int, rate_hz: float | None, time_s: Any, dt_s: Any) -> float:
    """The one step of readings that are taken evenly: of stamps the mean, where none is missing."""
    step = steps(rows, rate_hz, time_s, dt_s)
    if isinstance(step, float):
        return step
    usual = float(np.median(step))
    long = np.flatnonzero(step > 1.5 * usual)
    if long.size:
        row = int(long[0])
        raise DomainError(say(
            f"row {row + 1} is {step[row]:.6g} s after the one before, where the usual step is {usual:.6g} s; this needs "
            "readings without gaps",
            f"{row + 1} 行目の時間間隔が {step[row]:.6g} 秒です (通常は {usual:.6g} 秒)。欠落のない記録が必要です"))
    return float(np.mean(step[1:]))


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


def axis(forward: Any) -> list[float] | None:
    """A sensor axis: '+x' … '-z' (the plus may be left out), three numbers, or None."""
    if forward is None:
        return None
    if not isinstance(forward, str):
        return finite_vector(forward, 3, "forward")
    letter = forward[-1:]
    if letter not in ("x", "y", "z") or forward[:-1] not in ("", "+", "-"):
        raise ValueError(say(f"forward is {forward!r}; it must be '+x', '-x', '+y', '-y', '+z', '-z' or three numbers",
                             f"forward が {forward!r} です。'+x'、'-x'、'+y'、'-y'、'+z'、'-z' または 3 つの数値にしてください"))
    sign = -1.0 if forward[:-1] == "-" else 1.0
    return [sign if letter == at else 0.0 for at in "xyz"]


def warn_of_doubts(gyro_rad_s: Floats, acc_m_s2: Floats, step: float | Floats, level: int = 3) -> None:
    """A UserWarning for every doubt about units and readings, at the caller of the caller or `level` calls up."""
    for sentence in doubts(acc_m_s2, gyro_rad_s, step):
        warnings.warn(sentence, UserWarning, stacklevel=level)


def warn_of_attitudes(start: Any, forward: Any, gravity_m_s2: float) -> None:
    """The same about where the attitudes start, and the gravity."""
    for sentence in doubts_of_attitudes(start, forward is not None, gravity_m_s2):
        warnings.warn(sentence, UserWarning, stacklevel=3)
