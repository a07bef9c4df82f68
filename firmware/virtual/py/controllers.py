"""Virtual Bluetooth controllers for a receiver and its nodes: bumble's, on loopback TCP (H4), with what it lacks.

 * connection events: data moves only at the events of a link, at most PER_EVENT packets each way; some are missed
 * Nordic's vendor command 0xFD1F and vendor event 0x82: anchor points by each controller's own clock, with jitter
 * 251-byte packets, a reset that drops links, an answer to every command, cancelled connections, supervision timeout

usage: controllers.py BASE_US MISSED JITTER_US PORT:OFFSET_US:PPM ...   the receiver's first, then the nodes'
A controller's clock is (monotonic - BASE_US) * (1 + PPM * 1e-6) + OFFSET_US.
"""

import asyncio
import logging
import random
import struct
import sys
import time

from bumble import hci
from bumble.controller import Controller
from bumble.link import LocalLink
from bumble.transport import open_transport

PER_EVENT = 4
SUPERVISION_S = 1.0
ANCHOR_REPORTS = 0xFD1F
SET_PHY = 0x2032


class Raw:
    """An HCI packet as it goes over the line."""

    def __init__(self, content: bytes) -> None:
        self.content = content

    def __bytes__(self) -> bytes:
        return self.content


class Virtual(Controller):
    le_acl_data_packet_length = 251
    acl_data_packet_length = 251
    total_num_le_acl_data_packets = 6

    def __init__(self, name, offset_us, ppm, world, **rest):
        super().__init__(name, **rest)
        self.offset_us, self.ppm, self.world = offset_us, ppm, world
        self.reports_anchors = False
        self.waiting = {}  # handle -> packets for the next connection event
        self.le_features &= ~hci.LeFeatureMask.LE_EXTENDED_ADVERTISING

    def on_hci_command(self, command):
        known = command.op_code == ANCHOR_REPORTS
        if known:
            self.reports_anchors = bool(command.parameters[0])
        op_code = struct.pack("<H", command.op_code)
        if command.op_code == SET_PHY:
            self.send_hci_packet(Raw(bytes([4, 0x0F, 4, 1, 1]) + op_code))
        else:
            self.send_hci_packet(Raw(bytes([4, 0x0E, 4, 1]) + op_code + bytes([0 if known else 1])))

    def on_hci_reset_command(self, command):
        self.le_connections.clear()
        self.waiting.clear()
        self.pending_le_connection = None
        self.reports_anchors = False
        self.le_scan_enable = False
        self.le_legacy_advertiser.stop()
        return super().on_hci_reset_command(command)

    def on_hci_le_create_connection_cancel_command(self, _command):
        pending, self.pending_le_connection = self.pending_le_connection, None
        if pending is None:
            return hci.HCI_StatusReturnParameters(hci.HCI_ErrorCode.COMMAND_DISALLOWED_ERROR)
        self.send_hci_packet(
            hci.HCI_LE_Connection_Complete_Event(
                status=0x02,
                connection_handle=0,
                role=0,
                peer_address_type=0,
                peer_address=hci.Address("00:00:00:00:00:00"),
                connection_interval=0,
                peripheral_latency=0,
                supervision_timeout=0,
                central_clock_accuracy=0,
            )
        )
        return hci.HCI_StatusReturnParameters(hci.HCI_ErrorCode.SUCCESS)

    def create_le_connection(self, peer_address):
        pending = self.pending_le_connection
        super().create_le_connection(peer_address)
        link = self.le_connections.get(pending.peer_address)
        interval_s = getattr(pending, "connection_interval_min", 12) * 1.25e-3
        self.world.tasks.add(asyncio.get_running_loop().create_task(self.events(link, interval_s)))

    def on_hci_acl_data_packet(self, packet):
        if self.find_connection_by_handle(packet.connection_handle):
            self.waiting.setdefault(packet.connection_handle, []).append(packet)

    async def events(self, link, interval_s):
        """The connection events of a link; runs at its central."""
        await asyncio.sleep(0.005)
        peer = self.link.find_le_controller(link.peer_address)
        other = next((c for c in peer.le_connections.values() if c.peer_address == link.self_address), None)
        count, at = 0, time.monotonic() + interval_s
        while self.le_connections.get(link.peer_address) is link and other in peer.le_connections.values():
            await asyncio.sleep(max(0.0, at - time.monotonic()))
            missed = self.world.random.random() < self.world.missed
            for controller, end, heard in ((self, link, True), (peer, other, not missed)):
                if controller.reports_anchors and heard:
                    controller.report_anchor(end.handle, count, at)
            if not missed:
                self.exchange(link)
                peer.exchange(other)
            count += 1
            at += interval_s
        await asyncio.sleep(SUPERVISION_S)
        for controller, end in ((self, link), (peer, other)):
            if end and controller.le_connections.get(end.peer_address) is end:
                controller.on_le_disconnected(end, 0x08)
            if end:
                controller.waiting.pop(end.handle, None)

    def report_anchor(self, handle, count, at):
        elapsed_us = at * 1e6 - self.world.base_us
        own_us = elapsed_us * (1 + self.ppm * 1e-6) + self.offset_us + self.world.random.gauss(0, self.world.jitter_us)
        fields = struct.pack("<HHQ", handle, count & 0xFFFF, max(0, round(own_us)))
        self.send_hci_packet(Raw(bytes([4, 0xFF, 13, 0x82]) + fields))

    def exchange(self, end):
        queue = self.waiting.setdefault(end.handle, [])
        moved, queue[:PER_EVENT] = queue[:PER_EVENT], []
        for packet in moved:
            end.assembler.feed_packet(packet)
        if moved:
            self.send_hci_packet(
                hci.HCI_Number_Of_Completed_Packets_Event(
                    connection_handles=[end.handle], num_completed_packets=[len(moved)]
                )
            )


class World:
    def __init__(self, base_us, missed, jitter_us):
        self.base_us, self.missed, self.jitter_us = base_us, missed, jitter_us
        self.random = random.Random(1)
        self.tasks = set()


async def open_controller(link, world, word, name):
    port, offset_us, ppm = word.split(":")
    transport = await open_transport(f"tcp-server:127.0.0.1:{port}")
    controller = Virtual(
        name,
        float(offset_us),
        float(ppm),
        world,
        host_source=transport.source,
        host_sink=transport.sink,
        link=link,
    )
    return transport, controller


async def main():
    world = World(*(float(word) for word in sys.argv[1:4]))
    link = LocalLink()
    kept = [await open_controller(link, world, word, f"c{k}") for k, word in enumerate(sys.argv[4:])]
    print("ready", flush=True)
    # Ends with the test that started it.
    await asyncio.get_running_loop().run_in_executor(None, sys.stdin.read)
    del kept
    sys.exit(0)


if __name__ == "__main__":
    logging.basicConfig(level=logging.CRITICAL)
    asyncio.run(main())
