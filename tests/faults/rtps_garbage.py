#!/usr/bin/env python3
"""Sends malformed RTPS to every port of a DDS domain at a host, until it is killed.

rtps_garbage.py ADDRESS DOMAIN KIND PER_SECOND
  random    bytes
  header    a right header, then submessages of drawn kinds and lengths
  mutated   packets of the network (as this host sees them for 5 s), some bytes of each drawn anew

The same bytes at every call, but for the packets of the network. mutated needs root.
"""
import random
import socket
import struct
import sys
import time

KINDS_OF_SUBMESSAGE = (0x01, 0x06, 0x07, 0x08, 0x09, 0x0C, 0x0E, 0x12, 0x13, 0x15, 0x16, 0x80)
VENDORS = (b"\x01\x0f", b"\x01\x10")


def captured(seconds):
    sniffer = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.ntohs(3))
    sniffer.settimeout(1)
    packets = []
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            frame = sniffer.recv(3000)
        except OSError:
            continue
        begin = frame.find(b"RTPS")
        if 0 < begin < 60:
            packets.append(frame[begin:])
    if not packets:
        sys.exit("no RTPS packet was seen")
    return packets


def submessage(draw):
    kind = draw.choice(KINDS_OF_SUBMESSAGE + (draw.randrange(256),))
    length = draw.choice((0, 20, 24, 28, 48, draw.randrange(1400)))
    body = draw.randbytes(draw.randrange(64))
    return bytes((kind, draw.randrange(16))) + struct.pack("<H", length) + body


def mutated(packet, draw):
    packet = bytearray(packet)
    for _ in range(draw.choice((1, 1, 1, 2, 4, 16))):
        packet[draw.randrange(len(packet))] = draw.choice((draw.randrange(256), 0, 255, 127, 128))
    cut = draw.random() < 0.1
    return bytes(packet[: draw.randrange(len(packet) + 1)] if cut else packet)


def main():
    address, domain, kind, rate = sys.argv[1], int(sys.argv[2]), sys.argv[3], int(sys.argv[4])
    draw = random.Random(1)
    real = captured(5) if kind == "mutated" else []
    first = 7400 + 250 * domain
    ports = [first, first + 1] + [first + 10 + i for i in range(16)]
    out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    begin = time.monotonic()
    for sent in range(sys.maxsize):
        if kind == "random":
            datagram = draw.randbytes(draw.randrange(1, 1400))
        elif kind == "header":
            datagram = b"RTPS\x02\x01" + draw.choice(VENDORS) + draw.randbytes(12)
            datagram += b"".join(submessage(draw) for _ in range(draw.randrange(1, 5)))
        else:
            datagram = mutated(draw.choice(real), draw)
        try:
            out.sendto(datagram, (address, draw.choice(ports)))
        except OSError:
            pass  # nobody listens at this port
        if sent % 100 == 0:
            time.sleep(max(0.0, begin + sent / rate - time.monotonic()))


main()
