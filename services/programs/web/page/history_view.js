/**
 * Earlier runs of a sensor laid over each other, with the normalised error E_n of each against the
 * one before: |E_n| up to 1 agrees within the uncertainties. And what is to be calibrated.
 */

import { get } from "./api.js";
import { copy_tools } from "./copy_tools.js";
import { DuePanel } from "./due_panel.js";
import { Choice, element, name_element, set_shown, set_text, table_in_scroll } from "./element.js";
import { full, is_number, significant, utc_text } from "./number_text.js";
import { overlay_panel } from "./overlay.js";
import { PanelChart } from "./panel_chart.js";
import { href_of } from "./route.js";
import { quantity_in } from "./unit_text.js";

const MAX_OVERLAID = 12;
const EN_HEADINGS = ["Run", "Against", { text: "f / Hz", number: true },
                     { text: "E_n of |H|", number: true }, { text: "E_n of arg H", number: true },
                     "Agreement"];
const MAX_ROWS = 1000;
const RETRY_MS = 5000;

export class HistoryView {
  constructor(page, route) {
    this.page = page;
    this.sensor = route.sensor;
    this.history = null;
    this.hidden = new Set();
    this.sensors = new Choice("Sensor", (sensor) => {
      window.location.hash = href_of("history", sensor);
    });
    this.channel = new Choice("Channel", () => this.show());
    this.message = element("p", { class: "message", role: "status", "data-field": "message" });
    this.runs = element("ul", { class: "runs" });
    this.magnitude = new PanelChart({ title: "Magnitude of earlier runs" });
    this.phase = new PanelChart({ title: "Phase of earlier runs" });
    this.due = new DuePanel();
    this.worst = element("p", { "data-field": "en_worst" });
    const { root, body } = table_in_scroll("Normalised errors", EN_HEADINGS);
    this.en_table = root;
    this.en_body = body;
    this.root = element(
      "div", { class: "view", "data-view": "history" },
      element("div", { class: "view-head" }, element("h1", {}, "History")),
      element("div", { class: "tools no-print" }, this.sensors.root, this.channel.root),
      this.message,
      element("section", { class: "panel", "aria-label": "Runs" }, element("h2", {}, "Runs"),
              this.runs),
      element("section", { class: "panel", "aria-label": "Figures" },
              element("h2", {}, "Laid over each other"),
              element("div", { class: "pair" }, this.magnitude.root, this.phase.root)),
      element("section", { class: "panel", "data-panel": "en" },
              element("h2", {}, "Normalised error E_n"),
              element("p", { class: "quiet" },
                      "E_n is the difference of two runs over its expanded uncertainty: both U " +
                      "without what both have in common, as the calibration of the reference; they " +
                      "agree where |E_n| is at most 1."),
              this.worst, copy_tools(root), root),
      this.due.root,
    );
    this.ask();
  }

  wants() {
    return {};
  }

  // Earlier runs do not change; what is new is seen when the view is opened again. What could not be
  // read is asked for again once the daemon is heard.
  receive() {
    if (this.has_failed) {
      this.has_failed = false;
      this.retry = setTimeout(() => this.ask(), RETRY_MS);
    }
  }

  async ask() {
    set_text(this.message, "Reading earlier runs …");
    try {
      this.history = await get("/api/history", this.sensor === null ? {} : { sensor: this.sensor });
    } catch (problem) {
      this.has_failed = true;
      set_text(this.message, `✕ No history: ${problem.message}`);
      return;
    }
    this.due.show(this.history.due ?? []);
    const sensors = this.history.sensors ?? [];
    this.sensors.offer(sensors.map((value) => ({ value, text: value })), this.sensor);
    if (this.sensor === null && sensors.length > 0) {
      window.location.replace(href_of("history", sensors[0]));
      return;
    }
    set_text(this.message, sensors.length === 0 ? "There are no earlier runs yet." : "");
    this.channel.offer([...new Set((this.history.runs ?? []).map(({ channel }) => channel))]
      .map((value) => ({ value, text: value })));
    this.show();
  }

