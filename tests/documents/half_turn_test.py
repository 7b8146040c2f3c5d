#!/usr/bin/env python3
"""A reference whose table crosses 180 degrees, and a sensor that answers at half a turn: what is
stored, printed, drawn and certified is one phase, without a jump of 2 pi, and its U is small.

    half_turn_test.py DYNCAL EXAMPLE_WRITER [SEED]
"""

import collections
import csv
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import stored_run

sys.path.insert(0, str(stored_run.TOP / "tests/coverage"))
import analysed_folder  # noqa: E402, F401, leaves where numpy is not there
import class_presets  # noqa: E402
from bench_simulator import Calibration  # noqa: E402
from faults.tables_and_means import Inverting  # noqa: E402

DYNCAL = sys.argv[1]
SEED = int(sys.argv[3]) if len(sys.argv) > 3 else 2026_11_27
SI = "{https://ptb.de/si}"
FREQUENCIES = ("12.5", "31.5", "57", "63", "80", "100", "160")
REPETITIONS = 3
MOST_U_RAD = 5e-3  # 1.2 rad when the table was taken through zero
DEVIATIONS = 5.0  # in u, of what was drawn once and for all


class AtHalfATurn(Inverting):
    """The sensor as well: about as far from half a turn as a result is uncertain, on both sides."""

    def __init__(self, calibration, rng):
        super().__init__(calibration, rng)
        self.beside_rad = {
            text: 1e-3 * rng.standard_normal() for text in self.settings.frequencies
        }
        for step in self.steps:
            step.delay_rad = math.pi + self.beside_rad[step.frequency_text]


def settings():
    return class_presets.bench(
        class_presets.SHORT_ANALOGUE_STEPS,
        class_presets.LITTLE_NOISE,
        calibrated_reference=True,
        frequencies=FREQUENCIES,
        repetitions=REPETITIONS,
        sensor_noise_rel=0.01,
        fault=AtHalfATurn,
    )


