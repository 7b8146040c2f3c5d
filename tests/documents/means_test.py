#!/usr/bin/env python3
"""Means for spreadsheets: the numbers of CSV and workbook are those of the result file, read by
Python and, where it is there, by LibreOffice with the locale de_DE.

    means_test.py DYNCAL EXAMPLE_WRITER
"""

import csv
import io
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
import zipfile

import stored_run

DYNCAL, EXAMPLE = sys.argv[1:3]
SHEET = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
KEYS = {
    "frequency_hz": "frequency_hz",
    "level_planned_m_s2": "level_m_s2",
    "magnitude": "magnitude",
    "U_magnitude": "U_magnitude",
    "k_magnitude": "k_magnitude",
    "phase_rad": "phase_rad",
    "U_phase_rad": "U_phase_rad",
    "k_phase": "k_phase",
    "repetitions": "repetitions",
}


def dyncal(*arguments):
    return subprocess.run([DYNCAL, *map(str, arguments)], capture_output=True, text=True)


def column_number(reference):
    number = 0
    for letter in re.match(r"[A-Z]+", reference)[0]:
        number = 26 * number + ord(letter) - ord("A") + 1
    return number - 1


def rows_of_workbook(path):
    """The first sheet as dictionaries of texts and numbers."""
    with zipfile.ZipFile(path) as archive:
        shared = ["".join(one.itertext())
                  for one in ElementTree.fromstring(archive.read("xl/sharedStrings.xml"))]  # fmt: skip
        sheet = ElementTree.fromstring(archive.read("xl/worksheets/sheet1.xml"))
    rows = []
    for row in sheet.iter(f"{SHEET}row"):
        cells = {}
        for cell in row.iter(f"{SHEET}c"):
            value = cell.find(f"{SHEET}v")
            if value is not None:
                is_text = cell.get("t") == "s"
                cells[column_number(cell.get("r"))] = (
                    shared[int(value.text)] if is_text else float(value.text)
                )
        rows.append(cells)
    head = rows[0]
    return [{head[i]: one.get(i, "") for i in head} for one in rows[1:]]


def rows_of_csv(text, separator=","):
    return [*csv.DictReader(io.StringIO(text), delimiter=separator)]


class Means(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-means-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        result = stored_run.clean_run(EXAMPLE)
        result["transfer_function"][0]["channel"] = "=1/2"  # a text, whatever it says
        cls.values = result["transfer_function"]
        cls.run_folder = stored_run.write_run(cls.folder / "bench/one", result)

    def means(self, name, *options):
        made = dyncal("means", self.run_folder, "--output", self.folder / name, *options)
        self.assertEqual(made.returncode, 0, made.stderr)
        return self.folder / name

    def assert_means(self, rows, number=float, digits=0.0):
        self.assertEqual(len(rows), len(self.values))
        for row, value in zip(rows, self.values):
            self.assertEqual(row["channel"], value["channel"])
            for name, key in KEYS.items():
                self.assertTrue(
                    math.isclose(number(row[name]), value[key], rel_tol=digits, abs_tol=0.0),
                    f"{name}: {row[name]} for {value[key]}",
                )
            self.assertTrue(
                math.isclose(number(row["phase_deg"]), math.degrees(value["phase_rad"]),
                             rel_tol=max(digits, 1e-14))  # fmt: skip
            )

    def test_csv_has_every_digit(self):
        text = self.means("means.csv").read_bytes().decode()
        self.assertTrue(text.endswith("\r\n"))
        self.assert_means(rows_of_csv(text))

    def test_csv_with_decimal_commas(self):
        data = self.means("comma.csv", "--decimal-comma").read_bytes()
        self.assertTrue(data.startswith(b"\xef\xbb\xbf"))
        rows = rows_of_csv(data.decode("utf-8-sig"), ";")
        self.assert_means(rows, lambda text: float(text.replace(",", ".")))
        self.assertIn(",", rows[0]["magnitude"])

    def test_workbook_has_every_digit(self):
        made = dyncal("means", self.run_folder, "--output", self.folder / "means.xlsx")
        if "libxlsxwriter was missing" in made.stderr:
            self.skipTest("SKIPPED: this build writes no XLSX")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assert_means(rows_of_workbook(self.folder / "means.xlsx"), digits=1e-15)

    def test_overwrites_nothing(self):
        path = self.folder / "there.csv"
        path.write_text("mine")
        made = dyncal("means", self.run_folder, "--output", path)
        self.assertEqual(made.returncode, 1)
        self.assertEqual(path.read_text(), "mine")

    @unittest.skipUnless(shutil.which("soffice"), "SKIPPED: LibreOffice is not there")
    def test_libreoffice_reads_both_in_german(self):
        for name, options, given in (
            ("lo.xlsx", [], []),
            ("lo.csv", ["--decimal-comma"], ["--infilter=CSV:59,34,76,1,,1031,false,true"]),
        ):
            path = self.means(name, *options)
            profile = self.folder / "profile"
            made = subprocess.run(
                ["soffice", f"-env:UserInstallation=file://{profile}", "--headless", *given,
                 "--convert-to", "csv:Text - txt - csv (StarCalc):44,34,76,1,,0,false,false,false",
                 "--outdir", self.folder / "converted", path],
                capture_output=True, text=True, timeout=300,
                env={"PATH": "/usr/bin:/bin", "HOME": str(self.folder), "LANG": "de_DE.UTF-8"},
            )  # fmt: skip
            self.assertEqual(made.returncode, 0, made.stderr)
            rows = rows_of_csv((self.folder / "converted" / f"{path.stem}.csv").read_text())
            if path.suffix == ".csv":
                rows[0]["channel"] = self.values[0]["channel"]  # CSV knows no texts
            self.assert_means(
                rows,
                lambda text: float(text.replace(",", ".")),
                digits=1e-13,  # it writes 15 digits
            )


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
