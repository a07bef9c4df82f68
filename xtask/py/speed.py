"""Our kernels and files beside named programs, in turns, on one core. Called by `cargo xtask bench speed`.

Processor time is taken, of the system's part too: on a quiet machine it is the time by the clock, on another one it is
what can still be compared. Only the last lines, of two cores, go by the clock.

Usage: speed.py EXAMPLES SHISEI FOLDER ROWS ROUNDS. EXAMPLES holds the examples `arithmetic` of shisei-wide and
`kernels` of shisei-record. Prints medians, ratios and whether each is within its limit; ends with 1 where one is not.
"""

import ctypes
import importlib.metadata
import os
import shutil
import statistics
import subprocess
import sys
import tarfile
import time

os.environ["POLARS_MAX_THREADS"] = "1"
os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import ahrs
import imufusion
import numpy
import pandas
import polars
import pyarrow
import pyarrow.csv
import vqf
from scipy.spatial.transform import Rotation

import cli

DT_S = 0.01
FUSION_LOOP = """
#include "Fusion.h"
void run(const float *gyr, const float *acc, float *out, long rows, float dt) {
    FusionAhrs ahrs;
    FusionAhrsInitialise(&ahrs);
    FusionAhrsSetSamplePeriod(&ahrs, dt);
    for (long k = 0; k < rows; k++) {
        const FusionVector g = {{gyr[3 * k], gyr[3 * k + 1], gyr[3 * k + 2]}};
        const FusionVector a = {{acc[3 * k], acc[3 * k + 1], acc[3 * k + 2]}};
        FusionAhrsUpdateNoMagnetometer(&ahrs, g, a);
        const FusionQuaternion q = FusionAhrsGetQuaternion(&ahrs);
        for (int i = 0; i < 4; i++) out[4 * k + i] = q.array[i];
    }
}
"""


def fusion_core(folder):
    """x-io Fusion's C sources, from the source package of imufusion, compiled with -O3 around a loop in C."""
    version = importlib.metadata.version("imufusion")
    library = os.path.join(folder, f"fusion-{version}.so")
    if not os.path.exists(library):
        fetch = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
        subprocess.run(fetch + ["--no-binary", "imufusion", "--dest", folder, f"imufusion=={version}"], check=True)
        with tarfile.open(os.path.join(folder, f"imufusion-{version}.tar.gz")) as package:
            package.extractall(folder, filter="data")
        sources = os.path.join(folder, f"imufusion-{version}", "Fusion")
        with open(os.path.join(sources, "loop.c"), "w") as out:
            out.write(FUSION_LOOP)
        files = [os.path.join(sources, name) for name in sorted(os.listdir(sources)) if name.endswith(".c")]
        subprocess.run(["cc", "-O3", "-shared", "-fPIC", "-o", library, *files, "-lm"], check=True)
    return ctypes.CDLL(library)


class Kernels:
    """Our side: a program that waits for names and tells how long each run took."""

    def __init__(self, program, folder):
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        self.process = subprocess.Popen([program, folder], **pipes)

    def __call__(self, name):
        started = self.processor_time()
        self.process.stdin.write(name + "\n")
        self.process.stdin.flush()
        if not self.process.stdout.readline():
            raise SystemExit(f"the kernels ended at {name}")
        return self.processor_time() - started

    def processor_time(self):
        with open(f"/proc/{self.process.pid}/schedstat") as statistics_of_process:
            return int(statistics_of_process.read().split()[0]) * 1e-9


def timed(work):
    def run():
        started = time.process_time()
        work()
        return time.process_time() - started
    return run


def timed_program(command):
    """Its output is not looked at."""
    def run():
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        if status != 0:
            raise SystemExit(f"{command} ended with {status}")
        return usage.ru_utime + usage.ru_stime
    return run


def imufusion_loop(gyr_deg, acc_g):
    filter = imufusion.Ahrs()
    out = numpy.empty((len(gyr_deg), 4))
    for k in range(len(gyr_deg)):
        filter.update_no_magnetometer(gyr_deg[k], acc_g[k])
        out[k] = filter.get_quaternion()


def numpy_ypr(q):
    w, x, y, z = q.T
    out = numpy.empty((len(q), 3))
    out[:, 0] = numpy.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    out[:, 1] = numpy.arcsin(numpy.clip(2 * (w * y - z * x), -1, 1))
    out[:, 2] = numpy.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))


def written(path, text):
    with open(path, "wb") as out:
        out.write(text)


def replaced(path, text):
    """As `shisei orient` must: whole or not at all, so under another name and then in the place of the old file."""
    written(path + ".tmp", text)
    os.replace(path + ".tmp", path)


def warmed(run):
    """Takes memory, touches it and gives it back before the run. A virtual machine may have handed what was free to its
    host, and the next to touch it pays for that: whoever's turn it happens to be."""
    def warm_run():
        numpy.ones(80_000_000)
        return run()
    return warm_run


