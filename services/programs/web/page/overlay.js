/**
 * Transfer functions of several runs laid over each other, in the form in which the daemon describes
 * the figures of a run.
 */

import { significant } from "./number_text.js";
import { series_colour, series_marker } from "./palette.js";

/**
 * One panel for PanelChart. runs: [{name, index, is_joined, points}], index: of colour and marker;
 * quantity: "magnitude" or "phase".
 */
export function overlay_panel(runs, quantity, y_label) {
  const series = runs.flatMap(({ name, index, is_joined = true, points }) =>
    lines_of(points).map((line, i) => ({
      label: `${name}${line.name}`,
      colour: series_colour(index),
      marker: series_marker(index + i),
      radius: 6 - 1.2 * (index % 3),
      joined: is_joined,
      line_width: 1.3,
      points: line.points.map((p) => (quantity === "magnitude"
        ? [p.frequency_hz, p.magnitude, p.U_magnitude ?? 0]
        : [p.frequency_hz, p.unwrapped_phase_rad ?? p.phase_rad, p.U_phase_rad ?? 0]))
        .sort((a, b) => a[0] - b[0]),
    })));
  return over_frequency(series, `${y_label}, bars: U`);
}

export function over_frequency(series, y_label) {
  return { x_label: "frequency in Hz", y_label, x_scale: "logarithmic", y_scale: "linear",
           y_range: null, series };
}

// Points as lines: one, or one a level where a frequency has several levels.
function lines_of(points) {
  const levels = [...new Set(points.map((p) => p.level_m_s2))].sort((a, b) => a - b);
  const frequencies = new Set(points.map((p) => p.frequency_hz));
  const places = new Set(points.map((p) => `${p.frequency_hz} ${p.level_m_s2}`));
  return places.size === frequencies.size ? [{ name: "", points }] : levels.map((level) => ({
    name: `, ${significant(level)} m/s²`, points: points.filter((p) => p.level_m_s2 === level),
  }));
}
