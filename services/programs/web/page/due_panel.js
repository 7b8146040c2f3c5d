/**
 * Which sensors, references and equipment are to be calibrated, the earliest first. Not there where
 * the store knows of none.
 */

import { copy_tools } from "./copy_tools.js";
import { element, name_element, set_shown, set_text, table_in_scroll } from "./element.js";

const HEADINGS = ["Due", "What", "Serial number", "Name", "Last calibrated", "Certificate", "Owner"];
const SOON_DAYS = 30;
const DAY_MS = 86400e3;
const MAX_ROWS = 500;

export class DuePanel {
  constructor() {
    const { root, body } = table_in_scroll("To be calibrated", HEADINGS);
    this.body = body;
    this.said = element("p", { "data-field": "due" });
    this.root = element("section", { class: "panel", "data-panel": "due" },
                        element("h2", {}, "To be calibrated"), this.said, copy_tools(root), root);
    set_shown(this.root, false);
  }

  /** `dates` as the daemon has them; `now_ms`: of the clock of this browser. */
  show(dates, now_ms = Date.now()) {
    set_shown(this.root, dates.length > 0);
    const soon = new Date(now_ms + SOON_DAYS * DAY_MS).toISOString().slice(0, 10);
    const overdue = dates.filter(({ overdue: is_over }) => is_over).length;
    const near = dates.filter((one) => is_near(one, soon)).length;
    set_text(this.said, overdue === 0 && near === 0
      ? `✓ Nothing is due within ${SOON_DAYS} days.`
      : `${overdue > 0 ? "✕" : "▲"} ${overdue} due, ${near} more within ${SOON_DAYS} days.`);
    this.body.replaceChildren(...dates.slice(0, MAX_ROWS).map((one) =>
      element("tr", {}, element("th", { scope: "row", class: one.overdue ? "flagged" : "" },
                                due_text(one, soon)),
              element("td", {}, one.what), element("td", {}, name_element(one.serial, 40)),
              element("td", {}, name_element(one.name, 60)), element("td", {}, one.last ?? "never"),
              element("td", {}, name_element(one.certificate ?? "", 40)),
              element("td", {}, name_element(one.owner ?? "", 40)))));
  }
}

function is_near({ due, overdue }, soon) {
  return !overdue && due !== null && due < soon;
}

function due_text(one, soon) {
  const sign = one.overdue ? "✕ " : is_near(one, soon) ? "▲ " : "";
  return sign + (one.due ?? "never calibrated");
}
