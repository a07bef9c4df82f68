"""Many recordings in one call."""
from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

Found = TypeVar("Found")


def many(function: Callable[..., Found], recordings: Iterable[Mapping[str, Any]], *, threads: int | None = None,
         **common: Any) -> list[Found]:
    """Calls ``function(**recording, **common)`` for every recording, on several threads, and keeps their order.

    function: any of this package's, such as ``estimate``, ``orient`` or ``mahony``; they release the GIL while they
    work. recordings: the keyword arguments of each call. threads: as many as there are processors by default; every
    result has the same bits whatever their number. The first exception in the order of the recordings is raised.

    >>> shisei.many(shisei.estimate, [{"gyro_rad_s": g, "acc_m_s2": a} for g, a in trials], rate_hz=100)
    """
    count = threads or os.cpu_count() or 1
    if count < 1:
        raise ValueError(f"threads is {threads}; it must be at least 1")
    with ThreadPoolExecutor(count) as pool:
        return list(pool.map(lambda recording: function(**recording, **common), recordings))
