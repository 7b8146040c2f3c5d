#!/usr/bin/env python3
"""The closures of real records: a seismometer on a shake table, with one digitiser and as if with
two of which one has another clock, and the stamps of a MEMS IMU with the dropouts of its logger.

    real_records_test.py DYNCAL

The records stand beside the project, in ../shared/data; without them the test skips.
"""

import csv
import json
import lzma
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import unittest

DYNCAL = pathlib.Path(sys.argv[1]).resolve()
DATA = pathlib.Path(__file__).resolve().parents[3] / "shared/data"
SEISMOMETER = DATA / "seismometer"
IMU = DATA / "imu/sensor_combined.csv.xz"
SEED = 2026_11_27
METRES_PER_COUNT = 0.9442e-6 / 0.9932e3 * 0.579  # the laser's factor, by the lever to the mass
VOLTS_PER_COUNT = 0.9425e-6


def rows_of(path):
    with lzma.open(path, "rt", newline="") as file:
        yield from csv.reader(file)


def seismometer_steps():
    """(frequency, [(t_ns, sync, laser, coil)]) of each file, in the order of recording."""
    steps = []
    for path in SEISMOMETER.glob("*Hz.csv.xz"):
        frequency = re.match(r"(\d+)_(\d+)Hz", path.name).expand(r"\1.\2")
        rows = []
        for row in rows_of(path):
            if row[0].isdigit():
                seconds, fraction = row[12].split(".")
                stamp_ns = int(seconds) * 10**9 + int(fraction.ljust(9, "0"))
                rows.append((stamp_ns, *(int(row[i]) for i in (2, 4, 3))))
        steps.append((frequency, rows))
    return sorted(steps, key=lambda step: step[1][0][0])


