/**
 * A signal over time as the smallest and largest value of each column, so that a peak of one sample
 * stays; also plain lines (a fitted sine, a spectrum).
 */

import { decade_ticker } from "./axis_ticks.js";
import { Chart, place_x, place_y } from "./chart.js";
import { is_number, significant } from "./number_text.js";
import { ground_colour, series_colour } from "./palette.js";

export class TraceChart {
  /**
   * @param {{title: string, x_label: string, height?: number, y_log?: boolean,
   *          x_log?: boolean}} description
   */
  constructor({ title, x_label, height = 220, y_log = false, x_log = false }) {
    this.y_log = y_log;
    this.chart = new Chart({
      title,
      x_label,
      height,
      options: {
        customBars: true,
        logscale: y_log,
        xRangePad: 0,
        axes: {
          x: { logscale: x_log, axisLabelFormatter: (x) => significant(x, 6),
               ...(x_log ? { ticker: decade_ticker(false) } : {}) },
          y: { axisLabelWidth: 66, pixelsPerLabel: 26, axisLabelFormatter: (y) => significant(y, 6),
               ...(y_log ? { ticker: decade_ticker(true) } : {}) },
        },
      },
    });
    this.root = this.chart.root;
  }

  /**
   * traces: [{text, colour, points: [[x, low, high]...] or [[x, y]...], gaps: [[x0, x1]...]}]
   * colour null: that of text.
   */
  show(traces, y_label, { summary = "", range = null, x_label = null } = {}) {
    const shown = traces
      .map((trace) => ({ ...trace, points: usable(trace.points ?? [], this.y_log) }))
      .filter((trace) => trace.points.length > 0);
    this.chart.show({
      rows: rows_of(shown),
      labels: shown.map((_, i) => `s${i}`),
      y_label,
      x_label,
      summary,
      legend: shown.length > 1 ? shown.map(legend_of) : [],
      read: (x, points) => reading(x, points, shown, y_label),
      options: {
        series: Object.fromEntries(
          shown.map((trace, i) => [`s${i}`, this.style(trace, i)])),
      },
      home: { valueRange: range ?? range_of(shown, this.y_log) },
    });
  }

  style(trace, index) {
    const colour = () => colour_of(trace, index);
    return { color: colour(), plotter: (event) => draw_trace(event, trace, colour()) };
  }

  destroy() {
    this.chart.destroy();
  }
}

function colour_of(trace, index) {
  return trace.colour === null ? ground_colour("text") : (trace.colour ?? series_colour(index));
}

function legend_of(trace, index) {
  return {
    text: trace.text,
    colour: colour_of(trace, index),
    marker: "line",
  };
}

function usable(points, y_log) {
  return points
    .map((p) => (p.length === 2 ? [p[0], p[1], p[1]] : p))
    .filter(([x, low, high]) =>
      is_number(x) && is_number(low) && is_number(high) && (!y_log || high > 0))
    .map(([x, low, high]) => [x, y_log ? Math.max(low, high * 1e-12) : low, high]);
}

function rows_of(traces) {
  const rows = traces.flatMap((trace, column) =>
    trace.points.map(([x, low, high]) => {
      const row = [x, ...traces.map(() => [null, null, null])];
      row[column + 1] = [low, (low + high) / 2, high];
      return row;
    }));
  return rows.sort((a, b) => a[0] - b[0]);
}

function range_of(traces, y_log) {
  let [low, high] = [Infinity, -Infinity];
  for (const [, l, h] of traces.flatMap((trace) => trace.points)) {
    low = Math.min(low, l);
    high = Math.max(high, h);
  }
  if (low > high) {
    return null;
  }
  if (y_log) {
    return [low / 1.6, high * 1.6];
  }
  const room = 0.07 * (high - low) || 0.01 * Math.abs(high) || 1;
  return [low - room, high + room];
}

function reading(x, points, traces, y_label) {
  const values = points.map(({ name, yval }) => {
    const text = traces[Number(name.slice(1))]?.text;
    return `${text ? `${text}: ` : ""}${significant(yval, 5)}`;
  });
  return `at ${significant(x, 6)}: ${values.join("; ")} (${y_label})`;
}

function is_in_gap(from, to, gaps) {
  return gaps.some(([begin, end]) => from < end && to > begin);
}

// From column to column, each drawn from its smallest to its largest value.
function draw_trace(event, trace, colour) {
  const { drawingContext: context, dygraph: graph } = event;
  context.save();
  context.strokeStyle = colour;
  context.lineWidth = 1.2;
  context.beginPath();
  let before = null;
  for (const [x, low, high] of trace.points) {
    const place = place_x(graph, x);
    const is_joined = before !== null && !is_in_gap(before, x, trace.gaps ?? []);
    context[is_joined ? "lineTo" : "moveTo"](place, place_y(graph, high));
    context.lineTo(place, place_y(graph, low));
    before = x;
  }
  context.stroke();
  context.restore();
}
