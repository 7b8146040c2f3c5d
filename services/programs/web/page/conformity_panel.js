/**
 * Whether the run meets its tolerances: what `dyncal conformity --keep` left in the run folder. Not
 * shown where there is none. What does not pass comes first.
 */

import { get } from "./api.js";
import { element, name_element, set_shown, set_text, table_in_scroll } from "./element.js";
import { download_path } from "./foreign_text.js";
import { full, UNKNOWN } from "./number_text.js";

const HEADINGS = ["channel", { text: "f / Hz", number: true },
                  { text: "level / (m/s²)", number: true }, "limits",
                  { text: "deviation", number: true }, { text: "U", number: true },
                  { text: "probability of conformity", number: true }, "statement"];
const FILE = "conformity.json";
const SIGNS = { pass: "✓", fail: "✕" };
const MAX_ROWS = 1000;

export class ConformityPanel {
  constructor() {
    const { root, body } = table_in_scroll("Conformity", HEADINGS);
    this.body = body;
    this.shown = "";
    this.verdict = element("p", { "data-field": "conformity" });
    this.notes = element("ul", { class: "quiet" });
    this.root = element("section", { class: "panel", "data-panel": "conformity" },
                        element("h2", {}, "Conformity"), this.verdict, this.notes, root);
    set_shown(this.root, false);
  }

  /** files: those of the run folder. */
  async update(files) {
    const file = (files ?? []).find(({ name }) => name === FILE);
    const path = file ? download_path(file.href) : null;
    const as_text = path === null ? "" : `${path} ${file.bytes}`;
    if (as_text === this.shown) {
      return;
    }
    this.shown = as_text;
    set_shown(this.root, path !== null);
    if (path === null) {
      return;
    }
    try {
      const report = await get(path);
      if (this.shown === as_text) {
        this.show(report);
      }
    } catch (problem) {
      set_text(this.verdict, `✕ ${FILE}: ${problem.message}`);
      this.body.replaceChildren();
    }
  }

  show({ verdict, statement, rule_text, notes = [], values = [] }) {
    set_text(this.verdict, `${sign_of(statement)} ${verdict}`);
    this.verdict.className = statement === "pass" ? "quiet" : "flagged";
    this.notes.replaceChildren(...[rule_text, ...notes].map((text) =>
      element("li", {}, name_element(text ?? "", 400))));
    const passes = ({ statement: said }) => said === "pass";
    const ordered = [...values.filter((one) => !passes(one)), ...values.filter(passes)];
    this.body.replaceChildren(...ordered.slice(0, MAX_ROWS).map(row_of));
  }
}

function sign_of(statement) {
  return SIGNS[statement] ?? "▲";
}

function row_of(value) {
  const unit = value.unit ?? "";
  const number = (text, all) => element("td", { class: "number", title: full(all, unit) },
                                        text ? `${text} ${unit}` : UNKNOWN);
  const text = value.text ?? {};
  return element(
    "tr", { "data-statement": value.statement },
    element("th", { scope: "row" }, name_element(value.channel, 48)),
    element("td", { class: "number" }, name_element(value.frequency_text_hz, 24)),
    element("td", { class: "number" }, String(value.level_m_s2 ?? UNKNOWN)),
    element("td", {}, `${value.lower_limit} ${unit} to ${value.upper_limit} ${unit}`),
    number(text.deviation, value.deviation), number(text.U_deviation, value.U_deviation),
    element("td", { class: "number" }, text.probability || UNKNOWN),
    element("td", { class: value.statement === "pass" ? null : "flagged" },
            `${sign_of(value.statement)} `, name_element(value.statement, 24),
            value.reason ? [": ", name_element(value.reason, 200)] : []),
  );
}
