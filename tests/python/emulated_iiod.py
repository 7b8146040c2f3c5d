"""The other end of libiio's network: an IIOD of version 0.24 with one ADC of two channels.

    with EmulatedIiod(rate_hz, block_of) as context: ...     # "ip:127.0.0.1:PORT"

Text lines over TCP; samples are 24 bits in the upper end of 32 (le:s24/32>>8), paced by the rate.
block_of(first, count) gives counts, int32 (count, 2).
"""

import socketserver
import threading
import time

DEVICE = "iio:device0"
CONTEXT = """<?xml version="1.0" encoding="utf-8"?>
<context name="network" description="emulated"><device id="iio:device0" name="adc">
<attribute name="sampling_frequency" filename="sampling_frequency"/>
<channel id="voltage0" type="input"><scan-element index="0" format="le:s24/32&gt;&gt;8"/>
<attribute name="scale" filename="in_voltage0_scale"/></channel>
<channel id="voltage1" type="input"><scan-element index="1" format="le:s24/32&gt;&gt;8"/>
<attribute name="scale" filename="in_voltage1_scale"/></channel>
</device></context>"""
SCALES = {"voltage0": "0.0025", "voltage1": "0.0005"}
NOT_THERE = -2  # ENOENT
NOT_SO = -22  # EINVAL: the client asks again in another way
BYTES_A_SAMPLE = 8


class Connection(socketserver.StreamRequestHandler):
    def handle(self):
        self.first, self.begin = 0, time.monotonic()
        while line := self.rfile.readline().decode().split():
            if line[0] == "EXIT":
                return
            self.wfile.write(self.answer(line))

    def answer(self, words):
        if words[0] == "VERSION":
            return b"0.24.v0.24  \n"  # seven places of the tag
        if words[0] == "PRINT":
            return f"{len(CONTEXT)}\n{CONTEXT}\n".encode()
        if words[0] == "READ":
            return self.attribute(words)
        if words[0] == "READBUF":
            return self.samples(int(words[2]))
        return b"0\n" if words[0] in ("TIMEOUT", "SET", "OPEN", "CLOSE") else f"{NOT_SO}\n".encode()

    def attribute(self, words):
        known = {f"{name} scale": scale for name, scale in SCALES.items()}
        known["sampling_frequency"] = str(self.server.rate_hz)
        value = known.get(" ".join(words[3:] if words[2] == "INPUT" else words[2:]))
        return f"{len(value) + 1}\n{value}\0\n".encode() if value else f"{NOT_THERE}\n".encode()

    def samples(self, wanted):
        count = wanted // BYTES_A_SAMPLE
        due = self.begin + (self.first + count) / self.server.rate_hz
        time.sleep(max(0.0, due - time.monotonic()))  # the clock of the ADC
        counts = self.server.block_of(self.first, count)
        self.first += count
        return f"{wanted}\n00000003\n".encode() + (counts << 8).astype("<i4").tobytes()


class EmulatedIiod(socketserver.ThreadingTCPServer):
    daemon_threads = True
    allow_reuse_address = True

    def __init__(self, rate_hz, block_of):
        super().__init__(("127.0.0.1", 0), Connection)
        self.rate_hz, self.block_of = rate_hz, block_of

    def __enter__(self):
        threading.Thread(target=self.serve_forever, daemon=True).start()
        return f"ip:127.0.0.1:{self.server_address[1]}"

    def __exit__(self, *failure):
        self.shutdown()
        self.server_close()
