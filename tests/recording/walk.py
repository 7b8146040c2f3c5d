"""Walks an MCAP file by the format's description, with Python's standard library alone."""

import struct
import sys
import zlib

MAGIC = b"\x89MCAP0\r\n"


class Wrong(Exception):
    """What is wrong with a file."""


def need(condition, what):
    if not condition:
        raise Wrong(what)


def messages_of(records):
    count = 0
    at = 0
    while at < len(records):
        opcode, length = struct.unpack_from("<BQ", records, at)
        at += 9 + length
        need(at <= len(records), "a record is longer than its chunk")
        count += opcode == 5
    return count


def messages(path):
    """Topic and data of each message of a file whose chunks are not compressed."""
    with open(path, "rb") as stream:
        data = stream.read()
    topics = {}
    at = 8
    while at < len(data) - 8:
        opcode, length = struct.unpack_from("<BQ", data, at)
        content = at + 9
        at = content + length
        if opcode == 4:
            number, _, name_bytes = struct.unpack_from("<HHI", data, content)
            topics[number] = data[content + 8 : content + 8 + name_bytes].decode()
        elif opcode == 6:
            inner = content + 40
            while inner < at:
                kind, size = struct.unpack_from("<BQ", data, inner)
                if kind == 5:
                    (number,) = struct.unpack_from("<H", data, inner + 9)
                    yield topics[number], data[inner + 9 + 22 : inner + 9 + size]
                inner += 9 + size
        elif opcode == 15:
            return


def walk(path):
    """How many messages the file holds. Raises Wrong unless all of it is sound."""
    with open(path, "rb") as stream:
        data = stream.read()
    need(data[:8] == MAGIC and data[-8:] == MAGIC, "magic")
    need(data[-37] == 2, "no Footer before the end")
    messages = 0
    at = 8
    while True:
        need(at + 9 <= len(data), "no DataEnd")
        opcode, length = struct.unpack_from("<BQ", data, at)
        content = at + 9
        at = content + length
        need(at <= len(data), f"a record at {content - 9} is longer than the file")
        if opcode == 6:
            crc, name_bytes = struct.unpack_from("<II", data, content + 24)
            begin = content + 32 + name_bytes + 8
            need(name_bytes == 0, "a compressed chunk")
            records = data[begin:at]
            need(zlib.crc32(records) == crc, f"the chunk at {content - 9} has another CRC")
            messages += messages_of(records)
        elif opcode == 15:
            (crc,) = struct.unpack_from("<I", data, content)
            need(crc in (0, zlib.crc32(data[: content - 9])), "the data have another CRC")
            return messages
        else:
            need(opcode in (1, 3, 4, 7, 9, 12, 0x80), f"an unexpected record {opcode}")


if __name__ == "__main__":
    print(walk(sys.argv[1]))
