/**
 * The uncertainty budget of a chosen point: contributions, the largest first, each as a number and
 * as the length of a bar.
 */

import { bench_path, get } from "./api.js";
import { element, name_element, set_shown, set_text, table_in_scroll } from "./element.js";
import { full, is_number, rounded_text, significant, UNKNOWN } from "./number_text.js";
import { unit_text } from "./unit_text.js";

const HEADINGS = ["Contribution", "Of", { text: "u(|H|) / |H|", number: true }, "",
                  { text: "u(arg H) / mrad", number: true }, "", "Distribution", "Repeats",
                  { text: "degrees of freedom", number: true }];

export class BudgetPanel {
  constructor() {
    this.hint = element("p", { class: "quiet" },
                        "Choose a point of a figure, or “Budget” in the table.");
    this.what = element("p", { "data-field": "budget_of", "aria-live": "polite" });
    const { root, body } = table_in_scroll("Uncertainty budget", HEADINGS);
    this.body = body;
    this.table = root;
    this.root = element("section", { class: "panel", "data-panel": "budget" },
                        element("h2", { tabindex: "-1" }, "Uncertainty budget"), this.hint,
                        this.what, root);
    set_shown(root, false);
  }

  /** point: as the run's answer has it. */
  async ask(bench, run, point) {
    const { channel, step, repetition } = point;
    this.asked = `${run} ${channel} ${step} ${repetition}`;
    const asked = this.asked;
    try {
      const answer = await get(bench_path(bench, "/budget"), { run, channel, step, repetition });
      if (asked === this.asked) {
        this.show({ ...point, contributions: answer.contributions });
      }
    } catch (problem) {
      set_text(this.what, `✕ No budget of step ${step}: ${problem.message}`);
      set_shown(this.table, false);
    }
  }

  show({ channel, step, repetition, frequency_text_hz, magnitude, text, unit, contributions }) {
    const size = rounded_text(text?.magnitude);
    const phase = rounded_text(text?.phase_rad);
    const short = unit_text(unit);
    const values = is_number(magnitude)
      ? `: ${size.value}${short ? ` ${short}` : ""}, u ${size.u}; ${phase.value} rad, u ${phase.u} rad`
      : "";
    set_text(this.what, `${channel}, step ${step}, repetition ${repetition}` +
      `${frequency_text_hz ? `, ${frequency_text_hz} Hz` : ""}${values}`);
    set_shown(this.hint, false);
    set_shown(this.table, true);
    this.body.replaceChildren(...rows_of(contributions ?? []));
  }
}

function rows_of(contributions) {
  const largest = (key) => Math.max(...contributions.map((c) => c[key] ?? 0), 1e-300);
  const [all_magnitude, all_phase] = [largest("u_magnitude_rel"), largest("u_phase_rad")];
  const weight = (c) => Math.max((c.u_magnitude_rel ?? 0) / all_magnitude,
                                 (c.u_phase_rad ?? 0) / all_phase);
  return [...contributions].sort((a, b) => weight(b) - weight(a)).map((c) =>
    element("tr", {},
            element("th", { scope: "row" }, name_element(c.name ?? "", 60)),
            element("td", {}, name_element(c.subject ?? "", 40)),
            element("td", { class: "number", title: full(c.u_magnitude_rel) },
                    significant(c.u_magnitude_rel, 2)),
            bar_cell((c.u_magnitude_rel ?? 0) / all_magnitude),
            element("td", { class: "number", title: full(c.u_phase_rad, "rad") },
                    is_number(c.u_phase_rad) ? significant(1e3 * c.u_phase_rad, 2) : UNKNOWN),
            bar_cell((c.u_phase_rad ?? 0) / all_phase),
            element("td", {}, c.distribution ?? ""), element("td", {}, c.repeats ?? ""),
            element("td", { class: "number" },
                    is_number(c.degrees_of_freedom) ? significant(c.degrees_of_freedom, 3) : "∞")));
}

function bar_cell(part) {
  const bar = element("span", { class: "part", "aria-hidden": "true" });
  bar.style.width = `${(100 * Math.min(1, part)).toFixed(1)}%`;
  return element("td", { class: "part-cell" }, bar);
}
