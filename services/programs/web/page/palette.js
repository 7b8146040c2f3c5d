/**
 * Colours and markers of what is drawn: those of services/views/figures/panel.cpp (Okabe and Ito,
 * for any colour vision). What must stand out from the ground (axes, grid, means) takes its colour
 * from the style sheet.
 */

export const SERIES_COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"];
export const MARKERS = ["circle", "square", "triangle", "cross"];

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

const MIN_CONTRAST = 4.5;
const DARK = 0.2; // luminance of a ground

/**
 * A colour of a description on this ground: what is nearly black on paper is the colour of text,
 * lighter grey that of quiet text; others are made lighter on a dark ground until they stand out.
 * null: that of text.
 */
export function colour_on_ground(colour) {
  const parts = parts_of(colour ?? "#000000");
  if (parts === null) {
    return ground_colour("text");
  }
  if (parts[0] === parts[1] && parts[1] === parts[2]) {
    return ground_colour(parts[0] < 0x60 ? "text" : "quiet");
  }
  const ground = luminance(parts_of(ground_colour("card")) ?? [255, 255, 255]);
  let shown = parts;
  for (let white = 0.1; ground < DARK && white < 1 && contrast(shown, ground) < MIN_CONTRAST;
    white += 0.1) {
    shown = parts.map((part) => Math.round(part + white * (255 - part)));
  }
  return `rgb(${shown.join(", ")})`;
}

// Of "#0072B2"; null: it is none.
function parts_of(colour) {
  return /^#[0-9a-f]{6}$/i.test(colour)
    ? [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16)) : null;
}

// Of WCAG 2.
function luminance(parts) {
  const [red, green, blue] = parts.map((part) => part / 255).map((part) =>
    (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

function contrast(parts, ground) {
  return (luminance(parts) + 0.05) / (ground + 0.05);
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
  if (marker === "dot") {
    context.fillStyle = colour;
    context.fill();
  }
  context.stroke();
  context.restore();
}
