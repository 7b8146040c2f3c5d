/**
 * One pair of axes, drawn by dygraphs. Labels, legend and reading stand beside the canvas as text:
 * dygraphs would take its own labels for markup, so it never gets text of others.
 *
 * A chart without data says so. Zoom: drag; back: double click or the button.
 */

import { element, set_attribute, set_name, set_shown, set_text } from "./element.js";
import { colour_on_ground, draw_marker, ground_colour, on_ground_change } from "./palette.js";

const NO_LIBRARY =
  "Charts need dygraphs on the daemon's machine (Debian package libjs-dygraphs); the numbers are " +
  "in the tables.";
const MAX_ROWS = 5000;
const MAX_LABEL = 120;

export class Chart {
  /**
   * @param {{title: string|null, x_label: string, height?: number, options?: object}} description
   *        title null: that of what it is part of; options: what dygraphs is given besides
   */
  constructor({ title, x_label, height = 260, options = {} }) {
    this.title = title;
    this.options = options;
    this.graph = null;
    this.data = null;
    this.is_zoomed = false;
    this.is_left = false;
    this.y_label = element("p", { class: "y-label" });
    this.canvas = element("div", { class: "canvas", role: "img" });
    this.canvas.style.height = `${height}px`;
    this.message = element("p", { class: "no-data" }, "no data yet");
    this.reading = element("output", { class: "reading" });
    this.legend = element("ul", { class: "legend" });
    this.back = element("button", { type: "button", class: "small", onclick: () => this.unzoom() },
                        "Whole range");
    this.back.hidden = true;
    this.x_label = element("p", { class: "x-label" }, x_label);
    this.root = element("figure", { class: "chart" },
                        title === null ? null : element("figcaption", {}, title),
                        element("div", { class: "chart-head" }, this.y_label, this.reading, this.back),
                        element("div", { class: "plot" }, this.canvas, this.message),
                        this.x_label, this.legend);
    this.observer = new ResizeObserver(() => this.fit());
    this.observer.observe(this.canvas);
    this.stop_listening = on_ground_change(() => this.recolour());
  }

  /**
   * data: {rows: [[x, ...y]], labels: [text], y_label, summary, legend: [entry], options, home}
   * labels are the page's own, never text of others; home: {dateWindow, valueRange}, the axes as
   * long as nobody zooms.
   */
  show(data) {
    this.data = { ...data, rows: data.rows.slice(-MAX_ROWS) };
    set_name(this.y_label, data.y_label, MAX_LABEL);
    if (data.x_label) {
      set_name(this.x_label, data.x_label, MAX_LABEL);
    }
    set_attribute(this.canvas, "aria-label",
                  `${this.title ?? data.y_label}: ${data.summary ?? ""}`);
    this.show_legend(data.legend ?? []);
    const is_empty = this.data.rows.length === 0;
    const can_draw = typeof window.Dygraph === "function";
    set_text(this.message, can_draw ? "no data yet" : NO_LIBRARY);
    set_shown(this.message, is_empty || !can_draw);
    if (is_empty || !can_draw) {
      this.clear();
    } else {
      this.draw();
    }
  }

  // Shown for the first time, or in another width.
  fit() {
    if (this.graph !== null) {
      this.graph.resize();
    } else if (this.data?.rows.length > 0 && typeof window.Dygraph === "function") {
      this.draw();
    }
  }

  // What is not laid out has no width to be drawn in: it is drawn when it is shown.
  draw() {
    if (this.is_left || this.canvas.clientWidth === 0) {
      return;
    }
    const changing = {
      file: this.data.rows,
      ...this.colours(),
      ...(this.data.options ?? {}),
      ...(this.is_zoomed ? {} : (this.data.home ?? {})),
    };
    const labels = ["x", ...this.data.labels];
    if (this.graph !== null && this.graph.getLabels().length !== labels.length) {
      this.clear();
    }
    if (this.graph !== null) {
      this.graph.updateOptions({ ...changing, labels });
      return;
    }
    const { file, ...others } = changing;
    this.graph = new window.Dygraph(this.canvas, file, {
      ...this.fixed_options(),
      ...this.options,
      ...others,
      labels,
    });
    this.canvas.graph = this.graph; // for whoever wants to read what is drawn
  }

