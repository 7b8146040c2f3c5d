/**
 * A panel of a picture (PROTOCOL.md, figures) as a chart: its axes, units, labels, colours and
 * markers are the description's; nothing is added here but zoom, reading and the click on a point.
 */

import { decade_ticker, frequency_ticker } from "./axis_ticks.js";
import { Chart, place_x, place_y } from "./chart.js";
import { is_number, significant } from "./number_text.js";
import { draw_layer } from "./panel_drawing.js";

const NEAR_PIXELS = 24;

export class PanelChart {
  /**
   * @param {{title?: string, height?: number, on_pick?: (step: number) => void}} description
   *        on_pick: called with the step of the result that was clicked
   */
  constructor({ title = null, height = 250, on_pick = null }) {
    this.on_pick = on_pick;
    this.layers = [];
    this.chart = new Chart({
      title,
      x_label: "",
      height,
      options: {
        customBars: true,
        xRangePad: 0,
        clickCallback: (event) => this.pick(event),
      },
    });
    this.root = this.chart.root;
  }

  /** panel: as the daemon describes it. */
  show(panel) {
    const is_log = { x: panel.x_scale === "logarithmic", y: panel.y_scale === "logarithmic" };
    const layers = layers_of(panel, is_log);
    this.layers = layers;
    const { x_label, y_label } = panel;
    this.chart.show({
      rows: rows_of(layers),
      labels: layers.map((_, i) => `s${i}`),
      x_label,
      y_label,
      summary: summary_of(layers, x_label),
      legend: legend_of(layers),
      read: (x, points) => reading(x, points, layers, panel),
      options: {
        logscale: is_log.y,
        axes: axes_of(is_log, layers),
        series: Object.fromEntries(layers.map((layer, i) => [
          `s${i}`, { color: layer.colour, plotter: (event) => draw_layer(event, layer) }])),
      },
      home: { valueRange: panel.y_range ?? range_of(layers, is_log.y),
              dateWindow: window_of(layers, is_log.x) },
    });
  }

  unzoom() {
    this.chart.unzoom();
  }

  // The nearest point to the click that is the result of a step.
  pick(event) {
    const graph = this.chart.graph;
    if (this.on_pick === null || graph === null) {
      return;
    }
    const box = this.chart.canvas.getBoundingClientRect();
    const [left, top] = [event.clientX - box.left, event.clientY - box.top];
    let [nearest, distance] = [null, NEAR_PIXELS];
    for (const { kind, points } of this.layers) {
      for (const [x, y, , step] of kind === "series" ? points : []) {
        const away = Math.hypot(place_x(graph, x) - left, place_y(graph, y) - top);
        if (step > 0 && away < distance) {
          [nearest, distance] = [step, away];
        }
      }
    }
    if (nearest !== null) {
      this.on_pick(nearest);
    }
  }

  destroy() {
    this.layers = [];
    this.chart.destroy();
  }
}

// In the order in which they are drawn, without points that the axes cannot show.
function layers_of(panel, is_log) {
  const can_show = (value, is_logarithmic) => is_number(value) && (!is_logarithmic || value > 0);
  const shown = (points, xs, ys) => (points ?? []).filter((point) =>
    xs.every((i) => can_show(point[i], is_log.x)) && ys.every((i) => can_show(point[i], is_log.y)));
  const { colour } = panel;
  return [
    { kind: "band", label: panel.band_label, colour, points: shown(panel.band, [0], [1, 2]) },
    { kind: "bars", label: "", colour, points: shown(panel.bars, [0, 1], [2]) },
    { kind: "dots", label: panel.dots_label, colour, points: shown(panel.dots, [0], [1]) },
    ...(panel.series ?? []).map((series) =>
      ({ kind: "series", ...series, points: shown(series.points, [0], [1]) })),
  ].filter(({ points }) => points.length > 0);
}

