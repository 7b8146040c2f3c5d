"""Writes XDF files, which the public library only reads: chunks by the format's specification."""

import struct

FORMATS = {"float32": "f", "double64": "d", "int8": "b", "int16": "h", "int32": "i", "int64": "q"}


def chunk(tag, content):
    body = struct.pack("<H", tag) + content
    return struct.pack("<BI", 4, len(body)) + body


def header_chunk(number, name, channels, rate_hz, kind):
    described = "".join(f"<channel><label>{label}</label><unit>{unit}</unit></channel>"
                        for label, unit in channels)
    xml = (f"<?xml version='1.0'?><info><name>{name}</name><type>drawn</type>"
           f"<channel_count>{len(channels)}</channel_count><nominal_srate>{rate_hz}</nominal_srate>"
           f"<channel_format>{kind}</channel_format><source_id>{name} 4711</source_id>"
           f"<desc><channels>{described}</channels></desc></info>")
    return chunk(2, struct.pack("<I", number) + xml.encode())


def samples_chunk(number, kind, stamps, rows):
    content = struct.pack("<IBI", number, 4, len(stamps))
    for stamp, row in zip(stamps, rows):
        content += struct.pack("<Bd", 8, stamp)
        if kind == "string":
            for text in row:
                content += struct.pack("<BB", 1, len(text)) + text.encode()
        else:
            content += struct.pack(f"<{len(row)}{FORMATS[kind]}", *row)
    return chunk(3, content)


def offset_chunk(number, time, offset):
    return chunk(4, struct.pack("<Idd", number, time, offset))


def footer_chunk(number, count):
    xml = f"<?xml version='1.0'?><info><sample_count>{count}</sample_count></info>"
    return chunk(6, struct.pack("<I", number) + xml.encode())


def file_bytes(chunks):
    return b"XDF:" + chunk(1, b"<?xml version='1.0'?><info><version>1.0</version></info>") + chunks
