/**
 * One signal as it comes: smallest and largest value of every column, the part of its range that it
 * uses, and its spectrum. Freezing keeps what is shown; the daemon goes on.
 */

import { bench_path, get } from "./api.js";
import { split_channel } from "./connection.js";
import { Choice, element, set_attribute, set_shown, set_text } from "./element.js";
import { LevelMeter } from "./level_meter.js";
import { full, is_number, short_time, significant, utc_text, with_unit } from "./number_text.js";
import { TraceChart } from "./trace_chart.js";
import { quantity_in, unit_text } from "./unit_text.js";

const SPECTRUM_EVERY_MS = 2000;
const MAX_COLUMNS = 1000;
const OLD_AFTER_MS = 3000;
const SECONDS = ["1", "2", "5", "10", "30", "60"];

export class SignalPanel {
  /**
   * @param {() => string} bench_of  @param {() => void} on_change  what is wanted has changed
   */
  constructor(page, bench_of, on_change) {
    this.page = page;
    this.bench_of = bench_of;
    this.is_frozen = false;
    this.is_asking = false; // for a spectrum
    this.signal = null;
    this.is_excited = false;
    this.channel = new Choice("Channel", () => this.change(on_change));
    this.seconds = new Choice("Window", () => this.change(on_change));
    this.seconds.offer(SECONDS.map((value) => ({ value, text: `${value} s` })), "2");
    this.freeze = element("button", { type: "button", "aria-pressed": "false",
                                      onclick: () => this.set_frozen(!this.is_frozen) }, "Freeze");
    this.meter = new LevelMeter();
    this.note = element("p", { class: "quiet", "data-field": "signal" });
    this.trace = new TraceChart({ title: "Signal, smallest and largest value of each column",
                                  x_label: "time in s" });
    this.spectrum = new TraceChart({ title: "Amplitude spectrum", x_label: "frequency in Hz",
                                     y_log: true, x_log: true });
    this.spectrum_note = element("p", { class: "quiet", "data-field": "spectrum" });
    this.root = element(
      "section", { class: "panel" },
      element("div", { class: "panel-head" }, element("h2", {}, "Signals"),
              element("div", { class: "tools no-print" }, this.channel.root, this.seconds.root,
                      this.freeze)),
      this.meter.root, this.note,
      element("div", { class: "pair" }, this.trace.root,
              element("div", {}, this.spectrum.root, this.spectrum_note)),
    );
    this.on_change = on_change;
    this.timer = setInterval(() => this.ask_spectrum(), SPECTRUM_EVERY_MS);
  }

  wants() {
    const signal = this.channel.value;
    return signal === null ? {}
                           : { signal, columns: this.columns(), seconds: this.seconds.value };
  }

  // About one a pixel.
  columns() {
    const width = this.trace.chart.canvas.clientWidth || 600;
    return Math.max(100, Math.min(MAX_COLUMNS, Math.round(width / 100) * 100));
  }

  /** The channels of the bench's sources; is_excited: a step is. */
  offer(sources, is_excited) {
    this.is_excited = is_excited;
    const before = this.channel.value;
    const names = sources.flatMap(({ source, channels }) =>
      (channels ?? []).map(({ name }) => `${source}/${name}`));
    this.channel.offer(names.map((value) => ({ value, text: value })));
    if (this.channel.value !== before) {
      this.change(this.on_change);
    }
  }

  change(on_change) {
    this.set_frozen(false);
    this.signal = null;
    this.trace.show([], "");
    this.spectrum.show([], "");
    on_change();
    this.ask_spectrum();
  }

  set_frozen(is_frozen) {
    this.is_frozen = is_frozen;
    set_attribute(this.freeze, "aria-pressed", String(is_frozen));
    set_text(this.freeze, is_frozen ? "Back to live" : "Freeze");
  }

  is_chosen({ source, channel }) {
    return `${source}/${channel}` === this.channel.value;
  }

