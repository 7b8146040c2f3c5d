/**
 * A bench as a tile of the laboratory: what it does, how far it is, what is worst, what came out
 * last. A bench that has been silent for 3 s is greyed and says for how long.
 */

import { element, name_element, set_attribute, set_name, set_shown, set_text } from "./element.js";
import {
  count_text, duration_text, full, is_number, rounded_text, short_time,
  with_unit,
} from "./number_text.js";
import { href_of } from "./route.js";
import { StateBadge } from "./state_badge.js";
import { unit_text } from "./unit_text.js";

export class BenchTile {
  constructor(bench, clock) {
    this.clock = clock;
    this.fields = new Map();
    this.state = new StateBadge("state");
    this.worst = new StateBadge("severity");
    this.worst_text = name_element("", 160);
    this.worst_text.dataset.field = "worst";
    this.age = element("p", { class: "age", "data-field": "age" });
    this.progress = element("progress", { max: 1, value: 0, "aria-label": "steps done" });
    this.message = element("p", { class: "message", "data-field": "message" });
    this.list = element("dl", { class: "facts" });
    this.run_link = element("a", { href: href_of("run", bench) }, "Run");
    this.title = element("h3", {}, element("a", { href: href_of("bench", bench) },
                                           name_element(bench, 48)));
    this.root = element(
      "article", { class: "tile", "data-bench": bench },
      element("div", { class: "tile-head" }, this.title, this.state.root),
      element("p", { class: "worst" }, this.worst.root, " ", this.worst_text),
      this.progress, this.list, this.message,
      element("p", { class: "tile-foot" }, this.age, this.run_link),
    );
  }

  update(bench) {
    this.bench = bench;
    this.state.update(bench.state);
    this.worst.update(bench.worst?.severity ?? "ok");
    set_name(this.worst_text, bench.worst?.what || "nothing to report", 160);
    this.show_progress(bench);
    set_name(this.message, bench.message, 160);
    set_shown(this.message, Boolean(bench.message));
    for (const [name, text, title] of facts_of(bench)) {
      this.show_fact(name, text, title);
    }
    this.tick();
  }

  show_progress({ step, step_count }) {
    const is_known = is_number(step) && is_number(step_count) && step_count > 0;
    set_shown(this.progress, is_known);
    if (is_known) {
      this.progress.value = Math.min(1, step / step_count);
    }
  }

  show_fact(name, text, title = null) {
    if (!this.fields.has(name)) {
      const value = element("dd", { "data-field": field_of(name) });
      this.fields.set(name, value);
      this.list.append(element("div", {}, element("dt", {}, name), value));
    }
    const value = this.fields.get(name);
    set_text(value, text);
    set_attribute(value, "title", title);
  }

  tick() {
    const is_stale = this.clock.is_stale(this.bench.last_message_utc_ms);
    this.root.classList.toggle("is-stale", is_stale);
    set_text(this.age, this.clock.age_text(this.bench.last_message_utc_ms));
  }
}

function field_of(name) {
  return name.toLowerCase().replace(/ /g, "_");
}

/** [name, text, title] of a bench; also the head of its own view. */
export function facts_of(bench) {
  return [
    ["Run", bench.run || "none"],
    ["Step", step_text(bench)],
    ["Excitation", excitation_text(bench)],
    ["Time left", duration_text(bench.time_left_s)],
    ["Last result", ...result_text(bench.last_result)],
    ["Results", results_text(bench)],
    ["Lost samples", count_text(bench.lost)],
    ["Clock", ...clock_text(bench)],
    ["Recording", recording_text(bench.recording)],
  ];
}

function step_text({ step, step_count, repetition }) {
  if (!is_number(step) || !is_number(step_count)) {
    return "none";
  }
  return `${step} of ${step_count}${is_number(repetition) ? `, repetition ${repetition}` : ""}`;
}

function excitation_text({ frequency_text_hz, level_m_s2, excitation }) {
  if (!frequency_text_hz) {
    return "none";
  }
  const state = excitation && excitation !== "null" ? `, ${excitation}` : "";
  return `${frequency_text_hz} Hz, ${with_unit(level_m_s2, "m/s²")}${state}`;
}

function result_text(result) {
  if (!result) {
    return ["none yet", null];
  }
  if (!result.valid) {
    return [`${result.frequency_text_hz} Hz: not valid`, result.channel];
  }
  const unit = unit_text(result.unit);
  const size = rounded_text(result.text?.magnitude);
  const phase = rounded_text(result.text?.phase_deg);
  const flags = result.flag_names?.length ? `, ${result.flag_names.length} flagged` : "";
  return [
    `${result.frequency_text_hz} Hz: ${size.value}${unit ? ` ${unit}` : ""}, ${phase.value}°${flags}`,
    `${result.channel}: magnitude ${full(result.magnitude, unit)}, u ${full(result.u_magnitude)}; ` +
      `phase ${full(result.phase_rad, "rad")}, u ${full(result.u_phase_rad, "rad")}`,
  ];
}

function results_text({ results, results_invalid, results_flagged }) {
  return `${count_text(results)}, ${count_text(results_invalid)} invalid, ` +
    `${count_text(results_flagged)} flagged`;
}

function clock_text({ clock_offset_s, clock_offset_bound_s }) {
  if (!is_number(clock_offset_s)) {
    return ["not compared", null];
  }
  return [`${short_time(clock_offset_s)} off, within ${short_time(clock_offset_bound_s, 2)}`,
          `${full(clock_offset_s, "s")}, within ${full(clock_offset_bound_s, "s")}: the host whose ` +
          "clock is farthest from the daemon's"];
}

function recording_text(recording) {
  if (!recording) {
    return "off";
  }
  const { state, messages_stored, messages_not_stored, message } = recording;
  const lost = messages_not_stored && messages_not_stored !== "0"
    ? `, ${count_text(messages_not_stored)} not stored` : "";
  return `${state ?? "on"}, ${count_text(messages_stored)} messages${lost}` +
    (message ? `: ${message}` : "");
}
