/**
 * A bench while it works: its sources, its signals live, their spectrum, the step it is at.
 */

import { bench_path, get } from "./api.js";
import { ask } from "./dialog.js";
import { Choice, element, name_element, set_attribute, set_name, set_text } from "./element.js";
import { EventList } from "./event_list.js";
import { facts_of } from "./bench_tile.js";
import { PlanBand } from "./plan_band.js";
import { href_of } from "./route.js";
import { SignalPanel } from "./signal_panel.js";
import { SourcePanel } from "./source_panel.js";
import { StateBadge } from "./state_badge.js";
import { StepPanel } from "./step_panel.js";

const FIT_EVERY_MS = 2000;
const EXCITED = ["settling", "steady"]; // states of a step

export class BenchView {
  constructor(page, route) {
    this.page = page;
    this.name = route.bench ?? first_bench(page.laboratory);
    this.state = new StateBadge("state");
    this.age = element("p", { class: "age", "data-field": "age" });
    this.heading = name_element(this.name ?? "no bench yet", 48);
    this.message = element("p", { class: "message", "data-field": "message" });
    this.facts = element("dl", { class: "facts wide" });
    this.bench_choice = new Choice("Bench", (bench) => {
      window.location.hash = href_of("bench", bench);
    });
    this.plan = new PlanBand();
    this.sources = new SourcePanel(page.clock);
    this.signals = new SignalPanel(page, () => this.name, () => page.watch());
    this.step = new StepPanel();
    this.events = new EventList({ title: "Messages of this bench", with_bench: false });
    this.run_link = element("a", { href: href_of("run", this.name) }, "Results of this run");
    this.actions = page.actions.panel("Actions of the bench", this.buttons());
    this.root = this.make_root();
    this.timer = setInterval(() => this.ask_fit(), FIT_EVERY_MS);
    this.ask_fit();
  }

  make_root() {
    return element(
      "div", { class: "view", "data-view": "bench", "data-bench": this.name },
      element("div", { class: "view-head" }, element("h1", {}, "Bench ", this.heading),
              this.state.root, this.age),
      element("div", { class: "tools no-print" }, this.bench_choice.root, this.run_link),
      this.message, this.facts, this.actions.root, this.plan.root, this.signals.root,
      this.step.root, this.sources.root, this.events.root,
    );
  }

  buttons() {
    const confirmed = (question, yes, command) => async () =>
      (await ask({ ...question, yes, danger: true })) === null
        ? null
        : this.page.actions.command(this.name, { ...command, run: this.bench?.run });
    const about = (title, line) => ({ title: `${title} (bench ${this.name})`, lines: [line] });
    return [
      { text: "Pause", act: confirmed(about("Pause the run?", "The exciter stops after this step."),
                                      "Pause", { command: "pause" }) },
      { text: "Continue", act: confirmed(about("Continue the run?", "The exciter will move again."),
                                         "Continue", { command: "continue" }) },
      { text: "Repeat a step …", act: () => this.repeat() },
      { text: "Abort the run", danger: true,
        act: confirmed(about("Abort the run?", "The exciter stops now; results so far are kept."),
                       "Abort the run", { command: "abort" }) },
    ];
  }

  async repeat() {
    const now = this.bench?.step ?? 1;
    const step = await ask({
      title: `Repeat a step (bench ${this.name})`,
      lines: ["It is excited again; its earlier result is replaced."],
      field: element("label", {}, "Step ",
                     element("input", { type: "number", min: 1, max: this.bench?.step_count ?? null,
                                        value: now, required: true })),
      yes: "Repeat the step",
    });
    return step === null ? null : this.page.actions.command(
      this.name, { command: "repeat", step: Number(step), run: this.bench?.run });
  }

  wants() {
    return this.name ? { bench: this.name, ...this.signals.wants() } : {};
  }

  receive(name, data) {
    if (name === "laboratory") {
      this.receive_laboratory(data);
    } else if (name === "bench" && data.bench === this.name) {
      this.show(data);
    } else if (name === "signal") {
      this.signals.receive(data);
    }
  }

  receive_laboratory(laboratory) {
    const benches = laboratory.benches ?? [];
    if (this.name === null && benches.length > 0) {
      window.location.replace(href_of("bench", benches[0].bench));
      return;
    }
    this.bench_choice.offer(benches.map(({ bench }) => ({ value: bench, text: bench })), this.name);
    const tile = benches.find(({ bench }) => bench === this.name);
    if (tile) {
      this.show_head(tile);
    } else if (this.name !== null) {
      this.state.update("gone");
    }
  }

  show_head(bench) {
    this.bench = { ...this.bench, ...bench };
    this.state.update(bench.state);
    set_name(this.message, bench.message, 300);
    const facts = facts_of(bench);
    if (this.facts.childElementCount !== facts.length) {
      this.facts.replaceChildren(...facts.map(([name]) =>
        element("div", {}, element("dt", {}, name), element("dd"))));
    }
    facts.forEach(([name, text, title], i) => {
      const value = this.facts.children[i].lastElementChild;
      set_text(value, text);
      set_attribute(value, "title", title);
      set_attribute(value, "data-field", name.toLowerCase().replace(/ /g, "_"));
    });
    this.tick();
  }

  show(data) {
    this.show_head(data);
    this.plan.update(data.plan, data.now);
    const is_excited = EXCITED.includes(data.now?.state);
    this.sources.update(data.sources ?? [], is_excited);
    this.signals.offer(data.sources ?? [], is_excited);
    this.step.show_now(data);
    this.events.update(data.messages);
    set_attribute(this.root, "data-number", data.number);
  }

  async ask_fit() {
    if (!this.bench?.plan || this.is_asking || document.hidden) {
      return;
    }
    this.is_asking = true;
    try {
      this.step.show_fit(await get(bench_path(this.name, "/fit")));
    } catch (problem) {
      this.step.show_problem(problem.message);
    }
    this.is_asking = false;
  }

  tick() {
    if (!this.bench) {
      return;
    }
    set_text(this.age, this.page.clock.age_text(this.bench.last_message_utc_ms));
    this.root.classList.toggle("is-stale",
                               this.page.clock.is_stale(this.bench.last_message_utc_ms));
    this.sources.tick();
    this.signals.tick();
  }

  leave() {
    clearInterval(this.timer);
    this.actions.leave();
    this.signals.leave();
    this.step.leave();
  }
}

function first_bench(laboratory) {
  return laboratory?.benches?.[0]?.bench ?? null;
}
