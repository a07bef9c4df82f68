"""Cost of the Python door against the mathematics alone: python crates/shisei-python/tests/bench.py LIBRARY [ROWS]

The mathematics is the C function of LIBRARY (libshisei.so) writing into an array that is there already.
"""
import ctypes
import sys
import time

import numpy as np

import shisei

LIMIT = 3.0


def best(run):
    times = []
    for _ in range(5):
        started = time.perf_counter()
        run()
        times.append(time.perf_counter() - started)
    return min(times)


def main(library, rows=1_000_000):
    rows = int(rows)
    rng = np.random.default_rng(1)
    gyro, acc = rng.normal(0, 0.5, (rows, 3)), rng.normal(0, 0.5, (rows, 3)) + [0, 0, 9.8]
    start, out = np.array([1.0, 0, 0, 0]), np.zeros((rows, 4))
    function = ctypes.CDLL(library).UpdateQuaternionSeriesByMahony
    at = lambda a: a.ctypes.data_as(ctypes.c_void_p)  # noqa: E731
    number = ctypes.c_double

    def maths():
        n = function(at(start), 1, 4, at(gyro), rows, 3, at(acc), rows, 3, number(0.01), number(2), number(0),
                     number(9.80665), at(out), 4 * rows)
        assert n == 4 * rows, n

    def door():
        return shisei.mahony(gyro_rad_s=gyro, acc_m_s2=acc, dt_s=0.01, kp=2.0)

    plain, through = best(maths), best(door)
    np.testing.assert_array_equal(door(), out)
    extra = (through - plain) / plain
    print("Python, %d rows: maths %.1f ms, through the door %.1f ms; the door costs %.2f x the maths (limit %.0f)"
          % (rows, plain * 1e3, through * 1e3, extra, LIMIT))
    return 0 if extra < LIMIT else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
