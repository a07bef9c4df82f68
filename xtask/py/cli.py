"""A big CSV to orientation and back to CSV: `shisei orient` beside polars + vqf. Called by `cargo xtask bench cli`.

Usage: cli.py SHISEI FOLDER ROWS RUNS. Prints seconds (median) and peak memory of whole processes, run in turn.
"""

import multiprocessing
import os
import statistics
import subprocess
import sys
import time

import numpy

PEER = """
import sys, numpy, polars, vqf
table = polars.read_csv(sys.argv[1])
columns = [table[name].to_numpy() for name in table.columns]
acc = numpy.ascontiguousarray(numpy.stack(columns[1:4], axis=1))
gyr = numpy.ascontiguousarray(numpy.stack(columns[4:7], axis=1))
dt = 0.01
{estimate}
w, x, y, z = q.T
yaw = numpy.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
pitch = numpy.arcsin(numpy.clip(2 * (w * y - z * x), -1, 1))
roll = numpy.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
polars.DataFrame({{"time_s": columns[0], "q_w": w, "q_x": x, "q_y": y, "q_z": z, "yaw_rad": yaw, "pitch_rad": pitch,
    "roll_rad": roll}}).write_csv(sys.argv[2])
"""
ONLINE = "q = vqf.VQF(dt).updateBatch(gyr, acc)['quat6D']"
OFFLINE = "q = vqf.offlineVQF(gyr, acc, None, dt)['quat6D']"


def motion(rows: int) -> tuple:
    """Rest, then slow turns with noise, 100 Hz; seeded: times, rates (rad/s), specific forces (m/s2)."""
    random = numpy.random.default_rng(1)
    t = numpy.arange(rows) / 100.0
    moving = t > 5
    rate = numpy.stack([numpy.sin(0.7 * t), numpy.sin(1.1 * t + 1), numpy.sin(0.9 * t + 2)], axis=1) * moving[:, None]
    gyr = 0.3 * rate + 0.002 * random.standard_normal((rows, 3)) + 0.01
    tilt = 0.3 * (1 - numpy.cos(0.7 * t)) * moving
    acc = numpy.stack([0 * t, 9.81 * numpy.sin(tilt), 9.81 * numpy.cos(tilt)], axis=1)
    acc += 0.02 * random.standard_normal((rows, 3))
    return t, gyr, acc


def recording(path: str, rows: int) -> None:
    """Writes `motion` as CSV."""
    t, gyr, acc = motion(rows)
    header = "time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z"
    numpy.savetxt(path, numpy.column_stack([t, acc, gyr]), delimiter=",", header=header, comments="", fmt="%.6f")


def run(command: list[str]) -> tuple[float, float]:
    """Wall seconds and peak MB of one process."""
    started = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - started
    if status != 0:
        raise SystemExit(f"{command} ended with {status}")
    return seconds, usage.ru_maxrss / 1024


def main() -> None:
    shisei, folder, rows, runs = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
    os.makedirs(folder, exist_ok=True)
    source, result = os.path.join(folder, "big.csv"), os.path.join(folder, "big.orientation.csv")
    # In a process of its own: the peak memory of a process counts that of the one which started it.
    maker = multiprocessing.Process(target=recording, args=(source, rows))
    maker.start()
    maker.join()
    ours = [shisei, "orient", source, "-o", result, "--no-report", "--force", "--filter"]
    commands = {
        "shisei orient (default)": ours + ["shisei"],
        "shisei orient --filter shisei-online": ours + ["shisei-online"],
        "shisei orient --filter mahony": ours + ["mahony"],
        "polars + vqf, online": [sys.executable, "-c", PEER.format(estimate=ONLINE), source, result],
        "polars + vqf, offline": [sys.executable, "-c", PEER.format(estimate=OFFLINE), source, result],
    }
    found: dict[str, list[tuple[float, float]]] = {name: [] for name in commands}
    for turn in range(runs + 1):
        for name, command in commands.items():
            measured = run(command)
            if turn > 0:  # the first turn warms the file cache
                found[name].append(measured)
    medians = {name: (statistics.median(s for s, _ in all), statistics.median(m for _, m in all))
               for name, all in found.items()}
    peer = medians["polars + vqf, offline"]
    print(f"{rows} rows, CSV to CSV, median of {runs} runs in turn")
    print(f"{'':38} {'s':>7} {'MB':>7}   time and memory against polars + vqf offline")
    for name, (seconds, megabytes) in medians.items():
        print(f"{name:38} {seconds:7.2f} {megabytes:7.0f}   {seconds / peer[0]:.2f} {megabytes / peer[1]:.2f}")


if __name__ == "__main__":
    main()
