/**
 * The sources of a bench: rate against nominal, losses by the place where they happen, stamps, and
 * every channel with the part of its range that it uses.
 */

import { element, name_element, set_attribute, set_name, set_shown, set_text } from "./element.js";
import { KeyedList } from "./keyed_list.js";
import { has_range, judge_use, range_use } from "./level_meter.js";
import { count_text, full, is_number, short_time, significant, with_unit } from "./number_text.js";
import { StateBadge } from "./state_badge.js";
import { unit_text } from "./unit_text.js";

export class SourcePanel {
  constructor(clock) {
    const grid = element("div", { class: "tiles" });
    this.cards = new KeyedList(grid, ({ source }) => source, () => new SourceCard(clock));
    this.none = element("p", { class: "quiet" }, "No source has described itself yet.");
    this.root = element("section", { class: "panel" }, element("h2", {}, "Sources"), this.none, grid);
  }

  update(sources, is_excited) {
    this.cards.update(sources.map((source) => ({ ...source, is_excited })));
    set_shown(this.none, sources.length === 0);
  }

  tick() {
    for (const card of this.cards.rows.values()) {
      card.tick();
    }
  }
}

// [name, key] of counters, in the order of a sample's way.
const COUNTERS = [
  ["received", "received"],
  ["lost in the device", "lost_in_device"],
  ["lost in transit", "lost_in_transit"],
  ["dropped in the program", "dropped_in_service"],
  ["rejected", "rejected"],
  ["duplicates", "duplicates"],
  ["stamps not trusted", "stamps_not_trusted"],
];

class SourceCard {
  constructor(clock) {
    this.clock = clock;
    this.name = name_element("");
    this.state = new StateBadge("state");
    this.device = name_element("");
    this.facts = element("dl", { class: "facts" });
    this.values = new Map();
    this.message = element("p", { class: "message" });
    this.age = element("p", { class: "age" });
    const list = element("ul", { class: "channels" });
    this.channels = new KeyedList(list, ({ name }) => name, () => new ChannelRow());
    this.root = element("article", { class: "tile" },
                        element("div", { class: "tile-head" }, element("h3", {}, this.name),
                                this.state.root),
                        element("p", { class: "quiet" }, this.device), this.message, this.facts,
                        element("h4", {}, "Channels"), list, this.age);
  }

  update(source) {
    this.source = source;
    set_name(this.name, source.source, 40);
    set_attribute(this.root, "data-source", source.source);
    this.state.update(source.state);
    set_name(this.device, [source.kind, source.device, source.serial, source.driver, source.host]
      .filter(Boolean).join(", "), 120);
    set_name(this.message, source.message, 200);
    set_shown(this.message, Boolean(source.message));
    for (const [name, text, tone, title] of facts_of(source)) {
      this.show_fact(name, text, tone, title);
    }
    this.channels.update((source.channels ?? []).map((channel) =>
      ({ ...channel, is_excited: source.is_excited })));
    this.tick();
  }

  show_fact(name, text, tone = null, title = null) {
    if (!this.values.has(name)) {
      const value = element("dd", { "data-field": name.replace(/ /g, "_") });
      this.values.set(name, value);
      this.facts.append(element("div", {}, element("dt", {}, name), value));
    }
    const value = this.values.get(name);
    set_text(value, text);
    set_attribute(value, "data-tone", tone);
    set_attribute(value, "title", title);
  }

  tick() {
    const { last_message_utc_ms } = this.source;
    this.root.classList.toggle("is-stale", this.clock.is_stale(last_message_utc_ms));
    set_text(this.age, this.clock.age_text(last_message_utc_ms));
  }
}

function facts_of(source) {
  const facts = [rate_fact(source)];
  for (const [name, key] of COUNTERS) {
    const is_bad = key !== "received" && Number(source[key] ?? 0) > 0;
    facts.push([name, `${is_bad ? "▲ " : ""}${count_text(source[key])}`, is_bad ? "warning" : null]);
  }
  const causes = (source.causes ?? []).filter(({ value }) => Number(value) > 0)
    .map(({ name, value }) => `${name}: ${count_text(value)}`);
  facts.push(["causes", causes.join("; ") || "none"]);
  facts.push(["clock", `${source.time_base ?? "?"}, u ${short_time(source.clock_uncertainty_s, 2)}`,
              null, full(source.clock_uncertainty_s, "s")]);
  facts.push(["buffer", is_number(source.buffer_fill)
    ? `${significant(100 * source.buffer_fill, 2)} % full` : "–"]);
  facts.push(["readers", count_text(source.matched_readers)]);
  return facts;
}

// Of blocks as they come within 3 s: what is nearer to the nominal rate is no deviation.
const RATE_KNOWN_TO = 0.01;

function rate_fact({ rate_hz, nominal_rate_hz }) {
  const measured = `measured ${full(rate_hz, "Hz")}`;
  if (!is_number(rate_hz) || !(nominal_rate_hz > 0)) {
    return ["rate", with_unit(rate_hz, "Hz", 3), null, measured];
  }
  const nominal = with_unit(nominal_rate_hz, "Hz", 5);
  const off = rate_hz / nominal_rate_hz - 1;
  if (Math.abs(off) <= RATE_KNOWN_TO) {
    return ["rate", `${nominal}, as nominal`, null, measured];
  }
  const is_bad = Math.abs(off) > 0.02;
  return ["rate", `${is_bad ? "▲ " : ""}${with_unit(rate_hz, "Hz", 3)} of ${nominal} ` +
    `(${off >= 0 ? "+" : "−"}${significant(Math.abs(100 * off), 2)} %)`,
          is_bad ? "warning" : null, measured];
}

class ChannelRow {
  constructor() {
    this.name = name_element("");
    this.text = element("span");
    this.use = element("span", { class: "use" });
    this.root = element("li", {}, element("b", {}, this.name), " ", this.text, " ", this.use);
  }

  update(channel) {
    const { name, quantity, unit, minimum, maximum, over_range, is_excited } = channel;
    const short = unit_text(unit);
    const range = has_range(channel)
      ? `, ${significant(minimum)} to ${with_unit(maximum, short)}` : (short ? `, ${short}` : "");
    set_name(this.name, name, 40);
    set_name(this.text, `${quantity || "quantity not known"}${range}`, 100);
    const use = range_use(channel);
    const is_known = use !== null || over_range > 0;
    const [tone, word] = judge_use(use, over_range, is_excited);
    set_shown(this.use, is_known);
    set_text(this.use, is_known ? `${word}${use === null ? "" : ` ${significant(100 * use, 3)} %`}` : "");
    set_attribute(this.use, "data-tone", tone);
  }
}
