#!/usr/bin/env python3
"""dyncal check and analyse with files whose header says something else than their values: codecs
that change the values, in files named .wav, and ranges that are narrower than what was measured.

    file_values_test.py PROGRAMS SOURCE
"""

import json
import math
import pathlib
import random
import struct
import tempfile

from programs import expect, run

FREQUENCY_HZ, AMPLITUDE, MAGNITUDE, DELAY_S = 80.0, 10.0, 0.98, 2e-3
BEGIN_S, END_S, RAMP_S = 0.7, 3.4, 0.05
EPOCH_NS = 1_700_000_000_000_000_000
CAN_RATE_HZ, ACS_RATE_HZ = 1000.0, 4000.0

ANALOGUE = """bench = "analogue"

[excitation]
frequencies_hz = ["80"]
level = 0.5
settling_s = 0.5
duration_s = 2

[sources.acs]
driver = "file"
path = "acs.wav"
channels = { channel_1 = "reference", channel_2 = "dut" }
units = { reference = "m/s^2", dut = "m/s^2" }

[method]
kind = "analogue"
reference = "acs/reference"
dut = ["acs/dut"]

[uncertainty]
reference_magnitude_rel = 1e-4
reference_phase_rad = 1e-4
acs_delay_s = 1e-8
"""

ON_CAN = """bench = "can"

[excitation]
frequencies_hz = ["80"]
level = 10.0
settling_s = 0.5
duration_s = 2

[sources.can]
driver = "can"
log = "drive.log"
interface = "can0"
dbc = "s.dbc"
messages = ["Acceleration"]
channels = { acc_z = "acceleration_z" }
bit_rate_per_s = 500000
u_utc_s = 1e-6
u_latency_s = 1e-6
frame_duration_correction = false
bus_is_shared = false
RANGES
[sources.acs]
driver = "file"
path = "acs.csv"
time_base = "utc"
units = { reference = "m/s^2", sync = "V" }

[method]
kind = "absolute-time"
reference = "acs/reference"
sync_acs = "acs/sync"
dut = ["can/acceleration_z"]

[uncertainty]
reference_magnitude_rel = 0.001
reference_phase_rad = 0.001
adc_delay_s = 1e-6
acs_delay_s = 1e-8
"""

DBC = """VERSION ""

NS_ :

BS_:

BU_: Sensor Host

BO_ 291 Acceleration: 8 Sensor
 SG_ acc_z : 0|16@1- (0.001,0) [-RANGE|RANGE] "m/s^2" Host
 SG_ count : 16|16@1+ (1,0) [0|65535] "" Host
"""


def played(times_s, amplitude, phase_rad, noise):
    """A step of one sine, with its noise."""
    drawn = random.Random(31)
    values = []
    for t in times_s:
        ramp = min(1.0, max(0.0, min(t - BEGIN_S, END_S - t) / RAMP_S))
        sine = math.sin(2.0 * math.pi * FREQUENCY_HZ * t + phase_rad)
        values.append(ramp * amplitude * sine + drawn.gauss(0.0, noise))
    return values


def times_of(rate_hz):
    return [i / rate_hz for i in range(int((END_S + 0.7) * rate_hz))]


def lag_rad():
    return 2.0 * math.pi * FREQUENCY_HZ * DELAY_S


# As RIFF numbers them, with what a block holds: bits a value, and bytes a block of both channels.
CODECS = {
    "A-law": (6, 8, 2),
    "U-law": (7, 8, 2),
    "MS ADPCM": (2, 4, 1024),
    "IMA ADPCM": (17, 4, 1024),
    "GSM 6.10": (49, 0, 65),
    "MP3": (85, 0, 1),
    "G.721": (64, 4, 64),
    "AAC": (255, 0, 1),
    "WMA": (353, 16, 1024),
}


