/**
 * The step now: reference and sync with the sine that was fitted to them and what it leaves, the
 * phase of the DAU's sync over the step, and whether the excitation is steady.
 */

import { element, name_element, set_name, set_shown, set_text } from "./element.js";
import { count_text, full, rounded_text, significant, with_unit } from "./number_text.js";
import { StateBadge } from "./state_badge.js";
import { TraceChart } from "./trace_chart.js";
import { quantity_in, unit_text } from "./unit_text.js";

export class StepPanel {
  constructor() {
    this.state = new StateBadge("step_state");
    this.what = element("p", { class: "quiet", "data-field": "step_now" });
    this.problem = element("p", { class: "quiet" });
    this.reference = new FitBlock("Reference");
    this.sync = new FitBlock("Sync");
    this.dau = new FitBlock("DAU");
    this.phase = new TraceChart({ title: "Phase of the DAU's sync", x_label: "time in s",
                                  height: 160 });
    this.root = element(
      "section", { class: "panel" },
      element("div", { class: "panel-head" }, element("h2", {}, "The step now"), this.state.root),
      this.what, this.problem,
      element("div", { class: "pair" }, this.reference.root, this.sync.root, this.dau.root),
      this.phase.root,
    );
    this.show_problem("no step has been evaluated yet");
  }

  show_now({ now, frequency_text_hz, level_m_s2 }) {
    set_shown(this.state.root, Boolean(now?.state));
    if (!now?.state) {
      set_text(this.what, "No step is excited.");
      return;
    }
    this.state.update(now.state);
    set_text(this.what, `Step ${now.step}: ${frequency_text_hz ?? "?"} Hz, ` +
      `${with_unit(level_m_s2, "m/s²")}.`);
  }

  show_fit(fit) {
    const { reference, sync, dau_phase } = fit;
    const is_fit = Boolean(dau_phase?.fit || dau_phase?.problem);
    const has_numbers = [reference, sync, dau_phase].some((role) => role?.fit || role?.columns);
    const step = `${fit.step}, ${fit.frequency_text_hz ?? "?"} Hz` +
      `${fit.attempt > 1 ? `, attempt ${fit.attempt}` : ""}`;
    const text = has_numbers ? `Fits of step ${step}.` : `Step ${step}: settling.`;
    set_text(this.problem, fit.step ? text : "");
    this.reference.show(reference);
    this.sync.show(sync);
    this.dau.show(is_fit ? dau_phase : null);
    const course = is_fit ? [] : (dau_phase?.columns ?? []);
    set_shown(this.phase.root, course.length > 0);
    this.phase.show([{ text: "phase", points: course }],
                    quantity_in("phase (lead)", dau_phase?.unit ?? "rad"));
  }

  show_problem(text) {
    set_text(this.problem, `Nothing fitted: ${text}.`);
    this.reference.show(null);
    this.sync.show(null);
    this.dau.show(null);
    set_shown(this.phase.root, false);
  }

  leave() {
    this.reference.leave();
    this.sync.leave();
    this.dau.leave();
    this.phase.destroy();
  }
}

class FitBlock {
  constructor(title) {
    this.channel = name_element("");
    this.text = element("p", { class: "quiet", "data-field": `fit_${title.toLowerCase()}` });
    this.trace = new TraceChart({ title: `${title}: samples and fitted sine`, x_label: "time in s",
                                  height: 180 });
    this.residual = new TraceChart({ title: `${title}: residuals of the fit`, x_label: "time in s",
                                     height: 150 });
    this.figures = element("div", {}, this.trace.root, this.residual.root);
    this.root = element("div", {}, element("h3", {}, title, " ", this.channel), this.text,
                        this.figures);
  }

  show(shown) {
    const why = shown?.problem ?? "";
    set_shown(this.root, Boolean(shown?.fit || why));
    set_shown(this.figures, Boolean(shown?.fit));
    if (!shown?.fit) {
      set_name(this.channel, shown?.channel ?? "", 48);
      set_text(this.text, why);
      this.trace.show([], "");
      this.residual.show([], "");
      return;
    }
    const { channel, unit, fit } = shown;
    set_name(this.channel, channel, 48);
    this.show_numbers(fit, unit_text(unit));
    this.trace.show([{ text: "samples", points: shown.columns ?? [] },
                     { text: "fitted sine", colour: null, points: shown.model ?? [] }],
                    quantity_in("value", unit));
    this.residual.show([{ text: "residual", points: shown.residual_columns ?? [] }],
                       quantity_in("residual", unit));
  }

  show_numbers(fit, unit) {
    const { amplitude } = fit;
    const size = rounded_text(fit.text?.amplitude);
    set_text(this.text, `Frequency ${with_unit(fit.frequency_hz, "Hz", 6)} (taken as known), amplitude ` +
      `${size.value}${unit ? ` ${unit}` : ""} (u ${size.u}), phase ` +
      `${with_unit(Math.atan2(fit.cosine, fit.sine), "rad", 5)}, residual ` +
      `${with_unit(fit.residual_rms, unit, 3)} rms (` +
      `${significant(100 * fit.residual_rms / amplitude, 2)} % of the amplitude), ` +
      `${count_text(fit.sample_count)} samples`);
    this.text.title = `frequency ${full(fit.frequency_hz, "Hz")}, amplitude ` +
      `${full(amplitude, unit)}, residual ${full(fit.residual_rms, unit)}`;
  }

  leave() {
    this.trace.destroy();
    this.residual.destroy();
  }
}
