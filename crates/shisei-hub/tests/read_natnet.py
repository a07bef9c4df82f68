"""An independent client (PyPI natnet) reads what `shisei live --demo --natnet-out` gives out.

usage: read_natnet.py SHISEI
"""

import socket
import subprocess
import sys
import threading
import time

from natnet import NatNetClient, Version


def free_port(kind):
    with socket.socket(socket.AF_INET, kind) as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def drain(client):
    """What came before the change of version is of the old one, which the client would take for the new."""
    command = client._NatNetClient__command_socket
    command.settimeout(0.0)
    try:
        while True:
            command.recvfrom(65536)
    except BlockingIOError:
        pass


def read(command, data, version, multicast=False):
    client = NatNetClient(command_port=command, data_port=data, use_multicast=multicast)
    frames, models = [], []
    client.on_data_frame_received_event.handlers.append(frames.append)
    client.on_data_description_received_event.handlers.append(models.append)
    with client:
        assert client.server_info.application_name == "shisei", client.server_info
        if version != client.protocol_version.truncate(2):
            client.protocol_version = version
            drain(client)
        client.run_async()
        until = time.time() + 8
        while time.time() < until and (len(frames) < 200 or not models):
            if not models:
                client.request_modeldef()
            time.sleep(0.2)
        client.stop_async()
    return frames, models


def check(what, frames, models):
    assert len(frames) >= 200, f"{what}: {len(frames)} frames"
    numbers = [frame.prefix.frame_number for frame in frames]
    steps = {b - a for a, b in zip(numbers, numbers[1:])}
    assert steps == {1}, f"{what}: steps {steps}"
    last = frames[-1]
    assert len(last.rigid_bodies) == 3, last.rigid_bodies
    assert any(body.tracking_valid for body in last.rigid_bodies)
    assert len(last.skeletons) == 1 and len(last.skeletons[0].rigid_bodies) == 11
    names = {body.name for body in models[-1].rigid_bodies}
    assert {"Tool 1", "Board", "Wand"} <= {n.decode() if isinstance(n, bytes) else n for n in names}, names
    print(f"NatNet {what}: {len(frames)} frames, {len(models)} descriptions")


def serve(shisei, options):
    command, data, page = free_port(socket.SOCK_DGRAM), free_port(socket.SOCK_DGRAM), free_port(socket.SOCK_STREAM)
    out = ["--natnet-out", f"127.0.0.1:{command}:{data}", *options]
    process = subprocess.Popen(
        [shisei, "live", "--demo", "--listen", f"127.0.0.1:{page}", *out],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    process.stdout.readline()
    time.sleep(1.5)
    return process, command, data


def main():
    shisei = sys.argv[1]
    passed = 0
    process, command, data = serve(shisei, [])
    try:
        for version in [Version(4, 1), Version(4, 0), Version(3, 1), Version(3, 0)]:
            check(version, *read(command, data, version))
            passed += 1
    finally:
        process.terminate()
        process.wait()
    process, command, data = serve(shisei, ["--natnet-multicast"])
    try:
        check("4.1, multicast", *read(command, data, Version(4, 1), multicast=True))
        passed += 1
    finally:
        process.terminate()
        process.wait()
    print(f"{passed} passed, 0 failed")


if __name__ == "__main__":
    main()
