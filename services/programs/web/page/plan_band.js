/**
 * The steps of a run as one band, a cell a step with its state: one look tells what is done, what
 * was aborted and what is open. The step now is named beneath, with the time that it has left.
 */

import { element, set_attribute, set_name, set_shown, set_text } from "./element.js";
import { KeyedList } from "./keyed_list.js";
import { duration_text, is_number, with_unit } from "./number_text.js";
import { sign_of, tone_of, word_of } from "./state_badge.js";

const MAX_CELLS = 600;

export class PlanBand {
  constructor() {
    this.band = element("ol", { class: "band", tabindex: "0", "aria-label": "Steps of the run" });
    this.cells = new KeyedList(this.band, ({ step }) => step, () => new StepCell());
    this.summary = element("p", { class: "quiet" });
    this.now_text = element("p", { class: "now", "data-field": "now" });
    this.method = element("p", { class: "quiet" });
    this.root = element("section", { class: "panel" }, element("h2", {}, "Plan"), this.method,
                        this.band, this.summary, this.now_text);
    set_shown(this.root, false);
  }

  update(plan, now) {
    this.now = now;
    set_shown(this.root, Boolean(plan));
    if (!plan) {
      return;
    }
    this.steps = plan.steps ?? [];
    this.cells.update(this.steps.slice(0, MAX_CELLS));
    set_name(this.method, `${plan.method ?? ""}; reference ${plan.reference ?? "not known"}; ` +
      `device under test ${(plan.dut ?? []).join(", ") || "all channels of the sensor"}`, 200);
    set_text(this.summary, summary_of(this.steps));
    this.show_now();
  }

  show_now() {
    const { now, steps = [] } = this;
    const step = steps.find((one) => one.step === now?.step);
    set_shown(this.now_text, Boolean(step));
    if (!step) {
      return;
    }
    const left = now.time_left_s; // its times UTC are by the conductor's clock, not the server's
    set_text(this.now_text, `${sign_of(now.state)} step ${step.step}: ${step_text(step)}, ` +
      `${word_of(now.state)}${is_number(left) ? `, ${duration_text(left)} left` : ""}`);
  }
}

class StepCell {
  constructor() {
    this.root = element("li");
  }

  update(step) {
    set_attribute(this.root, "data-tone", tone_of(step.state));
    set_attribute(this.root, "data-state", step.state);
    set_attribute(this.root, "title", `step ${step.step}, ${step_text(step)}: ${word_of(step.state)}` +
      (step.attempt > 1 ? `, attempt ${step.attempt}` : ""));
    set_text(this.root, sign_of(step.state));
    set_attribute(this.root, "aria-label", this.root.title);
  }
}

function step_text({ frequency_text_hz, level_m_s2, repetition }) {
  return `${frequency_text_hz} Hz, ${with_unit(level_m_s2, "m/s²")}` +
    (is_number(repetition) ? `, repetition ${repetition}` : "");
}

function summary_of(steps) {
  const counts = new Map();
  for (const { state } of steps) {
    counts.set(state, (counts.get(state) ?? 0) + 1);
  }
  const parts = [...counts].map(([state, n]) => `${sign_of(state)} ${n} ${word_of(state)}`);
  const hidden = steps.length > MAX_CELLS ? `; the first ${MAX_CELLS} are shown` : "";
  return `${steps.length} steps: ${parts.join(", ")}${hidden}`;
}
