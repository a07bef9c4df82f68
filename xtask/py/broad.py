"""Turns BROAD trials (Parquet) into rows of 12 little-endian float64 that need no library to read.

python broad.py OUT_FOLDER FILE.parquet ...

Columns: time_s, acc x y z (m/s2), gyr x y z (rad/s), optical quaternion w x y z (NaN where lost), movement (0 or 1).
"""

import sys
from pathlib import Path

import polars as pl

COLUMNS = "time_s acc_x acc_y acc_z gyr_x gyr_y gyr_z opt_q_w opt_q_x opt_q_y opt_q_z movement".split()

out = Path(sys.argv[1])
for name in map(Path, sys.argv[2:]):
    table = pl.read_parquet(name).select(pl.col(COLUMNS).cast(pl.Float64).fill_null(float("nan")))
    partial = out / f"{name.stem}.tmp"
    table.to_numpy(order="c").astype("<f8").tofile(partial)
    partial.rename(out / f"{name.stem}.f64")
