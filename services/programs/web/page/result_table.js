/**
 * Results as tables: the means with U, and every repetition with its flags and what it lost. Values
 * are rounded by their uncertainty; the title of a cell has every digit.
 */

import { copy_tools } from "./copy_tools.js";
import { element, name_element, set_name, set_shown, set_text, table_in_scroll } from "./element.js";
import { KeyedList } from "./keyed_list.js";
import { count_text, full, is_number, rounded_text, significant, UNKNOWN } from "./number_text.js";
import { unit_text } from "./unit_text.js";

const number = (text, title = null) => ({ text, title, number: true });

const LEVEL = number("level / (m/s²)", "as the reference measured it; in brackets: as planned");
// The value first: it is what a phone shows without scrolling.
const MEAN_HEADINGS = [
  number("f / Hz"), number("|H|"), number("U(|H|)", "expanded, 95.45 %"),
  number("arg H / °", "lead: a delay is negative"), number("U / °", "expanded, 95.45 %"),
  number("arg H / rad", "lead: a delay is negative"), number("U / rad", "expanded, 95.45 %"), LEVEL,
  number("k", "of magnitude; of phase in the title"), number("n", "repetitions"), "flags", "budget",
];
const POINT_HEADINGS = [
  number("f / Hz"), number("|H|"), number("u(|H|)"), number("arg H / °"), number("u / °"),
  number("arg H / rad"), number("u / rad"), LEVEL, number("step"), number("repetition"), "valid",
  number("lost"), "flags", "budget",
];
const MAX_ROWS = 2000;

export class ResultTable {
  /** on_budget: called with a point, or a mean, which has no step */
  constructor(on_budget) {
    this.unit = element("span", { "data-field": "unit" });
    const means = table_in_scroll("Means over the repetitions", MEAN_HEADINGS);
    const points = table_in_scroll("Every repetition", POINT_HEADINGS);
    this.means = new KeyedList(means.body, (p) => `${p.frequency_text_hz} ${p.level_m_s2}`,
                               () => new MeanRow(on_budget));
    this.points = new KeyedList(points.body, (p) => `${p.step} ${p.repetition}`,
                                () => new PointRow(on_budget));
    this.no_means = element("p", { class: "quiet" },
                            "The means with their U come when the run is over.");
    this.means_root = element("div", {}, copy_tools(means.root), means.root);
    this.advice = element("p", { class: "quiet", "data-field": "advice" });
    this.root = element("section", { class: "panel", "data-panel": "table" },
                        element("div", { class: "panel-head" }, element("h2", {}, "Table"),
                                this.unit),
                        element("h3", {}, "Means over the repetitions"), this.no_means,
                        this.means_root, this.advice,
                        element("details", { open: true },
                                element("summary", {}, "Every repetition"),
                                copy_tools(points.root), points.root));
  }

  /** transfer: with the means; null while the run lasts. axis: excited; empty: not stated. */
  update(points, transfer, unit, axis) {
    const short = unit_text(unit);
    set_text(this.unit, (unit ? `|H| in ${short || "one (dimensionless)"}` : "unit not known") +
      (axis ? `, excited axis ${axis}` : ""));
    set_shown(this.no_means, transfer === null);
    set_shown(this.means_root, transfer !== null);
    set_text(this.advice, transfer?.advice ?? "");
    set_shown(this.advice, Boolean(transfer?.advice));
    this.means.update((transfer?.points ?? []).map((p) => ({ ...p, unit: short })));
    this.points.update(points.slice(-MAX_ROWS).map((p) => ({ ...p, unit: short })));
  }
}

function number_cell() {
  return element("td", { class: "number" });
}

// A value and its u in two cells, to the digits of u; every digit in their titles.
function show_pair([value_cell, u_cell], text, value, u, unit, is_shown = true) {
  const { value: value_text, u: u_text } = rounded_text(text);
  set_text(value_cell, is_shown ? value_text : UNKNOWN);
  set_text(u_cell, is_shown ? u_text : UNKNOWN);
  value_cell.title = full(value, unit);
  u_cell.title = full(u, unit);
}

const DEGREES = 180 / Math.PI;

function show_phase([degrees, u_degrees, radians, u_radians], text, phase_rad, u_rad, is_shown) {
  show_pair([degrees, u_degrees], text?.phase_deg, in_degrees(phase_rad), in_degrees(u_rad), "°",
            is_shown);
  show_pair([radians, u_radians], text?.phase_rad, phase_rad, u_rad, "rad", is_shown);
}

function in_degrees(angle_rad) {
  return is_number(angle_rad) ? DEGREES * angle_rad : null;
}

function show_level(cell, { level_m_s2, measured_level_m_s2 }) {
  const is_measured = is_number(measured_level_m_s2);
  set_text(cell, is_measured ? significant(measured_level_m_s2) : `(${significant(level_m_s2)})`);
  cell.title = `${is_measured ? `measured ${full(measured_level_m_s2, "m/s²")}, ` : ""}` +
    `planned ${full(level_m_s2, "m/s²")}`;
}

