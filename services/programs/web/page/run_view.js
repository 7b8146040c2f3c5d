/**
 * A run: its results as they come, point by point, what they are worth, and what it left on disk.
 */

import { bench_path, get } from "./api.js";
import { BudgetPanel } from "./budget_panel.js";
import { ClockPanel } from "./clock_panel.js";
import { ClosurePanel } from "./closure_panel.js";
import { ComparisonPanel } from "./comparison_panel.js";
import { ConformityPanel } from "./conformity_panel.js";
import { DownloadPanel } from "./download_panel.js";
import { Choice, element, name_element, set_attribute, set_name, set_text } from "./element.js";
import { FlagPanel } from "./flag_panel.js";
import { JournalPanel } from "./journal_panel.js";
import { duration_text, rounded_text, utc_text } from "./number_text.js";
import { ResultTable, table_csv } from "./result_table.js";
import { href_of } from "./route.js";
import { BARS, channels_of, clock_of, flags_of, points_of, transfer_of } from "./run_data.js";
import { RunFigures } from "./run_figures.js";
import { StateBadge } from "./state_badge.js";
import { quantity_in } from "./unit_text.js";

const CURRENT = "";

export class RunView {
  constructor(page, route) {
    this.page = page;
    this.bench = route.bench ?? page.laboratory?.benches?.[0]?.bench ?? null;
    this.asked_run = route.run;
    this.run = null;
    this.state = new StateBadge("state");
    this.heading = name_element(this.bench ?? "no bench yet", 48);
    this.run_name = name_element("", 80);
    this.age = element("p", { class: "age", "data-field": "age" });
    this.note = element("p", { class: "message", "data-field": "message" });
    this.progress = element("p", { class: "quiet", "data-field": "progress" });
    this.delay = element("p", { class: "quiet", "data-field": "group_delay" });
    this.benches = new Choice("Bench", (bench) => this.go(bench, null));
    this.runs = new Choice("Run", (run) => this.go(this.bench, run === CURRENT ? null : run));
    this.channel = new Choice("Channel", () => this.show());
    this.bars = new Choice("Bars", () => this.show_figures());
    this.bars.offer(BARS);
    this.figures = new RunFigures((step) => this.show_budget_of_step(step));
    this.comparison = new ComparisonPanel();
    this.budget = new BudgetPanel();
    this.flags = new FlagPanel();
    this.closures = new ClosurePanel();
    this.conformity = new ConformityPanel();
    this.clock_panel = new ClockPanel(this.figures.clock.root);
    this.table = new ResultTable((point) => this.show_budget(point));
    this.journal = new JournalPanel();
    this.files = new DownloadPanel();
    this.csv = element("button", { type: "button", class: "small", onclick: () => this.save_csv() },
                       "This table as CSV");
    this.root = this.make_root();
    if (this.asked_run !== null) {
      this.ask_once();
    }
  }

  make_root() {
    return element(
      "div", { class: "view", "data-view": "run", "data-bench": this.bench },
      element("div", { class: "view-head" },
              element("h1", {}, "Run ", this.run_name, " of ", this.heading), this.state.root,
              this.age),
      element("div", { class: "tools no-print" }, this.benches.root, this.runs.root,
              this.channel.root, this.bars.root),
      this.note, this.progress, this.delay,
      this.figures.root, this.comparison.root, this.budget.root, this.flags.root, this.closures.root,
      this.conformity.root, this.table.root, this.figures.interferometer_panel,
      this.clock_panel.root, this.journal.root, this.files.root,
    );
  }

  go(bench, run) {
    window.location.hash = href_of("run", bench, run);
  }

  wants() {
    return this.bench ? { bench: this.bench } : {};
  }

  // An earlier run does not change any more.
  async ask_once() {
    try {
      this.take(await get(bench_path(this.bench, "/run"), { run: this.asked_run }));
    } catch (problem) {
      set_text(this.note, `✕ ${problem.message}`);
    }
  }

  receive(name, data) {
    if (name === "laboratory") {
      this.receive_laboratory(data);
    } else if (name === "run" && data.bench === this.bench) {
      if (this.asked_run === null || data.run === this.asked_run) {
        this.take(data);
      }
    }
  }

  receive_laboratory({ benches = [] }) {
    if (this.bench === null && benches.length > 0) {
      window.location.replace(href_of("run", benches[0].bench));
      return;
    }
    this.benches.offer(benches.map(({ bench }) => ({ value: bench, text: bench })), this.bench);
    this.tile = benches.find(({ bench }) => bench === this.bench) ?? null;
    this.show_progress();
    this.tick();
  }

