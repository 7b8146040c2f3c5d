#!/usr/bin/env python3
"""Records of a transducer and an amplifier that are not flat, evaluated by `dyncal analyse`.

    sensitivity_test.py DYNCAL WORK

Reference and sensor are drawn as voltages behind the responses that the bench file names, from the
seed DYNCAL_FILE_SEED; H must be that of the sensor, and each table's U a row of its budget.
"""

import cmath
import csv
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import unittest

PROGRAM, WORK = sys.argv[1], pathlib.Path(sys.argv[2])
RATE_HZ = 4000
FREQUENCIES_HZ = (20, 40, 80)
LEVEL_M_S2 = 5.0
STEP_S, PAUSE_S = 3.0, 0.5
TABLE_HZ = (10, 20, 40, 80, 160)


def drawn_table(draw, magnitude):
    """{frequency: (magnitude, delay, relative u, u of the delay)}"""
    return {hz: (magnitude * draw.uniform(0.9, 1.1), draw.uniform(1e-5, 1e-4),
                 draw.uniform(1e-3, 4e-3), draw.uniform(1e-6, 1e-5)) for hz in TABLE_HZ}


def response(table, hz):
    magnitude, delay_s, _, _ = table[hz]
    return cmath.rect(magnitude, -2 * math.pi * hz * delay_s)


def write_table(path, table):
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["frequency_hz", "magnitude", "delay_s", "u_magnitude_rel", "u_delay_s"])
        for hz, values in table.items():
            rows.writerow([hz, *(repr(value) for value in values)])


def write_records(path, reference, sensor, transfer):
    """A step a frequency with pauses between them, in V."""
    samples = []
    for hz in FREQUENCIES_HZ:
        a = cmath.rect(LEVEL_M_S2, 0.3)
        read, made = (a * response(reference, hz),
                      a * transfer[hz] * response(sensor, hz))
        steady = [cmath.exp(2j * math.pi * hz * i / RATE_HZ) for i in range(int(STEP_S * RATE_HZ))]
        samples += [((read * turn).real, (made * turn).real) for turn in steady]
        samples += [(0.0, 0.0)] * int(PAUSE_S * RATE_HZ)
    with path.open("w") as file:
        file.write("vibrometer [V],charge [V]\n")
        file.writelines(f"{a + random.gauss(0, 1e-6)!r},{b + random.gauss(0, 1e-6)!r}\n"
                        for a, b in samples)


BENCH = f"""bench = "drawn"
[excitation]
frequencies_hz = [{", ".join(f'"{hz}"' for hz in FREQUENCIES_HZ)}]
level = {LEVEL_M_S2}
settling_s = 0.5
duration_s = 1.5
[generator]
driver = "none"
[sources.acs]
driver = "file"
path = "records.csv"
sample_rate_hz = {RATE_HZ}
sensitivity = {{ vibrometer = "laser.toml", charge = "amplifier.csv" }}
[method]
kind = "analogue"
reference = "acs/vibrometer"
dut = ["acs/charge"]
"""
LASER = """[reference]
name = "drawn vibrometer"
[response]
unit = "mV/(m/s^2)"
file = "laser.csv"
[channel]
unit = "mV/(m/s^2)"
sensitivity = 10.2
"""


class Sensitivity(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        seed = int(os.environ.get("DYNCAL_FILE_SEED", "1"))
        print(f"seed {seed}")
        draw = random.Random(seed)
        random.seed(seed)
        WORK.mkdir(parents=True, exist_ok=True)
        cls.reference, cls.sensor = drawn_table(draw, 10.2), drawn_table(draw, 1.0)
        cls.transfer = {hz: cmath.rect(draw.uniform(0.01, 0.02), draw.uniform(-1, 1))
                        for hz in FREQUENCIES_HZ}
        in_v = {hz: (row[0] * 1e-3, *row[1:]) for hz, row in cls.reference.items()}
        write_records(WORK / "records.csv", in_v, cls.sensor, cls.transfer)
        write_table(WORK / "laser.csv", cls.reference)
        write_table(WORK / "amplifier.csv", cls.sensor)
        (WORK / "laser.toml").write_text(LASER)

    def analyse(self, bench):
        (WORK / "bench.toml").write_text(bench)
        return subprocess.run([PROGRAM, "analyse", "bench.toml", "--output", "result.json"],
                              cwd=WORK, capture_output=True, text=True, check=False)

    def test_is_taken_from_the_results_and_in_their_budget(self):
        done = self.analyse(BENCH)
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads((WORK / "result.json").read_text())
        points = result["points"]
        self.assertEqual([point["frequency_hz"] for point in points], list(FREQUENCIES_HZ))
        for point in points:
            hz = int(point["frequency_hz"])
            measured = cmath.rect(point["magnitude"], point["phase_rad"])
            self.assertLess(abs(measured / self.transfer[hz] - 1), 2e-5, hz)
            budget = {row["name"]: row for row in point["budget"]}
            for name, table in (("reference", self.reference),
                                ("response of the channel", self.sensor)):
                self.assertAlmostEqual(budget[name]["u_magnitude_rel"], table[hz][2], 12)
                self.assertAlmostEqual(budget[name]["u_phase_rad"],
                                       2 * math.pi * hz * table[hz][3], 12)
            of_both = math.hypot(self.reference[hz][2], self.sensor[hz][2])
            self.assertGreaterEqual(point["u_magnitude"] / point["magnitude"], 0.9999 * of_both)

    def test_is_refused_beyond_its_table(self):
        done = self.analyse(BENCH.replace('["20"', '["5"'))
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("5 Hz", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
