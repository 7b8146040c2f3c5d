#!/usr/bin/env python3
"""What a metrologist asks of the page besides its numbers: the budget of what is certified, tables
for a spreadsheet, one run against another, ticks to read, no alarm for nothing."""

import played_state
from page_case import PageCase, choose, drawn_pixels, rows_of_chart, run, text_of, texts_of
from played_laboratory import example


class Metrologist(PageCase):
    def setUp(self):
        super().setUp()
        self.laboratory = example()
        self.server.laboratory = self.laboratory
        self.server.server.laboratory = self.laboratory

    def test_budget_of_a_mean_whose_uncertainty_is_certified(self):
        page = self.open("run/acc-2")
        page.wait_for("document.querySelectorAll('[data-frequency]').length === 17")
        page.value("document.querySelector('[data-frequency=\"63\"] button').click()")
        page.wait_for("document.querySelectorAll('[data-panel=budget] tbody tr').length === 6")
        mean = next(m for m in played_state.transfer(self.laboratory.points["acc-2"])
                    if m["frequency_text_hz"] == "63")
        text = mean["text"]
        self.assertEqual(page.value(text_of("[data-field=budget_of]")),
                         f"{played_state.CHANNEL}, mean of 3, 63 Hz: {text['magnitude']['value']}, "
                         f"U {text['magnitude']['u']}; {text['phase_deg']['value']}°, "
                         f"U {text['phase_deg']['u']}°")
        self.assertEqual(page.value("[...document.querySelector('[data-panel=budget] tbody tr')"
                                    ".cells].slice(0, 4).map(c => c.textContent)"),
                         ["scatter of the repetitions", "0.09", "", "0.046"])

    def test_tables_are_copied_as_text_between_tabs(self):
        page = self.open("run/acc-2")
        page.wait_for("document.querySelectorAll('[data-frequency]').length === 17")
        page.value("window.copied = null; document.addEventListener('copy', e => { window.copied = "
                   "e.clipboardData.getData('text/plain'); })")
        place = page.value(  # by a hand: a script may not copy
            "(b => { b.scrollIntoView({ block: 'center' }); const r = b.getBoundingClientRect(); "
            "return [r.left + r.width / 2, r.top + r.height / 2]; })([...document.querySelectorAll("
            "'button')].find(b => b.textContent === 'Copy table' && b.checkVisibility()))")
        page.click(*place)
        page.wait_for("copied !== null")
        lines = page.value("copied").splitlines()
        self.assertEqual(len(lines), 18)
        self.assertEqual(lines[0].split("\t")[:4], ["f / Hz", "|H|", "U(|H|)", "arg H / °"])
        text = played_state.transfer(self.laboratory.points["acc-2"])[0]["text"]
        self.assertEqual(lines[1].split("\t"),
                         ["10", text["magnitude"]["value"], text["magnitude"]["u"],
                          text["phase_deg"]["value"], text["phase_deg"]["u"],
                          text["phase_rad"]["value"], text["phase_rad"]["u"],
                          "2.469", "2.1", "3", "none"])
        comma = page.value("import('/page/copy_tools.js').then(m => m.table_text(document."
                           "querySelector('[data-panel=table] table'), ','))")
        self.assertEqual(comma.splitlines()[1], lines[1].replace(".", ","))

    def test_run_is_laid_over_another_one(self):
        page = self.open("run/acc-1")  # which lasts
        page.wait_for("document.querySelectorAll('[data-panel=comparison] option').length === 4")
        self.assertIn("last: run-40", page.value(texts_of("[data-panel=comparison] option"))[1])
        choose(page, "run-40")
        page.wait_for("document.querySelectorAll('[data-panel=comparison] .canvas').length === 4")
        page.wait_for("document.querySelectorAll('[data-panel=comparison] .canvas')[2].graph?.numRows() > 0")
        rows = page.value(rows_of_chart(2, "[data-panel=comparison] .canvas"))
        other = {p["frequency_hz"]: p for p in played_state.history("")["runs"][2]["points"]}
        drawn = sorted((row[0], row[1][1]) for row in rows)
        expected = sorted((p["frequency_hz"], 100 * (p["magnitude"] / other[p["frequency_hz"]][
            "magnitude"] - 1)) for p in self.laboratory.points["acc-1"])
        self.assertEqual(len(drawn), 24)
        for (f, value), (f_expected, value_expected) in zip(drawn, expected):
            self.assertEqual(f, f_expected)
            self.assertAlmostEqual(value, value_expected, 9)

    def test_phone_shows_the_value_without_scrolling_sideways(self):
        self.laboratory.runs["acc-2"] = [
            {"run": "20261128T004241.295Z.f8f913b0", "planned_utc_ms": 1795388400000,
             "state": "done"}]
        page = self.open("run/acc-2", width=390)
        page.wait_for("document.querySelectorAll('[data-frequency]').length === 17")
        self.assertLessEqual(page.value("document.documentElement.scrollWidth"), 390)
        for row in ("[data-frequency]", "[data-step]"):
            right = page.value(f"document.querySelector('{row}').cells[2]"
                               ".getBoundingClientRect().right")
            self.assertLess(right, 390)

    def test_ticks_are_frequencies_that_were_measured(self):
        page = self.open("run/acc-2")
        page.wait_for(f"{drawn_pixels(0)} > 500")
        ticks = ("import('/page/axis_ticks.js').then(m => m.{}({})(...{}).map(t => t.label))")
        measured = "[10, 12.5, 16, 20, 25, 31.5, 40, 50, 63, 80, 100, 125, 160]"
        octaves = ["10", "20", "40", "80", "160"]
        self.assertEqual(page.value(ticks.format("frequency_ticker", measured, "[9, 170, 400]")),
                         octaves)
        self.assertEqual(page.value(ticks.format("frequency_ticker", "[]", "[9, 170, 400]")),
                         octaves)
        self.assertEqual(page.value(ticks.format("frequency_ticker", "[10, 33.3, 90]",
                                                 "[9, 170, 400]")), ["10", "33.3", "90"])
        self.assertEqual(page.value(ticks.format("decade_ticker", "false", "[0.5, 500, 400]")),
                         ["1", "10", "100"])
        labels = page.value("[...document.querySelectorAll('.canvas')[0].querySelectorAll("
                            "'.dygraph-axis-label-x')].map(e => e.textContent)")
        self.assertEqual([float(one) for one in labels][:3], [10, 20, 40])

    def test_idle_bench_does_not_warn(self):
        self.laboratory.benches["acc-1"].update(excitation="done")
        self.laboratory.signal_changes = {"level_peak": 0.01, "level_rms": 0.005}
        page = self.open("bench/acc-1")
        level, _ = page.wait_for("(t => t?.includes('peak') ? t : null)"
                                 f"({text_of('[data-field=level]')})")
        self.assertIn("○ quiet", level)
        self.assertNotIn("underload", page.value("document.body.textContent"))
        self.assertEqual(page.value(text_of('[data-source="dau"] [data-field="rate"]')),
                         "1000 Hz, as nominal")

    def test_what_stops_a_run_is_in_the_title(self):
        page = self.open("bench/acc-1")
        page.wait_for("document.title === 'Bench acc-1 · dyncal'")
        self.laboratory.benches["acc-1"].update(state="aborted", message="the reference is away")
        self.laboratory.changed()
        page.wait_for("document.title === '✕ acc-1 aborted: the reference is away · Bench acc-1 "
                      "· dyncal'")


if __name__ == "__main__":
    run()