def ours(examples, folder):
    programs = {
        "arithmetic": ["floor", "mahony", "mahony-plain", "mahony-many", "gyro", "gyro-plain-vectors", "ypr",
                       "ypr-plain-vectors"],
        "kernels": ["csv-read", "csv-write-6", "csv-write-shortest"],
    }
    runs = {}
    for program, names in programs.items():
        kernels = Kernels(os.path.join(examples, program), folder)
        runs |= {name: (lambda name=name, kernels=kernels: kernels(name)) for name in names}
    return runs


def arithmetic_peers(gyr, acc, folder):
    """Name: a run, and over how many samples (fewer for loops in Python)."""
    rows = len(gyr)
    gyr_deg, acc_g = numpy.degrees(gyr), acc / 9.80665
    gyr_32, acc_32 = (numpy.ascontiguousarray(v, dtype=numpy.float32) for v in (gyr_deg, acc_g))
    out_32 = numpy.zeros((rows, 4), dtype=numpy.float32)
    core = fusion_core(folder)
    pointer = lambda array: array.ctypes.data_as(ctypes.c_void_p)
    fusion = lambda: core.run(pointer(gyr_32), pointer(acc_32), pointer(out_32), ctypes.c_long(rows),
                              ctypes.c_float(DT_S))
    few, some = min(rows, 2_000), min(rows, 50_000)
    q = vqf.BasicVQF(DT_S).updateBatch(gyr, acc)["quat6D"]
    rotations = Rotation.from_quat(q[:, [1, 2, 3, 0]])
    return {
        "x-io Fusion, C core, f32": (fusion, rows),
        "imufusion, loop": (lambda: imufusion_loop(gyr_deg[:some], acc_g[:some]), some),
        "BasicVQF, batch": (lambda: vqf.BasicVQF(DT_S).updateBatch(gyr, acc), rows),
        "VQF, batch": (lambda: vqf.VQF(DT_S).updateBatch(gyr, acc), rows),
        "ahrs Mahony": (lambda: ahrs.filters.Mahony(gyr=gyr[:few], acc=acc[:few], frequency=1 / DT_S), few),
        "SciPy as_euler": (lambda: rotations.as_euler("ZYX"), rows),
        "NumPy by hand": (lambda: numpy_ypr(q), rows),
    }


def file_peers(folder, shisei):
    source, result = os.path.join(folder, "big.csv"), os.path.join(folder, "big.orientation.csv")
    other = os.path.join(folder, "peer.csv")
    table = polars.read_csv(source)
    orient = [shisei, "orient", source, "-o", result, "--no-report", "--force", "--filter", "mahony"]
    timed_program(orient)()
    with open(result, "rb") as made:
        ready = made.read()
    single = pyarrow.csv.ReadOptions(use_threads=False)
    return {
        "pandas read": timed(lambda: pandas.read_csv(source)),
        "polars read": timed(lambda: polars.read_csv(source)),
        "pyarrow read": timed(lambda: pyarrow.csv.read_csv(source, read_options=single)),
        "polars write, 6 decimals": timed(lambda: table.write_csv(other, float_precision=6)),
        "polars write, shortest": timed(lambda: table.write_csv(other)),
        "shisei orient, mahony": timed_program(orient),
        "wc -l": timed_program(["wc", "-l", source]),
        "write ready bytes": timed(lambda: replaced(os.path.join(folder, "ready.csv"), ready)),
    }


