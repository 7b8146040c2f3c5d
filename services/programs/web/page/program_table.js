/**
 * Every program of the laboratory: where it runs, which DDS it speaks, how it is.
 */

import { element, name_element, set_name, set_text, table_in_scroll } from "./element.js";
import { KeyedList } from "./keyed_list.js";
import { full, is_number, short_time, UNKNOWN } from "./number_text.js";
import { StateBadge } from "./state_badge.js";

const HEALTH_ORDER = ["failed", "silent", "waiting", "ok"];
const HEADINGS = ["Program", "Bench", "Health", "Host", "Process", "DDS", "Version",
                  { text: "Clock offset", number: true }, "Message", "Last heard"];

export class ProgramTable {
  constructor(clock) {
    this.clock = clock;
    const { root, body } = table_in_scroll("Programs", HEADINGS);
    this.rows = new KeyedList(body, key_of, () => new ProgramRow(clock));
    this.root = element("section", { class: "panel" }, element("h2", {}, "Programs"), root);
  }

  update(programs) {
    this.rows.update([...programs].sort((a, b) =>
      HEALTH_ORDER.indexOf(a.health) - HEALTH_ORDER.indexOf(b.health) ||
      String(key_of(a)).localeCompare(String(key_of(b)), "en", { numeric: true })));
  }

  tick() {
    for (const row of this.rows.rows.values()) {
      row.tick();
    }
  }
}

function key_of({ bench, name, kind, host, process_id }) {
  return JSON.stringify([bench, name, kind, host, process_id]);
}

class ProgramRow {
  constructor(clock) {
    this.clock = clock;
    this.health = new StateBadge("health");
    this.names = ["name", "bench", "host", "process_id", "vendor", "version", "message"]
      .map((key) => [key, name_element("")]);
    const cell = (key) => this.names.find(([name]) => name === key)[1];
    this.offset = element("td", { class: "number" });
    this.heard = element("td", { class: "nowrap" });
    this.root = element("tr", {},
                        element("th", { scope: "row", class: "nowrap" }, cell("name")),
                        element("td", {}, cell("bench")), element("td", {}, this.health.root),
                        ["host", "process_id", "vendor", "version"].map((key) =>
                          element("td", { class: "nowrap" }, cell(key))),
                        this.offset, element("td", { class: "wide" }, cell("message")), this.heard);
  }

  update(program) {
    this.program = program;
    this.health.update(program.health);
    for (const [key, node] of this.names) {
      set_name(node, program[key] ?? "", key === "message" ? 120 : 36);
    }
    const { clock_offset_s, clock_offset_bound_s } = program;
    set_text(this.offset, is_number(clock_offset_s)
      ? `${short_time(clock_offset_s)}, within ${short_time(clock_offset_bound_s, 2)}` : UNKNOWN);
    this.offset.title = `${full(clock_offset_s, "s")}, within ${full(clock_offset_bound_s, "s")}`;
    this.tick();
  }

  tick() {
    set_text(this.heard, this.clock.age_text(this.program.last_message_utc_ms));
    this.root.classList.toggle("is-stale",
                               this.clock.is_stale(this.program.last_message_utc_ms));
  }
}
