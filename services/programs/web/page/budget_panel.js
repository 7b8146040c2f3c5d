/**
 * The uncertainty budget of a mean, whose U is certified, or of one repetition: contributions, the
 * largest first, each as a number and as the length of a bar.
 */

import { bench_path, get } from "./api.js";
import { copy_tools } from "./copy_tools.js";
import { element, name_element, set_shown, set_text, table_in_scroll } from "./element.js";
import { full, is_number, rounded_text, significant, UNKNOWN } from "./number_text.js";
import { unit_text } from "./unit_text.js";

const DEGREES = 180 / Math.PI;
const HEADINGS = ["Contribution", { text: "u(|H|) / %", number: true }, "",
                  { text: "u(arg H) / °", number: true }, "", "Distribution", "Repeats",
                  { text: "degrees of freedom", number: true }];

export class BudgetPanel {
  constructor() {
    this.hint = element("p", { class: "quiet" },
                        "Choose a point of a figure, or “Budget” in a table.");
    this.what = element("p", { "data-field": "budget_of", "aria-live": "polite" });
    const { root, body } = table_in_scroll("Uncertainty budget", HEADINGS);
    this.body = body;
    this.table = root;
    this.copy = copy_tools(root);
    this.root = element("section", { class: "panel", "data-panel": "budget" },
                        element("h2", { tabindex: "-1" }, "Uncertainty budget"), this.hint,
                        this.what, this.copy, root);
    set_shown(root, false);
    set_shown(this.copy, false);
  }

  /** point: a result or a mean, as the run's answer has it. */
  async ask(bench, run, point) {
    const { channel, step, repetition, frequency_text_hz, level_m_s2 } = point;
    const place = step === undefined
      ? { frequency: frequency_text_hz, ...(is_number(level_m_s2) ? { level: level_m_s2 } : {}) }
      : { step, repetition };
    const asked = JSON.stringify([run, channel, place]);
    this.asked = asked;
    try {
      const answer = await get(bench_path(bench, "/budget"), { run, channel, ...place });
      if (asked === this.asked) {
        this.show({ ...point, contributions: answer.contributions });
      }
    } catch (problem) {
      set_text(this.what, `✕ No budget of ${name_of(point)}: ${problem.message}`);
      set_shown(this.table, false);
      set_shown(this.copy, false);
    }
  }

  show(point) {
    const { channel, step, magnitude, text, unit, contributions } = point;
    const size = rounded_text(text?.magnitude);
    const phase = rounded_text(text?.phase_deg);
    const short = unit_text(unit);
    const u = step === undefined ? "U" : "u"; // texts of means are rounded by U
    const values = is_number(magnitude)
      ? `: ${size.value}${short ? ` ${short}` : ""}, ${u} ${size.u}; ${phase.value}°, ${u} ${phase.u}°`
      : "";
    set_text(this.what, `${channel}, ${name_of(point)}${values}`);
    set_shown(this.hint, false);
    set_shown(this.table, true);
    set_shown(this.copy, true);
    this.body.replaceChildren(...rows_of(contributions ?? []));
  }
}

function name_of({ step, repetition, repetitions, frequency_text_hz }) {
  const frequency = frequency_text_hz ? `, ${frequency_text_hz} Hz` : "";
  return step === undefined ? `mean of ${repetitions}${frequency}`
                            : `step ${step}, repetition ${repetition}${frequency}`;
}

function rows_of(contributions) {
  const largest = (key) => Math.max(...contributions.map((c) => c[key] ?? 0), 1e-300);
  const [all_magnitude, all_phase] = [largest("u_magnitude_rel"), largest("u_phase_rad")];
  const weight = (c) => Math.max((c.u_magnitude_rel ?? 0) / all_magnitude,
                                 (c.u_phase_rad ?? 0) / all_phase);
  return [...contributions].sort((a, b) => weight(b) - weight(a)).map((c) =>
    element("tr", {},
            element("th", { scope: "row" }, name_element(c.name ?? "", 60)),
            element("td", { class: "number", title: full(c.u_magnitude_rel) },
                    is_number(c.u_magnitude_rel) ? significant(100 * c.u_magnitude_rel, 2) : UNKNOWN),
            bar_cell((c.u_magnitude_rel ?? 0) / all_magnitude),
            element("td", { class: "number", title: full(c.u_phase_rad, "rad") },
                    is_number(c.u_phase_rad) ? significant(DEGREES * c.u_phase_rad, 2) : UNKNOWN),
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
