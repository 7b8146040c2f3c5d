/**
 * Who conducted a run, and what was noted and happened in it: notes, events and amendments on the
 * axis of time. Notes come without a new result, also afterwards, so the daemon is asked again
 * while the run is shown. Not there where nothing is known.
 */

import { bench_path, get } from "./api.js";
import { element, name_element, set_name, set_shown, set_text, table_in_scroll }
  from "./element.js";
import { utc_text } from "./number_text.js";

const AGAIN_MS = 5000;
const SIGNS = { note: "✎ note", event: "● event", amendment: "▲ amendment" };

export class JournalPanel {
  constructor() {
    const { root, body } = table_in_scroll("Notes", ["time (UTC)", "who", "what", "text"]);
    this.body = body;
    this.table = root;
    this.run = null;
    this.shown = "";
    this.asked_ms = -Infinity;
    this.conductor = element("p", { "data-field": "conducted_by" });
    this.comment = element("p", { "data-field": "comment" });
    this.said = element("p", { class: "quiet", "data-field": "journal" });
    this.root = element("section", { class: "panel", "data-panel": "journal" },
                        element("h2", {}, "Notes"), this.conductor, this.comment, this.said, root);
    set_shown(this.root, false);
  }

  /** As often as one likes; another run is asked for at once. */
  async ask(bench, run) {
    const name = JSON.stringify([bench, run]);
    const now_ms = performance.now();
    if (name === this.run && now_ms - this.asked_ms < AGAIN_MS) {
      return;
    }
    if (name !== this.run) {
      set_shown(this.root, false);
    }
    this.run = name;
    this.asked_ms = now_ms;
    try {
      const journal = await get(bench_path(bench, "/journal"), { run });
      if (name === this.run) {
        this.show(journal);
      }
    } catch {
      // What is shown stays; the connection says that the daemon is away.
    }
  }

  show({ conducted_by = "", comment = "", entries = [], left_out = 0, problem = "" }) {
    set_shown(this.root, Boolean(conducted_by || comment || problem || entries.length > 0));
    const as_text = JSON.stringify([conducted_by, comment, entries, left_out, problem]);
    if (as_text === this.shown) {
      return;
    }
    this.shown = as_text;
    show_line(this.conductor, "Conducted by ", conducted_by);
    show_line(this.comment, "Comment: ", comment);
    set_shown(this.said, Boolean(problem) || left_out > 0);
    set_text(this.said, problem ? `✕ ${problem}` : `${left_out} earlier entries are not shown.`);
    set_shown(this.table, entries.length > 0);
    this.body.replaceChildren(...entries.map((one) => element(
      "tr", { "data-entry": one.kind }, element("th", { scope: "row" }, utc_text(one.utc_ms)),
      element("td", {}, name_element(one.by, 48)),
      element("td", {}, SIGNS[one.kind] ?? name_element(one.kind, 24)),
      element("td", {}, name_element(one.text, 600)))));
  }
}

function show_line(line, begin, text) {
  set_shown(line, Boolean(text));
  set_name(line, begin + text, 400);
}
