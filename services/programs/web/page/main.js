/**
 * The page: shows the view that the address asks for, gives it what the daemon sends, and says in
 * its head whether what is shown is up to date.
 */

import { Actions } from "./actions.js";
import { BenchView } from "./bench_view.js";
import { Connection } from "./connection.js";
import { element, set_attribute, set_shown, set_text } from "./element.js";
import { shortened, visible } from "./foreign_text.js";
import { HistoryView } from "./history_view.js";
import { LaboratoryView } from "./laboratory_view.js";
import { duration_text, utc_text } from "./number_text.js";
import { href_of, parse_route } from "./route.js";
import { RunView } from "./run_view.js";
import { ServerClock } from "./server_clock.js";
import { sign_of, word_of } from "./state_badge.js";

const VIEWS = {
  laboratory: { name: "Laboratory", make: LaboratoryView },
  bench: { name: "Bench", make: BenchView },
  run: { name: "Run", make: RunView },
  history: { name: "History", make: HistoryView },
};

const CONNECTIONS = {
  connecting: ["◔", "warning", "connecting"],
  live: ["●", "ok", "live"],
  polling: ["●", "warning", "live, asked once a second: too many visitors for a stream"],
  lost: ["✕", "error", "connection lost"],
  hidden: ["‖", "stale", "paused while hidden"],
};

const STOPS = ["aborted", "paused", "silent"]; // states of a bench whose run does not go on
const MAX_REASON = 120;

class Page {
  constructor() {
    this.main = document.getElementById("main");
    this.status = document.getElementById("connection");
    this.foot = document.getElementById("foot");
    this.clock = new ServerClock();
    this.laboratory = null;
    this.view = null;
    this.links = new Map();
    this.state = "connecting";
    this.changed_ms = performance.now();
    this.actions = new Actions();
    this.connection = new Connection(
      (name, data) => this.receive(name, data),
      (state) => this.show_connection(state),
    );
    this.make_navigation();
    document.getElementById("skip").addEventListener("click", () => this.main.focus());
    window.addEventListener("hashchange", () => this.show_view());
    this.show_view();
    setInterval(() => this.tick(), 1000);
  }

  make_navigation() {
    const list = element("ul");
    for (const [view, { name }] of Object.entries(VIEWS)) {
      const link = element("a", { href: href_of(view) }, name);
      this.links.set(view, link);
      list.append(element("li", {}, link));
    }
    this.guide = element("li", {}, element("a", { href: "/guide/" }, "Guide"));
    set_shown(this.guide, false); // until the daemon says that it has one
    list.append(this.guide);
    document.getElementById("views").append(list);
  }

  show_view() {
    const route = parse_route(window.location.hash);
    const is_first = this.view === null;
    this.view?.leave();
    this.view = new VIEWS[route.view].make(this, route);
    this.main.replaceChildren(this.view.root);
    for (const [view, link] of this.links) {
      set_attribute(link, "aria-current", view === route.view ? "page" : null);
    }
    this.links.get("bench").href = href_of("bench", route.bench);
    this.links.get("run").href = href_of("run", route.bench);
    this.route = route;
    this.show_title();
    if (!is_first) {
      this.main.focus({ preventScroll: true });
      window.scrollTo(0, 0);
    }
    if (this.laboratory !== null) {
      this.view.receive("laboratory", this.laboratory);
    }
    this.watch();
  }

  /** Views call it when they want to see something else. */
  watch() {
    this.connection.watch(this.view.wants());
  }

  receive(name, data) {
    if (data === null || typeof data !== "object") {
      return;
    }
    this.clock.learn(data.now_utc_ms);
    if (name === "laboratory") {
      this.laboratory = data;
      this.actions.set_allowed(data.may_act === true);
      set_shown(this.guide, data.has_guide === true);
      this.show_foot();
      this.show_title();
    }
    this.view.receive(name, data);
  }

  show_connection(state) {
    if (state !== this.state) {
      this.state = state;
      this.changed_ms = performance.now();
    }
    this.show_status();
  }

  show_status() {
    const [sign, tone, text] = CONNECTIONS[this.state];
    const lasted = (performance.now() - this.changed_ms) / 1000;
    const is_old = this.state === "lost" && this.laboratory !== null;
    const since = is_old ? `, shown is what was ${duration_text(lasted)} ago; trying again` : "";
    set_text(this.status, `${sign} ${text}${since}`);
    set_attribute(this.status, "data-tone", tone);
    set_attribute(this.status, "data-state", this.state);
    document.body.classList.toggle("is-old", this.state === "lost");
  }

  // What stops a run stands first, so that the tab tells it.
  show_title() {
    const { view, bench } = this.route;
    const stopped = (this.laboratory?.benches ?? []).find((one) =>
      STOPS.includes(one.state) && (!bench || one.bench === bench));
    const reason = stopped?.message ? `: ${shortened(stopped.message, MAX_REASON)}` : "";
    const news = stopped ? `${sign_of(stopped.state)} ${shortened(stopped.bench, 48)} ` +
      `${word_of(stopped.state)}${reason} · ` : "";
    const title = `${news}${VIEWS[view].name}${bench ? ` ${bench}` : ""} · dyncal`;
    if (document.title !== title) {
      document.title = title;
    }
  }

  show_foot() {
    const { daemon = {}, software, now_utc_ms } = this.laboratory;
    set_text(this.foot,
             `${software ?? "dyncal"} on ${daemon.host ?? "this machine"}; all times UTC; ` +
             `${daemon.visitors ?? "?"} visitors; ` +
             (Number(daemon.samples_missed ?? 0) > 0 ? `${daemon.samples_missed} samples not seen by this page; ` : "") +
             (daemon.strangers ? `${visible(daemon.strangers)}; ` : "") +
             (daemon.is_open_to_others === true ? "the bench network is not secured; " : "") +
             `state of ${utc_text(now_utc_ms)}`);
  }

  tick() {
    this.show_status();
    this.view.tick();
  }
}

new Page();
