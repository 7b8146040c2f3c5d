#!/usr/bin/env python3
"""Runs whose statements are corrected: documents use and name the correction, and whoever changes
a journal or the store behind the audit trail is found.

    amended_documents_test.py DYNCAL EXAMPLE_WRITER
"""

import shutil
import sqlite3
import sys
import time
import unittest

from documents_of_run import DocumentsOfRun, dyncal

ISSUED = 10


# What a forger does to the journal of a run that was amended: its lines, before and after.


def other_value(lines):
    return [line.replace("SN-777", "SN-778") for line in lines]


def other_person(lines):
    return [line.replace("A. Meter", "B. Meter") for line in lines]


def other_day(lines):
    return [line.replace('"utc":"20', '"utc":"19', 1) for line in lines]


def no_reason(lines):
    return [line.replace("typing error", "") for line in lines]


def no_lines(lines):
    return []


def one_more(lines):
    return [*lines, lines[-1].replace("SN-777", "SN-999")]


def no_json(lines):
    return [*lines, "amended: serial=SN-777"]


JOURNALS = {
    other_value: "it was changed",
    other_person: "it was changed",
    other_day: "it was changed",
    no_reason: "it was changed",
    no_lines: "it was changed",
    one_more: "the store does not have the amendment",
    no_json: "is not an entry of a journal",
}


class AmendedDocuments(DocumentsOfRun):
    def amended(self, name, *changes):
        run = self.copy(name)
        (run / "recording.mcap").unlink()  # the store alone is quicker
        made = dyncal("amend", run, *changes, "--reason", "typing error", "--operator", "A. Meter",
                      "--store", run.parents[1] / "dyncal.sqlite")  # fmt: skip
        self.assertEqual(made.returncode, 0, made.stderr)
        return run, made

    def test_an_amended_run_is_certified_with_its_amendment(self):
        run, _ = self.amended("amended", "serial=SN-777", "customer=Example Ltd")
        named = self.sensor("named", ("0xbccb0100", "SN-777"))
        self.assert_refused("serial number 'SN-777'", self.certify(run))  # the old sensor file
        made, file = self.certify(run, sensor=named)
        self.assertEqual(made.returncode, 0, made.stderr)
        text = file.read_text()
        for said in ("serial number of dau corrected to SN-777", "was 0xbccb0100", "A. Meter",
                     "typing error", "Example Ltd"):  # fmt: skip
            self.assertIn(said, text)
        made, pdf = self.issue(run, "--number", "2026-0077", sensor=named)
        self.assertEqual(made.returncode, 0, made.stderr)
        store = ("--store", run.parents[1] / "dyncal.sqlite")
        self.assertEqual(self.verify(pdf, *store).returncode, 0)
        checked = dyncal("store", "audit", *store)
        self.assertEqual(checked.returncode, 0, checked.stdout)
        self.assertIn("run_amended", checked.stdout)
        self.assertEqual(checked.stdout.count("document_issued"), 2)

    def test_edited_journals_get_no_document(self):
        named = self.sensor("named", ("0xbccb0100", "SN-777"))
        for edit, reason in JOURNALS.items():
            run, _ = self.amended(f"journal-{edit.__name__}", "serial=SN-777")
            journal = run / "journal.jsonl"
            lines = journal.read_text().splitlines()
            self.assertTrue(any("SN-777" in line for line in lines))
            journal.write_text("".join(line + "\n" for line in edit(lines)))
            with self.subTest(edit.__name__):
                for make in (self.certify, self.issue):
                    self.assert_refused(reason, make(run, "--force", sensor=named))
            shutil.rmtree(run.parents[1])

    def test_an_amendment_makes_older_documents_due(self):
        run = self.copy("due")
        (run / "recording.mcap").unlink()
        store = ("--store", run.parents[1] / "dyncal.sqlite")
        made, file = self.certify(run)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual(self.verify(file, *store).returncode, 0)
        self.next_second()
        made = dyncal("amend", run, "customer=Example Ltd", "--reason", "renamed", *store)
        self.assertIn("issue a revision with --replaces 2026-0042", made.stdout)
        checked = self.verify(file, *store)
        self.assertEqual(checked.returncode, ISSUED, checked.stdout)
        self.assertIn("a revision is due: customer corrected to Example Ltd", checked.stdout)
        made, revision = self.certify(run, "--number", "2026-0043", "--replaces", "2026-0042")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual(self.verify(revision, *store).returncode, 0)

    @staticmethod
    def next_second():
        """Documents and amendments are told apart by the second."""
        begun = int(time.time())
        while int(time.time()) == begun:
            pass

    def test_only_statements_are_amended(self):
        run = self.copy("numbers-amended")
        for change in ("magnitude=1.0", "began_utc=2019-01-01", "flags=", "U_magnitude=1e-6"):
            made = dyncal("amend", run, change, "--reason", "better")
            self.assertNotEqual(made.returncode, 0, change)
            self.assertIn("cannot be amended", made.stderr)
        self.assertFalse((run / "journal.jsonl").exists() and "amendment" in
                         (run / "journal.jsonl").read_text())  # fmt: skip

    def test_a_changed_store_is_found_by_its_audit(self):
        changes = {
            "was changed": "UPDATE audit SET name = 'B. Meter' WHERE action = 'run_amended'",
            "entry 1 is missing": "DELETE FROM audit WHERE number = 1",
            "the text of a result": "UPDATE results SET document = replace(document, '1', '2')",
            "the text of a journal entry": "UPDATE run_entries SET entry = '{}'",
            "not in the store any more": "DELETE FROM run_entries",
        }
        for number, (reason, change) in enumerate(changes.items()):
            run, _ = self.amended(f"audit-{number}", "serial=SN-777")
            store = run.parents[1] / "dyncal.sqlite"
            with sqlite3.connect(store) as database:
                if "results" not in change:
                    with self.assertRaisesRegex(sqlite3.IntegrityError, "append-only"):
                        database.execute(change)
                    for trigger in database.execute(
                        "SELECT name FROM sqlite_master WHERE type = 'trigger'"
                    ).fetchall():
                        database.execute(f"DROP TRIGGER {trigger[0]}")
                database.execute(change)
            checked = dyncal("store", "audit", "--store", store)
            self.assertEqual(checked.returncode, 3, checked.stdout)
            self.assertIn(reason, checked.stdout)
            self.assertEqual(dyncal("store", "audit", "--store", store, "--json").returncode, 3)

    def test_a_noted_head_is_missed(self):
        run, _ = self.amended("head", "serial=SN-777")
        store = ("--store", run.parents[1] / "dyncal.sqlite")
        head = dyncal("store", "audit", *store).stdout.splitlines()[-1].split()[-1]
        self.assertEqual(dyncal("store", "audit", *store, "--head", head).returncode, 0)
        checked = dyncal("store", "audit", *store, "--head", "0" * 64)
        self.assertEqual(checked.returncode, 3)
        self.assertIn("the head that was noted is not in the trail", checked.stdout)

if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