class RealRecords(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="dyncal-real-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def evaluated(self, bench):
        """Closures by kind, and the result, of the only channel."""
        (self.folder / "bench.toml").write_text(bench)
        made = subprocess.run(
            [DYNCAL, "analyse", "bench.toml", "--output", "result.json"],
            cwd=self.folder,
            capture_output=True,
            text=True,
        )
        self.assertTrue((self.folder / "result.json").exists(), made.stdout + made.stderr)
        result = json.loads((self.folder / "result.json").read_text())
        self.assertEqual(len(result["channels"]), 1)
        closures = {}
        for closure in result["channels"][0]["closures"]:
            closures.setdefault(closure["kind"], []).append(closure)
        return closures, result

    def assert_verdicts(self, closures, closing=(), open_ones=()):
        """These, and all others not possible."""
        for kind, all_of in closures.items():
            verdict = (
                "closes" if kind in closing else "open" if kind in open_ones else "not_possible"
            )
            for one in all_of:
                self.assertEqual(one["verdict"], verdict, f"{kind}: {one['sentence']}")
        self.assertEqual({*closing, *open_ones} - set(closures), set())

    def write(self, name, header, rows):
        with open(self.folder / name, "w", newline="") as file:
            file.write(header + "\n")
            file.writelines(",".join(map(str, row)) + "\n" for row in rows)


class Seismometer(RealRecords):
    """Its phase against displacement has a resonance at 0.49 Hz, above that a line from 90
    degrees; sensor and reference are of two kinds; the levels were not noted in m/s^2."""

    def bench(self, steps, method, rate_rel=0.0):
        frequencies = ", ".join(f'"{frequency}"' for frequency, _ in steps)
        acs, dau = [], []
        for _, rows in steps:
            for stamp_ns, sync, laser, coil in rows:
                acs.append((stamp_ns, METRES_PER_COUNT * laser, VOLTS_PER_COUNT * sync,
                            VOLTS_PER_COUNT * coil))  # fmt: skip
                since_ns = stamp_ns - steps[0][1][0][0]
                dau.append((stamp_ns + round(rate_rel * since_ns), VOLTS_PER_COUNT * sync,
                            VOLTS_PER_COUNT * coil))  # fmt: skip
        self.write("acs.csv", "t_ns,laser,sync,coil", acs)
        self.write("dau.csv", "t_ns,sync,coil", dau)
        return f"""bench = "seismometer"
[excitation]
frequencies_hz = [{frequencies}]
level = 1.0
settling_s = 2.0
duration_s = 40.0
[sources.acs]
driver = "file"
path = "acs.csv"
units = {{ laser = "m", sync = "V", coil = "V" }}
[sources.dau]
driver = "file"
path = "dau.csv"
units = {{ sync = "V", coil = "V" }}
{method}"""

    ONE = """[method]
kind = "analogue"
reference = "acs/laser"
sync_acs = "acs/sync"
dut = ["acs/coil"]
"""
    TWO = """[method]
kind = "sample-timestamping"
reference = "acs/laser"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/coil"]
"""

    def test_one_digitiser(self):
        closures, result = self.evaluated(self.bench(seismometer_steps(), self.ONE))
        self.assert_verdicts(
            closures,
            closing=("excitation_frequency", "samples_counted", "delay_alternatives"),
            open_ones=("delay_fit",),
        )
        # The laser is good from 0.3 to 3 Hz, and at 0.2 Hz it was out of range.
        values = {v["frequency_text_hz"]: v for v in result["transfer_function"]}
        self.assertIn("over_range", values["0.2"]["flag_names"])
        for frequency in ("0.7", "0.8", "0.9", "1.0", "2.0", "3.0"):
            self.assertNotIn("peaks_bent", values[frequency]["flag_names"], frequency)

    def test_its_resonance_stated(self):
        method = self.ONE + 'dut_phase = "any"\n'
        closures, result = self.evaluated(self.bench(seismometer_steps(), method))
        self.assert_verdicts(closures, closing=("excitation_frequency", "samples_counted"))
        self.assertEqual(result["group_delay"], [])
        self.assertIn("not that of a delay", result["channels"][0]["group_delay_problem"])

    def test_from_1_to_4_hz_where_it_has_a_delay(self):
        steps = [s for s in seismometer_steps() if s[0] in ("1.0", "2.0", "3.0", "4.0")]
        closures, result = self.evaluated(self.bench(steps, self.ONE))
        self.assert_verdicts(
            closures,
            closing=("excitation_frequency", "samples_counted", "delay_alternatives", "delay_fit"),
        )
        delay = result["group_delay"][0]
        self.assertAlmostEqual(delay["value_s"], -2.44e-3, delta=0.05e-3)
        self.assertAlmostEqual(math.degrees(delay["intercept_rad"]), 90.0, delta=0.05)

    def test_two_clocks(self):
        for rate_rel, verdict in ((50e-6, "closes"), (-800e-6, "open")):
            closures, _ = self.evaluated(self.bench(seismometer_steps(), self.TWO, rate_rel))
            clocks = ("clock_rate",)
            self.assert_verdicts(
                closures,
                closing=("excitation_frequency", "samples_counted", "delay_alternatives",
                         "clock_ratio", *(clocks if verdict == "closes" else ())),
                open_ones=("delay_fit", *(clocks if verdict == "open" else ())),
            )  # fmt: skip
            found = closures["clock_rate"][0]
            self.assertAlmostEqual(abs(found["value"]), abs(rate_rel), delta=0.05e-6)


class InertialUnit(RealRecords):
    """Its stamps and its noise are real, with four dropouts of 51 samples; sines are put on it."""

    FREQUENCIES = ("3", "5", "8", "13", "21", "34")
    STEP_S = 10.0

    def bench(self):
        draw = random.Random(SEED)
        rows = [row for row in rows_of(IMU) if row[0].isdigit()]
        origin_us = int(rows[0][0])
        delay_s = 2e-3 + 2e-3 * draw.random()

        def sine(t_s):
            step, since_s = divmod(t_s, self.STEP_S)
            step = int(step)
            if not 0 <= step < len(self.FREQUENCIES) or since_s > self.STEP_S - 1.5:
                return 0.0
            return math.sin(2 * math.pi * float(self.FREQUENCIES[step]) * t_s)

        dau = []
        for row in rows:
            t_s = 1e-6 * (int(row[0]) - origin_us)
            moved = float(row[4]) + 4 * sine(t_s - 1 - delay_s)
            dau.append((1000 * int(row[0]), moved, sine(t_s - 1)))
        acs = []
        for i in range(72 * 2000):
            t_s = i / 2000
            acs.append((1000 * origin_us + i * 500_000,
                        4 * sine(t_s - 1) + 1e-3 * draw.gauss(0, 1), sine(t_s - 1)))  # fmt: skip
        self.write("acs.csv", "t_ns,reference,sync", acs)
        self.write("dau.csv", "t_ns,z,sync", dau)
        return f"""bench = "imu"
[excitation]
frequencies_hz = [{", ".join(f'"{f}"' for f in self.FREQUENCIES)}]
level = 4.0
settling_s = 1.0
duration_s = 7.0
[sources.acs]
driver = "file"
path = "acs.csv"
units = {{ reference = "m/s^2", sync = "V" }}
[sources.dau]
driver = "file"
path = "dau.csv"
units = {{ z = "m/s^2", sync = "V" }}
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/z"]
"""

    def test_stamps_with_dropouts(self):
        closures, result = self.evaluated(self.bench())
        self.assert_verdicts(
            closures,
            closing=("clock_rate", "clock_ratio", "excitation_frequency", "level",
                     "samples_counted", "delay_fit", "delay_alternatives", "phase_at_zero"),
        )  # fmt: skip
        self.assertGreater(result["sample_clock"][0]["lost"], 0)


if __name__ == "__main__":
    for data in (SEISMOMETER, IMU):
        if not data.exists():
            print(f"SKIPPED: {data} is not there")
            sys.exit(77)
    unittest.main(argv=sys.argv[:1])
