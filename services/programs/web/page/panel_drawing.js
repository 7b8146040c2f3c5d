/**
 * Draws what stands in a panel of a picture on a canvas, as services/views/figures/panel.cpp draws
 * it in files: band, bars, dots, then series with lines, error bars and markers.
 */

import { dash_lengths, place_x, place_y } from "./chart.js";
import { colour_on_ground, draw_marker } from "./palette.js";

const CROWDED = 25; // points of a series: more have error bars without ends
const BAND_OPACITY = 0.25;
const MAX_DOTS_OPAQUE = 500;

/** layer: {kind: "band"|"bars"|"dots"|"series", ...}, as layers_of makes it. */
export function draw_layer(event, layer) {
  const { drawingContext: context, dygraph: graph, plotArea: area } = event;
  context.save();
  const colour = colour_on_ground(layer.colour);
  context.strokeStyle = colour;
  context.fillStyle = colour;
  DRAW[layer.kind](context, graph, layer, { colour, bottom: area.y + area.h });
  context.restore();
}

const DRAW = { band: draw_band, bars: draw_bars, dots: draw_dots, series: draw_series };

function draw_band(context, graph, { points }) {
  const corner = (x, y, index) => {
    context[index === 0 ? "moveTo" : "lineTo"](place_x(graph, x), place_y(graph, y));
  };
  context.beginPath();
  points.forEach(([x, , high], index) => corner(x, high, index));
  [...points].reverse().forEach(([x, low]) => corner(x, low, 1));
  context.closePath();
  context.globalAlpha = BAND_OPACITY;
  context.fill();
  context.globalAlpha = 1; // the outline keeps a single narrow spike visible
  context.lineWidth = 0.8;
  context.stroke();
}

function draw_bars(context, graph, { points }, { bottom }) {
  for (const [left, right, height] of points) {
    const [from, to] = [place_x(graph, left), place_x(graph, right)];
    const top = place_y(graph, height);
    context.fillRect(from, top, Math.max(to - from - (to - from > 4 ? 0.7 : 0), 0.7), bottom - top);
  }
}

function draw_dots(context, graph, { points }) {
  context.globalAlpha = points.length > MAX_DOTS_OPAQUE ? 0.5 : 0.8;
  for (const [x, y] of points) {
    context.beginPath();
    context.arc(place_x(graph, x), place_y(graph, y), 1.2, 0, 2 * Math.PI);
    context.fill();
  }
}

function draw_series(context, graph, series, { colour }) {
  const { points, marker, radius, joined } = series;
  if (joined) {
    draw_line(context, graph, series);
  }
  context.lineWidth = 1;
  for (const point of points) {
    draw_error_bar(context, graph, point, points.length > CROWDED);
  }
  if (marker !== "none") {
    for (const [x, y] of points) {
      draw_marker(context, marker, place_x(graph, x), place_y(graph, y), radius, colour);
    }
  }
}

function draw_line(context, graph, { points, dashes, line_width }) {
  context.lineWidth = line_width;
  context.setLineDash(dash_lengths(dashes));
  context.beginPath();
  points.forEach(([x, y], index) => {
    context[index === 0 ? "moveTo" : "lineTo"](place_x(graph, x), place_y(graph, y));
  });
  context.stroke();
  context.setLineDash([]);
}

// One that would be shorter than a line is wide stays visible by its ends.
function draw_error_bar(context, graph, [x, y, half], is_crowded) {
  if (!(half > 0)) {
    return;
  }
  const [place, low, high] = [place_x(graph, x), place_y(graph, y - half), place_y(graph, y + half)];
  if (!Number.isFinite(low)) {
    return; // below zero on a logarithmic axis
  }
  context.globalAlpha = is_crowded ? 0.6 : 1;
  context.beginPath();
  context.moveTo(place, low);
  context.lineTo(place, high);
  for (const end of is_crowded ? [] : [low, high]) {
    context.moveTo(place - 3, end);
    context.lineTo(place + 3, end);
  }
  context.stroke();
  context.globalAlpha = 1;
}
