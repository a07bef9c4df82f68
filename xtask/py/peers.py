"""Attitudes of other people's estimators, for the same table.

python peers.py TRIAL.f64 OUT_FOLDER [NAME ...]

Writes OUT_FOLDER/NAME.q64 of those named, or of all: N x 4 little-endian float64 (w, x, y, z; body to world, z up). Everyone gets the same raw
readings and the true sample rate; VQF has its defaults, imufusion the settings of its own example.
"""

import sys
from pathlib import Path

import imufusion
import numpy as np
from vqf import VQF, offlineVQF

rows = np.fromfile(sys.argv[1], dtype="<f8").reshape(-1, 12)
out = Path(sys.argv[2])
time_s = rows[:, 0]
acc_m_s2 = np.ascontiguousarray(rows[:, 1:4])
gyro_rad_s = np.ascontiguousarray(rows[:, 4:7])
dt_s = (time_s[-1] - time_s[0]) / (len(time_s) - 1)


def fusion():
    """x-io Fusion with the run-time gyroscope bias of its example."""
    settings = imufusion.AhrsSettings()
    settings.sample_rate = 1 / dt_s
    settings.gain = 0.5
    settings.gyroscope_range = 2000
    settings.acceleration_rejection = 10
    settings.rejection_timeout = 5 / dt_s
    ahrs = imufusion.Ahrs()
    ahrs.set_settings(settings)
    bias_settings = imufusion.BiasSettings()
    bias_settings.sample_rate = 1 / dt_s
    bias = imufusion.Bias()
    bias.set_settings(bias_settings)
    gyro_dps = np.degrees(gyro_rad_s)
    acc_g = acc_m_s2 / 9.80665
    q = np.empty((len(rows), 4))
    for i in range(len(rows)):
        ahrs.update_no_magnetometer(bias.update(gyro_dps[i]), acc_g[i])
        q[i] = ahrs.get_quaternion()
    return q


PEERS = {
    "vqf": lambda: VQF(dt_s).updateBatch(gyro_rad_s, acc_m_s2)["quat6D"],
    "vqf-offline": lambda: offlineVQF(gyro_rad_s, acc_m_s2, None, dt_s)["quat6D"],
    "imufusion": fusion,
}

for name in sys.argv[3:] or PEERS:
    run = PEERS[name]
    np.ascontiguousarray(run()).astype("<f8").tofile(out / f"{name}.q64")
