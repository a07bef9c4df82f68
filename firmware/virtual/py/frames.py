"""Reads a receiver's bytes with readers that are not ours: PyPI's cobs and crcmod.

usage: frames.py FILE      every frame must be whole; prints how many of each kind
"""

import collections
import sys

import crcmod.predefined
from cobs import cobs

crc = crcmod.predefined.mkCrcFun("crc-ccitt-false")
with open(sys.argv[1], "rb") as file:
    *frames, rest = file.read().split(b"\0")
kinds = collections.Counter()
for frame in frames:
    content = cobs.decode(frame)
    message, checksum = content[:-2], int.from_bytes(content[-2:], "little")
    assert crc(message) == checksum, frame.hex()
    version, kind = message[0], message[1]
    assert version == 1, version
    if kind == 3:  # data: the packet begins after 24 bytes, and its length says its count
        packet = message[24:]
        assert len(packet) == 20 + 22 * packet[1], packet.hex()
    kinds[kind] += 1
assert kinds[1] and kinds[2] > 1000 and kinds[3] > 1000, kinds
print(f"{sum(kinds.values())} frames, {kinds[3]} of them data, {len(rest)} bytes of one that was cut")
