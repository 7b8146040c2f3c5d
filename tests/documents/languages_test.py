#!/usr/bin/env python3
"""Documents in German, and in German and English: nothing of a German one is in English but names,
identifiers and what files of the laboratory say; numbers have commas and days their order.

    languages_test.py DYNCAL EXAMPLE_WRITER
"""

import html
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest
import xml.etree.ElementTree as ElementTree

import stored_run

DYNCAL, EXAMPLE = sys.argv[1:3]
SCHEMA = stored_run.TOP / "deploy/third-party/dcc/v3.3.0/dcc.xsd"
DCC = "{https://ptb.de/dcc}"
ENGLISH = re.compile(
    r"\b(the|of|with|and|are|which|were|for|from|not|has|have|this|that|to|by|is|no|each|other|"
    r"uncertainty|frequency|value|phase shift|delay|calibration report)\b"
)


def dyncal(*arguments):
    return subprocess.run([DYNCAL, *map(str, arguments)], capture_output=True, text=True)


def texts_in(tree):
    """All texts of a TOML or JSON file."""
    if isinstance(tree, dict):
        tree = [*tree.keys(), *tree.values()]
    if isinstance(tree, list):
        return [text for one in tree for text in texts_in(one)]
    return [tree] if isinstance(tree, str) else []


def text_of(page):
    page = re.sub(r"<(style|pre|title)\b.*?</\1>", "", page, flags=re.DOTALL)
    return " ".join(html.unescape(re.sub(r"<[^>]+>", " ", page)).replace("\u00ad", "").split())


def english_in(text):
    """English words with what stands around them."""
    return [text[max(0, one.start() - 40) : one.end() + 40] for one in ENGLISH.finditer(text)]


def contents_by_language(element):
    languages = {}
    for content in element.iter(f"{DCC}content"):
        languages.setdefault(content.get("lang"), []).append(content.text)
    return languages


