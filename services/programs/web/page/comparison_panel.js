/**
 * The run that is shown, live or over, against another one of its sensor: both laid over each other,
 * and how far each value is from the other run's at its frequency and level. Other runs are those
 * that the daemon has heard, and those of the store.
 */

import { bench_path, get } from "./api.js";
import { Choice, element, set_shown, set_text } from "./element.js";
import { is_number, utc_text } from "./number_text.js";
import { over_frequency, overlay_panel } from "./overlay.js";
import { series_colour } from "./palette.js";
import { PanelChart } from "./panel_chart.js";
import { points_of, transfer_of } from "./run_data.js";
import { quantity_in } from "./unit_text.js";

const NONE = "";
const DEGREES = 180 / Math.PI;
const TITLES = ["Magnitude", "Phase", "Difference of magnitude", "Difference of phase"];

export class ComparisonPanel {
  constructor() {
    this.asked = ""; // which list of runs
    this.stored = new Map(); // of the store, by name: points
    this.points = null; // of the other run
    this.choice = new Choice("Compare with", () => this.choose());
    this.message = element("p", { class: "quiet" });
    this.charts = []; // made when another run is chosen
    this.figures = element("div", { class: "pair" });
    this.root = element("section", { class: "panel", "data-panel": "comparison" },
                        element("div", { class: "panel-head" },
                                element("h2", {}, "Against another run"), this.choice.root),
                        this.message, this.figures);
    set_shown(this.root, false);
    set_shown(this.figures, false);
  }

  /** run: as the daemon has it; channel: the one that is shown. */
  update(bench, run, channel) {
    this.shown = { bench, run, channel };
    const list = `${bench} ${run.run} ${channel}`;
    if (list !== this.asked) {
      this.asked = list;
      this.stored = new Map();
      this.points = null;
      this.offer();
      this.ask_store();
    }
    this.draw();
  }

  offer() {
    const { run } = this.shown;
    const heard = (run.runs ?? []).filter((one) => one.run !== run.run && !this.stored.has(one.run))
      .map((one) => ({ value: one.run, utc_ms: one.planned_utc_ms }));
    const kept = [...this.stored].map(([value, { utc_ms }]) => ({ value, utc_ms }));
    const others = [...heard, ...kept].sort((a, b) => (b.utc_ms ?? 0) - (a.utc_ms ?? 0));
    set_shown(this.root, others.length > 0);
    this.choice.offer([{ value: NONE, text: "no other run" }, ...others.map(({ value, utc_ms }, i) => ({
      value, text: `${i === 0 ? "last: " : ""}${value} (${utc_text(utc_ms)})` }))]);
  }

  // Without a store there are the runs that the daemon has heard.
  async ask_store() {
    const { asked, shown: { bench, run, channel } } = this;
    try {
      const { sources = [] } = await get(bench_path(bench));
      const source = sources.find((one) => channel.startsWith(`${one.source}/`));
      const sensor = source?.serial || source?.device;
      const history = sensor ? await get("/api/history", { sensor }) : {};
      if (asked === this.asked) {
        this.stored = new Map((history.runs ?? [])
          .filter((one) => one.channel === channel && one.run !== run.run)
          .map((one) => [one.run, one]));
        this.offer();
        this.choose(); // another channel of the run that was chosen
      }
    } catch (problem) {
      set_text(this.message, `Runs of the store: ${problem.message}`);
    }
  }

  async choose() {
    const name = this.choice.value ?? NONE;
    const { bench, channel } = this.shown;
    this.points = null;
    set_text(this.message, "");
    if (name !== NONE) {
      try {
        const points = this.stored.get(name)?.points
          ?? values_of(await get(bench_path(bench, "/run"), { run: name }), channel).points;
        if (name === this.choice.value) {
          this.points = points;
        }
      } catch (problem) {
        set_text(this.message, `✕ ${name}: ${problem.message}`);
      }
    }
    this.draw();
  }

  draw() {
    set_shown(this.figures, this.points !== null);
    if (this.points === null) {
      return;
    }
    if (this.charts.length === 0) {
      this.charts = TITLES.map((title) => new PanelChart({ title }));
      this.figures.replaceChildren(...this.charts.map(({ root }) => root));
    }
    const { run, channel } = this.shown;
    const own = values_of(run, channel);
    const others = new Map(this.points.map((p) => [place_of(p), p]));
    const pairs = own.points.map((p) => ({ p, other: others.get(place_of(p)) }))
      .filter(({ p, other }) => other && is_number(p.magnitude) && is_number(other.magnitude));
    const runs = [{ name: this.choice.value, index: 1, points: this.points },
                  { name: run.run, index: 0, is_joined: own.is_mean,
                    points: near(own.points, others) }];
    const [magnitude, phase, ratio, angle] = this.charts;
    magnitude.show(overlay_panel(runs, "magnitude", quantity_in("magnitude", own.points[0]?.unit)));
    phase.show(overlay_panel(runs, "phase", "phase (lead) in rad"));
    ratio.show(differences(pairs, "difference in %, bars: U of this run", ({ p, other }) =>
      [100 * (p.magnitude / other.magnitude - 1), 100 * p.U_magnitude / p.magnitude]));
    angle.show(differences(pairs, "difference in degrees, bars: U of this run", ({ p, other }) =>
      [DEGREES * wrapped(p.phase_rad - other.phase_rad), DEGREES * p.U_phase_rad]));
    set_text(this.message, pairs.length === 0
      ? "Both have no frequency and level in common." : "");
  }

  leave() {
    this.charts.forEach((chart) => chart.destroy());
  }
}

// Means, or single results while there are none.
function values_of(run, channel) {
  const transfer = transfer_of(run, channel);
  return { is_mean: transfer !== null,
           points: transfer?.points ?? points_of(run, channel).filter(({ valid }) => valid) };
}

function place_of({ frequency_hz, level_m_s2 }) {
  return `${frequency_hz} ${level_m_s2}`;
}

function wrapped(phase_rad) {
  return phase_rad - 2 * Math.PI * Math.round(phase_rad / (2 * Math.PI));
}

// With phases in the turn of the other run.
function near(points, others) {
  return points.map((p) => {
    const other = others.get(place_of(p));
    const there = other?.unwrapped_phase_rad ?? other?.phase_rad;
    return is_number(there)
      ? { ...p, unwrapped_phase_rad: there + wrapped(p.phase_rad - there) } : p;
  });
}

function differences(pairs, y_label, difference_of) {
  const points = pairs.map((pair) => {
    const [difference, U] = difference_of(pair);
    return [pair.p.frequency_hz, difference, is_number(U) ? U : 0];
  });
  return over_frequency([{ label: "this run less the other", colour: series_colour(0),
                           marker: "circle", radius: 5, joined: false, line_width: 1, points }],
                        y_label);
}
