#!/usr/bin/env python3
"""A value of a triggered series has one U and one k, wherever it is stated: as a point, as the mean
of its only repetition, in the CSV of the figures and in the certificate.

    series_uncertainty_test.py DYNCAL EXAMPLE_WRITER [SEED]
"""

import csv
import json
import math
import pathlib
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

DYNCAL = sys.argv[1]
SEED = int(sys.argv[3]) if len(sys.argv) > 3 else 2026_11_26
SI = "{https://ptb.de/si}"
# So few that k is far from 2, of noise that outweighs what is known with many degrees of freedom.
SHOTS = 4
SETTINGS = class_presets.bench(
    class_presets.SERIES,
    frequencies=("20", "80", "210"),
    shots=SHOTS,
    sensor_noise_rel=0.05,
    u_reference_magnitude_rel=1e-5,
    u_reference_phase_rad=1e-5,
)
QUANTITIES = {"magnitude": "magnitude", "phase": "phase_rad"}


def run(*command):
    done = subprocess.run([*map(str, command)], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{command}: {done.returncode}\n{done.stdout}\n{done.stderr}")


class OneUncertainty(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-series-uncertainty-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        bench, stored = cls.folder / "bench", cls.folder / "run"
        bench.mkdir()
        stored.mkdir()
        Calibration(SETTINGS, [SEED]).write(bench)
        run(DYNCAL, "analyse", bench / "bench.toml", "--output", stored / "result.json",
            "--figures", cls.folder / "figures")  # fmt: skip
        cls.result = json.loads((stored / "result.json").read_text())
        cls.certificate = cls.folder / "certificate.xml"
        run(DYNCAL, "certify", stored, "--lab", stored_run.LAB, "--sensor", stored_run.SENSOR,
            "--performed", "2026-11-26", "--output", cls.certificate,
            *stored_run.kept(DYNCAL, stored))  # fmt: skip

    def values(self):
        """Each point beside the mean that is made of it alone."""
        points, means = self.result["points"], self.result["transfer_function"]
        self.assertEqual(len(points), len(SETTINGS.frequencies))
        self.assertEqual(len(means), len(points))
        return list(zip(points, means))

    def test_k_is_that_of_few_shots(self):
        factors = [point[f"k_{name}"] for point, _ in self.values() for name in QUANTITIES]
        self.assertGreater(max(factors), 2.2)

    def test_point_and_mean_agree(self):
        for point, mean in self.values():
            for name, value in QUANTITIES.items():
                for member in (value, f"u_{value}", f"k_{name}", f"U_{value}", f"nu_eff_{name}"):
                    self.assertTrue(
                        math.isclose(point[member], mean[member], rel_tol=1e-9),
                        f"{point['frequency_hz']} Hz, {member}: {point[member]}, {mean[member]}",
                    )
                expanded = point[f"k_{name}"] * point[f"u_{value}"]
                self.assertAlmostEqual(point[f"U_{value}"] / expanded, 1.0, places=9)

    def test_u_is_that_of_the_budget(self):
        for point, _ in self.values():
            squares = sum(row["u_phase_rad"] ** 2 for row in point["budget"])
            self.assertAlmostEqual(point["u_phase_rad"] / math.sqrt(squares), 1.0, places=9)
            starts = [row for row in point["budget"] if row["name"].startswith("start of")]
            self.assertEqual(len(starts), 1, "one row of the start, whoever found it")

    def test_figures_agree(self):
        text = (self.folder / "figures/transfer-function-tss-z.csv").read_text().splitlines()
        rows = list(csv.DictReader(line for line in text if not line.startswith("#")))
        self.assertEqual(len(rows), 2 * len(SETTINGS.frequencies))
        for point, _ in self.values():
            of_point = [
                row for row in rows if float(row["frequency_hz"]) == point["frequency_hz"]
            ]
            self.assertEqual([row["repetition"] for row in of_point], ["1", "mean"])
            for value in QUANTITIES.values():
                for row in of_point:
                    self.assertAlmostEqual(float(row[f"u_{value}"]) / point[f"u_{value}"], 1.0, 9)
                expanded = float(of_point[1][f"U_{value}"])
                self.assertAlmostEqual(expanded / point[f"U_{value}"], 1.0, 9)

    def test_certificate_agrees(self):
        root = ElementTree.parse(self.certificate).getroot()
        lists = root.findall(f".//{SI}realListXMLList")
        checked = 0
        for stated in lists:
            unit = stated.find(f".//{SI}unitXMLList").text.strip()
            value = {r"\one": "magnitude", r"\radian": "phase_rad"}.get(unit)
            expanded = stated.find(f".//{SI}valueExpandedMUXMLList")
            if value is None or expanded is None:
                continue
            k = stated.find(f".//{SI}coverageFactorXMLList").text.split()
            values = stated.find(f".//{SI}valueXMLList").text.split()
            for i, (point, _) in enumerate(self.values()):
                number, uncertainty = stored_run.rounded(point[value], point[f"U_{value}"])
                self.assertEqual((values[i], expanded.text.split()[i]), (number, uncertainty))
                factor = point["k_" + value.removesuffix("_rad")]
                self.assertEqual(k[i], f"{factor:.2f}")
                checked += 1
        self.assertEqual(checked, len(QUANTITIES) * len(SETTINGS.frequencies))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