def run(*command):
    done = subprocess.run([*map(str, command)], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{command}: {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


def of_turns(angle, turn=2.0 * math.pi):
    return abs(math.remainder(angle, turn))


class HalfATurn(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-half-turn-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        bench, cls.stored = cls.folder / "bench", cls.folder / "run"
        bench.mkdir()
        cls.stored.mkdir()
        calibration = Calibration(settings(), [SEED])
        calibration.write(bench)
        cls.true_rad = {float(f): math.pi - d for f, d in calibration.fault.beside_rad.items()}
        cls.table = run(
            DYNCAL, "analyse", bench / "bench.toml", "--output", cls.stored / "result.json",
            "--figures", cls.folder / "figures",
        )  # fmt: skip
        cls.result = json.loads((cls.stored / "result.json").read_text())
        cls.means = cls.result["transfer_function"]

    def test_both_sides_are_drawn(self):
        signs = {mean["phase_rad"] > 0.0 for mean in self.means}
        self.assertEqual(signs, {True, False}, "nothing crosses; draw with another seed")

    def check_values(self, entries, count):
        self.assertEqual(len(entries), count)
        for entry in entries:
            where = f"{entry['frequency_hz']} Hz"
            self.assertLessEqual(abs(entry["phase_rad"]), math.pi, where)
            self.assertLessEqual(abs(entry["phase_deg"]), 180.0, where)
            self.assertLess(entry["U_phase_rad"], MOST_U_RAD, where)
            error = of_turns(entry["phase_rad"] - self.true_rad[entry["frequency_hz"]])
            self.assertLess(error, DEVIATIONS * entry["u_phase_rad"], where)

    def test_points_and_means_are_right_and_u_is_small(self):
        self.check_values(self.result["points"], len(FREQUENCIES) * REPETITIONS)
        self.check_values(self.means, len(FREQUENCIES))
        for mean in self.means:
            self.assertLess(mean["scatter_phase_rad"], MOST_U_RAD)
            self.assertLess(of_turns(mean["unwrapped_phase_rad"] - mean["phase_rad"]), 1e-9)

    def test_corrections_are_within_a_turn(self):
        corrections = [
            one
            for step in self.result["steps"]
            for one in step["corrections"]
            if one["name"] == "reference_response"
        ]
        self.assertEqual(len(corrections), len(FREQUENCIES) * REPETITIONS)
        for one in corrections:
            self.assertLessEqual(abs(one["phase_rad"]), math.pi)
            self.assertLess(of_turns(one["phase_rad"] - math.pi), 0.05)

    def test_the_printed_table_has_the_phases(self):
        for mean in self.means:
            number, u = stored_run.rounded(mean["phase_rad"], mean["u_phase_rad"])
            rows = [line.split() for line in self.table.splitlines()]
            row = [one for one in rows if one[:1] == [mean["frequency_text_hz"]]]
            self.assertEqual(len(row), 1)
            self.assertEqual(row[0][4], u)
            self.assertLessEqual(of_turns(float(row[0][3]) - float(number)), 2e-3)

    def test_figures_are_continuous(self):
        text = (self.folder / "figures/transfer-function-acs-dut.csv").read_text().splitlines()
        rows = list(csv.DictReader(line for line in text if not line.startswith("#")))
        means = [row for row in rows if row["repetition"] == "mean"]
        self.assertEqual(len(rows), (REPETITIONS + 1) * len(FREQUENCIES))
        self.assertEqual(len(means), len(FREQUENCIES))
        phases = [float(row["phase_rad"]) for row in means]
        for before, after in zip(phases, phases[1:]):
            self.assertLess(abs(after - before), 0.1)
        for row, mean in zip(means, self.means):
            self.assertLess(of_turns(float(row["phase_rad"]) - mean["phase_rad"]), 1e-9)
            self.assertAlmostEqual(float(row["U_phase_rad"]) / mean["U_phase_rad"], 1.0, 9)

    def test_deviations_of_repetitions_are_small(self):
        text = (self.folder / "figures/deviation-acs-dut.csv").read_text().splitlines()
        rows = list(csv.DictReader(line for line in text if not line.startswith("#")))
        self.assertEqual(len(rows), REPETITIONS * len(FREQUENCIES))
        for row in rows:
            self.assertLess(abs(float(row["deviation_phase_rad"])), MOST_U_RAD)

    def check_stated(self, degrees, radians, mean):
        self.assertEqual(degrees.startswith("-"), radians.startswith("-"), (degrees, radians))
        self.assertGreater(float(degrees), -180.0)
        self.assertLessEqual(float(degrees), 180.0)
        for text, value, expanded, turn in (
            (degrees, mean["phase_deg"], mean["U_phase_deg"], 360.0),
            (radians, mean["phase_rad"], mean["U_phase_rad"], 2.0 * math.pi),
        ):
            self.assertLessEqual(of_turns(float(text) - value, turn), 0.06 * expanded)

    def test_certificate_states_the_same(self):
        certificate = self.folder / "certificate.xml"
        documents = ("--lab", stored_run.LAB, "--sensor", stored_run.SENSOR)
        run(DYNCAL, "certify", self.stored, *documents, "--performed", "2026-11-26",
            "--output", certificate, *stored_run.kept(DYNCAL, self.stored))  # fmt: skip
        found = {}
        for stated in ElementTree.parse(certificate).getroot().findall(f".//{SI}realListXMLList"):
            unit = stated.find(f".//{SI}unitXMLList").text.strip()
            expanded = stated.find(f".//{SI}valueExpandedMUXMLList")
            if unit in (r"\radian", r"\degree") and expanded is not None:
                values = stated.find(f".//{SI}valueXMLList").text.split()
                found[unit] = list(zip(values, expanded.text.split()))
        self.assertEqual(set(found), {r"\radian", r"\degree"})
        self.assertEqual(len(found[r"\radian"]), len(self.means))
        for mean, radians, degrees in zip(self.means, found[r"\radian"], found[r"\degree"]):
            self.check_stated(degrees[0], radians[0], mean)
            self.assertEqual(
                (radians[1], degrees[1]),
                (
                    stored_run.rounded(mean["phase_rad"], mean["U_phase_rad"])[1],
                    stored_run.rounded(mean["phase_deg"], mean["U_phase_deg"])[1],
                ),
            )

    def test_report_states_the_same(self):
        page = self.folder / "report.html"
        run(DYNCAL, "report", self.stored, "--lab", stored_run.LAB, "--no-pdf",
            "--output", page.with_suffix(""))  # fmt: skip
        text = page.read_text()
        rows = collections.defaultdict(list)  # by the kind of their table
        for kind, table in re.findall(r'<table class="([a-z]+)">(.*?)</table>', text, re.S):
            for row in re.findall(r"<tr[^>]*>(.*?)</tr>", table, re.S):
                cells = re.findall(r"<td[^>]*>(.*?)</td>", row, re.S)
                rows[kind].append([re.sub("<[^>]*>", "", cell) for cell in cells])
        values = [row for row in rows["values"] if row]
        texts = [mean["frequency_text_hz"] for mean in self.means]
        self.assertEqual([row[0] for row in values], texts)
        for row, mean in zip(values, self.means):
            self.check_stated(row[6], row[8], mean)
        single = [row for row in rows["single"] if row]
        self.assertEqual(len(single), len(FREQUENCIES) * REPETITIONS)
        for row in single:
            self.assertGreater(float(row[4]), -180.0)
            self.assertLessEqual(float(row[4]), 180.0)
        applied = [row for row in rows["legend"] if row[:1] == ["response of the reference"]]
        self.assertEqual(len(applied), 1)
        low, high = map(float, applied[0][1].split(" to "))
        self.assertLess(high - low, 2.0, "the table spans 0.6 degrees, not a whole turn")


    def test_history_states_the_same(self):
        store = self.folder / "runs.sqlite"
        run(DYNCAL, "store", "add", self.stored, "--store", store)
        text = run(DYNCAL, "history", "acs", "--store", store)
        self.assertNotIn("-180.0", text)
        sections = re.split(r"\n(?=acs/dut at )", text)[1:]
        self.assertEqual(len(sections), len(self.means))
        for mean in self.means:
            head = f"acs/dut at {mean['frequency_text_hz']} Hz,"
            rows = [one.splitlines()[2:] for one in sections if one.startswith(head)]
            self.assertEqual(len(rows), 1, text)
            # begin, state, |H|, U, its drift, E_n, arg H, U
            degrees, expanded = rows[0][0].split()[6:8]
            self.assertEqual(
                expanded, stored_run.rounded(mean["phase_deg"], mean["U_phase_deg"])[1]
            )
            self.assertGreater(float(degrees), -180.0)
            self.assertLessEqual(float(degrees), 180.0)
            error = of_turns(float(degrees) - mean["phase_deg"], 360.0)
            self.assertLessEqual(error, 0.06 * mean["U_phase_deg"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
