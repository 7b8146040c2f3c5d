/**
 * What must hold over a whole run, and whether it does: a row a closure of the channel. What is
 * open comes first, with a sign and its sentence.
 */

import { element, name_element, set_shown, set_text, table_in_scroll } from "./element.js";
import { full, UNKNOWN, with_unit } from "./number_text.js";

const HEADINGS = ["closure", "compared", "verdict", { text: "value", number: true },
                  { text: "u", number: true }, { text: "limit", number: true }, "what it says"];
const VERDICTS = { closes: "✓ closes", open: "▲ open", not_possible: "– not possible" };

export class ClosurePanel {
  constructor() {
    const { root, body } = table_in_scroll("Closures", HEADINGS);
    this.body = body;
    this.table = root;
    this.shown = "";
    this.summary = element("p", { "data-field": "closures" });
    this.root = element("section", { class: "panel", "data-panel": "closures" },
                        element("h2", {}, "Closures"), this.summary, root);
  }

  /** closures: of a channel; empty while the run lasts. */
  update(closures) {
    const as_text = JSON.stringify(closures);
    if (as_text === this.shown) {
      return;
    }
    this.shown = as_text;
    const open = closures.filter(is_open);
    const closing = closures.filter(({ verdict }) => verdict === "closes");
    set_shown(this.table, closures.length > 0);
    set_text(this.summary, closures.length === 0
      ? "What must hold over the run is compared when it is over."
      : open.length === 0 ? `✓ ${closing.length} close, none is open.`
                          : `▲ ${open.length} open, ${closing.length} close.`);
    this.summary.className = open.length > 0 ? "flagged" : "quiet";
    this.body.replaceChildren(...[...open, ...closures.filter((one) => !is_open(one))].map(row_of));
  }
}

function is_open({ verdict }) {
  return verdict === "open";
}

function row_of(closure) {
  const unit = closure.unit === "1" ? "" : closure.unit;
  const is_compared = closure.verdict !== "not_possible";
  const number = (value) => element("td", { class: "number", title: full(value, unit) },
                                    is_compared ? with_unit(value, unit, 3) : UNKNOWN);
  return element(
    "tr", { "data-closure": closure.kind, "data-verdict": closure.verdict },
    element("th", { scope: "row" }, name_element(closure.title ?? closure.kind, 48)),
    element("td", {}, name_element(closure.subject || UNKNOWN, 48)),
    element("td", { class: is_open(closure) ? "flagged" : null },
            VERDICTS[closure.verdict] ?? name_element(closure.verdict, 24)),
    number(closure.value), number(closure.u), number(closure.limit),
    element("td", {}, name_element(closure.sentence, 400)),
  );
}
