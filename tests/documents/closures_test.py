#!/usr/bin/env python3
"""What does not close is not certified: each kind of closure, open in the result of a run, is
refused by name by `dyncal certify` and `dyncal report`, and with --force stands on the first page.
What closes or is not possible is neither refused nor hidden, and what another channel has does not
count.

    closures_test.py DYNCAL EXAMPLE_WRITER
"""

import copy
import html
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import stored_run

DYNCAL, EXAMPLE = sys.argv[1:3]
KINDS = stored_run.TOP / "services/evaluation/result/closure.cpp"
FIRST, SECOND = stored_run.CHANNELS


def kinds():
    """Name and title of each, as the program has them."""
    found = re.findall(r'Names\{"(\w+)",\s*"([^"]+)"\}', KINDS.read_text())
    assert len(found) >= 13, found
    return found


def closure(kind, verdict):
    return {
        "kind": kind,
        "subject": "dau",
        "verdict": verdict,
        "value": 0.0 if verdict == "not_possible" else 0.0042,
        "u": 0.001,
        "limit": 0.002,
        "unit": "1",
        "sentence": f"of {kind} so much is said: {verdict}",
    }


class Closures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-closures-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.result = stored_run.clean_run(EXAMPLE)

    def stored(self, name, closures):
        """A run whose first channel has these."""
        result = copy.deepcopy(self.result)
        result["channels"][0]["closures"] = closures
        if any(one["verdict"] == "open" for one in closures):
            result["channels"][0].update(
                flags=["what must hold over the run does not"], flag_names=["closure_open"]
            )
        return stored_run.write_run(self.folder / "runs/bench" / name, result)

    def certify(self, run, *options):
        output = self.folder / f"{run.name}.xml"
        output.unlink(missing_ok=True)
        made = self.dyncal("certify", run, "--lab", stored_run.LAB, "--sensor", stored_run.SENSOR,
                           "--output", output, *stored_run.kept(DYNCAL, run),
                           *options)  # fmt: skip
        return made, output.read_text() if output.exists() else ""

    def report(self, run, *options):
        file = run / "report.html"
        file.unlink(missing_ok=True)
        made = self.dyncal("report", run, *options)
        return made, file.read_text() if file.exists() else ""

    def dyncal(self, *arguments):
        return subprocess.run([DYNCAL, *map(str, arguments)], capture_output=True, text=True)

    def test_each_open_one_is_refused_by_name(self):
        for kind, title in kinds():
            run = self.stored(kind, [closure(kind, "open")])
            for make in (self.certify, self.report):
                with self.subTest(kind=kind, command=make.__name__):
                    made, document = make(run)
                    self.assertNotEqual(made.returncode, 0)
                    self.assertEqual(document, "")
                    self.assertIn(f"{title}: of {kind} so much is said: open", made.stderr)
                    self.assertIn("--force", made.stderr)

    def test_when_forced_each_open_one_stands_on_the_first_page(self):
        run = self.stored("forced", [closure(kind, "open") for kind, _ in kinds()])
        made, certificate = self.certify(run, "--force")
        self.assertEqual(made.returncode, 0, made.stderr)
        made, report = self.report(run, "--force")
        self.assertEqual(made.returncode, 0, made.stderr)
        first_page = html.unescape(report[: report.index("<h2")])
        for kind, title in kinds():
            # Not assertIn, which would print the document.
            said = f"{title}: of {kind} so much is said: open"
            self.assertTrue(said in first_page, kind)
            self.assertTrue(f"of {kind} so much is said: open" in certificate, kind)

    def test_what_closes_or_is_not_possible_is_not_refused(self):
        for verdict in ("closes", "not_possible"):
            run = self.stored(verdict, [closure(kind, verdict) for kind, _ in kinds()])
            made, certificate = self.certify(run)
            self.assertEqual(made.returncode, 0, made.stderr)
            self.assertFalse("FORCED" in certificate)
            made, report = self.report(run)
            self.assertEqual(made.returncode, 0, made.stderr)
            for kind, title in kinds():
                self.assertTrue(title in html.unescape(report), kind)
                self.assertTrue(f"of {kind} so much is said: {verdict}" in report, kind)

    def test_another_channel_is_certified(self):
        run = self.stored("other", [closure("level", "open")])
        made, certificate = self.certify(run, "--channel", SECOND)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertFalse("FORCED" in certificate)
        self.assertEqual(self.certify(run, "--channel", FIRST)[0].returncode, 1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
