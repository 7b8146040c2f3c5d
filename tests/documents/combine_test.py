#!/usr/bin/env python3
"""Runs of one sensor, mounted anew for each, as one result with a certificate of its own: what it
holds, and what is refused.

    combine_test.py DYNCAL EXAMPLE_WRITER
"""

import json
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import unittest

import stored_run

DYNCAL, EXAMPLE = sys.argv[1:3]
CHANNEL = "dau/acceleration_z"
MOUNTINGS = (0.997, 1.0, 1.004)


def dyncal(*arguments):
    return subprocess.run([DYNCAL, *map(str, arguments)], capture_output=True, text=True)


def logged(quantity, low, mean, high, source="file room.csv", count=10):
    unit = {"temperature": "degC", "humidity": "%"}[quantity]
    return {"quantity": quantity, "unit": unit, "source": source, "count": count, "minimum": low,
            "mean": mean, "maximum": high, "U": 0.3, "problem": ""}


def mean_of(result):
    """What the results of this version are: means of the single ones."""
    return [one["magnitude"] for one in result["transfer_function"] if one["channel"] == CHANNEL]


class Combine(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-combine-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.store = ["--store", self.folder / "store.sqlite"]
        self.runs = [self.run_of(f"R{i}", factor) for i, factor in enumerate(MOUNTINGS)]

    def run_of(self, name, factor, change=None, keep=True):
        result = stored_run.clean_run(EXAMPLE)
        result["run"] = name
        result["software"] = "dyncal 0.0.1"  # so that its means may be those of another version
        result["analysis"]["software"] = "dyncal-analysis 0.0.1"
        for one in result["points"] + result["transfer_function"]:
            one["magnitude"] *= factor
        if change:
            change(result)
        run = stored_run.write_run(self.folder / "runs/bench" / name, result)
        if keep:
            added = dyncal("store", "add", run, *self.store)
            self.assertEqual(added.returncode, 0, added.stderr)
        return run

    def combine(self, *runs, output="combined.json"):
        return dyncal("combine", *runs, "--output", self.folder / output, *self.store)

    def refused(self, *runs):
        made = self.combine(*runs)
        self.assertNotEqual(made.returncode, 0, made.stdout)
        self.assertFalse((self.folder / "combined.json").exists())
        return made.stderr

    def test_scatter_of_mountings_is_in_u(self):
        made = self.combine(*self.runs)
        self.assertEqual(made.returncode, 0, made.stderr)
        combined = json.loads((self.folder / "combined.json").read_text())
        self.assertEqual([one["run"] for one in combined["combined"]], ["R0", "R1", "R2"])
        single = json.loads((self.runs[1] / "result.json").read_text())
        values = [one for one in combined["transfer_function"] if one["channel"] == CHANNEL]
        self.assertEqual(len(values), len(stored_run.FREQUENCIES))
        for value, of_one in zip(values, mean_of(single)):
            self.assertEqual(value["repetitions"], len(MOUNTINGS))
            expected = of_one * statistics.fmean(MOUNTINGS)
            self.assertLess(abs(value["magnitude"] - expected), value["U_magnitude"])
            of_scatter = of_one * statistics.stdev(MOUNTINGS) / len(MOUNTINGS) ** 0.5
            self.assertGreater(value["U_magnitude"], 2 * of_scatter)

    def test_has_a_certificate_of_its_own(self):
        self.assertEqual(self.combine(*self.runs).returncode, 0)
        combined = self.folder / "combined.json"
        documents = ["--lab", stored_run.LAB, "--sensor", stored_run.SENSOR]
        made = dyncal("certify", combined, *documents, *self.store,
                      "--output", self.folder / "dcc.xml")  # fmt: skip
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertIn("The result combines 3 runs", made.stdout)
        self.assertIn("combines 3 runs", (self.folder / "dcc.xml").read_text())
        edited = json.loads(combined.read_text())
        edited["combined"].pop()
        combined.write_text(json.dumps(edited))
        made = dyncal("certify", combined, *documents, *self.store, "--force",
                      "--output", self.folder / "no.xml")  # fmt: skip
        self.assertEqual(made.returncode, 1)
        self.assertIn("is not the result that the store has", made.stderr)

    def with_conditions(self, name, *conditions):
        return self.run_of(name, 1.0, lambda result: result.update(conditions=list(conditions)))

    def certificate_of(self, *runs):
        """The texts of the certificate of these runs combined, and their conditions."""
        made = self.combine(*runs, output="mounted.json")
        self.assertEqual(made.returncode, 0, made.stderr)
        combined = self.folder / "mounted.json"
        made = dyncal("certify", combined, "--lab", stored_run.LAB, "--sensor", stored_run.SENSOR,
                      "--language", "en,de", "--output", self.folder / "mounted.xml", *self.store)
        self.assertEqual(made.returncode, 0, made.stderr)
        return (self.folder / "mounted.xml").read_text(), json.loads(combined.read_text())

    def test_states_the_conditions_of_all_runs(self):
        text, combined = self.certificate_of(
            self.with_conditions("C0", logged("temperature", 22.0, 22.2, 22.5)),
            self.with_conditions("C1", logged("temperature", 23.0, 23.2, 23.5)),
            self.with_conditions("C2", logged("temperature", 22.4, 22.9, 23.7, "other.csv", 5),
                                 logged("humidity", 40.0, 41.0, 42.0)))  # fmt: skip
        self.assertEqual([(one["quantity"], one["mean"]) for one in combined["conditions"]],
                         [("temperature", 22.2), ("temperature", 23.2), ("temperature", 22.9),
                          ("humidity", 41.0)])  # fmt: skip
        mean = statistics.fmean([22.2, 23.2, 22.9])
        self.assertIn("The temperature was measured over all 3 runs by file room.csv, other.csv: "
                      "22 to 23.7 degC, mean of the runs' means 22.77 degC, 25 readings.", text)
        self.assertIn("The humidity was measured over 1 of the 3 runs (the others state none)",
                      text)
        self.assertIn("Temperatur über alle 3 Messläufe gemessen mit", text)
        # As U has it: a reading, and how far all runs went.
        expanded = (0.3**2 + (2 * 0.5 * 1.7) ** 2 / 3) ** 0.5
        value, stated = stored_run.rounded(mean, float(stored_run.two_digits(expanded)))
        self.assertIn(f"<si:value>{value}</si:value>", text)
        self.assertIn(f"<si:valueExpandedMU>{stated}</si:valueExpandedMU>", text)

    def test_takes_a_condition_as_it_was_amended(self):
        one = self.with_conditions("D0", logged("temperature", 29.0, 29.2, 29.5))
        amended = dyncal("amend", one, "temperature_degc=22.0", "--reason", "wrong logger",
                         "--operator", "B. Other", *self.store)  # fmt: skip
        self.assertEqual(amended.returncode, 0, amended.stderr)
        text, combined = self.certificate_of(
            one, self.with_conditions("D1", logged("temperature", 23.0, 23.2, 23.5)))
        self.assertEqual(combined["conditions"][0]["mean"], 22.0)
        self.assertIn("The temperature was measured over all 2 runs by B. Other, file room.csv: "
                      "22 to 23.5 degC", text)

    def test_states_no_conditions_where_no_run_does(self):
        text, combined = self.certificate_of(*self.runs)
        self.assertNotIn("conditions", combined)
        self.assertIn("Entered by hand, not measured over the run", text)

    def test_refuses_what_does_not_belong_together(self):
        def serial(result):
            for source in result["sources"]:
                source["serial"] = "another"

        def interrupted(result):
            result["interrupted"] = True

        def axis(result):
            for one in result["transfer_function"]:
                one["excited_axis"] = "x"

        def reference(result):
            device = {"name": "another", "serial": "2", "certificate": "C-2"}
            result["corrections"]["reference_standard"] = {"devices": [device]}

        one = self.runs[0]
        self.assertIn("references differ", self.refused(one, self.run_of("F", 1.0, reference)))
        self.assertIn("serial number", self.refused(one, self.run_of("S", 1.0, serial)))
        self.assertIn("was interrupted", self.refused(one, self.run_of("I", 1.0, interrupted)))
        self.assertIn("excited axis", self.refused(one, self.run_of("A", 1.0, axis)))
        self.assertIn("it is one run", self.refused(one, one))
        self.assertIn(
            "nothing shows that", self.refused(one, self.run_of("N", 1.0, keep=False))
        )

    def test_refuses_a_run_that_was_changed(self):
        path = self.runs[2] / "result.json"
        path.write_text(path.read_text().replace('"problem": ""', '"problem":  ""'))
        self.assertIn("is not the result that the store has", self.refused(*self.runs))

    def test_needs_two_runs(self):
        self.assertNotEqual(self.combine(self.runs[0]).returncode, 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