  is_current() {
    return this.tile !== null && this.tile !== undefined && this.run?.run === this.tile.run;
  }

  show_progress() {
    const tile = this.tile;
    if (!tile) {
      return;
    }
    if (this.is_current()) {
      this.state.update(tile.state);
      set_text(this.progress, tile.state === "done" ? `All ${tile.step_count ?? ""} steps are done.`.replace("  ", " ")
        : `Step ${tile.step ?? "–"} of ${tile.step_count ?? "–"}, ` +
        `${tile.frequency_text_hz ? `${tile.frequency_text_hz} Hz, ` : ""}` +
        `${duration_text(tile.time_left_s)} left`);
    } else if (this.run) {
      const listed = (this.run.runs ?? []).find(({ run }) => run === this.run.run);
      this.state.update(this.run.state ?? listed?.state);
      set_text(this.progress, "An earlier run.");
    }
  }

  // Asked once a second, the same answer comes again and again.
  is_known(run) {
    const { generation } = this.page.connection;
    const is_same = this.run?.run === run.run && this.run.number === run.number &&
      this.generation === generation;
    this.generation = generation;
    return is_same;
  }

  take(run) {
    if (this.is_known(run)) {
      return;
    }
    this.run = run;
    set_name(this.run_name, run.run ?? "", 80);
    set_attribute(this.root, "data-number", run.number);
    set_attribute(this.root, "data-run", run.run);
    const earlier = (run.runs ?? []).map(({ run: name, planned_utc_ms }) => ({
      value: name, text: `${name} (${utc_text(planned_utc_ms)})`,
    }));
    this.runs.offer([{ value: CURRENT, text: "current run" }, ...earlier],
                    this.asked_run ?? CURRENT);
    const { names, best } = channels_of(run);
    this.channel.offer(names.map((value) => ({ value, text: value })), best);
    set_name(this.note, run.message ?? "", 300);
    this.show_progress();
    this.show();
    this.tick();
  }

  show() {
    const { run } = this;
    if (!run) {
      return;
    }
    const channel = this.channel.value ?? "";
    const transfer = transfer_of(run, channel);
    const points = points_of(run, channel);
    const unit = transfer?.unit ?? points.find(({ valid }) => valid)?.unit ?? "";
    this.show_figures();
    this.show_delay(transfer);
    const axis = transfer?.points[0]?.excited_axis ?? points[0]?.excited_axis ?? "";
    this.table.update(points, transfer, unit, axis);
    this.comparison.update(this.bench, run, channel);
    this.closures.update(transfer?.closures ?? []);
    this.flags.update(flags_of(run, channel), points);
    this.clock_panel.update(clock_of(run, channel));
    this.conformity.update(run.files);
    this.files.update(run.files, this.csv);
  }

  show_figures() {
    if (this.run) {
      const { run, number } = this.run;
      this.figures.update({ bench: this.bench, run, number, generation: this.generation,
                            channel: this.channel.value, bars: this.bars.value });
    }
  }

  show_delay(transfer) {
    if (!transfer?.text?.group_delay_ms) {
      set_text(this.delay, transfer?.group_delay_problem
        ? `No group delay: ${transfer.group_delay_problem}` : "");
      return;
    }
    const { value, U, k } = rounded_text(transfer.text.group_delay_ms);
    set_text(this.delay, `Group delay ${value} ms (U ${U} ms, k ${k})`);
  }

  show_budget_of_step(step) {
    const point = points_of(this.run, this.channel.value ?? "").find((p) => p.step === step);
    if (point) {
      this.show_budget(point);
    }
  }

  show_budget(point) {
    this.budget.ask(this.bench, this.run.run, point).then(() => {
      this.budget.root.scrollIntoView({ block: "nearest" });
    });
  }

  save_csv() {
    const channel = this.channel.value ?? "";
    const points = points_of(this.run, channel);
    const text = table_csv(points, quantity_in("", points[0]?.unit).trim());
    const url = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
    element("a", { href: url, download: "table.csv" }).click();
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  }

  tick() {
    if (this.run?.run) {
      this.journal.ask(this.bench, this.run.run);
    }
    if (this.tile && this.is_current()) {
      set_text(this.age, this.page.clock.age_text(this.tile.last_message_utc_ms));
      this.root.classList.toggle("is-stale",
                                 this.page.clock.is_stale(this.tile.last_message_utc_ms));
    }
  }

  leave() {
    this.figures.leave();
    this.comparison.leave();
  }
}
