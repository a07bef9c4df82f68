"""Reads fused.mcap with the format's own Python package, front to back and by its index: check_fused.py FOLDER."""
import csv
import io
import json
import math
import pathlib
import struct
import sys

from mcap.reader import NonSeekingReader, make_reader

folder = pathlib.Path(sys.argv[1])
with open(folder / "fused.csv", encoding="utf-8") as file:
    rows = list(csv.DictReader(file))
content = (folder / "fused.mcap").read_bytes()
by_index = [(s, c, m) for s, c, m in make_reader(io.BytesIO(content)).iter_messages()]
streamed = [(s, c, m) for s, c, m in NonSeekingReader(io.BytesIO(content)).iter_messages()]
assert len(by_index) == len(streamed)
topics: dict = {}
for schema, channel, message in streamed:
    topics.setdefault(channel.topic, []).append((schema, channel, message))
assert set(topics) == {"/pose/Tool_道具", "/optical/Tool_道具", "/fused/Tool_道具"}, set(topics)


def pose(data):
    """geometry_msgs/msg/PoseStamped in plain CDR: stamp, frame_id, then seven numbers on a boundary of eight bytes."""
    assert data[:4] == b"\0\1\0\0"
    body = data[4:]
    sec, nanosec, length = struct.unpack_from("<iII", body)
    frame_id = body[12:12 + length]
    start = (12 + length + 7) // 8 * 8
    assert len(body) == start + 56
    return sec + nanosec * 1e-9, frame_id, struct.unpack_from("<7d", body, start)


def turn(q, v):
    w, u = q[0], q[1:]
    cross = lambda a, b: (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])  # noqa: E731
    t = [2 * x for x in cross(u, v)]
    c = cross(u, t)
    return [v[k] + w * t[k] + c[k] for k in range(3)]


def z_up(v):
    """(x, y, z) of a y-up world in a z-up one: y becomes z, z becomes −y."""
    return (v[0], -v[2], v[1])


seen = {"/pose/Tool_道具": [r for r in rows if r["p_x"]], "/optical/Tool_道具": [r for r in rows if r["source"] == "optical"]}
for topic, expected in seen.items():
    assert len(topics[topic]) == len(expected) > 0
    for (schema, channel, message), row in zip(topics[topic], expected):
        assert schema.name == "geometry_msgs/msg/PoseStamped" and schema.encoding == "ros2msg"
        assert channel.message_encoding == "cdr"
        time_s, frame_id, (px, py, pz, x, y, z, w) = pose(message.data)
        assert frame_id == b"world\0" and abs(time_s - float(row["time_s"])) < 2e-9
        assert abs(message.log_time * 1e-9 - time_s) < 2e-9
        given = [float(row[f"p_{axis}"]) for axis in "xyz"]
        assert math.dist((px, py, pz), z_up(given)) < 1e-12
        # every axis of the body points the same way in both worlds
        q = [float(row[f"q_{axis}"]) for axis in "wxyz"]
        for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1)):
            assert math.dist(turn((w, x, y, z), axis), z_up(turn(q, axis))) < 1e-9
fused = [json.loads(message.data) for _, _, message in topics["/fused/Tool_道具"]]
assert [f["frame"] for f in fused] == [int(r["frame"]) for r in rows]
assert [f["source"] for f in fused] == [r["source"] for r in rows]
assert all((f["sigma_mm"] is None) == (f["source"] == "none") for f in fused)
print(f"{len(streamed)} messages on {len(topics)} topics")
