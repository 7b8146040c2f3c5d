#!/usr/bin/env python3
"""Compares our DBC decoder with canmatrix (Debian's python3-canmatrix) on random frames of every
message of every file.

    dbc_oracle.py DBC_PRINT FOLDER [frames of each file, default 10000]

Every signal of every frame is compared: whether it is in the frame, its raw integer, its value.
Exit status 0: all agree; 1: a difference; 77: canmatrix or the files are not there.
"""

import io
import logging
import pathlib
import random
import struct
import subprocess
import sys

logging.disable(logging.CRITICAL)
ABSENT, NOT_AVAILABLE, ERROR = 1, 3, 4
LENGTHS = (0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64)


def skip(reason):
    print("skipped: " + reason)
    sys.exit(77)


def random_payload(generator, size):
    """Half of the bytes small, so that switches of multiplexed messages often name a branch."""
    return bytes(
        generator.choice(
            (generator.randrange(256), generator.randrange(4), generator.choice((8, 16, 24)) << 2)
        )
        for _ in range(size)
    )


def raw_of(signal, bits):
    """The integer of the frame that canmatrix gives for these bits."""
    if signal.is_signed and bits >> (signal.size - 1):
        return bits - (1 << signal.size)
    return bits


def differences(file, printer, frames_of_file):
    import canmatrix.formats

    matrix = canmatrix.formats.loadp_flat(str(file), dbcImportEncoding="cp1252")
    # Where a message has SG_MUL_VAL_ for some signals, canmatrix loses those that are marked mN
    # alone; it reads them without SG_MUL_VAL_.
    text = b"\n".join(
        line for line in file.read_bytes().split(b"\n") if not line.startswith(b"SG_MUL_VAL_ ")
    )
    simple = canmatrix.formats.load_flat(io.BytesIO(text), "dbc", dbcImportEncoding="cp1252")
    simple_messages = {
        (message.arbitration_id.id, bool(message.arbitration_id.extended), message.name): message
        for message in simple.frames
    }
    messages = {}
    for message in matrix.frames:
        key = (message.arbitration_id.id, bool(message.arbitration_id.extended))
        if message.name != "VECTOR__INDEPENDENT_SIG_MSG" and message.signals:
            messages.setdefault(key, message)
    generator = random.Random(5)
    cases = []
    for key, message in messages.items():
        for _ in range(-(-frames_of_file // len(messages))):
            size = next(length for length in LENGTHS if length >= message.size)
            cases.append((key, message, random_payload(generator, size)))
    text = "".join("%x %d %s\n" % (key[0], key[1], data.hex() or "-") for key, _, data in cases)
    output = subprocess.run(
        [str(printer), str(file)], input=text, capture_output=True, text=True, check=True
    ).stdout
    ours = [{} for _ in cases]
    for line in output.splitlines():
        number, name, state, bits, value = line.split()
        ours[int(number)][name] = (state, bits, value)
    compared = 0
    for (_, message, data), own in zip(cases, ours):
        theirs = message.decode(data[: message.size])
        lost = [
            signal.name
            for signal in message.signals
            if isinstance(signal.multiplex, int) and not signal.mux_val_grp
        ]
        if lost and message.is_complex_multiplexed:
            plain = simple_messages[
                message.arbitration_id.id, bool(message.arbitration_id.extended), message.name
            ].decode(data[: message.size])
            theirs.update((name, plain[name]) for name in lost if name in plain)
        if set(own) != {signal.name for signal in message.signals}:
            yield "%s %s: signals %s, canmatrix has others" % (
                message.name,
                data.hex(),
                sorted(own),
            )
            continue
        for signal in message.signals:
            state, bits, value = own[signal.name]
            state, bits = int(state), int(bits)
            where = "%s.%s in %s: " % (message.name, signal.name, data.hex())
            if (state == ABSENT) != (signal.name not in theirs):
                yield where + "state %d, canmatrix %s it" % (
                    state,
                    "has" if signal.name in theirs else "has not",
                )
                continue
            if state == ABSENT:
                continue
            compared += 1
            value = struct.unpack(">d", bytes.fromhex(value))[0]
            raw = theirs[signal.name].raw_value
            if signal.is_float:
                if value != raw and not (value != value and raw != raw):
                    yield where + "%r, canmatrix %r" % (value, raw)
                continue
            if raw_of(signal, bits) != raw:
                yield where + "raw %d, canmatrix %d" % (raw_of(signal, bits), raw)
            # canmatrix knows no "not available" of J1939, and computes in decimal: what its exact
            # value rounds to is what we must give.
            if state in (NOT_AVAILABLE, ERROR):
                top = bits >> max(signal.size - 8, 0) if signal.size > 2 else bits | 0xFC
                if top != (0xFF if state == NOT_AVAILABLE else 0xFE):
                    yield where + "said not to be available"
                continue
            exact = raw * float(signal.factor) + float(signal.offset)
            if value != exact or abs(value - float(theirs[signal.name].phys_value)) > 1e-12 * max(
                abs(raw * float(signal.factor)), abs(float(signal.offset)), 1e-300
            ):
                yield where + "%r, canmatrix %s" % (value, theirs[signal.name].phys_value)
    print(
        "%s: %d messages, %d frames, %d signals compared"
        % (file.name, len(messages), len(cases), compared)
    )


def main():
    printer, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    frames_of_file = int(sys.argv[3]) if len(sys.argv) > 3 else 10000
    try:
        import canmatrix.formats  # noqa: F401
    except ImportError:
        skip(
            "canmatrix is not installed for %s; apt-get install python3-canmatrix" % sys.executable
        )
    files = sorted(folder.glob("*.dbc"))
    if not files:
        skip("no DBC files in %s" % folder)
    found = 0
    for file in files:
        for difference in differences(file, printer, frames_of_file):
            found += 1
            if found <= 20:
                print(file.name + ": " + difference)
    print("%d files, %d differences" % (len(files), found))
    sys.exit(1 if found else 0)


main()