class Languages(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-languages-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.result = stored_run.clean_run(EXAMPLE)
        self.run_folder = self.folder / "runs" / "bench" / "one"
        laboratory = stored_run.LAB.read_text()
        laboratory = laboratory.replace('title = "Calibration report"\n', "")
        laboratory = laboratory.replace('logo = "', f'logo = "{stored_run.LAB_FOLDER}/')
        self.laboratory = self.folder / "laboratory.toml"
        self.laboratory.write_text(laboratory)
        self.sensor = self.folder / "sensor.toml"
        self.sensor.write_text(stored_run.SENSOR.read_text() + stored_run.TOLERANCES)

    def documents(self):
        return ["--lab", self.laboratory, "--sensor", self.sensor]

    def report(self, *options):
        stored_run.write_run(self.run_folder, self.result)
        made = dyncal("report", self.run_folder, *self.documents(), "--no-pdf", *options)
        self.assertEqual(made.returncode, 0, made.stderr)
        return (self.run_folder / "report.html").read_text()

    def certificate(self, *options):
        stored_run.write_run(self.run_folder, self.result)
        file = self.folder / "certificate.xml"
        file.unlink(missing_ok=True)
        made = dyncal("certify", self.run_folder, *self.documents(), "--output", file, *options,
                      *stored_run.kept(DYNCAL, self.run_folder))  # fmt: skip
        self.assertEqual(made.returncode, 0, made.stderr)
        return file

    def words_of_user(self):
        """What files and instruments say, the longest first."""
        words = texts_in(tomllib.loads(self.laboratory.read_text()))
        words += texts_in(tomllib.loads(self.sensor.read_text()))
        keys = ("bench", "run", "sources", "software", "analysis_software", "channels", "method")
        for key in keys:
            words += texts_in(self.result.get(key, ""))
        words += [pause["reason"] for pause in self.result.get("pauses", [])]
        words += ["what-it-cannot-see.md", "Example Laboratory for Vibration", "ISO/IEC", "DDS"]
        return sorted({word for word in words if len(word) > 2}, key=len, reverse=True)

    def without_words_of_user(self, text):
        for word in self.words_of_user():
            text = text.replace(word, " ")
        return text

    def add_flags(self):
        names = ["level_off_plan", "shots_missing"]
        self.result["flag_legend"] = [
            {"name": name, "sentences": ["the sentence of it"], "meaning": "what is to be done"}
            for name in names
        ]
        for value in self.result["transfer_function"][:3]:
            value.update(flags=["the sentence of it"], flag_names=[names[0]])
        self.result["channels"][0].update(flags=["the sentence of it"], flag_names=[names[1]])

    def test_a_german_report_is_in_german(self):
        self.add_flags()
        page = self.report("--language", "de")
        self.assertIn('<html lang="de">', page)
        text = self.without_words_of_user(text_of(page))
        self.assertGreater(len(text), 5000)
        self.assertEqual(english_in(text), [])
        numbers = re.findall(r"(?<![\d.,])\d+\.\d+(?![\d.])", text)
        self.assertEqual(numbers, [])
        for part in ("95,45 %", "23,0 °C", "12,5", "Kalibrierschein", "Messunsicherheitsbudget"):
            self.assertIn(part, text_of(page))
        self.assertRegex(text_of(page), r"Entwurf vom \d\d\.\d\d\.\d{4}")
        self.assertIn("01.03.2026 12:00:05 UTC", text_of(page))
        self.assertIn("Das Bezugsnormal zeigt einen anderen Pegel als geplant", text_of(page))

    def test_the_english_one_would_be_found(self):
        text = self.without_words_of_user(text_of(self.report()))
        self.assertGreater(len(ENGLISH.findall(text)), 50)
        self.assertGreater(len(re.findall(r"(?<![\d.,])\d+\.\d+(?![\d.])", text)), 50)

    def test_numbers_are_the_same_in_both_languages(self):
        rows = {}
        for language in ("en", "de"):
            page = self.report("--language", language)
            rows[language] = re.findall(r'<table class="values">.*?</table>', page, re.DOTALL)
        self.assertGreater(len(rows["en"]), 1)
        cells = [
            [re.findall(r"<td>([-0-9.,]+)</td>", table) for table in rows[language]]
            for language in ("en", "de")
        ]
        self.assertGreater(sum(map(len, cells[0])), 200)
        self.assertEqual(
            [[cell.replace(".", ",") for cell in table] for table in cells[0]], cells[1]
        )

    def test_both_languages_follow_each_other(self):
        page = self.report("--language", "de,en")
        self.assertEqual(re.findall(r'<div class="part" lang="(..)">', page), ["de", "en"])
        self.assertEqual(re.findall(r'<div class="draft.*?>(.*?)<', page), ["ENTWURF / DRAFT"])
        german, english = page.split('<div class="part" lang="en">')
        self.assertIn("Übertragungsfunktion von dau/acceleration_z", german)
        self.assertIn("Transfer function of dau/acceleration_z", english)
        self.assertIn("der Sprache, die zuerst kommt", german)
        self.assertIn("the language that comes first", english)
        ids = re.findall(r'\bid="([^"]*)"', page)
        self.assertGreater(len(ids), 0)
        self.assertEqual(len(ids), len(set(ids)))

    def test_the_laboratory_file_may_say_the_language(self):
        self.laboratory.write_text('language = "de"\n' + self.laboratory.read_text())
        self.assertIn('<html lang="de">', self.report())
        self.assertIn('<html lang="en">', self.report("--language", "en"))
        self.laboratory.write_text(self.laboratory.read_text().replace('"de"', '"fr"', 1))
        made = dyncal("report", self.run_folder, *self.documents(), "--no-pdf")
        self.assertEqual(made.returncode, 1)
        self.assertIn("laboratory.toml:1: key 'language'", made.stderr)
        self.assertIn("documents are in en (English), de (German)", made.stderr)

    def test_other_languages_are_refused(self):
        for codes in ("fr", "de,de", "", "DE"):
            made = dyncal("report", self.run_folder, "--language", codes)
            self.assertNotEqual(made.returncode, 0, codes)
            self.assertIn("documents are in en (English), de (German)", made.stderr)

    @unittest.skipUnless(shutil.which("xmllint"), "SKIPPED: xmllint (libxml2-utils) is not there")
    def test_certificates_have_each_text_in_each_language(self):
        for codes in (["de"], ["en"], ["de", "en"], ["en", "de"]):
            file = self.certificate("--language", ",".join(codes))
            checked = subprocess.run(["xmllint", "--nonet", "--noout", "--schema", SCHEMA, file],
                                     capture_output=True, text=True)  # fmt: skip
            self.assertEqual(checked.returncode, 0, checked.stderr)
            tree = ElementTree.parse(file).getroot()
            used = [one.text for one in tree.iter(f"{DCC}usedLangCodeISO639_1")]
            mandatory = [one.text for one in tree.iter(f"{DCC}mandatoryLangCodeISO639_1")]
            self.assertEqual((used, mandatory), (codes, codes[:1]))
            contents = contents_by_language(tree)
            self.assertEqual(sorted(contents), sorted(codes))
            self.assertEqual(len({len(texts) for texts in contents.values()}), 1)
            self.assertGreater(len(contents[codes[0]]), 60)
            verified = dyncal("verify", file, "--run", self.run_folder)
            self.assertIn("numbers    ok: ", verified.stdout, verified.stderr)

    def test_a_german_certificate_is_in_german_and_its_numbers_are_xml(self):
        self.add_flags()
        text = self.certificate("--language", "de").read_text()
        tree = ElementTree.fromstring(text)
        german = self.without_words_of_user(" ".join(contents_by_language(tree)["de"]))
        self.assertEqual(english_in(german), [])
        for part in ("Übertragungskoeffizient", "Metrologische Rückführung", "Konformitätsaussage"):
            self.assertIn(part, german)
        numbers = [one.text for one in tree.iter() if one.tag.endswith("valueXMLList")]
        self.assertGreater(len(numbers), 8)
        self.assertNotIn(",", "".join(numbers))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
