/**
 * The sample clock of a channel's source: its numbers, and below them its figures.
 */

import { element, set_name, set_shown } from "./element.js";
import {
  count_text, full, is_number, rounded_text, short_time, with_unit,
} from "./number_text.js";

export class ClockPanel {
  /** figures: the element that has them */
  constructor(figures) {
    this.none = element("p", { class: "quiet" },
                        "The intervals of the sample clock come when the run is over.");
    this.text = element("p", { class: "quiet", "data-field": "clock_report" });
    this.root = element("section", { class: "panel", "data-panel": "clock" },
                        element("h2", {}, "Sample clock"), this.none, this.text, figures);
  }

  /** report: null: there is none yet. */
  update(report) {
    set_shown(this.none, report === null);
    set_shown(this.text, report !== null);
    if (report === null) {
      return;
    }
    const u_s = report.u_mean_interval_s;
    const mean = rounded_text(report.text?.mean_interval_us);
    const u_text = is_number(u_s) ? `U ${mean.U} µs, k ${mean.k}` : "u not known";
    set_name(this.text, `${report.source}: mean interval ${mean.value} µs (${u_text}), ` +
      `rate ${with_unit(report.mean_rate_hz, "Hz", 7)}` +
      `${report.nominal_rate_hz > 0 ? ` of ${with_unit(report.nominal_rate_hz, "Hz")} nominal` : ""}` +
      `, sd ${short_time(report.sd_s)}, tick ${short_time(report.tick_s)}, ` +
      `${count_text(report.count)} intervals, ${count_text(report.event_count)} events, ` +
      `${count_text(report.lost)} samples lost`, 400);
    this.text.title = `mean interval ${full(report.mean_interval_s, "s")}, u ` +
      full(report.u_mean_interval_s, "s");
  }
}