def write_wav(path, tag, bits, block, payload, channels=2, rate_hz=4000):
    extra = b""
    if tag == 2:  # samples a block, and the seven pairs of coefficients of every such file
        coefficients = (256, 0, 512, -256, 0, 0, 192, 64, 240, 0, 460, -208, 392, -232)
        extra = struct.pack("<HHH14h", 32, (block - 7 * channels) * 8 // 4 // channels + 2, 7,
                            *coefficients)
    elif tag == 17:
        extra = struct.pack("<HH", 2, (block - 4 * channels) * 8 // 4 // channels + 1)
    elif tag == 49:
        extra = struct.pack("<HH", 2, 320)
    elif tag != 1:
        extra = struct.pack("<H", 0)
    form = struct.pack("<HHIIHH", tag, channels, rate_hz, rate_hz * block, block, bits) + extra
    body = b"WAVE" + b"fmt " + struct.pack("<I", len(form)) + form
    body += b"data" + struct.pack("<I", len(payload)) + payload
    path.write_bytes(b"RIFF" + struct.pack("<I", len(body)) + body)


def write_analogue(folder):
    (folder / "bench.toml").write_text(ANALOGUE)
    times_s = times_of(4000.0)
    pairs = zip(played(times_s, 0.5, 0.0, 1e-4), played(times_s, 0.5 * MAGNITUDE, -lag_rad(), 1e-4))
    return b"".join(struct.pack("<hh", *(round(32768 * value) for value in pair)) for pair in pairs)


def analysed(folder):
    result = folder / "result.json"
    result.unlink(missing_ok=True)
    done = run("dyncal", "analyse", folder / "bench.toml", "--output", result)
    points = json.loads(result.read_text())["points"] if result.exists() else []
    return done, points


def expect_covered(case, points):
    expect(len(points) == 1 and points[0]["valid"], f"{case}: {points}")
    point = points[0]
    magnitude = point["magnitude"] - MAGNITUDE
    phase = math.remainder(point["phase_rad"] + lag_rad(), 2.0 * math.pi)
    inside = abs(magnitude) <= point["U_magnitude"] and abs(phase) <= point["U_phase_rad"]
    expect(inside, f"{case}: {magnitude}, {phase} beyond U {point}")
    return point["flag_names"]


def check_codecs(folder):
    payload = write_analogue(folder)
    write_wav(folder / "acs.wav", 1, 16, 4, payload)
    done, points = analysed(folder)
    expect_covered(f"integers: {done.stdout}{done.stderr}", points)
    for name, (tag, bits, block) in CODECS.items():
        write_wav(folder / "acs.wav", tag, bits, block, random.Random(tag).randbytes(16640))
        for command, status in (("check", 3), ("analyse", 1)):
            done = run("dyncal", command, folder / "bench.toml", cwd=folder)
            text = done.stdout + done.stderr
            expect(done.returncode == status, f"{name}, {command}: {done.returncode} {text}")
            expect("floating-point numbers" in text, f"{name}, {command}: {text}")
            for word in ("damaged", "Malformed", "Invalid", "connected"):
                expect(word not in text, f"{name}, {command}: {text}")
        _, points = analysed(folder)
        expect(not any(point["valid"] for point in points), f"{name}: {points}")


def write_on_can(folder, reach):
    (folder / "s.dbc").write_text(DBC.replace("RANGE", f"{reach:g}"))
    times_s = times_of(CAN_RATE_HZ)
    sensor = played(times_s, AMPLITUDE * MAGNITUDE, -lag_rad(), 0.02)
    lines = []
    for i, (t, value) in enumerate(zip(times_s, sensor)):
        data = struct.pack("<hHI", round(1000.0 * value), i % 65536, 0).hex().upper()
        lines.append(f"({EPOCH_NS // 10**9 + t:.6f}) can0 123#{data}\n")
    (folder / "drive.log").write_text("".join(lines))
    times_s = times_of(ACS_RATE_HZ)
    columns = zip(times_s, played(times_s, AMPLITUDE, 0.0, 0.01), played(times_s, 5.0, 0.0, 0.01))
    rows = [f"{EPOCH_NS + round(1e9 * t)},{a:.6f},{b:.6f}\n" for t, a, b in columns]
    (folder / "acs.csv").write_text("t_ns,reference,sync\n" + "".join(rows))


def check_range(folder, ranges, flagged):
    key = f"ranges = {{ acceleration_z = \"{ranges}\" }}" if ranges else ""
    (folder / "bench.toml").write_text(ON_CAN.replace("RANGES", key))
    done = run("dyncal", "check", "bench.toml", cwd=folder)
    expect(done.returncode == 0, f"{ranges}, check: {done.stdout}{done.stderr}")
    done, points = analysed(folder)
    flags = expect_covered(f"{ranges}: {done.stdout}{done.stderr}", points)
    about_range = {"signal_not_judged", "sensor_over_range"} & set(flags)
    expect(bool(about_range) == flagged, f"{ranges}: {flags} {points[0]['flags']}")


def check_ranges(folder):
    write_on_can(folder, reach=7.7)  # less than the values
    check_range(folder, "", flagged=True)
    check_range(folder, "none", flagged=False)
    check_range(folder, "-20 to 20", flagged=False)
    check_range(folder, "-7 to 7", flagged=True)


def main():
    with tempfile.TemporaryDirectory() as name:
        check_codecs(pathlib.Path(name))
    with tempfile.TemporaryDirectory() as name:
        check_ranges(pathlib.Path(name))


main()