// What dygraphs is told of a point: x, and [low, y, high].
const CELL = {
  band: ([x, low, high]) => [x, [low, (low + high) / 2, high]],
  bars: ([left, right, height]) => [(left + right) / 2, [height, height, height]],
  dots: ([x, y]) => [x, [y, y, y]],
  series: ([x, y, half]) => [x, [y - (half || 0), y, y + (half || 0)]],
};

// One row for each x, and as many more as a series has points there; where a layer has none, a hole.
function rows_of(layers) {
  const rows = new Map();
  layers.forEach(({ kind, points }, column) => {
    const count = new Map();
    for (const point of points) {
      const [x, values] = CELL[kind](point);
      const before = count.get(x) ?? 0;
      count.set(x, before + 1);
      const key = `${x} ${before}`;
      if (!rows.has(key)) {
        rows.set(key, [x, ...layers.map(() => [null, null, null])]);
      }
      rows.get(key)[column + 1] = values;
    }
  });
  return [...rows.values()].sort((a, b) => a[0] - b[0]);
}

function axes_of(is_log, layers) {
  const plain = window.Dygraph?.numericTicks;
  const measured = layers.filter(({ kind }) => kind === "series")
    .flatMap(({ points }) => points.map(([x]) => x));
  return {
    x: { logscale: is_log.x, ticker: is_log.x ? frequency_ticker(measured) : plain,
         axisLabelFormatter: (x) => significant(x, is_log.x ? 4 : 6) },
    y: { axisLabelWidth: 66, pixelsPerLabel: 26, ticker: is_log.y ? decade_ticker(true) : plain,
         axisLabelFormatter: (y) => significant(y, 6) },
  };
}

function range_of(layers, is_log) {
  let [low, high] = [Infinity, -Infinity];
  for (const { kind, points } of layers) {
    for (const point of points) {
      const [, [bottom, middle, top]] = CELL[kind](point);
      low = Math.min(low, is_log && bottom <= 0 ? middle : bottom);
      high = Math.max(high, top);
    }
  }
  if (low > high) {
    return null;
  }
  if (is_log) {
    const room = low === high ? 1.5 : (high / low) ** 0.07;
    return [low / room, high * room];
  }
  const room = 0.07 * (high - low) || 0.01 * Math.abs(high) || 1;
  return [low - room, high + room];
}

function window_of(layers, is_log) {
  let [first, last] = [Infinity, -Infinity];
  for (const { kind, points } of layers) {
    for (const [x, right] of points) {
      first = Math.min(first, x);
      last = Math.max(last, kind === "bars" ? right : x);
    }
  }
  if (first > last) {
    return null;
  }
  if (is_log) {
    const room = first === last ? 1.5 : (last / first) ** 0.03;
    return [first / room, last * room];
  }
  const room = 0.02 * (last - first) || 0.01 * Math.abs(last) || 1;
  return [first - room, last + room];
}

const SAMPLES = { band: "band", bars: "bar", dots: "dot" };

// Each label once.
function legend_of(layers) {
  const entries = new Map();
  for (const { kind, label, colour, marker, joined, dashes } of layers) {
    if (label && !entries.has(label)) {
      entries.set(label, kind === "series" ? { text: label, colour, marker, joined, dashes }
                                           : { text: label, colour, marker: SAMPLES[kind] });
    }
  }
  return [...entries.values()];
}

function reading(x, points, layers, { x_label, y_label }) {
  const values = points.map(({ name, yval }) => {
    const label = layers[Number(name.slice(1))]?.label;
    return `${label ? `${label}: ` : ""}${significant(yval, 6)}`;
  });
  return `${values.join("; ")} (${y_label}) at ${significant(x, 6)} (${x_label})`;
}

function summary_of(layers, x_label) {
  const range = window_of(layers, false);
  if (range === null) {
    return "no points";
  }
  const count = layers.reduce((sum, { points }) => sum + points.length, 0);
  return `${count} points over ${x_label}`;
}
