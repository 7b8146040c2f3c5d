#!/usr/bin/env python3
"""dyncal check refuses plans that nobody can run or hold in memory: at once, in little memory, in
one line that names the key. Arguments: programs' folder, source, seed."""

import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile

from programs import FOLDER, expect

SEED = int(sys.argv[3]) if len(sys.argv) > 3 else 32
PLANS = 50
HONEST = 15
LIMIT_S = 1.0  # of the processor: others use it too
LIMIT_KB = 100_000

BENCH = """bench = "acc-1"
[excitation]
frequencies_hz = [{frequencies_hz}]
level = {level}
repetitions = {repetitions}
attempts = {attempts}
settling_s = {settling_s}
duration_s = {duration_s}
[generator]
driver = "scpi"
address = "192.0.2.11:5025"
level_per_volt = 10.0
maximum_voltage_v = 5.0
maximum_level_m_s2 = 20.0
[sources.dau]
driver = "smartup"
listen = "0.0.0.0:7654"
sensor = "0xbccb0100"
nominal_rate_hz = 1000.0
[sources.acs]
driver = "socket"
address = "192.0.2.12:5026"
nominal_rate_hz = 10000.0
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_z"]
[uncertainty]
reference_magnitude_rel = 1e-3
reference_phase_rad = 1e-3
adc_delay_s = 1e-6
acs_delay_s = 1e-7
"""


def honest(draw):
    return {
        "frequencies_hz": ", ".join(f'"{hz}"' for hz in draw.sample(range(10, 400), 5)),
        "level": round(draw.uniform(1.0, 15.0), 3),
        "repetitions": draw.randint(1, 1000),
        "attempts": draw.randint(1, 10),
        "settling_s": round(draw.uniform(0.5, 5.0), 3),
        "duration_s": round(draw.uniform(2.0, 60.0), 3),
    }


def hostile(draw):
    """A plan with one wrong value, and its key."""
    plan = honest(draw)
    far = int(10 ** draw.uniform(4.0, 18.0))
    many = draw.randint(10_001, 100_000)
    key, value = draw.choice(
        [
            ("repetitions", far),
            ("repetitions", -far),
            ("repetitions", 0),
            ("repetitions", f"{far}.0"),
            ("repetitions", "9" * draw.randint(20, 5000)),
            ("attempts", far),
            ("attempts", -far),
            ("duration_s", f"1e{draw.randint(5, 300)}"),
            ("duration_s", draw.choice(["inf", "nan", "-inf", "0.0", "-1.0"])),
            ("settling_s", f"1e{draw.randint(5, 300)}"),
            ("settling_s", draw.choice(["inf", "nan", "-inf", "-1.0"])),
            ("level", draw.choice(["inf", "nan", "-1.0", "1e300"])),
            ("frequencies_hz", f'"1{"0" * draw.randint(1000, 100_000)}"'),
            ("frequencies_hz", ", ".join(['"10"'] * many)),
            ("frequencies_hz", ", ".join(f'"{10 + i / 1000}"' for i in range(many))),
            ("frequencies_hz", ""),
        ]
    )
    return {**plan, key: value}, key


def line_of(plan, key):
    return next(line for line in BENCH.format(**plan).splitlines() if line.startswith(key))


def check(folder, plan):
    """Status, output, processor time in s and memory in kB of a check of this plan."""
    path = folder / "bench.toml"
    path.write_text(BENCH.format(**plan))
    out = folder / "out"
    with out.open("wb") as file:
        child = subprocess.Popen([FOLDER / "dyncal", "check", path], stdout=file, stderr=file)
        _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, out.read_text(), used.ru_utime + used.ru_stime, used.ru_maxrss


def main():
    draw = random.Random(SEED)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        slowest, largest = 0.0, 0
        for number in range(HONEST):
            plan = honest(draw)
            status, text, _, memory = check(folder, plan)
            expect(status == 0, f"seed {SEED}, honest plan {number}, {plan}: {text}")
        limit = max(LIMIT_KB, 2 * memory)  # a sanitizer needs more for everything
        for number in range(PLANS):
            plan, key = hostile(draw)
            shown = f"seed {SEED}, plan {number}, {key} = {str(plan[key])[:60]}"
            status, text, seconds, memory = check(folder, plan)
            expect(status == 3, f"{shown}: status {status}: {text[-400:]}")
            line = 1 + BENCH.format(**plan).splitlines().index(line_of(plan, key))
            named = f"{key}|repetitions" if key == "frequencies_hz" else key
            expect(re.search(rf"{named}|toml:{line}: ", text), f"{shown}: {text}")
            expect(max(map(len, text.splitlines())) < 400, f"{shown}: {text[:1000]}")
            expect(seconds < LIMIT_S, f"{shown}: {seconds} s")
            expect(memory < limit, f"{shown}: {memory} kB")
            slowest, largest = max(slowest, seconds), max(largest, memory)
    print(f"{PLANS} plans refused within {slowest:.2f} s and {largest / 1000:.0f} MB each")


main()
