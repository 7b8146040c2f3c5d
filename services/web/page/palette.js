/**
 * Colours and markers of what is drawn: those of services/report/figures/panel.cpp (Okabe and Ito,
 * for any colour vision), the same on light and dark. What must stand out from the ground (axes,
 * grid, means) takes its colour from the style sheet.
 */

export const SERIES_COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"];
export const MARKERS = ["circle", "square", "triangle", "cross"];
export const FLAGGED_COLOUR = "#CC0000";

export function series_colour(index) {
  return SERIES_COLOURS[index % SERIES_COLOURS.length];
}

export function series_marker(index) {
  return MARKERS[index % MARKERS.length];
}

/** A colour of the style sheet, as it is now: light, dark or printed. */
export function ground_colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** Calls back when light and dark change, and before and after printing. */
export function on_ground_change(callback) {
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const print = window.matchMedia("print");
  dark.addEventListener("change", callback);
  print.addEventListener("change", callback);
  return () => {
    dark.removeEventListener("change", callback);
    print.removeEventListener("change", callback);
  };
}

/** Draws a marker of the figures on a canvas. */
export function draw_marker(context, marker, x, y, radius, colour, line_width = 1.6) {
  context.save();
  context.strokeStyle = colour;
  context.lineWidth = line_width;
  context.beginPath();
  if (marker === "square") {
    context.rect(x - 0.85 * radius, y - 0.85 * radius, 1.7 * radius, 1.7 * radius);
  } else if (marker === "triangle") {
    context.moveTo(x, y - radius);
    context.lineTo(x + 0.9 * radius, y + 0.75 * radius);
    context.lineTo(x - 0.9 * radius, y + 0.75 * radius);
    context.closePath();
  } else if (marker === "cross") {
    context.moveTo(x - 0.8 * radius, y - 0.8 * radius);
    context.lineTo(x + 0.8 * radius, y + 0.8 * radius);
    context.moveTo(x + 0.8 * radius, y - 0.8 * radius);
    context.lineTo(x - 0.8 * radius, y + 0.8 * radius);
  } else {
    context.arc(x, y, radius, 0, 2 * Math.PI);
  }
  context.stroke();
  context.restore();
}
