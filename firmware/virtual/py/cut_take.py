"""Reads a recording that was never finished with PyPI's mcap, whole and cut at twenty places.

usage: cut_take.py FILE
"""

import io
import json
import struct
import sys

from mcap.reader import NonSeekingReader


def read(content):
    """Topics and messages up to where the file ends."""
    found = []
    try:
        for schema, channel, message in NonSeekingReader(io.BytesIO(content)).iter_messages(log_time_order=False):
            found.append((channel.topic, schema.name if schema else "", message.data))
    except Exception as error:  # the torn end; what came before it counts
        assert found or len(content) < 2000, error
    return found


with open(sys.argv[1], "rb") as file:
    whole = file.read()
everything = read(whole)
samples = [message for message in everything if message[0].startswith("/sample/")]
values = [message for message in everything if message[0].startswith("/imu/")]
assert len(samples) == len(values) > 5000, (len(samples), len(values))
assert {message[1] for message in values} == {"sensor_msgs/msg/Imu"}
for _, _, data in samples:
    sample = json.loads(data)
    assert 0 <= sample["node"] < 6 and (sample["frame"] is None or sample["frame"] > 0), sample
for _, _, data in values:
    # XCDR1: 4 bytes of encapsulation, stamp, frame_id "node0\0" and padding, then doubles; gravity is on z.
    (z,) = struct.unpack_from("<d", data, 4 + 24 + 8 * 27)
    assert abs(z - 9.8) < 0.1, z
before = 0
for k in range(1, 21):
    found = read(whole[: len(whole) * k // 20])
    assert found == everything[: len(found)] and len(found) >= before
    # A chunk at most is missing.
    assert len(found) >= len(everything) * (k - 1) // 20 - 500, (k, len(found))
    before = len(found)
print(f"{len(everything)} messages whole; cut at twenty places all of them up to the last chunk")
