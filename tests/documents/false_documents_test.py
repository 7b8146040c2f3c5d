#!/usr/bin/env python3
"""Ways to make a false document of a good run: each is refused with its reason, by `dyncal
certify`, by `dyncal report --issue`, or by `dyncal verify` of what was made.

    false_documents_test.py DYNCAL EXAMPLE_WRITER

The run is one of the demo, with its recording and its entry in a store. What was edited is found by
the store; without an entry, by the recording, to the last bit.
"""

import random
import shutil
import sys
import unittest

from documents_of_run import SEED, DocumentsOfRun, day, dyncal

ISSUED, NUMBERS, MEASURED = 10, 8, 9
STORE, RECORDING = "was changed after it was kept", "is not what the recording of run"


# What a forger does to a result, by name.


def scaled(result, draw):
    """A mean and its single results, alike."""
    value = draw.choice(result["transfer_function"])
    factor = draw.choice([0.99, 1.001, 1.01, 1.1])
    alike = ("channel", "frequency_hz", "level_m_s2")
    points = [p for p in result["points"] if all(p[name] == value[name] for name in alike)]
    for one in (value, *points):
        one["magnitude"] *= factor
        for name in ("u_magnitude", "U_magnitude"):
            one[name] *= factor


def smaller_u(result, draw):
    factor = draw.uniform(0.3, 0.9)
    for one in result["transfer_function"] + result["points"]:
        for name in ("u_magnitude", "U_magnitude"):
            one[name] *= factor
        for row in one.get("budget", []):
            row["u_magnitude_rel"] *= factor


def turned(result, draw):
    shift = draw.choice([-1, 1]) * draw.uniform(0.01, 0.1)
    for one in result["transfer_function"] + result["points"]:
        if abs(one["phase_rad"] + shift) < 3.1:
            one["phase_rad"] += shift


def budget(result, draw):
    row = draw.choice(draw.choice(result["points"])["budget"])
    row["u_phase_rad"] = 0.5 * row["u_phase_rad"] + 1e-9


def dates(result, draw):
    for name in ("began_utc", "ended_utc"):
        result[name] = "2026-02-20" + result[name][10:]


def serial(result, draw):
    for source in result["sources"]:
        if source["source"] == "dau":
            source["serial"] = "0xdeadbeef"


def recipe(result, draw):
    result["recipe"] = result["recipe"].replace("reference_magnitude_rel", "# ", 1) + "\n"


def run_name(result, draw):
    result["run"] += "-2"


def channel_name(result, draw):
    for one in result["transfer_function"] + result["points"] + result["channels"]:
        one["channel"] = one["channel"].replace("acceleration_x", "acceleration_w")


def closure(result, draw):
    for channel in result["channels"]:
        for one in channel["closures"]:
            one["verdict"] = "not_possible"


def left_out(result, draw):
    step = draw.choice(result["points"])["step"]
    gone = [p["frequency_hz"] for p in result["points"] if p["step"] == step][0]
    for name in ("points", "transfer_function"):
        result[name] = [one for one in result[name] if one["frequency_hz"] != gone]
    result["planned_steps"] -= 1


def operator(result, draw):
    result["conducted_by"]["name"] = "Somebody Else"


EDITS = (scaled, smaller_u, turned, budget, dates, serial, recipe, run_name, channel_name, closure,
         left_out)  # fmt: skip
# What the recording does not know: the store does.
STATEMENTS = (operator,)


