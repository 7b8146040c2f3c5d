#!/usr/bin/env python3
"""The report of a stored run: text and numbers of the PDF are those of the result file, the HTML
needs nothing but itself, and no text of a file becomes markup.

    report_test.py DYNCAL EXAMPLE_WRITER
"""

import html.parser
import json
import math
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import unittest

import stored_run

DYNCAL, EXAMPLE = sys.argv[1:3]


def dyncal(*arguments, **settings):
    return subprocess.run(
        [DYNCAL, *map(str, arguments)], capture_output=True, text=True, **settings
    )


class Fetches(html.parser.HTMLParser):
    """What a browser would fetch or run."""

    def __init__(self):
        super().__init__()
        self.found = []
        self.tags = set()

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        for name, value in attributes:
            if name in ("src", "href", "xlink:href", "data", "action", "srcset"):
                if not (value or "").startswith(("data:", "#")):
                    self.found.append((tag, name, value))
            if name.startswith("on"):
                self.found.append((tag, name, value))


class Report(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-report-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.result = stored_run.clean_run(EXAMPLE)
        self.run_folder = self.folder / "runs" / "bench" / "run-1"

    def report(self, *options):
        stored_run.write_run(self.run_folder, self.result)
        made = dyncal("report", self.run_folder, *options)
        self.assertEqual(made.returncode, 0, made.stderr)
        return (self.run_folder / "report.html").read_text()

    def check_row(self, value, lines):
        magnitude = stored_run.rounded(value["magnitude"], value["U_magnitude"])
        degrees = stored_run.rounded(value["phase_deg"], value["U_phase_deg"])
        radians = stored_run.rounded(value["phase_rad"], value["U_phase_rad"])
        level = statistics.fmean(
            one["measured_level_m_s2"]
            for one in self.result["points"]
            if one["channel"] == value["channel"]
            and one["frequency_text_hz"] == value["frequency_text_hz"]
        )
        row = [
            value["frequency_text_hz"],
            f"{level:.4g}",
            *magnitude,
            stored_run.two_digits(100 * value["U_magnitude"] / value["magnitude"]),
            f"{value['k_magnitude']:.2f}",
            *degrees,
            *radians,
            f"{value['k_phase']:.2f}",
            str(value["repetitions"]),
        ]
        found = [line for line in lines if line.split()[: len(row)] == row]
        self.assertEqual(len(found), 1, f"{value['channel']}: {row}")

    @unittest.skipUnless(
        shutil.which("weasyprint") and shutil.which("pdftotext"),
        "SKIPPED: weasyprint or pdftotext (poppler-utils) is not there",
    )
    def test_numbers_and_text_of_the_pdf_are_those_of_the_result(self):
        self.report("--lab", stored_run.LAB, "--sensor", stored_run.SENSOR)
        pdf = self.run_folder / "report.pdf"
        text = subprocess.run(
            ["pdftotext", "-layout", pdf, "-"], check=True, capture_output=True, text=True
        ).stdout
        lines = text.splitlines()
        checked = 0
        for value in self.result["transfer_function"]:
            self.check_row(value, lines)
            checked += 1
        self.assertEqual(checked, len(stored_run.FREQUENCIES) * len(stored_run.CHANNELS))
        flowing = " ".join(text.split())
        for part in (
            "Example Laboratory for Vibration",
            "Dr. Erika Mustermann",
            "Max Beispiel",
            "Sensor Works Example",
            "No. 2026-0042",
            "NMI-17-0001",
            "95.45 %",
            "None of these values has a flag.",
            "23.0 °C, U = 1.0 °C",
            f"{self.result['bench']}, {self.result['run']}",
        ):
            self.assertIn(part, flowing)
        pages = int(re.search(r"page 1 of (\d+)", flowing)[1])
        self.assertGreater(pages, 1)
        for page in range(1, pages + 1):
            self.assertIn(f"page {page} of {pages}", flowing)

    def test_budget_at_the_reference_frequency_adds_up(self):
        page = self.report("--no-pdf")
        tables = re.findall(r'<table class="model">.*?</table>', page, re.DOTALL)
        self.assertEqual(len(tables), 2 * len(stored_run.CHANNELS))  # magnitude, phase
        self.assertIn("Uncertainty budget of dau/acceleration_z at 199.87 Hz", page)
        for table in tables:
            cells = [re.findall(r"<td>(.*?)</td>", row) for row in table.split("<tr>")]
            *rows, total = [row for row in cells if row]
            self.assertGreater(len(rows), 0)
            squares = 0.0
            for name, estimate, unit, u, distribution, sensitivity, contribution, freedom in rows:
                self.assertTrue(name and estimate and unit and distribution and freedom)
                squares += float(contribution) ** 2
                if u != "–":
                    product = float(u) * float(sensitivity)
                    self.assertAlmostEqual(product / float(contribution), 1.0, delta=0.11, msg=name)
            self.assertAlmostEqual(math.sqrt(squares) / float(total[6]), 1.0, delta=0.06)

    def test_comments_of_the_recipe_stay_in_the_laboratory(self):
        self.result["recipe"] = '# MEASURE IT\nbench = "b#1" # ours\n'
        page = self.report("--no-pdf")
        self.assertIn("bench = &quot;b#1&quot;\n", page)
        self.assertNotIn("MEASURE IT", page)
        self.assertNotIn("ours", page)

    def test_html_needs_nothing_but_itself(self):
        page = self.report("--lab", stored_run.LAB, "--no-pdf")
        fetches = Fetches()
        fetches.feed(page)
        self.assertEqual(fetches.found, [])
        self.assertNotIn("script", fetches.tags)
        self.assertIn("svg", fetches.tags)
        self.assertIn("default-src 'none'", page)
        # Response and deviations.
        self.assertEqual(page.count("<svg "), 2 * len(stored_run.CHANNELS))
        ids = re.findall(r'\bid="([^"]*)"', page)
        self.assertEqual(len(ids), len(set(ids)))
        self.assertFalse((self.run_folder / "report.pdf").exists())

    def test_text_of_files_does_not_become_markup(self):
        attack = "<script>alert(1)</script>\"'&<img src=http://x onerror=y>\x07"
        self.result["bench"] = attack
        self.result["run"] = attack
        self.result["problem"] = attack
        self.result["recipe"] = attack
        self.result["flag_legend"] = [{"name": "other", "sentences": [attack], "meaning": attack}]
        self.result["transfer_function"][0].update(flags=[attack], flag_names=["other"])
        for source in self.result["sources"]:
            source["device"] = attack
        laboratory = self.folder / "lab.toml"
        laboratory.write_text(
            f"[laboratory]\nname = '''{attack[:-1]}'''\ncity = 'x'\ncountry = 'DE'\n"
        )
        page = self.report("--lab", laboratory, "--no-pdf")
        fetches = Fetches()
        fetches.feed(page)
        self.assertEqual(fetches.found, [])
        self.assertNotIn("script", fetches.tags)
        self.assertGreater(page.count("&lt;script&gt;alert(1)"), 5)
        self.assertNotIn("\x07", page)

    def test_a_result_file_gets_its_report_beside_it(self):
        file = self.folder / "monday.json"
        file.write_text(json.dumps(self.result))
        made = dyncal("report", file, "--no-pdf")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertTrue((self.folder / "monday-report.html").is_file())

    def test_says_that_weasyprint_is_missing_and_leaves_the_html(self):
        stored_run.write_run(self.run_folder, self.result)
        made = dyncal("report", self.run_folder, env={**os.environ, "PATH": str(self.folder)})
        self.assertEqual(made.returncode, 1)
        self.assertIn("apt install weasyprint", made.stderr)
        self.assertTrue((self.run_folder / "report.html").is_file())
        self.assertFalse((self.run_folder / "report.pdf").exists())

    def test_flags_losses_and_missing_values_are_seen(self):
        value = self.result["transfer_function"][3]
        value.update(flags=["dau: samples lost"], flag_names=["samples_lost"])
        self.result["flag_legend"] = [
            {"name": "samples_lost", "sentences": ["dau: samples lost"], "meaning": "look there"}
        ]
        point = self.result["points"][0]
        point.update(valid=False, problem="no steady sine")
        for name in ("magnitude", "u_magnitude", "phase_rad", "u_phase_rad"):
            point[name] = None
        self.result["points"][1]["source_samples"][0]["lost"] = 4711
        page = self.report("--no-pdf")
        for text in ("no steady sine", "look there", "4711", "1 single results have no value"):
            self.assertIn(text, page)
        self.assertIn("<td>F1</td></tr>", page)

    def test_a_flag_of_another_channel_alone_is_not_in_the_report(self):
        flagged, other = stored_run.CHANNELS
        for value in self.result["transfer_function"]:
            if value["channel"] == flagged:
                value.update(flags=["polarity inverted"], flag_names=["polarity_inverted"])
        self.result["flag_legend"] = [
            {"name": "polarity_inverted", "sentences": ["polarity inverted"], "meaning": "turn it"}
        ]
        for channel, count in ((flagged, 1), (other, 0)):
            page = self.report("--no-pdf", "--channel", channel)
            self.assertEqual(page.count("turn it"), count)
            self.assertEqual(page.count("Some values have flags"), count)
            self.assertEqual(page.count("None of these values has a flag."), 1 - count)

    def test_pictures_of_the_run_folder_are_taken_in_only_if_they_fetch_nothing(self):
        stored_run.write_run(self.run_folder / "figures", self.result)
        good = self.run_folder / "figures" / "interval-histogram-dau.svg"
        good.write_text('<svg xmlns="http://www.w3.org/2000/svg"><rect width="3"/></svg>')
        bad = self.run_folder / "figures" / "interval-over-time-dau.svg"
        bad.write_text(
            '<svg xmlns="http://www.w3.org/2000/svg"><image href="http://x.example/a.png"/></svg>'
        )
        page = self.report("--no-pdf")
        self.assertEqual(page.count("data:image/svg+xml"), 1)
        self.assertNotIn("<h2>Interferometer</h2>", page)
        self.assertIn("interval-over-time-dau.svg", page)
        self.assertIn("a document fetches nothing", page)

    def test_ellipse_of_an_interferometer_has_a_section(self):
        stored_run.write_run(self.run_folder / "figures", self.result)
        ellipse = self.run_folder / "figures" / "ellipse-acs-displacement.svg"
        ellipse.write_text('<svg xmlns="http://www.w3.org/2000/svg"><rect width="3"/></svg>')
        page = self.report("--no-pdf")
        section = page[page.index("<h2>Interferometer</h2>"):]
        self.assertIn('alt="ellipse-acs-displacement.svg"', section)
        self.assertEqual(page.count("data:image/svg+xml"), 1)

    def test_refuses_what_is_not_a_result(self):
        for name, text, part in (
            ("missing.json", None, "cannot be read"),
            ("broken.json", '{"schema": ', "not JSON"),
            ("other.json", '{"schema": {"name": "dyncal-model"}}', "dyncal-model"),
            ("list.json", "[1]", "no 'schema'"),
        ):
            file = self.folder / name
            if text is not None:
                file.write_text(text)
            made = dyncal("report", file, "--no-pdf")
            self.assertEqual(made.returncode, 1, name)
            self.assertIn(part, made.stderr)
            self.assertIn(str(file), made.stderr)
            self.assertEqual(len(made.stderr.splitlines()), 1, made.stderr)
        self.result["transfer_function"][2].pop("U_phase_rad")
        file = self.folder / "key.json"
        file.write_text(json.dumps(self.result))
        made = dyncal("report", file, "--no-pdf")
        self.assertIn("transfer_function[2].U_phase_rad is missing", made.stderr)

    def test_unusual_numbers_are_refused_or_shown_as_such(self):
        self.result["transfer_function"][0].update(magnitude=None, U_magnitude=None)
        self.result["transfer_function"][1].update(U_phase_rad=0.0)
        page = self.report("--no-pdf")
        self.assertIn("<td>nan</td>", page)
        self.assertTrue(math.isfinite(len(page)))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
