#!/usr/bin/env python3
"""The raw signals of a laser interferometer, evaluated by `dyncal analyse` from files.

    interferometer_test.py DYNCAL WORK

A sensor whose response is drawn, and the quadrature signals of the mirror beside it, with offsets,
gain, quadrature error, noise, drift of the table and hum, from the seed DYNCAL_FILE_SEED. H must be
that of the sensor within 4 u; the last step, of 50 nm at 10 kHz, takes the ellipse of the others.
Needs NumPy.
"""

import cmath
import json
import math
import os
import pathlib
import subprocess
import sys
import unittest

try:
    import numpy
except ImportError:
    print("skipped: NumPy is not there")
    sys.exit(77)

PROGRAM, WORK = sys.argv[1], pathlib.Path(sys.argv[2])
RATE_HZ = 200_000
STEPS = {80: 20.0, 160: 10.0, 1000: 10.0, 2000: 10.0, 10000: 197.0}  # m/s^2
SETTLING_S, DURATION_S, PAUSE_S, QUIET_S = 0.5, 1.0, 0.4, 0.3
WAVELENGTH_M = 632.8211e-9
ROWS = ("ellipse of the interferometer", "periodic error of the interferometer",
        "wavelength of the laser in air")
BENCH = """bench = "laser"
[excitation]
frequencies_hz = [FREQUENCIES]
level = [LEVELS]
settling_s = 0.5
duration_s = 1.0
[generator]
driver = "none"
[sources.acs]
driver = "file"
path = "acs.npy"
sample_rate_hz = 200000
units = { sync = "V", dut = "V" }
[sources.acs.interferometer]
u1 = "u1"
u2 = "u2"
wavelength_nm = 632.8211
u_wavelength_rel = 1e-7
detector_bandwidth_hz = 5e6
u_skew_s = 1e-9
output_rate_hz = 100000
MORE
[method]
kind = "analogue"
reference = "acs/displacement"
sync_acs = "acs/sync"
dut = ["acs/dut"]
"""


def drawn(draw):
    """Columns of the record, and the response in V/(m/s^2)."""
    parts, responses = [numpy.zeros((3, int(QUIET_S * RATE_HZ)))], {}
    for hz, level in STEPS.items():
        n = int((SETTLING_S + DURATION_S + 0.3) * RATE_HZ)
        turn = 2 * math.pi * hz * numpy.arange(n) / RATE_HZ
        phase = draw.uniform(-3, 3)
        response = cmath.rect(draw.uniform(0.02, 0.05), draw.uniform(-1, 1))
        responses[hz] = response
        acceleration = level * numpy.exp(1j * (turn + phase))
        parts.append(numpy.stack([(-acceleration / (2 * math.pi * hz) ** 2).imag,
                                  (acceleration * response).imag,
                                  numpy.sin(turn + draw.uniform(-3, 3))]))
        parts.append(numpy.zeros((3, int(PAUSE_S * RATE_HZ))))
    displacement, dut, sync = numpy.concatenate(parts, axis=1)
    t = numpy.arange(displacement.size) / RATE_HZ
    displacement = displacement + 1.5e-7 * t + 2e-9 * numpy.sin(2 * math.pi * 50.02 * t)
    phi = 4 * math.pi * displacement / WAVELENGTH_M + draw.uniform(-3, 3)
    noise = draw.normal(0, 2e-3, (2, t.size))
    u1 = 0.02 + 0.64 * (numpy.cos(phi) + noise[0])
    u2 = -0.019 + 0.61 * (numpy.sin(phi - math.radians(5)) + noise[1])
    counts = numpy.round(numpy.stack([u1, u2]) * 8192) / 8192
    dut = dut + draw.normal(0, 1e-5, t.size)
    sync = sync + draw.normal(0, 1e-4, t.size)
    return [*counts, sync, dut], responses


def write(columns):
    rows = numpy.empty(columns[0].size, [(name, "<f8") for name in ("u1", "u2", "sync", "dut")])
    for name, column in zip(rows.dtype.names, columns):
        rows[name] = column
    numpy.save(WORK / "acs.npy", rows)


class Interferometer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        seed = int(os.environ.get("DYNCAL_FILE_SEED", "1"))
        print(f"seed {seed}")
        WORK.mkdir(parents=True, exist_ok=True)
        columns, cls.responses = drawn(numpy.random.default_rng(seed))
        write(columns)

    def analyse(self, more="", arguments=()):
        text = BENCH.replace("FREQUENCIES", ", ".join(f'"{hz}"' for hz in STEPS))
        text = text.replace("LEVELS", ", ".join(f"{level}" for level in STEPS.values()))
        (WORK / "bench.toml").write_text(text.replace("MORE", more))
        return subprocess.run([PROGRAM, "analyse", "bench.toml", "--output", "result.json",
                               *arguments], cwd=WORK, capture_output=True, text=True, check=False)

    def points(self):
        return json.loads((WORK / "result.json").read_text())["points"]

    def test_agrees_with_the_truth(self):
        done = self.analyse()
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
        points = self.points()
        self.assertEqual([point["frequency_hz"] for point in points], list(STEPS))
        for point in points:
            hz = int(point["frequency_hz"])
            with self.subTest(hz):
                off = cmath.rect(point["magnitude"], point["phase_rad"]) / self.responses[hz]
                self.assertLess(abs(abs(off) - 1),
                                4 * point["u_magnitude"] / point["magnitude"])
                self.assertLess(abs(cmath.phase(off)), 4 * point["u_phase_rad"])
                self.assertLess(point["u_magnitude"] / point["magnitude"], 3e-3)
                self.assertLess(point["u_phase_rad"], 3e-3)
                names = [row["name"] for row in point["budget"]]
                for row in ROWS:
                    self.assertIn(row, names)
                self.assertEqual(point["unit"], "(V)/(m/s^2)")
                flags = [flag for flag in point["flags"] if "displacement" in flag]
                self.assertEqual(flags, [])

    def test_refuses_what_the_filter_does_not_let_through(self):
        done = self.analyse('channel = "s"')
        self.assertNotEqual(done.returncode, 0)
        done = self.analyse().returncode
        text = (WORK / "bench.toml").read_text()
        (WORK / "bench.toml").write_text(text.replace("= 100000", "= 50000"))
        done = subprocess.run([PROGRAM, "analyse", "bench.toml"], cwd=WORK, capture_output=True,
                              text=True, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("output_rate_hz", done.stderr)

    def test_has_the_other_sign_the_other_way(self):
        done = self.analyse("direction = -1")
        self.assertEqual(done.returncode, 0, done.stderr)
        for point in self.points():
            off = cmath.rect(point["magnitude"], point["phase_rad"]) / self.responses[
                int(point["frequency_hz"])]
            self.assertLess(abs(off + 1), 5e-3)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