  fixed_options() {
    return {
      legend: "never",
      labelsUTC: true,
      animatedZooms: false,
      xRangePad: 14,
      axisLabelFontSize: 12,
      highlightCircleSize: 4,
      interactionModel: interaction(),
      zoomCallback: (first, last) => this.note_zoom(first, last),
      highlightCallback: (_event, x, points) => this.read(x, points),
      unhighlightCallback: () => set_text(this.reading, ""),
    };
  }

  colours() {
    return { gridLineColor: ground_colour("grid"), axisLineColor: ground_colour("axis") };
  }

  recolour() {
    this.show_legend(this.data?.legend ?? [], true);
    this.graph?.updateOptions(this.colours());
  }

  read(x, points) {
    set_text(this.reading, this.data?.read?.(x, points) ?? "");
  }

  // A double click gives the range of the data, for which the axes have a home of their own.
  note_zoom(first, last) {
    const [low, high] = this.graph.xAxisExtremes();
    const near = (a, b) => Math.abs(a - b) <= 1e-9 * Math.abs(high - low);
    const is_whole = near(first, low) && near(last, high);
    const [bottom, top] = this.graph.yAxisRange();
    const range = this.data.home?.valueRange;
    const is_tall = !range || (bottom <= range[0] && top >= range[1]);
    if (is_whole && is_tall) {
      this.unzoom();
    } else {
      this.is_zoomed = true;
      set_shown(this.back, true);
    }
  }

  unzoom() {
    this.is_zoomed = false;
    set_shown(this.back, false);
    this.graph?.updateOptions({ dateWindow: null, valueRange: null, ...(this.data.home ?? {}) });
  }

  /** entries: [{text, colour, marker, joined, dashes}]; made anew only when they differ. */
  show_legend(entries, anew = false) {
    const as_text = JSON.stringify(entries);
    if (as_text === this.shown_legend && !anew) {
      return;
    }
    this.shown_legend = as_text;
    this.legend.replaceChildren(
      ...entries.map((entry) => {
        const text = element("span");
        set_name(text, entry.text, MAX_LABEL);
        return element("li", {}, legend_sample(entry), " ", text);
      }),
    );
    set_shown(this.legend, entries.length > 0);
  }

  clear() {
    this.graph?.destroy();
    this.graph = null;
    this.canvas.graph = null;
    this.is_zoomed = false;
    set_shown(this.back, false);
  }

  /** When the view is left: answers that come later draw nothing any more. */
  destroy() {
    this.is_left = true;
    this.observer.disconnect();
    this.stop_listening();
    this.clear();
    this.data = null;
  }
}

/** Where x and y are in the canvas: dygraphs' own toDomXCoord takes every x axis for a linear one. */
export function place_x(graph, x) {
  const { x: left, w: width } = graph.getArea();
  return left + graph.toPercentXCoord(x) * width;
}

export function place_y(graph, y) {
  const { y: top, h: height } = graph.getArea();
  return top + graph.toPercentYCoord(y) * height;
}

function legend_sample({ colour, marker, joined = false, dashes = "" }) {
  const canvas = element("canvas", { width: 44, height: 28, "aria-hidden": "true" });
  const context = canvas.getContext("2d");
  context.scale(2, 2);
  const shown = colour_on_ground(colour);
  context.fillStyle = shown;
  context.strokeStyle = shown;
  if (marker === "bar" || marker === "band") {
    context.globalAlpha = marker === "band" ? 0.5 : 1;
    context.fillRect(2, 3, 18, 8);
    return canvas;
  }
  if (marker === "line" || joined) {
    context.lineWidth = 2;
    context.setLineDash(dash_lengths(dashes));
    context.beginPath();
    context.moveTo(2, 7);
    context.lineTo(20, 7);
    context.stroke();
  }
  if (marker && marker !== "line" && marker !== "none") {
    draw_marker(context, marker, 11, 7, marker === "dot" ? 2 : 4.5, shown);
  }
  return canvas;
}

/** "6 4" as the canvas takes it. */
export function dash_lengths(dashes) {
  return String(dashes ?? "").split(" ").map(Number).filter((length) => length > 0);
}

// A finger scrolls the page, it does not zoom the chart.
function interaction() {
  const whole = window.Dygraph.defaultInteractionModel;
  if (!window.matchMedia("(pointer: coarse)").matches) {
    return whole;
  }
  return Object.fromEntries(Object.entries(whole).filter(([name]) => !name.startsWith("touch")));
}
