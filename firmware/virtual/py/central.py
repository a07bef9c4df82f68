"""bumble's own central against our node, on two virtual controllers: an independent look at the GATT server.

usage: central.py BASE_US PORT OFFSET_US PPM     prints `ready`, then one JSON object
"""

import asyncio
import binascii
import json
import logging
import struct
import sys

from bumble import hci
from bumble.att import ATT_Error
from bumble.core import UUID
from bumble.device import Device, Peer
from bumble.host import Host
from bumble.link import LocalLink

from controllers import Virtual, World, open_controller

NODE = "FF:EE:00:00:00:01"


def uuid(number):
    return UUID(f"1f523310-9e1c-4e4d-b12a-5ccb6170{number:04x}")


def read_packet(content):
    """Count, flags, boot, sequence and sample times of a packet, as docs/en/wire.md says."""
    version, count, flags, boot, sequence, time_us = struct.unpack_from("<BBHHHI", content)
    assert version == 1 and len(content) == 20 + 22 * count, content.hex()
    samples = [struct.unpack_from("<H10h", content, 20 + 22 * k) for k in range(count)]
    return {"count": count, "flags": flags, "boot": boot, "sequence": sequence, "time_us": time_us, "samples": samples}


async def main():
    world = World(float(sys.argv[1]), 0.0, 0.0)
    link = LocalLink()
    listening = asyncio.create_task(open_controller(link, world, ":".join(sys.argv[2:5]), "node"))
    own = Virtual("central", 0.0, 0.0, world, link=link)
    own.random_address = hci.Address("F0:00:00:00:00:99")
    device = Device(name="central", address="F0:00:00:00:00:99", host=Host())
    device.host.controller = own
    own.host = device.host
    device.host.set_packet_sink(own)
    await device.power_on()
    print("ready", flush=True)
    listened = await listening
    advertised = []
    device.on("advertisement", advertised.append)
    await device.start_scanning()
    while not advertised:
        await asyncio.sleep(0.1)
    await device.stop_scanning()
    services = [str(service) for kind in (0x06, 0x07) for service in advertised[0].data.get_all(kind) or []]
    connection = await asyncio.wait_for(device.connect(NODE), 20)
    peer = Peer(connection)
    out = {"advertised": services, "mtu": await peer.request_mtu(247), "characteristics": {}}
    await peer.discover_services()
    for service in peer.services:
        await service.discover_characteristics()
        for characteristic in service.characteristics:
            out["characteristics"][str(characteristic.uuid)] = int(characteristic.properties)
    data, control, status = (peer.get_characteristics_by_uuid(uuid(number))[0] for number in (2, 3, 4))
    out["status"] = (await status.read_value()).hex()
    packets = []
    await peer.subscribe(data, lambda content: packets.append(bytes(content)))
    await asyncio.sleep(3)
    out["before"] = [read_packet(content) for content in packets]
    # Settings: estimator, eight samples a packet, 2000 deg/s, 8 g; then another name.
    await control.write_value(bytes([133, 1, 8, 4, 2]), with_response=True)
    await control.write_value(bytes([132]) + "left-hand".encode(), with_response=True)
    await asyncio.sleep(0.5)
    packets.clear()
    await asyncio.sleep(2)
    out["after"] = [read_packet(content) for content in packets]
    out["renamed"] = (await status.read_value()).hex()
    # A calibration, written by hand after docs/en/wire.md; a damaged one, which is refused; what is kept; taken away.
    kept = peer.get_characteristics_by_uuid(uuid(5))[0]
    matrix = [1.0, 0.125, 0.0, 0.0, 0.875, 0.0, 0.0, 0.0, 1.125]
    content = struct.pack("<B24f", 1, 0.25, -0.5, 1.0, *matrix, 0.0625, 0.0, -0.125, *matrix)
    calibration = content + struct.pack("<H", binascii.crc_hqx(content, 0xFFFF))
    out["kept"] = [(await kept.read_value()).hex()]
    await control.write_value(bytes([134]) + calibration, with_response=True)
    await asyncio.sleep(0.2)
    out["kept"].append((await kept.read_value()).hex())
    try:
        await control.write_value(bytes([134]) + calibration[:-1] + b"?", with_response=True)
        out["refused"] = None
    except ATT_Error as error:
        out["refused"] = int(error.error_code)
    await asyncio.sleep(0.2)
    out["kept"].append((await kept.read_value()).hex())
    packets.clear()
    await asyncio.sleep(0.5)
    out["calibrated"] = [read_packet(content)["flags"] >> 13 for content in packets]
    await control.write_value(bytes([134]), with_response=True)
    await asyncio.sleep(0.2)
    out["kept"].append((await kept.read_value()).hex())
    out["calibration"] = calibration.hex()
    del listened
    print(json.dumps(out), flush=True)


if __name__ == "__main__":
    logging.basicConfig(level=logging.CRITICAL)
    asyncio.run(asyncio.wait_for(main(), 60))