  receive(signal) {
    if (this.is_frozen || !this.is_chosen(signal)) {
      return;
    }
    if (signal.begin_utc_ms !== this.signal?.begin_utc_ms) {
      this.newer_ms = performance.now(); // not by its UTC, which is by the clock of the source's host
    }
    this.signal = signal;
    // A browser that cannot keep up draws the newest and leaves out those before.
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame(() => this.show(signal));
  }

  show(signal) {
    this.meter.update(signal, this.is_excited);
    const columns = signal.columns ?? [];
    const gaps = signal.gaps ?? [];
    this.trace.show([{ text: "signal", points: columns, gaps }],
                    quantity_in("value", signal.unit), {
      summary: `${columns.length} columns, peak ${with_unit(signal.level_peak, unit_text(signal.unit))}`,
    });
    const lost = gaps.length === 0 ? "no gaps" : `▲ ${gaps.length} ${gaps.length === 1 ? "gap" : "gaps"}, not bridged`;
    set_text(this.note, `${significant(signal.rate_hz, 6)} samples a second; ${lost}; ` +
      `from ${utc_text(signal.begin_utc_ms)} UTC`);
    const newest_s = columns.at(-1)?.[0] ?? null;
    set_attribute(this.root, "data-newest-utc-ms",
                  newest_s === null ? null : signal.begin_utc_ms + 1000 * newest_s);
  }

  async ask_spectrum() {
    const signal = this.channel.value;
    const has_samples = this.signal?.columns?.length > 0;
    if (signal === null || !has_samples || this.is_frozen || this.is_asking || document.hidden) {
      return;
    }
    this.is_asking = true;
    const [source, channel] = split_channel(signal);
    try {
      const answer = await get(bench_path(this.bench_of(), "/spectrum"),
                               { source, channel, seconds: this.seconds.value });
      if (signal === this.channel.value && !this.is_frozen) {
        this.show_spectrum(answer);
      }
    } catch (problem) {
      set_text(this.spectrum_note, `No spectrum: ${problem.message}`);
    }
    this.is_asking = false;
  }

  show_spectrum({ unit, lines, fundamental_hz, amplitude, thd, noise_floor, window,
                  resolution_hz }) {
    this.spectrum.show(
      [{ text: "spectrum", points: (lines ?? []).filter(([f]) => f > 0) }],
      quantity_in("amplitude", unit),
      { summary: `largest at ${with_unit(fundamental_hz, "Hz")}` },
    );
    const short = unit_text(unit);
    set_text(this.spectrum_note,
             `${is_number(thd) ? "Fundamental" : "Nothing is excited; largest line at"} ` +
             `${with_unit(fundamental_hz, "Hz", 6)}, amplitude ${with_unit(amplitude, short)}; ` +
             `${is_number(thd) ? `THD ${significant(100 * thd, 3)} %; ` : ""}noise floor ` +
             `${with_unit(noise_floor, short, 2)} a line; ${window ?? ""} window, resolution ` +
             `${with_unit(resolution_hz, "Hz", 3)}`);
    set_attribute(this.spectrum_note, "title",
                  `fundamental ${full(fundamental_hz, "Hz")}, amplitude ${full(amplitude, short)}, ` +
                  `THD ${full(thd)}, noise floor ${full(noise_floor, short)}`);
  }

  tick() {
    const age = this.signal === null ? 0 : performance.now() - this.newer_ms;
    const is_old = age > OLD_AFTER_MS;
    this.trace.root.classList.toggle("is-stale", is_old && !this.is_frozen);
    set_shown(this.meter.root, this.signal !== null);
    set_text(this.freeze, this.is_frozen ? `Back to live (frozen ${short_time(age / 1000, 2)} ago)`
                                         : "Freeze");
  }

  leave() {
    clearInterval(this.timer);
    cancelAnimationFrame(this.frame);
    this.trace.destroy();
    this.spectrum.destroy();
  }
}
