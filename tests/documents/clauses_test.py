#!/usr/bin/env python3
"""The guide's page for assessors: everything that it says stands in a report or certificate is
found in the documents of one run, in English and in German.

    clauses_test.py DYNCAL EXAMPLE_WRITER
"""

import html
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import stored_run

DYNCAL, EXAMPLE = sys.argv[1:3]
PAGE = stored_run.TOP / "deploy/guide/accreditation.md"
PREFIXES = {"https://ptb.de/dcc": "dcc", "https://ptb.de/si": "si"}


def dyncal(*arguments):
    done = subprocess.run([DYNCAL, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)


def rows_of_page():
    """(clause, words of the report, of a German one, of the DCC)"""
    for line in PAGE.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("|") and len(cells) == 5 and cells[1] not in ("---", "in the report"):
            yield cells[0], *(re.findall(r"`([^`]+)`", cell) for cell in cells[1:4])


def report_text(path):
    text = re.sub(r"<style>.*?</style>", "", path.read_text(), flags=re.DOTALL)
    return " ".join(html.unescape(re.sub(r"<[^>]+>", "", text)).split())


def dcc_words(path):
    """Names of its elements, refTypes and texts."""
    words = set()
    for element in ElementTree.parse(path).iter():
        namespace, _, name = element.tag.strip("{").partition("}")
        words.add(f"{PREFIXES.get(namespace, '?')}:{name}")
        words.update(element.get("refType", "").split())
        words.add((element.text or "").strip())
    return words


class Clauses(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-clauses-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        run = stored_run.write_run(cls.folder / "bench/one", stored_run.clean_run(EXAMPLE))
        sensor = cls.folder / "sensor.toml"
        sensor.write_text(stored_run.SENSOR.read_text() + stored_run.TOLERANCES)
        documents = ["--lab", stored_run.LAB, "--sensor", sensor]
        store = stored_run.kept(DYNCAL, run)
        dyncal("certify", run, *documents, "--output", cls.folder / "dcc.xml", *store)
        # A draft is the same HTML but for its day, and HTML alone needs no other program.
        dyncal("report", run, *documents, "--no-pdf", "--output", cls.folder / "report")
        cls.report = report_text(cls.folder / "report.html").replace("Draft of", "Issued")
        # The title of the example is the laboratory's own; without it the language has one.
        text = stored_run.LAB.read_text().replace('title = "Calibration report"\n', "")
        laboratory = cls.folder / "laboratory.toml"
        laboratory.write_text(text.replace('logo = "', f'logo = "{stored_run.LAB_FOLDER}/'))
        dyncal("report", run, "--lab", laboratory, "--sensor", sensor, "--no-pdf", "--language",
               "de", "--output", cls.folder / "german")  # fmt: skip
        german = report_text(cls.folder / "german.html")
        cls.german = german.replace("Entwurf vom", "Ausgestellt am")
        cls.dcc = dcc_words(cls.folder / "dcc.xml")

    def test_everything_is_where_the_page_says(self):
        found = 0
        for clause, of_report, of_german, of_dcc in rows_of_page():
            for words in of_report:
                with self.subTest(f"{clause}: {words}, report"):
                    self.assertIn(words, self.report)
                    found += 1
            for words in of_german:
                with self.subTest(f"{clause}: {words}, German report"):
                    self.assertIn(words, self.german)
                    found += 1
            for words in of_dcc:
                with self.subTest(f"{clause}: {words}, DCC"):
                    self.assertIn(words, self.dcc)
                    found += 1
        self.assertGreater(found, 100)

    def test_every_clause_has_a_row(self):
        clauses = [clause for clause, *_ in rows_of_page()]
        for letter in "abcdefghijklmnop":
            self.assertEqual(sum(one.startswith(f"{letter})") for one in clauses), 1, letter)
        for clause in ("7.8.4.1 a", "7.8.4.1 b", "7.8.4.1 c", "7.8.4.1 d", "7.8.4.1 e", "7.8.4.3"):
            self.assertEqual(sum(one.startswith(clause) for one in clauses), 1, clause)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