function budget_button(on_budget) {
  return element("button", { type: "button", class: "small", onclick: on_budget }, "Budget");
}

function show_flags(node, flag_names) {
  const names = [...new Set(flag_names ?? [])];
  set_name(node, names.length ? `▲ ${names.join(", ")}` : "none", 80);
  node.classList.toggle("flagged", names.length > 0);
}

class MeanRow {
  constructor(on_budget) {
    this.frequency = element("th", { scope: "row", class: "number" });
    this.cells = Array.from({ length: 9 }, number_cell);
    this.flags = name_element("");
    this.button = budget_button(() => on_budget(this.mean));
    this.root = element("tr", {}, this.frequency, this.cells, element("td", {}, this.flags),
                        element("td", {}, this.button));
  }

  update(p) {
    this.mean = p;
    const [magnitude, U_magnitude, ...others] = this.cells;
    const [level, k, n] = others.splice(4);
    set_text(this.frequency, p.frequency_text_hz);
    show_level(level, p);
    show_pair([magnitude, U_magnitude], p.text?.magnitude, p.magnitude, p.U_magnitude, p.unit);
    show_phase(others, p.text, p.phase_rad, p.U_phase_rad);
    this.button.setAttribute("aria-label", `Budget of the mean at ${p.frequency_text_hz} Hz`);
    set_text(k, significant(p.k_magnitude, 3));
    k.title = `|H|: ${full(p.k_magnitude)}, arg H: ${full(p.k_phase)}`;
    set_text(n, count_text(p.repetitions));
    show_flags(this.flags, p.flag_names);
    this.root.dataset.frequency = p.frequency_text_hz;
  }
}

class PointRow {
  constructor(on_budget) {
    this.frequency = element("th", { scope: "row", class: "number" });
    this.cells = Array.from({ length: 9 }, number_cell);
    this.valid = element("td");
    this.lost = number_cell();
    this.flags = name_element("");
    this.button = budget_button(() => on_budget(this.point));
    this.root = element("tr", {}, this.frequency, this.cells, this.valid, this.lost,
                        element("td", {}, this.flags), element("td", {}, this.button));
  }

  update(p) {
    this.point = p;
    const [magnitude, u_magnitude, ...others] = this.cells;
    const [level, step, repetition] = others.splice(4);
    set_text(this.frequency, p.frequency_text_hz);
    show_level(level, p);
    set_text(step, `${p.step}${p.attempt > 1 ? ` (attempt ${p.attempt})` : ""}`);
    set_text(repetition, p.repetition);
    set_name(this.valid, valid_text(p), 60);
    show_pair([magnitude, u_magnitude], p.text?.magnitude, p.magnitude, p.u_magnitude, p.unit,
              p.valid);
    show_phase(others, p.text, p.phase_rad, p.u_phase_rad, p.valid);
    set_text(this.lost, count_text(p.lost));
    show_flags(this.flags, p.flag_names);
    this.button.disabled = !p.valid;
    this.button.setAttribute("aria-label", `Budget of step ${p.step}, repetition ${p.repetition}`);
    this.root.dataset.step = String(p.step);
    this.root.dataset.valid = String(p.valid);
  }
}

function valid_text({ valid, problem, provisional }) {
  if (!valid) {
    return `✕ ${problem || "no result"}`;
  }
  return provisional ? "◔ provisional" : "✓";
}

const TEXTS = ["magnitude_text", "u_magnitude_text", "phase_rad_text", "u_phase_rad_text"];

function text_of({ text }) {
  return [text?.magnitude?.value, text?.magnitude?.u, text?.phase_rad?.value, text?.phase_rad?.u];
}

/** The whole table as CSV: every digit, and the texts that the table shows in columns of their own. */
export function table_csv(points, unit) {
  const keys = ["channel", "step", "attempt", "repetition", "frequency_text_hz", "level_m_s2",
                "valid", "magnitude", "u_magnitude", "U_magnitude", "phase_rad", "u_phase_rad",
                "U_phase_rad", "lost"];
  const cell = (value) => (is_number(value) || typeof value === "boolean" ? String(value)
    : `"${String(value ?? "").replace(/"/g, '""')}"`);
  const lines = points.map((p) => [...keys.map((key) => cell(p[key])),
                                   cell((p.flag_names ?? []).join(" ")),
                                   ...text_of(p).map(cell), cell(p.excited_axis)]);
  return `# magnitude in ${String(unit || "a unit that is not known").replace(/\s/g, " ")}; phase: ` +
    "lead, rad; u: standard uncertainty; U: expanded, 95.45 %; _text: rounded by u, as shown\n" +
    [[...keys, "flags", ...TEXTS, "excited_axis"], ...lines].map((line) => line.join(",")).join("\n") + "\n";
}