def many_files(folder, shisei, cores, rounds):
    """Seconds for a directory of recordings on one core, on two, and by two processes with a core each."""
    inputs, outputs = os.path.join(folder, "many"), os.path.join(folder, "many-out")
    os.makedirs(inputs, exist_ok=True)
    with open(os.path.join(folder, "big.csv"), "rb") as big:
        text = b"".join(big.readline() for _ in range(3_001))
    files = [os.path.join(inputs, f"{k:04}.csv") for k in range(1_000)]
    for path in files:
        written(path, text)

    def seconds(jobs):
        started = time.perf_counter()
        running = []
        for files, on in jobs:
            os.sched_setaffinity(0, on)
            command = [shisei, "orient", *files, "-o", outputs, "--no-report", "--filter", "mahony"]
            running.append(subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
        if any([process.wait() for process in running]):
            raise SystemExit("shisei orient failed on a directory")
        return time.perf_counter() - started

    ways = {
        "one core": [([inputs], cores[:1])],
        "two cores": [([inputs], cores[:2])],
        "two processes": [(files[:500], cores[:1]), (files[500:], cores[1:2])],
    }
    found = {name: [] for name in ways}
    for _ in range(rounds):
        for name, jobs in ways.items():
            found[name].append(warmed(lambda: seconds(jobs))())
    os.sched_setaffinity(0, cores[:1])
    shutil.rmtree(outputs)
    return {name: statistics.median(all) for name, all in found.items()}


def main():
    examples, shisei, folder, rows, rounds = sys.argv[1:4] + [int(word) for word in sys.argv[4:6]]
    cores = sorted(os.sched_getaffinity(0))
    os.sched_setaffinity(0, cores[:1])
    os.makedirs(folder, exist_ok=True)
    time_s, gyr, acc = cli.motion(rows)
    gyr.astype("<f8").tofile(os.path.join(folder, "gyr.f64"))
    acc.astype("<f8").tofile(os.path.join(folder, "acc.f64"))
    columns = dict(zip(["time_s", "acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z"], [time_s, *acc.T, *gyr.T]))
    columns["temp_c"] = 25 + 0.1 * gyr[:, 0]
    polars.DataFrame(columns).write_csv(os.path.join(folder, "big.csv"), float_precision=6)

    runs, samples = ours(examples, folder), {}
    for name, (work, count) in arithmetic_peers(gyr, acc, folder).items():
        runs[name], samples[name] = timed(work), count
    files = file_peers(folder, shisei) | {name: runs[name] for name in runs if name.startswith("csv-")}
    runs |= {name: warmed(run) for name, run in files.items()}
    seconds = {name: [] for name in runs}
    for turn in range(rounds + 1):
        for name, run in runs.items():
            took = run()
            if turn > 0:  # the first turn warms caches
                seconds[name].append(took / samples.get(name, rows) * rows)
    median = {name: statistics.median(all) for name, all in seconds.items()}
    both = many_files(folder, shisei, cores, 5) if len(cores) > 1 else None

    megabytes = os.path.getsize(os.path.join(folder, "big.csv")) / 1e6
    print(f"{rows} samples ({megabytes:.0f} MB of CSV), one core, {rounds} turns, medians of processor time")
    for name, value in median.items():
        print(f"  {name:28} {value * 1e3:9.1f} ms {value / rows * 1e9:9.1f} ns/sample")
    m = median
    best = min(["pandas read", "polars read", "pyarrow read"], key=m.get)
    floor = m["wc -l"] + m["write ready bytes"]
    checks = [
        ("Mahony / plain form", m["mahony"] / m["mahony-plain"], "<=", 0.75),
        ("Mahony against x-io Fusion's C core", m["x-io Fusion, C core, f32"] / m["mahony"], ">=", 1),
        ("Mahony against imufusion's loop", m["imufusion, loop"] / m["mahony"], ">=", 22),
        ("Mahony against BasicVQF's batch", m["BasicVQF, batch"] / m["mahony"], ">=", 4),
        ("Mahony against VQF's batch", m["VQF, batch"] / m["mahony"], ">=", 12),
        ("Mahony against ahrs' Mahony", m["ahrs Mahony"] / m["mahony"], ">=", 1800),
        ("Mahony, 100 recordings side by side / one by one", m["mahony-many"] / m["mahony"], "<=", 0.5),
        ("Mahony, 100 recordings side by side / memory floor", m["mahony-many"] / m["floor"], "<=", 1.5),
        ("gyroscope only / memory floor", m["gyro"] / m["floor"], "<=", 2.4),
        ("yaw, pitch, roll against NumPy", m["NumPy by hand"] / m["ypr"], ">=", 3),
        ("yaw, pitch, roll against SciPy", m["SciPy as_euler"] / m["ypr"], ">=", 4),
        (f"CSV read against the best ({best.split()[0]})", m[best] / m["csv-read"], ">=", 1.8),
        ("CSV write, 6 decimals, against polars", m["polars write, 6 decimals"] / m["csv-write-6"], ">=", 5),
        ("CSV write, shortest, against polars", m["polars write, shortest"] / m["csv-write-shortest"], ">=", 1),
        ("shisei orient / (wc -l + writing ready bytes)", m["shisei orient, mahony"] / floor, "<=", 2.5),
    ]
    if both:
        one, two, apart = (both[name] for name in ["one core", "two cores", "two processes"])
        print(f"  1,000 files: {one:.2f} s on one core, {two:.2f} s on two, {apart:.2f} s by two processes, a core each")
        checks.append(("1,000 files: two cores against one", one / two, ">=", 1.7))
        checks.append(("1,000 files: two cores against two processes", apart / two, ">=", 0.9))
    missed = 0
    for name, ratio, sign, limit in checks:
        good = ratio <= limit if sign == "<=" else ratio >= limit
        missed += not good
        print(f"{'pass' if good else 'MISS'}  {name:50} {ratio:8.2f}  {sign} {limit}")
    sys.exit(missed > 0)


if __name__ == "__main__":
    main()
