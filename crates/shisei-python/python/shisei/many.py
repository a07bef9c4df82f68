"""Many recordings in one call."""
from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar, cast

from ._arrays import Floats, count
from ._native import run_mahony_many
from .filters import mahony, mahony_given

Found = TypeVar("Found")


def many(function: Callable[..., Found], recordings: Iterable[Mapping[str, Any]], *, threads: int | None = None,
         **common: Any) -> list[Found]:
    """Calls ``function(**recording, **common)`` for every recording, on several threads, and keeps their order.

    function: any of this package's, such as ``estimate``, ``orient`` or ``mahony``; they release the GIL while they
    work. recordings: the keyword arguments of each call. threads: as many as there are processors by default; every
    result has the same bits whatever their number. The first exception in the order of the recordings is raised.
    ``mahony`` takes eight recordings side by side on every thread, which is about three times as fast; each gets the
    bits that it gets alone.

    >>> shisei.many(shisei.estimate, [{"gyro_rad_s": g, "acc_m_s2": a} for g, a in trials], rate_hz=100)
    """
    side_by_side = os.cpu_count() or 1 if threads is None else count(threads, "threads", 1)
    recordings = list(recordings)
    if cast(Any, function) is mahony and len(recordings) > side_by_side:
        try:
            return cast(list[Found], _side_by_side([mahony_given(**r, **common) for r in recordings], side_by_side))
        except Exception:  # one by one, so that the first in order is raised
            pass
    with ThreadPoolExecutor(side_by_side) as pool:
        return list(pool.map(lambda recording: function(**recording, **common), recordings))


def _side_by_side(given: list[Any], threads: int) -> list[Floats]:
    """Every thread takes as many of the long and of the short recordings as the others, the longest first."""
    longest_first = sorted(range(len(given)), key=lambda k: -len(given[k][3]))
    shares = [longest_first[thread::threads] for thread in range(threads)]
    found: list[Floats] = [given[0][3]] * len(given)
    with ThreadPoolExecutor(threads) as pool:
        for share, results in zip(shares, pool.map(lambda share: run_mahony_many([given[k] for k in share]), shares)):
            for k, result in zip(share, results):
                found[k] = result
    return found
