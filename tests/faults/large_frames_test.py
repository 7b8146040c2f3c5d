#!/usr/bin/env python3
"""An ACS that sends its samples in the longest frames of its protocol, as fast as they are taken.

    large_frames_test.py PROGRAMS

PROGRAMS is the folder of the built programs. Held, over each DDS vendor: dyncal-acs takes all of
200 MB, and its memory does not grow with them: what it keeps is bounded in bytes, however long the
frames are (drivers/acs/README.md).
"""

import array
import json
import pathlib
import socket
import struct
import sys
import tempfile
import unittest

from bench_laboratory import PATIENCE_S, Program, reserve_dds_domain
from process_figures import figures

FRAME_SAMPLES = 65_536
CHANNELS = 2
FRAMES = 200  # of 1 MB
MAX_PEAK_MB = 256.0  # 1800 before blocks were bounded in bytes; 50 to 130 now
MAGIC = 0x46534341

DESCRIPTION = {
    "protocol": "dyncal-acs-stream",
    "version": 1,
    "device": "an instrument with a large memory",
    "serial": "1",
    "firmware": "1",
    "sample_rate_hz": {"numerator": 1_000_000, "denominator": 1},
    "origin_ns": 0,
    "time_base": "local",
    "values": "float64",
    "channels": [
        {"name": "reference", "quantity": "Acceleration", "unit": "\\metre\\second\\tothe{-2}"},
        {"name": "sync", "quantity": "Voltage", "unit": "\\volt"},
    ],
}
BENCH = """bench = "large-frames"
[excitation]
frequencies_hz = ["40"]
level = 10.0
duration_s = 1.0
[sources.acs]
driver = "socket"
address = "{acs}"
[sources.dau]
driver = "smartup"
sensor = "0xbccb0100"
listen = "127.0.0.1:0"
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_z"]
"""


class LargeFrames(unittest.TestCase):
    def test_are_taken_in_little_memory(self):
        for vendor in ("cyclonedds", "fastdds"):
            with self.subTest(vendor), tempfile.TemporaryDirectory() as folder:
                self.send_to_service(vendor, pathlib.Path(folder))

    def send_to_service(self, vendor, folder):
        domain, keeper = reserve_dds_domain()
        with keeper, socket.create_server(("127.0.0.1", 0)) as instrument:
            instrument.settimeout(0.1)
            address = f"127.0.0.1:{instrument.getsockname()[1]}"
            bench = folder / "bench.toml"
            bench.write_text(BENCH.format(acs=address), encoding="utf-8")
            command = [PROGRAMS / "dyncal-acs", bench, "--domain", str(domain), "--dds", vendor]
            service = Program(command, folder / "log.txt")
            try:
                with self.connection_of(service, instrument) as connection:
                    connection.settimeout(PATIENCE_S)
                    self.send_frames(connection, service)
            finally:
                service.end()

    def connection_of(self, service, instrument):
        while service.runs():
            try:
                return instrument.accept()[0]
            except TimeoutError:
                continue
        self.fail(service.errors())

    def send_frames(self, connection, service):
        connection.sendall(json.dumps(DESCRIPTION).encode() + b"\n")
        values = array.array("d", [0.5] * (FRAME_SAMPLES * CHANNELS)).tobytes()
        for frame in range(FRAMES):
            header = struct.pack("<IIQ", MAGIC, FRAME_SAMPLES, frame * FRAME_SAMPLES)
            connection.sendall(header + values)
        self.assertTrue(service.runs(), service.errors())
        peak_mb = figures(service.process.pid).peak_mb
        print(f"{FRAMES} MB in frames of {FRAME_SAMPLES} samples: at most {peak_mb:.0f} MB")
        self.assertLess(peak_mb, MAX_PEAK_MB)
        self.assertIn("keeps up to", service.errors())  # it has described itself


if __name__ == "__main__":
    PROGRAMS = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main(verbosity=2)
