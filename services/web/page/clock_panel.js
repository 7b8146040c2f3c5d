/**
 * The sample clock of a source: how often each interval occurred, and how the interval went over
 * the run, smallest to largest of each stretch with its mean.
 */

import { Choice, element, set_name, set_shown } from "./element.js";
import { count_text, full, rounded_by_uncertainty, short_time, with_unit } from "./number_text.js";
import { TraceChart } from "./trace_chart.js";

export class ClockPanel {
  constructor() {
    this.reports = [];
    this.source = new Choice("Source", () => this.show());
    this.none = element("p", { class: "quiet" },
                        "The intervals of the sample clock come when the run is over.");
    this.text = element("p", { class: "quiet", "data-field": "clock_report" });
    this.histogram = new TraceChart({ title: "Interval histogram", kind: "bars", y_log: true,
                                      x_label: "sample interval in µs" });
    this.course = new TraceChart({ title: "Intervals over the run", x_label: "time in s" });
    this.pair = element("div", { class: "pair" }, this.histogram.root, this.course.root);
    this.root = element("section", { class: "panel", "data-panel": "clock" },
                        element("div", { class: "panel-head" }, element("h2", {}, "Sample clock"),
                                element("div", { class: "no-print" }, this.source.root)),
                        this.none, this.text, this.pair);
  }

  update(reports) {
    const as_text = JSON.stringify(reports);
    if (as_text === this.shown) {
      return;
    }
    this.shown = as_text;
    this.reports = reports;
    this.source.offer(reports.map(({ source }) => ({ value: source, text: source })));
    this.show();
  }

  show() {
    const report = this.reports.find(({ source }) => source === this.source.value);
    set_shown(this.source.root, this.reports.length > 1);
    set_shown(this.none, !report);
    set_shown(this.text, Boolean(report));
    set_shown(this.pair, Boolean(report));
    if (!report) {
      return;
    }
    const mean = rounded_by_uncertainty(1e6 * report.mean_interval_s,
                                        1e6 * (report.u_mean_interval_s ?? 0));
    set_name(this.text, `${report.source}: mean interval ${mean.value} µs (u ${mean.u} µs), ` +
      `rate ${with_unit(report.mean_rate_hz, "Hz", 7)}` +
      `${report.nominal_rate_hz > 0 ? ` of ${with_unit(report.nominal_rate_hz, "Hz")} nominal` : ""}` +
      `, sd ${short_time(report.sd_interval_s)}, tick ${short_time(report.tick_s)}, ` +
      `${count_text(report.interval_count)} intervals, ${count_text(report.event_count)} events, ` +
      `${count_text(report.lost)} samples lost`, 400);
    this.text.title = `mean interval ${full(report.mean_interval_s, "s")}, u ` +
      full(report.u_mean_interval_s, "s");
    this.histogram.show(
      [{ text: "count", points: (report.histogram ?? []).map((bin) =>
        [1e-3 * bin.interval_ns, 0.5, Number(bin.interval_count)]) }],
      "count per bin", { summary: `${count_text(report.interval_count)} intervals` });
    const course = (report.over_time ?? []).map((one) =>
      [one.time_s, ...["min", "max", "mean"].map((key) => 1e-3 * one[`${key}_interval_ns`])]);
    this.course.show([
      { text: "smallest to largest", points: course.map(([t, low, high]) => [t, low, high]) },
      { text: "mean", colour: null, points: course.map(([t, , , middle]) => [t, middle]) },
    ], "sample interval in µs");
  }

  leave() {
    this.histogram.destroy();
    this.course.destroy();
  }
}
