/**
 * The laboratory: every bench as a tile, the worst first; every program; the last messages of all.
 */

import { BenchTile } from "./bench_tile.js";
import { Choice, element, set_attribute, set_shown, set_text } from "./element.js";
import { EventList } from "./event_list.js";
import { visible } from "./foreign_text.js";
import { KeyedList } from "./keyed_list.js";
import { ProgramTable } from "./program_table.js";
import { start_button } from "./run_start.js";
import { rank_of, sign_of, word_of } from "./state_badge.js";

const STATE_ORDER = ["aborted", "silent", "paused", "running", "arming", "done", "idle", "gone"];

export class LaboratoryView {
  constructor(page) {
    this.page = page;
    this.benches = [];
    this.counts = element("p", { class: "counts", "aria-live": "polite", "data-field": "counts" });
    this.least = new Choice("Show", () => this.show_tiles());
    this.least.offer([
      { value: "ok", text: "all benches" },
      { value: "stale", text: "silent or worse" },
      { value: "warning", text: "warnings and errors" },
    ]);
    this.search = element("input", { type: "search", oninput: () => this.show_tiles() });
    this.none = element("p", { class: "quiet" }, "No bench has been heard of yet.");
    this.grid = element("div", { class: "tiles" });
    this.tiles = new KeyedList(this.grid, ({ bench }) => bench,
                               ({ bench }) => new BenchTile(bench, page.clock));
    this.programs = new ProgramTable(page.clock);
    this.events = new EventList({ title: "Messages", with_bench: true });
    this.actions = page.actions.panel("Actions of the laboratory", [start_button(page.actions)]);
    this.root = element(
      "div", { class: "view", "data-view": "laboratory" },
      element("div", { class: "view-head" }, element("h1", {}, "Laboratory"), this.counts),
      element("div", { class: "tools no-print" }, this.least.root,
              element("label", {}, "Search ", this.search)),
      this.actions.root,
      element("section", { "aria-label": "Benches" }, element("h2", {}, "Benches"), this.none,
              this.grid),
      this.programs.root, this.events.root,
    );
  }

  wants() {
    return {};
  }

  receive(name, laboratory) {
    if (name !== "laboratory") {
      return;
    }
    this.benches = [...(laboratory.benches ?? [])].sort(by_urgency);
    set_text(this.counts, counts_of(this.benches));
    this.show_tiles();
    this.programs.update(laboratory.programs ?? []);
    this.events.update(laboratory.events);
    set_attribute(this.root, "data-number", laboratory.number);
  }

  show_tiles() {
    const least = rank_of(this.least.value);
    const wanted = this.search.value.toLowerCase();
    const shown = this.benches.filter((bench) =>
      severity_rank(bench) >= least && visible(text_of(bench)).toLowerCase().includes(wanted));
    this.tiles.update(shown);
    set_shown(this.none, shown.length === 0);
    set_text(this.none, this.benches.length === 0 ? "No bench has been heard of yet."
                                                  : "No bench is like that.");
  }

  tick() {
    for (const tile of this.tiles.rows.values()) {
      tile.tick();
    }
    this.programs.tick();
  }

  leave() {
    this.actions.leave();
  }
}

function severity_rank({ worst }) {
  return rank_of(worst?.severity);
}

function text_of({ bench, run, message, worst }) {
  return `${bench} ${run} ${message} ${worst?.what}`;
}

function by_urgency(a, b) {
  return severity_rank(b) - severity_rank(a) ||
    STATE_ORDER.indexOf(a.state) - STATE_ORDER.indexOf(b.state) ||
    String(a.bench).localeCompare(String(b.bench), "en", { numeric: true });
}

// "3 benches: ▶ 2 running, ✕ 1 aborted"
function counts_of(benches) {
  const counts = new Map();
  for (const { state } of benches) {
    counts.set(state, (counts.get(state) ?? 0) + 1);
  }
  const parts = STATE_ORDER.filter((state) => counts.has(state))
    .map((state) => `${sign_of(state)} ${counts.get(state)} ${word_of(state)}`);
  const total = `${benches.length} ${benches.length === 1 ? "bench" : "benches"}`;
  return parts.length === 0 ? total : `${total}: ${parts.join(", ")}`;
}
