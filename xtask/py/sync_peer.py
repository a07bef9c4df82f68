"""Clock offset and mounting as qmt finds them, for `cargo xtask bench sync`.

python sync_peer.py TAKE.f64 RECORDING.f64 AT_S

TAKE: N x 8 little-endian float64 (time_s, q_w, q_x, q_y, q_z world from body, p_x, p_y, p_z), NaN where the body was lost.
RECORDING: N x 7 (time_s, acc_m_s2, gyro_rad_s). Both at even steps. Prints the sensor's time at the optical time AT_S,
sensor seconds in an optical second, and the mounting, sensor to body: w x y z.

syncOptImu with fast=True, without which half a minute of data takes it very long; alignOptImu with its defaults but
without positions, which it takes for the sensor's own.
"""

import sys

import numpy as np
import qmt

take = np.fromfile(sys.argv[1], dtype="<f8").reshape(-1, 8)
recording = np.fromfile(sys.argv[2], dtype="<f8").reshape(-1, 7)
optical_hz = (len(take) - 1) / (take[-1, 0] - take[0, 0])
sensor_hz = (len(recording) - 1) / (recording[-1, 0] - recording[0, 0])
attitude = np.ascontiguousarray(take[:, 1:5])
acc, gyro = np.ascontiguousarray(recording[:, 1:4]), np.ascontiguousarray(recording[:, 4:7])

sync = qmt.syncOptImu(attitude, optical_hz, gyro, sensor_hz, {"fast": True})
mapper = qmt.SyncMapper(sync)
# its rates of the optics are means of the step that ends at a frame: half a step old
row = (float(sys.argv[3]) - take[0, 0] + 0.5 / optical_hz) * optical_hz
at_s = recording[0, 0] + mapper.map("opt", "ind", row, "imu", "ind") / sensor_hz
rows = mapper.map("opt", "ind", np.arange(len(take)), "imu", "ind")
near = [np.column_stack([np.interp(rows, np.arange(len(part)), column) for column in part.T]) for part in (gyro, acc)]
alignment = qmt.alignOptImu(near[0], near[1], None, attitude, None, optical_hz)
print(at_s, sync["data"]["imu"]["rate"] / sensor_hz, *np.ravel(alignment["qImu2Seg"]))
