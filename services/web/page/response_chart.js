/**
 * Points with error bars over logarithmic frequency, as the transfer function figure of a run's
 * files draws them: means with bars, joined; repetitions apart as markers; flagged points ringed;
 * points without a valid value hollow squares at the edge.
 */

import { Chart, place_x, place_y } from "./chart.js";
import { is_number, significant } from "./number_text.js";
import { draw_marker, FLAGGED_COLOUR, ground_colour } from "./palette.js";

const NEAR_PIXELS = 24;

export class ResponseChart {
  /**
   * @param {{title: string, height?: number, on_pick?: (meta) => void}} description
   */
  constructor({ title, height = 270, on_pick = null }) {
    this.on_pick = on_pick;
    this.series = [];
    this.chart = new Chart({
      title,
      x_label: "frequency in Hz",
      height,
      options: {
        customBars: true,
        clickCallback: (event) => this.pick(event),
        axes: {
          x: { logscale: true, axisLabelFormatter: (x) => significant(x, 4) },
          y: { axisLabelWidth: 66, pixelsPerLabel: 26, axisLabelFormatter: (y) => significant(y, 6) },
        },
      },
    });
    this.root = this.chart.root;
  }

  /**
   * series: [{text, colour, marker, radius, joined, points: [{x, y, half_bar, flagged, meta}]}]
   * colour null: that of text.
   */
  show(series, y_label, summary) {
    const drawn = series.map((one) => ({
      ...one,
      points: one.points.filter((p) => is_number(p.y) && is_number(p.x) && p.x > 0),
    }));
    this.series = drawn.filter((one) => one.points.length > 0);
    const rows = rows_of(this.series);
    this.chart.show({
      rows,
      labels: this.series.map((_, i) => `s${i}`),
      y_label,
      summary,
      legend: this.legend(),
      read: (x, points) => this.reading(x, points, y_label),
      options: {
        series: Object.fromEntries(this.series.map((one, i) => [`s${i}`, this.style(one)])),
      },
      home: { valueRange: range_of(this.series), dateWindow: window_of(rows) },
    });
  }

  style(one) {
    return {
      color: one.colour ?? ground_colour("text"),
      plotter: (event) => draw_series(event, one),
    };
  }

  legend() {
    const entries = this.series.map(({ text, colour, marker, joined }) => ({
      text,
      colour,
      marker: joined && !marker ? "line" : marker,
    }));
    return this.series.some((one) => one.points.some((p) => p.flagged))
      ? [...entries, { text: "flagged, see below", colour: FLAGGED_COLOUR, marker: "circle" }]
      : entries;
  }

  reading(x, points, y_label) {
    const values = points
      .map((p) => `${this.series[Number(p.name.slice(1))]?.text}: ${significant(p.yval, 6)}`)
      .join("; ");
    return `${significant(x, 6)} Hz: ${values} (${y_label})`;
  }

  // The nearest point to the click, of all series.
  pick(event) {
    const graph = this.chart.graph;
    if (this.on_pick === null || graph === null) {
      return;
    }
    const box = this.chart.canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    let [nearest, distance] = [null, NEAR_PIXELS];
    for (const point of this.series.flatMap((one) => one.points)) {
      const [px, py] = [place_x(graph, point.x), place_y(graph, point.y)];
      const away = Math.hypot(px - x, py - y);
      if (point.meta && away < distance) {
        [nearest, distance] = [point.meta, away];
      }
    }
    if (nearest !== null) {
      this.on_pick(nearest);
    }
  }

  destroy() {
    this.chart.destroy();
  }
}


// One row a point, in the order of frequency; series without a point there have a hole.
function rows_of(series) {
  const rows = [];
  series.forEach((one, column) => {
    for (const point of one.points) {
      const row = [point.x, ...series.map(() => [null, null, null])];
      const half = is_number(point.half_bar) ? point.half_bar : 0;
      row[column + 1] = [point.y - half, point.y, point.y + half];
      rows.push(row);
    }
  });
  return rows.sort((a, b) => a[0] - b[0]);
}

function range_of(series) {
  const ends = series.flatMap((one) =>
    one.points.flatMap((p) => [p.y - (p.half_bar ?? 0), p.y + (p.half_bar ?? 0)]));
  if (ends.length === 0) {
    return null;
  }
  const [low, high] = [Math.min(...ends), Math.max(...ends)];
  const room = 0.08 * (high - low) || 0.01 * Math.abs(high) || 1;
  return [low - room, high + room];
}

function window_of(rows) {
  if (rows.length === 0) {
    return null;
  }
  const [first, last] = [rows[0][0], rows.at(-1)[0]];
  const room = first === last ? 1.5 : (last / first) ** 0.03;
  return [first / room, last * room];
}

function draw_series(event, one) {
  const { drawingContext: context, dygraph: graph } = event;
  const colour = one.colour ?? ground_colour("text");
  const places = one.points.map((point) => ({
    point,
    x: place_x(graph, point.x),
    y: place_y(graph, point.y),
    low: place_y(graph, point.y - (point.half_bar ?? 0)),
    high: place_y(graph, point.y + (point.half_bar ?? 0)),
  }));
  context.save();
  context.strokeStyle = colour;
  context.lineWidth = 1.3;
  if (one.joined) {
    context.beginPath();
    places.forEach(({ x, y }, i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
    context.stroke();
  }
  for (const place of places) {
    draw_bar(context, place);
    if (one.marker) {
      draw_marker(context, one.marker, place.x, place.y, one.radius ?? 4, colour);
    }
    if (place.point.flagged) {
      draw_marker(context, "circle", place.x, place.y, 9, FLAGGED_COLOUR);
    }
  }
  context.restore();
}

// A bar with ends; one that would be shorter than a line is wide stays visible by them.
function draw_bar(context, { point, x, low, high }) {
  if (!(point.half_bar > 0)) {
    return;
  }
  context.beginPath();
  context.moveTo(x, low);
  context.lineTo(x, high);
  for (const end of [low, high]) {
    context.moveTo(x - 4, end);
    context.lineTo(x + 4, end);
  }
  context.stroke();
}
