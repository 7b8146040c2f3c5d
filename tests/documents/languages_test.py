#!/usr/bin/env python3
"""Documents in German, and in German and English: nothing of a German one is in English but names,
identifiers, quotations and what files of the laboratory say; numbers have commas and days their
order. So too of one that is forced in spite of objections of every kind.

    languages_test.py DYNCAL EXAMPLE_WRITER
"""

import copy
import html
import json
import pathlib
import random
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
    r"it|its|be|does|cannot|without|before|after|when|until|why|lacks|says|samples|measured|reason|"
    r"uncertainty|frequency|value|phase shift|delay|calibration report)\b"
)
# What programs and persons said, as it stands in the journal.
QUOTED = re.compile("„[^“]*“")
OPEN = {"kind": "phase_at_zero", "subject": "dau/acceleration_z", "verdict": "open", "value": 0.25,
        "u": 0.01, "limit": 0.1, "unit": "rad", "sentence": "it is not near those of the rest"}
JOURNAL = [
    ("note", "the door was open", []),
    ("event", "the run has paused for 31 s", []),
    ("amendment", "misread", [{"key": "dau/model", "before": "MPU-9250", "after": "MPU-9255"}]),
]
# What a forced document says of the run that troubled() makes, and of its files.
OBJECTIONS = [
    "der Messlauf wurde abgebrochen",
    "der Messlauf endete vorzeitig: den Grund nennt die Ergebnisdatei",
    "der Messplatz verlangt eine Prüfung mit Sensor „SN-1“",
    "Gegenprobe stimmt nicht: dau/acceleration_z: Phase gegen 0 Hz: gefunden 0,25 rad, Grenze "
    "0,1 rad",
    "dau/acceleration_x liegt quer zur angeregten Achse z",
    "dau/acceleration_z: 2 Einzelergebnisse haben keinen Wert; das erste bei ",
    "dau/acceleration_z: 36 von 38 geplanten Schritten haben einen Wert",
    "im Schritt fehlen 7 Abtastwerte, und keine Kennzeichnung sagt, warum",
    "Kennzeichnung over_range: Abtastwerte liegen an einem Ende des Messbereichs",
    "gemessen ist mit Seriennummer „0xbccb0100“ (Quelle dau), die Sensordatei nennt „0xDEAD“",
    "gemessen ist mit Typ „MPU-9255“ (Quelle dau), die Sensordatei nennt „BMA280“",
    "der Kalibriergegenstand ging am 05.03.2026 ein, nach der Messung vom 01.03.2026",
    "der Kalibrierschein von „Laser vibrometer“ ist vom 03.03.2026, nach der Messung vom "
    "01.03.2026",
    "die Laboratoriumsdatei nennt nicht, bis wann „Laser vibrometer“ benutzt werden darf",
    "„Vibration exciter“ war bis 01.01.2026 neu zu kalibrieren",
]


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
        words += [text for _, text, _ in JOURNAL[::2]]
        words += ["what-it-cannot-see.md", "Example Laboratory for Vibration", "ISO/IEC", "DDS"]
        return sorted({word for word in words if len(word) > 2}, key=len, reverse=True)

    def without_words_of_user(self, text):
        for word in self.words_of_user():
            text = text.replace(word, " ")
        return text

    def troubled(self, seed=37):
        """Everything speaks against this run, and much against its files."""
        draw = random.Random(seed)
        self.add_flags()
        result = self.result
        result.update(interrupted=True, problem="the cable of the sensor was pulled",
                      recipe='bench = "b"\n[check]\nsensor = "SN-1"\nmax_age_h = 24\n')
        result["planned_steps"] += 2
        result["pauses"] = [{"began_utc": "2026-03-01T12:10:00.000000000Z",
                             "ended_utc": "2026-03-01T12:11:00.000000000Z",
                             "reason": "no message from the source for 12 s"}]
        logged = {"source": "file room.csv", "U": 0.3, "problem": "the file is not there"}
        result["conditions"] = [
            {"quantity": "temperature", "unit": "degC", "count": 9, "minimum": 22.9, "mean": 23.0,
             "maximum": 23.1, **logged},
            {"quantity": "humidity", "unit": "%", "count": 0, "minimum": None, "mean": None,
             "maximum": None, **logged}]
        result["channels"][1]["closures"] = [OPEN]
        result["flag_legend"].append(
            {"name": "over_range", "sentences": ["over range"], "meaning": "lower the level"})
        along = [one for one in result["points"] if one["channel"] == "dau/acceleration_z"]
        for one in draw.sample(along, 4):
            one.update(flags=["dau/acceleration_z: over range"], flag_names=["over_range"])
        unflagged = [one for one in along if not one["flag_names"]]
        draw.choice(unflagged)["lost"] = 7
        for one in result["points"]:
            one["budget"] = [row for row in one["budget"] if row["kind"] != "transverse_motion"]
        for flags in ([], ["over_range"]):
            missing = copy.deepcopy(draw.choice(along))
            missing.update(valid=False, problem="no steady sine of it was found in the record",
                           step=result["planned_steps"] - len(flags), flag_names=flags,
                           flags=["over range"] * len(flags), budget=[])
            result["points"].append(missing)
        self.run_folder.mkdir(parents=True)
        (self.run_folder / "journal.jsonl").write_text("".join(
            json.dumps({"kind": kind, "utc": f"2026-03-01T12:1{i}:00.000000000Z",
                        "by": {"name": "A. Meter", "user": "meter", "host": "lab3"},
                        "text": text, "changes": changes}) + "\n"
            for i, (kind, text, changes) in enumerate(JOURNAL)))
        edits = {
            self.laboratory: [("issued = 2026-02-03", "issued = 2026-03-03"),
                              ("interval_months = 60", "#"),
                              ('serial = "42"', 'serial = "42"\nvalid_until = 2026-01-01')],
            self.sensor: [('serial = "0xbccb0100"', 'serial = "0xDEAD"'),
                          ('model = "MPU-9250"', 'model = "BMA280"'),
                          ("received = 2026-02-20", "received = 2026-03-05")]}
        for file, changes in edits.items():
            text = file.read_text()
            for old, new in changes:
                self.assertEqual(text.count(old), 1, old)
                text = text.replace(old, new)
            file.write_text(text)

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

    def test_a_german_draft_of_such_a_run_is_in_german(self):
        self.troubled()
        shown = text_of(self.report("--language", "de", "--force"))
        for part in ("Der Messlauf endete vorzeitig: den Grund nennt die Ergebnisdatei",
                     "Was über den Messlauf gelten muss, gilt nicht: dau/acceleration_z: Phase "
                     "gegen 0 Hz: gefunden 0,25 rad, Grenze 0,1 rad",
                     "„the run has paused for 31 s“", "Typ von dau berichtigt in MPU-9255",
                     "einige fehlen: den Grund nennt die Ergebnisdatei",
                     "Luftfeuchte nicht gemessen, obwohl „file room.csv“ es sollte"):
            self.assertIn(part, shown)
        self.assertEqual(english_in(QUOTED.sub(" ", self.without_words_of_user(shown))), [])

    def issued_by_force(self, language):
        """The text of the PDF, without the bench file at its end."""
        stored_run.write_run(self.run_folder, self.result)
        kept = stored_run.kept(DYNCAL, self.run_folder)
        made = dyncal("report", self.run_folder, *self.documents(), "--issue", "--force",
                      "--language", language, "--output", self.folder / "forced",
                      *kept)  # fmt: skip
        if "weasyprint" in made.stderr:
            self.skipTest(made.stderr)
        self.assertEqual(made.returncode, 0, made.stderr)
        shown = subprocess.run(["pdftotext", "-raw", self.folder / "forced.pdf", "-"],
                               capture_output=True, text=True)  # fmt: skip
        text = shown.stdout.split("Anhang: Messplatzdatei")[0]
        return " ".join(re.sub("[\u00ad\u2010-]\n", "", text).split())

    @unittest.skipUnless(shutil.which("pdftotext"), "SKIPPED: pdftotext is not there")
    def test_a_forced_german_report_is_in_german(self):
        self.troubled()
        shown = self.issued_by_force("de")
        compact = shown.replace(" ", "").replace("-", "")
        said = [*OBJECTIONS, "DIESER BERICHT WURDE ERZWUNGEN", "„the run has paused for 31 s“",
                "Typ von dau berichtigt in MPU-9255", "einige fehlen: den Grund nennt die "
                "Ergebnisdatei", "Luftfeuchte nicht gemessen, obwohl „file room.csv“ es sollte"]
        for part in said:
            self.assertIn(part.replace(" ", "").replace("-", ""), compact)
        text = QUOTED.sub(" ", self.without_words_of_user(shown))
        self.assertGreater(len(text), 10000)
        self.assertEqual(english_in(text), [])

    def test_a_forced_german_certificate_is_in_german(self):
        self.troubled()
        stored_run.write_run(self.run_folder, self.result)
        for language in ("en", "de"):
            file = self.folder / f"{language}.xml"
            made = dyncal("certify", self.run_folder, *self.documents(), "--force", "--language",
                          language, "--output", file, "--store", self.folder / "elsewhere.sqlite")
            self.assertEqual(made.returncode, 0, made.stderr)
            self.assertIn("forced in spite of: the run was interrupted", made.stdout)
        trees = {language: ElementTree.parse(self.folder / f"{language}.xml").getroot()
                 for language in ("en", "de")}  # fmt: skip
        english, german = (" ".join(contents_by_language(tree)[language])
                           for language, tree in trees.items())  # fmt: skip
        for part in [*OBJECTIONS, "DIESES ZERTIFIKAT WURDE ERZWUNGEN",
                     "nichts zeigt, dass result.json das ist, was gemessen wurde",
                     "das Archiv hat die Berichtigung vom 01.03.2026 12:12:00 UTC nicht"]:
            self.assertIn(part, german)
        german = QUOTED.sub(" ", self.without_words_of_user(german))
        self.assertEqual(english_in(german), [])
        self.assertGreater(len(ENGLISH.findall(self.without_words_of_user(english))), 100)

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
