#!/usr/bin/env python3
"""The four views show what the state holds: the same numbers, with the digits that their
uncertainty leaves them, and every digit in the title."""

import json
import math
import threading
import unittest.mock

import played_state
from page_case import PageCase, choose, drawn_pixels, rows_of_chart, run, text_of, texts_of
from played_laboratory import example


class Views(PageCase):
    def setUp(self):
        super().setUp()
        example_laboratory = example()
        self.laboratory = example_laboratory
        self.server.laboratory = example_laboratory
        self.server.server.laboratory = example_laboratory

    def field(self, page, bench, name):
        selector = f'[data-bench="{bench}"] [data-field="{name}"]'
        return page.value(text_of(selector))

    def test_laboratory_shows_every_bench_the_worst_first(self):
        page = self.open()
        page.wait_for("document.querySelectorAll('.tile').length === 3")
        self.assertEqual(page.value("[...document.querySelectorAll('.tile')].map(t => "
                                    "t.dataset.bench)"), ["gyro", "acc-2", "acc-1"])
        self.assertEqual(self.field(page, "acc-1", "state"), "running")
        self.assertEqual(self.field(page, "acc-1", "step"), "24 of 51, repetition 2")
        self.assertEqual(self.field(page, "acc-1", "excitation"), "40 Hz, 10 m/s², steady")
        self.assertEqual(self.field(page, "acc-1", "time_left"), "5 min 24 s")
        self.assertEqual(self.field(page, "acc-1", "results"), "24, 0 invalid, 1 flagged")
        self.assertEqual(self.field(page, "acc-1", "recording"), "recording, 81\u202f234 messages")
        self.assertEqual(self.field(page, "acc-2", "worst"), "dau: 12 samples lost")
        self.assertRegex(self.field(page, "gyro", "age"), "silent for 1 min 3\\d s")
        result = self.laboratory.benches["acc-1"]["last_result"]
        title = page.value("document.querySelector('[data-bench=\"acc-1\"] "
                           "[data-field=last_result]').title")
        self.assertIn(repr(result["magnitude"]), title)
        self.assertEqual(len(page.value(texts_of(".panel tbody tr"))), 7)
        self.assertEqual(page.value(text_of("[data-field=counts]")),
                         "3 benches: ◌ 1 silent, ▶ 1 running, ✓ 1 done")
        self.assertEqual(len(page.value(texts_of(".events li"))), 4)

    def test_laboratory_is_filtered_by_text_and_severity(self):
        page = self.open()
        page.wait_for("document.querySelectorAll('.tile').length === 3")
        page.value("(e => { e.value = 'acc'; e.dispatchEvent(new Event('input')); })"
                   "(document.querySelector('input[type=search]'))")
        self.assertEqual(len(page.value(texts_of(".tile"))), 2)
        page.value("(e => { e.value = 'warning'; e.dispatchEvent(new Event('change')); })"
                   "(document.querySelector('.tools select'))")
        self.assertEqual(page.value(texts_of(".tile h3")), ["acc-2"])

    def test_bench_shows_sources_signal_spectrum_and_fit(self):
        page = self.open("bench/acc-1")
        page.wait_for("document.querySelectorAll('.band li').length === 51")
        self.assertEqual(page.value("document.querySelectorAll('.band [data-state=done]').length"),
                         24)
        self.assertEqual(page.value(text_of('[data-source="dau"] [data-field="received"]')),
                         "1\u202f234\u202f567")
        self.assertRegex(page.value(text_of("[data-field=now]")), "steady, 7 s left$")
        self.assertEqual(page.value("document.querySelectorAll('.is-stale').length"), 0)
        # Beyond 2^53, where a number of JavaScript has lost its last digit.
        self.assertEqual(page.value(text_of('[data-source="acs"] [data-field="received"]')),
                         "9\u202f007\u202f199\u202f254\u202f740\u202f993")
        self.assertEqual(page.value(text_of('[data-source="dau"] [data-field="lost_in_transit"]')),
                         "▲ 12")
        level, _ = page.wait_for("(t => t?.includes('peak') ? t : null)"
                                 f"({text_of('[data-field=level]')})")
        self.assertIn("✓ in range: peak 9.3 m/s² (23.7 % of the range)", level)
        spectrum, _ = page.wait_for(text_of("[data-field=spectrum]"))
        self.assertIn("Fundamental 16.0003 Hz", spectrum)
        self.assertIn("THD 0.35 %", spectrum)
        fit, _ = page.wait_for(text_of("[data-field=fit_reference]"))
        self.assertIn("16.0003 Hz (taken as known)", fit)
        page.wait_for(f"{drawn_pixels(0)} > 500 && {drawn_pixels(1)} > 500")
        self.assertIn("value in m/s²", page.value(texts_of(".y-label")))

    def test_freezing_keeps_the_signal(self):
        page = self.open("bench/acc-1")
        page.wait_for("document.querySelector('[data-field=signal]').textContent !== ''")
        page.value("[...document.querySelectorAll('button')].find(b => b.textContent === 'Freeze')"
                   ".click()")
        before = page.value(text_of("[data-field=level]"))
        self.laboratory.signal_changes = {"level_peak": 39.1}
        page.value("new Promise(done => setTimeout(done, 700))")
        self.assertEqual(page.value(text_of("[data-field=level]")), before)
        page.wait_for(r"/frozen (\d{1,3} ms|\d{1,2}(\.\d)? s) ago/.test("
                      "document.querySelector('[aria-pressed=true]').textContent)")
        page.value("document.querySelector('[aria-pressed=true]').click()")
        page.wait_for(f"{text_of('[data-field=level]')}.includes('overload')")

    def test_another_channel_is_asked_for(self):
        page = self.open("bench/acc-1")
        page.wait_for(f"{text_of('[data-field=level]')}.includes('9.3 m/s²')")
        page.value("(e => { e.value = 'dau/sync'; e.dispatchEvent(new Event('change')); })"
                   "([...document.querySelectorAll('select')].find(s => s.value === "
                   "'dau/x_acceleration'))")
        page.wait_for(f"{text_of('[data-field=level]')}.includes('0.6 m/s²')")
        self.assertTrue(any("signal=dau%2Fsync" in path for path in self.server.asked))

    def test_run_shows_every_number_with_its_digits(self):
        page = self.open("run/acc-2")
        page.wait_for("document.querySelectorAll('[data-step]').length === 51")
        rows = page.value("[...document.querySelectorAll('[data-step]')].map(r => "
                          "[...r.cells].map(c => [c.textContent, c.title]))")
        points = {p["step"]: p for p in self.laboratory.points["acc-2"]}
        for row in rows:
            point = points[int(row[8][0])]
            shown = {**point, "phase_deg": math.degrees(point["phase_rad"]),
                     "u_phase_deg": math.degrees(point["u_phase_rad"])}
            for column, key in ((1, "magnitude"), (2, "u_magnitude"), (3, "phase_deg"),
                                (4, "u_phase_deg"), (5, "phase_rad"), (6, "u_phase_rad")):
                text, title = row[column]
                self.assertAlmostEqual(float(title.split()[0]), shown[key], 12)
                self.assertLessEqual(abs(float(text) - shown[key]), digit(text), (key, text))
            self.assertEqual(float(row[7][0]), round(point["measured_level_m_s2"], 3))
            self.assertEqual(row[7][1], f"measured {point['measured_level_m_s2']} m/s², "
                                        f"planned {point['level_m_s2']:g} m/s²")
        means = page.value("[...document.querySelectorAll('[data-frequency]')].map(r => "
                           "[...r.cells].map(c => c.title))")
        expected = played_state.transfer(self.laboratory.points["acc-2"])
        self.assertEqual(len(means), len(expected))
        for row, mean in zip(means, expected):
            self.assertEqual([float(row[i].split()[0]) for i in (1, 2, 5, 6)],
                             [mean[k] for k in ("magnitude", "U_magnitude", "phase_rad",
                                                "U_phase_rad")])
        self.assertEqual(page.value(text_of("[data-field=advice]")), "Repeat more often.")
        self.assertEqual(page.value(text_of("[data-field=group_delay]")),
                         "Group delay 1.7003 ms (U 0.0024 ms, k 2.00)")
        self.assertIn("check its network", page.value(text_of("[data-panel=flags]")))
        self.assertEqual(page.value(texts_of("[data-panel=files] li a")),
                         ["result.json", "transfer_function.svg"])
        self.assertIn("612\u202f345 intervals", page.value(text_of("[data-field=clock_report]")))
        page.wait_for("document.querySelectorAll('.canvas').length === 8")  # fetched by themselves
        for i in range(8):
            page.wait_for(f"{drawn_pixels(i)} > 200")

    def test_run_shows_the_ellipse_of_its_interferometer(self):
        panel = "document.querySelector('[data-panel=interferometer]')"
        self.laboratory.interferometers.add("acc-2")
        page = self.open("run/acc-1")
        page.wait_for("document.querySelectorAll('.canvas').length > 2")
        self.assertTrue(page.value(f"{panel}.hidden"))
        page = self.open("run/acc-2")
        page.wait_for("document.querySelectorAll('.canvas').length === 10")
        self.assertFalse(page.value(f"{panel}.hidden"))
        self.assertIn("Interferometer of acs/displacement",
                      page.value(text_of("[data-panel=interferometer] h3")))
        for text in ("as recorded", "corrected", "order 4: 0.27 nm", "u of the ellipse"):
            self.assertIn(text, page.value(text_of("[data-panel=interferometer]")))
        page.wait_for(f"{panel}.querySelectorAll('.canvas').length === 2")
        first = page.value(f"[...document.querySelectorAll('.canvas')].indexOf("
                           f"{panel}.querySelector('.canvas'))")
        for chart in (first, first + 1):
            page.wait_for(f"{drawn_pixels(chart)} > 500")
        # The curve closes: as many pixels to the left of the middle of the circle as to the right.
        columns = page.value(
            f"(c => {{ const w = c.width, h = c.height, n = [0, 0]; const d = "
            "c.getContext('2d').getImageData(0, 0, w, h).data; for (let i = 3, p = 0; "
            "i < d.length; i += 4, ++p) n[p % w < w / 2 ? 0 : 1] += d[i] > 0; return n; })"
            f"(document.querySelectorAll('.canvas')[{first}].querySelector('canvas'))")
        self.assertGreater(min(columns) / max(columns), 0.5)

    def test_run_shows_its_closures_the_open_ones_first(self):
        page = self.open("run/acc-2")
        page.wait_for("document.querySelectorAll('[data-closure]').length === 3")
        self.assertEqual(page.value(text_of("[data-field=closures]")), "▲ 1 open, 1 close.")
        self.assertEqual(page.value("[...document.querySelectorAll('[data-closure]')].map(r => "
                                    "[...r.cells].map(c => c.textContent))"),
                         [["phase towards 0 Hz", "–", "▲ open", "0.0512 rad", "0.0041 rad",
                           "0.0184 rad", played_state.CLOSURES[2]["sentence"]],
                          ["rate of the sensor's clock", "dau", "✓ closes", "3.12e-06", "2.1e-07",
                           "0.0002", played_state.CLOSURES[0]["sentence"]],
                          ["first point repeated at the end", "–", "– not possible", "–", "–", "–",
                           played_state.CLOSURES[1]["sentence"]]])
        self.assertEqual(page.value("document.querySelectorAll('[data-verdict=open] .flagged')"
                                    ".length"), 1)
        page = self.open("run/acc-1")  # which lasts
        page.wait_for("document.querySelectorAll('[data-step]').length === 24")
        self.assertIn("when it is over", page.value(text_of("[data-field=closures]")))
        self.assertEqual(page.value("document.querySelectorAll('[data-closure]').length"), 0)

    def test_run_shows_who_conducted_it_and_what_was_noted(self):
        page = self.open("run/acc-2")
        page.wait_for("document.querySelectorAll('[data-entry]').length === 3")
        self.assertEqual(page.value(text_of("[data-field=conducted_by]")),
                         "Conducted by A. Meter (meter on lab-2)")
        self.assertEqual(page.value(text_of("[data-field=comment]")), "Comment: after the move")
        rows = page.value("[...document.querySelectorAll('[data-entry]')].map(r => "
                          "[...r.cells].map(c => c.textContent))")
        self.assertRegex(rows[0][0], r"^\d{4}-\d\d-\d\d \d\d:\d\d:\d\d$")
        self.assertEqual([row[1:] for row in rows], [
            ["A. Meter", "● event", "the run has paused for 31 s"],
            ["B. Other", "✎ note", "the door was open"],
            ["A. Meter", "▲ amendment",
             "serial number of dau corrected to 2 on 2026-11-22 by A. Meter: misread"]])
        # A note comes without a new result.
        self.laboratory.journals["acc-2"]["entries"].append(
            {"utc_ms": played_state.BEGIN_UTC_MS, "kind": "note", "by": "C", "text": "late"})
        page.wait_for("document.querySelectorAll('[data-entry]').length === 4")
        page = self.open("run/acc-1")  # of which nothing is known
        page.wait_for("document.querySelectorAll('[data-step]').length === 24")
        page.wait_for("document.querySelector('[data-panel=journal]').hidden")

    def test_run_shows_what_was_decided_of_tolerances(self):
        def value(frequency, statement, reason=""):
            return {"channel": "dau/x", "frequency_text_hz": frequency, "level_m_s2": 10,
                    "unit": "%", "deviation": 1.234, "U_deviation": 0.21, "lower_limit": -5,
                    "upper_limit": 5, "statement": statement, "reason": reason,
                    "text": {"deviation": "1.23", "U_deviation": "0.21",
                             "probability": "97.7 %"}}

        self.laboratory.files["conformity.json"] = json.dumps({
            "verdict": "data sheet: undecided", "statement": "undecided", "rule_text": "Guard band",
            "notes": ["limit 2: nothing"],
            "values": [value("10", "pass"), value("20", "undecided", "flag over_range")]})
        page = self.open("run/acc-2")
        page.wait_for("document.querySelectorAll('[data-statement]').length === 2")
        self.assertEqual(page.value(text_of("[data-field=conformity]")), "▲ data sheet: undecided")
        self.assertEqual(page.value("[...document.querySelectorAll('[data-statement]')].map(r => "
                                    "[...r.cells].map(c => c.textContent))"),
                         [["dau/x", "20", "10", "-5 % to 5 %", "1.23 %", "0.21 %", "97.7 %",
                           "▲ undecided: flag over_range"],
                          ["dau/x", "10", "10", "-5 % to 5 %", "1.23 %", "0.21 %", "97.7 %",
                           "✓ pass"]])
        self.laboratory.files.pop("conformity.json")
        self.laboratory.changed()
        page.wait_for("document.querySelector('[data-panel=conformity]').hidden")

    def test_levels_at_a_frequency_are_rows_of_their_own(self):
        points = self.laboratory.points["acc-2"]
        for point in points:
            point["excited_axis"] = "z"
        for number, level in enumerate((2.0, 15.0), len(points) + 1):
            points.append({**points[9], "step": number, "level_m_s2": level,
                           "measured_level_m_s2": None})
        page = self.open("run/acc-2")
        page.wait_for("document.querySelectorAll('[data-step]').length === 53")
        rows = page.value("[...document.querySelectorAll('[data-step]')].slice(-2).map(r => "
                          "[...r.cells].map(c => c.textContent))")
        self.assertEqual([[row[0], *row[7:10]] for row in rows],
                         [["80", "(2)", "52", "1"], ["80", "(15)", "53", "1"]])
        self.assertIn(", excited axis z", page.value(text_of("[data-field=unit]")))

    def test_figures_are_drawn_as_they_are_described(self):
        page = self.open("run/acc-2")
        for bars in ("U", "u", "none"):
            choose(page, bars)
            described = self.laboratory.figures("acc-2", "run-1", played_state.CHANNEL,
                                                bars)["pictures"]
            panels = [panel for picture in described for panel in picture["panels"]]
            page.wait_for(f"{texts_of('.legend')}[0]?.includes("
                          f"{panels[0]['series'][0]['label'] + ' #1'!r})")
            self.assertEqual(page.value(texts_of(".picture h3")), [p["title"] for p in described])
            self.assertEqual(page.value(texts_of(".picture .y-label")),
                             [panel["y_label"] for panel in panels])
            self.assertEqual(page.value(texts_of(".picture .x-label")),
                             [panel["x_label"] for panel in panels])
            compared = 0
            for chart, panel in enumerate(panels):
                compared += self.compare_series(page, chart, panel)
            self.assertGreater(compared, 500)

    def compare_series(self, page, chart, panel):
        """Every number of the panel's series is in the rows that the chart draws."""
        rows = page.value(rows_of_chart(chart))
        drawn = {(column, row[0], *cell) for row in rows for column, cell in enumerate(row[1:])
                 if cell[0] is not None}
        first = sum(bool(panel[kind]) for kind in ("band", "bars", "dots"))
        points = [(first + column, x, y - half, y, y + half)
                  for column, one in enumerate(panel["series"]) for x, y, half, _ in one["points"]]
        self.assertLessEqual(set(points), drawn, panel["y_label"])
        others = sum(len(panel[kind]) for kind in ("band", "bars", "dots"))
        self.assertEqual(len(drawn), len(set(points)) + others)
        return len(drawn)

    def test_figures_belong_to_the_table_or_are_not_there(self):
        page = self.open("run/acc-1")
        number = "document.querySelector('[data-panel=figures]').dataset.number"
        page.wait_for(f"{number} && {number} === document.querySelector('.view').dataset.number")
        self.laboratory.figures_wait = threading.Event()
        self.laboratory.measure("acc-1", 25)
        self.laboratory.changed()
        page.wait_for("document.querySelectorAll('[data-step]').length === 25", 3)
        page.value("window.figures = document.querySelector('[data-panel=figures]')")
        page.value("location.hash = '#/run/acc-2'")
        page.wait_for("document.querySelectorAll('[data-step]').length === 51")
        self.assertEqual(page.value("document.querySelectorAll('.canvas').length"), 0)
        # Results are there: a figure that is late is no lack of them.
        self.assertIn("on their way", page.value(text_of("[data-panel=figures]")))
        self.laboratory.figures_wait.set()
        page.wait_for(f"{drawn_pixels(0)} > 200")
        self.assertEqual(page.value("figures.querySelectorAll('.canvas').length"), 0)
        self.assertIn("bench acc-2", page.value(text_of(".picture .quiet")))

    def test_figures_that_cannot_be_had_leave_the_table(self):
        self.allowed_problems = ["404"]
        page = self.open("run/acc-1")
        page.wait_for("document.querySelectorAll('.picture').length === 2")
        self.laboratory.figures = lambda *_, **__: {}["figures"]
        self.laboratory.measure("acc-1", 25)
        self.laboratory.changed()
        page.wait_for(f"{text_of('[data-panel=figures]')}.includes('No figures: there is no')")
        self.assertEqual(page.value("document.querySelectorAll('.picture').length"), 0)
        self.assertEqual(page.value("document.querySelectorAll('[data-step]').length"), 25)
        del self.laboratory.figures
        page.wait_for("document.querySelectorAll('.picture').length === 2")

    def test_run_grows_point_by_point_and_shows_what_failed(self):
        self.laboratory.measure("acc-1", 24, played_state.invalid_point(24))
        page = self.open("run/acc-1")
        page.wait_for("document.querySelectorAll('[data-step]').length === 24")
        self.assertIn("no samples of dau/x_acceleration",
                      page.value(text_of("[data-panel=flags] .problems")))
        self.laboratory.measure("acc-1", 25)
        self.laboratory.changed()
        page.wait_for("document.querySelectorAll('[data-step]').length === 25", 3)
        again = {**played_state.point(24), "attempt": 2}
        self.laboratory.measure("acc-1", 24, again)
        self.laboratory.changed()
        page.wait_for("[...document.querySelectorAll('[data-step=\"24\"]')].map(r => "
                      "r.dataset.valid).join() === 'true'", 3)
        self.assertIn("24 (attempt 2)", page.value(texts_of("[data-step] td")))

    def test_budget_of_a_clicked_point(self):
        page = self.open("run/acc-2")
        page.wait_for(f"{drawn_pixels(0)} > 500")
        page.wait_for("document.querySelectorAll('[data-step]').length === 51")
        place = page.value(
            "(() => { const c = document.querySelector('.canvas'); const b = "
            "c.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()")
        points = self.laboratory.points["acc-2"]
        highest = max(points, key=lambda p: p["frequency_hz"])
        self.assertEqual(highest["frequency_hz"], 400)
        for y in range(4, 40, 6):  # 400 Hz is the highest point, close to the right edge
            page.click(place[0] + place[2] * 0.96, place[1] + y)
        page.wait_for("document.querySelector('[data-field=budget_of]').textContent")
        self.assertRegex(page.value(text_of("[data-field=budget_of]")), "400 Hz")
        rows = page.value(texts_of("[data-panel=budget] tbody th"))
        self.assertEqual(rows[0], "reference")
        self.assertEqual(len(rows), 5)
        page.value("document.querySelector('[data-step=\"9\"] button').click()")
        page.wait_for("document.querySelector('[data-field=budget_of]').textContent"
                      ".includes('step 9, repetition 1, 63 Hz')")

    def test_history_shows_runs_and_normalised_errors(self):
        page = self.open("history")
        page.wait_for("document.querySelectorAll('[data-panel=en] tbody tr').length === 34")
        self.assertIn("without what both have in common", page.value(text_of("[data-panel=en]")))
        history = played_state.history("0xbccb0100")
        titles = page.value("[...document.querySelectorAll('[data-panel=en] tbody tr')].map(r => "
                            "[r.cells[3].title, r.cells[4].title].map(Number))")
        expected = [[e["en_magnitude"], e["en_phase"]] for e in history["en"]]
        self.assertEqual(sorted(titles), sorted(expected))
        self.assertEqual(titles[0], max(expected, key=lambda e: max(map(abs, e))))
        page.value("document.querySelector('.runs input').click()")
        page.wait_for("document.querySelectorAll('[data-panel=en] tbody tr').length === 17")

    def test_history_lists_what_is_to_be_calibrated(self):
        page = self.open("history")
        page.wait_for("document.querySelectorAll('[data-panel=due] tbody tr').length === 3")
        page.wait_for(text_of("[data-field=due]") + " === '✕ 2 due, 0 more within 30 days.'")
        self.assertEqual(page.value(texts_of("[data-panel=due] tbody th")),
                         ["✕ never calibrated", "✕ 2025-06-30", "2999-01-07"])
        nothing = {**played_state.history("0xbccb0100"), "due": []}
        with unittest.mock.patch.object(played_state, "history", lambda sensor: nothing):
            page = self.open("history")
            page.wait_for("document.querySelectorAll('[data-panel=en] tbody tr').length === 34")
            self.assertTrue(page.value("document.querySelector('[data-panel=due]').hidden"))

    def test_history_tells_levels_apart_and_shows_open_closures(self):
        history = played_state.history("0xbccb0100")
        for run in history["runs"]:
            run["points"] = [{**p, "level_m_s2": level} for p in run["points"][:3]
                             for level in (2.0, 10.0)]
        history["en"] = [{**one, "level_m_s2": level, "excited_axis": "z"}
                         for one in history["en"][:3] for level in (2.0, 10.0)]
        history["runs"][2]["open_closures"] = ["dau/x_acceleration: phase towards 0 Hz: far off"]
        with unittest.mock.patch.object(played_state, "history", lambda sensor: history):
            page = self.open("history")
            page.wait_for("document.querySelectorAll('[data-panel=en] tbody tr').length === 6")
        places = page.value("[...document.querySelectorAll('[data-panel=en] tbody tr')].map(r => "
                            "r.cells[2].textContent)")
        self.assertEqual(set(places), {f"{f}, {level} m/s²" for f in ("10", "12.5", "16")
                                       for level in (2, 10)})
        self.assertEqual(page.value(texts_of(".runs .flagged")),
                         ["▲ open closure: dau/x_acceleration: phase towards 0 Hz: far off"])
        page.wait_for(f"{texts_of('.legend')}[0]?.includes('10 m/s²')")
        rows = page.value(rows_of_chart(0))
        self.assertEqual(len({row[0] for row in rows}), 3)
        self.assertEqual(len(rows[0]) - 1, 6)  # three runs at two levels

    def test_texts_of_the_daemon_are_shown_as_they_are(self):
        """The page rounds nothing that has an uncertainty: ties would go another way."""
        text = {"magnitude": {"value": "M", "u": "m"}, "phase_deg": {"value": "180.0", "u": "p"}}
        self.laboratory.benches["acc-1"]["last_result"].update(text=text)
        point = self.laboratory.points["acc-2"][0]
        point["text"] = {"magnitude": {"value": "-30", "u": "150"},
                         "phase_rad": {"value": "0.12", "u": None}}
        page = self.open()
        page.wait_for("document.querySelectorAll('.tile').length === 3")
        self.assertRegex(self.field(page, "acc-1", "last_result"), "Hz: M, 180.0°")
        page = self.open("run/acc-2")
        row = f"[data-step='{point['step']}']"
        page.wait_for(f"document.querySelector({json.dumps(row)}) !== null")
        cells = page.value(f"[...document.querySelector({json.dumps(row)}).cells]"
                           ".slice(1, 7).map(c => c.textContent)")
        self.assertEqual(cells, ["-30", "150", "–", "–", "0.12", "–"])


def digit(text):
    """Half of the last digit of a decimal text, and a little for its binary form."""
    mantissa, _, exponent = text.partition("e")
    places = len(mantissa.partition(".")[2])
    return (0.5 + 1e-6) * 10 ** (int(exponent or 0) - places)


if __name__ == "__main__":
    run()