  // Of the chosen channel, the newest first.
  chosen() {
    return (this.history?.runs ?? []).filter(({ channel }) => channel === this.channel.value)
      .sort((a, b) => (b.utc_ms ?? 0) - (a.utc_ms ?? 0)).slice(0, MAX_OVERLAID);
  }

  show() {
    const runs = this.chosen();
    this.show_runs(runs);
    const shown = runs.map((run, index) => ({ run, index }))
      .filter(({ run }) => !this.hidden.has(run.run));
    const named = shown.map(({ run, index }) => ({
      name: `${run.run}, ${utc_text(run.utc_ms).slice(0, 10)}`, index, points: run.points ?? [] }));
    this.magnitude.show(overlay_panel(named, "magnitude",
                                      quantity_in("magnitude", runs[0]?.points?.[0]?.unit)));
    this.phase.show(overlay_panel(named, "phase", "phase (lead) in rad"));
    this.show_en(new Set(shown.map(({ run }) => run.run)));
  }

  show_runs(runs) {
    this.runs.replaceChildren(...runs.map((run) => {
      const box = element("input", { type: "checkbox", onchange: () => {
        this.hidden[box.checked ? "delete" : "add"](run.run);
        this.show();
      } });
      box.checked = !this.hidden.has(run.run);
      return element("li", {}, element("label", {}, box, " ", name_element(run.run, 48)), " ",
                     element("span", { class: "quiet" }, `${utc_text(run.utc_ms)}, `,
                             name_element(run.bench, 32), `, ${run.points?.length ?? 0} values`),
                     " ", element("a", { href: href_of("run", run.bench, run.run) }, "open"),
                     (run.open_closures ?? []).map((sentence) =>
                       element("p", { class: "flagged" }, "▲ open closure: ",
                               name_element(sentence, 300))));
    }));
  }

  show_en(names) {
    const errors = (this.history.en ?? []).filter(({ of, against, channel }) =>
      names.has(of) && names.has(against) && (!channel || channel === this.channel.value));
    errors.sort((a, b) => size_of(b) - size_of(a));
    set_shown(this.en_table, errors.length > 0);
    const apart = errors.filter((one) => !agrees(one)).length;
    const place_of = place_texts(errors);
    set_text(this.worst, errors.length === 0 ? "There are not two runs to compare."
      : apart === 0 ? `✓ All ${errors.length} comparisons agree; the largest come first.`
                    : `▲ ${apart} of ${errors.length} comparisons do not agree; they come first.`);
    this.en_body.replaceChildren(...errors.slice(0, MAX_ROWS).map((one) =>
      element("tr", {}, element("th", { scope: "row" }, name_element(one.of, 40)),
              element("td", {}, name_element(one.against, 40)),
              element("td", { class: "number" }, place_of(one)),
              element("td", { class: "number", title: full(one.en_magnitude) },
                      significant(one.en_magnitude, 2)),
              element("td", { class: "number", title: full(one.en_phase) },
                      significant(one.en_phase, 2)),
              element("td", { class: agrees(one) ? "" : "flagged" },
                      agrees(one) ? "✓ agrees" : "▲ does not agree"))));
  }

  tick() {}

  leave() {
    clearTimeout(this.retry);
    this.magnitude.destroy();
    this.phase.destroy();
  }
}

// Frequency, with level and axis where they tell errors apart.
function place_texts(errors) {
  const has_several = (key) => new Set(errors.map((one) => one[key])).size > 1;
  const [levels, axes] = [has_several("level_m_s2"), has_several("excited_axis")];
  return (one) => `${one.frequency_text_hz}${levels ? `, ${significant(one.level_m_s2)} m/s²` : ""}` +
    `${axes && one.excited_axis ? `, axis ${one.excited_axis}` : ""}`;
}

// The larger of both, which decides.
function size_of({ en_magnitude, en_phase }) {
  return Math.max(...[en_magnitude, en_phase].map((en) => (is_number(en) ? Math.abs(en) : 0)));
}

function agrees(error) {
  return size_of(error) <= 1;
}
