/**
 * The last messages, newest first, of all benches or of one; those below a severity are left out.
 */

import { Choice, element, name_element, set_name, set_shown, set_text } from "./element.js";
import { KeyedList } from "./keyed_list.js";
import { utc_text } from "./number_text.js";
import { rank_of, StateBadge } from "./state_badge.js";

const MAX_SHOWN = 200;

export class EventList {
  constructor({ title, with_bench }) {
    this.with_bench = with_bench;
    this.events = [];
    this.least = new Choice("Show", () => this.show());
    this.least.offer([
      { value: "ok", text: "all messages" },
      { value: "warning", text: "warnings and errors" },
      { value: "error", text: "errors" },
    ]);
    this.none = element("p", { class: "quiet" }, "No messages.");
    const list = element("ol", { class: "events", tabindex: "0", "aria-label": title });
    this.rows = new KeyedList(list, ({ key }) => key, (event) => this.make_row(event));
    this.root = element("section", { class: "panel" },
                        element("div", { class: "panel-head" }, element("h2", {}, title),
                                this.least.root),
                        this.none, list);
  }

  update(events) {
    this.events = (events ?? []).slice(-MAX_SHOWN);
    this.show();
  }

  show() {
    const least = rank_of(this.least.value);
    const seen = new Map();
    const keyed = this.events.map((event) => {
      const same = `${event.utc_ms} ${event.bench} ${event.text}`;
      seen.set(same, (seen.get(same) ?? 0) + 1);
      return { ...event, key: `${same} ${seen.get(same)}` };
    });
    const shown = keyed.filter(({ severity }) => rank_of(severity) >= least).reverse();
    this.rows.update(shown);
    set_shown(this.none, shown.length === 0);
  }

  make_row(event) {
    const time = element("time");
    const state = new StateBadge("severity");
    const text = name_element(event.text, 400);
    const bench = this.with_bench && event.bench ? [name_element(event.bench, 32), ": "] : [];
    const root = element("li", {}, time, " ", state.root, " ",
                         element("span", { class: "event-text" }, bench, text));
    return {
      root,
      update: ({ utc_ms, severity, text: words }) => {
        set_text(time, utc_text(utc_ms, false));
        time.title = `${utc_text(utc_ms)} UTC`;
        state.update(severity);
        set_name(text, words, 400);
      },
    };
  }
}