class FalseDocuments(DocumentsOfRun):
    # The opposite first: nothing speaks against what was measured.

    def test_what_was_measured_is_certified_and_verified(self):
        for store in (True, False):
            run = self.copy(f"good-{store}", store)
            made, file = self.certify(run, "--store", run.parents[1] / "dyncal.sqlite")
            self.assertEqual(made.returncode, 0, made.stderr)
            self.assertIn("the same results to the last digit", made.stdout)
            self.assertEqual(store, "that the store has of the run" in made.stdout)
            checked = self.verify(file, "--run", run)
            self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
            self.assertIn("the same results to the last digit", checked.stdout)

    def test_edited_results_get_no_document(self):
        draw = random.Random(SEED)
        for edit in EDITS:
            for store in (True, False):
                make = draw.choice([self.certify, self.issue])
                name = f"{edit.__name__}-{store}"
                run = self.edited(name, edit, store)
                place = ("--store", run.parents[1] / "dyncal.sqlite" if store else "none")
                with self.subTest(name):
                    made, file = make(run, "--force", *place)
                    self.assertNotEqual(made.returncode, 0)
                    self.assertFalse(file.exists())
                    reasons = (STORE, RECORDING, "is not that of its single")
                    self.assertTrue(any(one in made.stderr for one in reasons), made.stderr)
                shutil.rmtree(run.parents[1])

    def test_statements_of_the_conductor_are_those_that_the_store_has(self):
        for edit in STATEMENTS:
            run = self.edited(edit.__name__, edit, store=True)
            self.assert_refused(STORE, self.certify(run, "--force"))

    def test_an_edited_mean_contradicts_its_single_results(self):
        def mean_alone(result, draw):
            draw.choice(result["transfer_function"])["magnitude"] *= 1.5

        run = self.edited("mean", mean_alone, store=True)
        self.assert_refused("a mean is not that of its single results", self.certify(run))
        added = dyncal("store", "add", run, "--store", self.folder / "mean.sqlite")
        self.assertIn("a mean is not that of its single results", added.stderr)

    def test_recordings_of_others_prove_nothing(self):
        run = self.copy("other-recording", store=False)
        shutil.copy(self.other_run / "recording.mcap", run)
        self.assert_refused(RECORDING, self.certify(run, "--force"))
        run = self.copy("cut-recording", store=False)
        size = (run / "recording.mcap").stat().st_size
        with open(run / "recording.mcap", "r+b") as file:  # among its samples
            file.truncate(int(size * random.Random(SEED).uniform(0.4, 0.9)))
        for make in (self.certify, self.issue):
            self.assert_refused("lacks samples of", make(run))
            self.assert_refused("nothing is signed or issued", make(run, "--force"))
        shutil.copy(self.runs / "dyncal.sqlite", run.parents[1])
        made, file = self.certify(run)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertIn("single results with deviations of at most", file.read_text())
        self.assertNotIn("to the last digit", file.read_text())
        run = self.copy("no-recording", store=False)
        (run / "recording.mcap").unlink()
        self.assert_refused("nothing shows that result.json is what was measured",
                            self.certify(run, "--force"))  # fmt: skip
        shutil.copy(self.runs / "dyncal.sqlite", run.parents[1])
        made, file = self.certify(run)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertIn("There is no recording of the run", file.read_text())

    def test_sensor_reference_and_days_must_fit(self):
        other_serial = self.sensor("other-serial", ("0xbccb0100", "0xdeadbeef"))
        other_model = self.sensor("other-model", ("MPU-9250", "BMA280"))
        late = self.sensor("late", (day(0), day(2)))
        labs = {
            "after the measurement": dict(issued=day(30), valid_until=day(500)),
            "was to be calibrated again by": dict(issued=day(-900), valid_until=day(-2)),
            "calibrated again by": dict(issued=day(-900), interval_months=12),
            "may be used (valid_until": dict(issued=day(-100)),
            "was issued (issued)": dict(valid_until=day(100)),
        }
        for make in (self.certify, self.issue):
            run = self.copy(make.__name__)
            (run / "recording.mcap").unlink()  # the store alone is quicker
            self.assert_refused("serial number '0xbccb0100'", make(run, sensor=other_serial))
            self.assert_refused("the sensor file says 'BMA280'", make(run, sensor=other_model))
            self.assert_refused("was received on", make(run, sensor=late))
            for reason, keys in labs.items():
                self.assert_refused(reason, make(run, lab=self.laboratory("false", **keys)))
        made, _ = self.certify(run, "--performed", "2019-01-01")
        self.assertIn("leave --performed out", made.stderr)
        made, file = self.certify(run, "--force", lab=self.laboratory("late", **labs[
            "was to be calibrated again by"]))  # fmt: skip
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertIn("was to be calibrated again by", file.read_text())

    def test_a_number_is_given_once(self):
        run, other = self.copy("numbers"), self.other_run
        store = ("--store", self.folder / "numbers" / "dyncal.sqlite")
        made, first = self.certify(run)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assert_refused("a number is given once", self.certify(run))
        dyncal("store", "add", other, *store)
        self.assert_refused("a number is given once", self.certify(other, *store))
        self.assert_refused("a number is given once", self.issue(other, *store))
        made, pdf = self.issue(run)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assert_refused("no document has number 2025-0001",
                            self.certify(run, "--number", "2026-0043", "--replaces",
                                         "2025-0001"))  # fmt: skip
        made, second = self.certify(run, "--number", "2026-0043", "--replaces", "2026-0042")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertIn("2026-0042", second.read_text())
        self.assert_refused("was replaced by 2026-0043 already",
                            self.certify(run, "--number", "2026-0044", "--replaces",
                                         "2026-0042"))  # fmt: skip
        for file, status in ((first, ISSUED), (pdf, ISSUED), (second, 0)):
            checked = self.verify(file, *store, "--run", run)
            self.assertEqual(checked.returncode, status, checked.stdout)
        self.assertIn("2026-0043 has taken its place", self.verify(pdf, *store).stdout)

    def test_changed_files_are_not_verified(self):
        run = self.copy("changed")
        store = ("--store", self.folder / "changed" / "dyncal.sqlite")
        made, pdf = self.issue(run)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual(self.verify(pdf, *store).returncode, 0)
        bytes_of_pdf = bytearray(pdf.read_bytes())
        bytes_of_pdf[random.Random(SEED).randrange(100, len(bytes_of_pdf))] ^= 1
        pdf.write_bytes(bytes_of_pdf)
        checked = self.verify(pdf, *store)
        self.assertEqual(checked.returncode, ISSUED, checked.stdout)
        self.assertIn("it was never issued as it is", checked.stdout)
        draft = self.folder / "draft"
        dyncal("report", run, "--lab", self.lab, "--output", draft)
        self.assertIn(">DRAFT<", draft.with_suffix(".html").read_text())
        self.assertEqual(self.verify(draft.with_suffix(".pdf"), *store).returncode, ISSUED)
        made, signed = self.certify(run, "--number", "2026-0050")
        self.assertEqual(made.returncode, 0, made.stderr)
        checked = self.verify(signed, *store, "--run", self.other_run)
        self.assertEqual(checked.returncode, NUMBERS, checked.stdout)
        edited = self.edited("edited-later", scaled, store=True)
        checked = self.verify(signed, "--run", edited)
        self.assertIn("measured   FAILED", checked.stdout)
        text = signed.read_text()
        signed.write_text(text.replace("<dcc:issueDate>20", "<dcc:issueDate>19"))
        self.assertEqual(self.verify(signed, *store).returncode, 6)

if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
