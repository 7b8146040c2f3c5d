/**
 * What a run's answer holds of one channel, ready to be drawn: means, repetitions, deviations from
 * the mean. Phases are lead in rad; repetitions are put into the turn of their mean, as
 * services/report/figures/transfer_function.cpp does.
 */

import { is_number, significant } from "./number_text.js";
import { series_colour, series_marker } from "./palette.js";

const TURN = 2 * Math.PI;
const DEGREES = 180 / Math.PI;

export const BARS = [
  { value: "U", text: "U (95.45 %)" },
  { value: "u", text: "u (k = 1)" },
  { value: "none", text: "none" },
];

/** Channels with results, by name; and the one with the best known values, to be shown first. */
export function channels_of(run) {
  const transfer = (run.transfer ?? []).map((one) => one.channel);
  const points = (run.points ?? []).map((one) => one.channel);
  const names = [...new Set([...transfer, ...points])].sort();
  const clearness = new Map(names.map((name) => [name, clearness_of(run, name)]));
  const best = [...names].sort((a, b) => clearness.get(b) - clearness.get(a))[0] ?? null;
  return { names, best };
}

// Median of |H| / u.
function clearness_of(run, channel) {
  const ratios = valid_points(run, channel).map((p) => p.magnitude / p.u_magnitude)
    .filter(is_number).sort((a, b) => a - b);
  return ratios[Math.floor(ratios.length / 2)] ?? 0;
}

export function points_of(run, channel) {
  return (run.points ?? []).filter((point) => point.channel === channel);
}

function valid_points(run, channel) {
  return points_of(run, channel).filter((p) => p.valid && is_number(p.magnitude));
}

function key_of({ frequency_text_hz, level_m_s2 }) {
  return `${frequency_text_hz} ${level_m_s2}`;
}

function by_frequency(a, b) {
  return a.frequency_hz - b.frequency_hz || a.level_m_s2 - b.level_m_s2;
}

/** Half the length of an error bar. */
export function half_bar(point, quantity, bars) {
  const u = point[quantity === "magnitude" ? "u_magnitude" : "u_phase_rad"];
  const expanded = point[quantity === "magnitude" ? "U_magnitude" : "U_phase_rad"];
  const half = bars === "u" ? u : expanded;
  return bars !== "none" && is_number(half) ? half : 0;
}

/** The run's means, or while it lasts plain means of what there is; is_final tells which. */
export function means_of(run, channel) {
  const transfer = (run.transfer ?? []).find((one) => one.channel === channel);
  if (transfer?.points?.length) {
    const points = transfer.points.map((p) => ({
      ...p,
      shown_phase_rad: is_number(p.unwrapped_phase_rad) ? p.unwrapped_phase_rad : p.phase_rad,
    }));
    return { is_final: true, transfer, points: points.sort(by_frequency) };
  }
  return { is_final: false, transfer: null, points: means_so_far(valid_points(run, channel)) };
}

function means_so_far(points) {
  const groups = new Map();
  for (const point of points) {
    groups.set(key_of(point), [...(groups.get(key_of(point)) ?? []), point]);
  }
  const means = [...groups.values()].map((group) => ({
    frequency_text_hz: group[0].frequency_text_hz,
    frequency_hz: group[0].frequency_hz,
    level_m_s2: group[0].level_m_s2,
    magnitude: mean(group.map((p) => p.magnitude)),
    phase_rad: mean(group.map((p) => in_turn_of(p.phase_rad, group[0].phase_rad))),
    repetitions: group.length,
  })).sort(by_frequency);
  let before = null;
  for (const one of means) {
    one.shown_phase_rad = before === null ? one.phase_rad : in_turn_of(one.phase_rad, before);
    before = one.shown_phase_rad;
  }
  return means;
}

function mean(values) {
  return values.reduce((sum, value) => sum + value, 0) / values.length;
}

function in_turn_of(phase, near) {
  return phase + TURN * Math.round((near - phase) / TURN);
}

/** Valid points of a channel by repetition, each with the mean that it belongs to. */
function repetitions_of(run, channel, means) {
  const mean_of = new Map(means.points.map((one) => [key_of(one), one]));
  const by_repetition = new Map();
  for (const point of valid_points(run, channel).sort(by_frequency)) {
    const group = by_repetition.get(point.repetition) ?? [];
    group.push({ ...point, mean: mean_of.get(key_of(point)) });
    by_repetition.set(point.repetition, group);
  }
  return [...by_repetition].sort(([a], [b]) => a - b);
}

function meta_of({ channel, step, repetition }) {
  return { channel, step, repetition };
}

function series_of_repetitions(run, channel, means, drawn) {
  return repetitions_of(run, channel, means).map(([repetition, points], index) => ({
    text: `#${repetition}`,
    colour: series_colour(index),
    marker: series_marker(index),
    radius: 6 - 1.2 * (index % 3),
    points: points.map((point) => ({
      x: point.frequency_hz,
      flagged: !means.is_final && point.flags?.length > 0,
      meta: meta_of(point),
      ...drawn(point),
    })),
  }));
}

function mean_series(run, channel, means, drawn, text) {
  const points = valid_points(run, channel);
  return {
    text,
    colour: null,
    marker: null,
    joined: true,
    points: means.points.map((point) => {
      const of_mean = points.find((p) => key_of(p) === key_of(point));
      return {
        x: point.frequency_hz,
        flagged: means.is_final && point.flags?.length > 0,
        meta: of_mean ? meta_of(of_mean) : null,
        ...drawn(point),
      };
    }),
  };
}

function mean_name(means, bars) {
  if (!means.is_final) {
    return "mean so far";
  }
  return bars === "none" ? "mean" : `mean ± ${bars}`;
}

/** quantity: "magnitude" or "phase". */
export function response_series(run, channel, means, quantity, bars) {
  const is_magnitude = quantity === "magnitude";
  const repetition_bars = means.is_final ? "none" : bars;
  const of_mean = (p) => ({
    y: is_magnitude ? p.magnitude : p.shown_phase_rad,
    half_bar: means.is_final ? half_bar(p, quantity, bars) : 0,
  });
  const of_point = (p) => ({
    y: is_magnitude ? p.magnitude
                    : in_turn_of(p.phase_rad, p.mean?.shown_phase_rad ?? p.phase_rad),
    half_bar: half_bar(p, quantity, repetition_bars),
  });
  return [mean_series(run, channel, means, of_mean, mean_name(means, bars)),
          ...series_of_repetitions(run, channel, means, of_point)];
}

/** Magnitude in % of the mean, phase in degrees. */
export function deviation_series(run, channel, means, quantity, bars) {
  const is_magnitude = quantity === "magnitude";
  const factor = (p) => (is_magnitude ? 100 / p.magnitude : DEGREES);
  const of_mean = (p) => ({
    y: 0,
    half_bar: means.is_final ? factor(p) * half_bar(p, quantity, bars) : 0,
  });
  const of_point = (p) => ({
    y: !p.mean ? NaN
       : is_magnitude ? 100 * (p.magnitude / p.mean.magnitude - 1)
                      : DEGREES * (in_turn_of(p.phase_rad, p.mean.phase_rad) - p.mean.phase_rad),
    half_bar: means.is_final ? 0 : factor(p) * half_bar(p, quantity, bars),
  });
  return [mean_series(run, channel, means, of_mean, mean_name(means, bars)),
          ...series_of_repetitions(run, channel, means, of_point)];
}

/** Every flag of the channel once, with what it says and what it means. */
export function flags_of(run, channel) {
  const transfer = (run.transfer ?? []).filter((one) => one.channel === channel);
  const clocks = (run.clock ?? []).filter(({ source }) => channel.startsWith(`${source}/`));
  const carriers = [...points_of(run, channel), ...transfer,
                    ...transfer.flatMap((one) => one.points ?? []), ...clocks];
  const by_name = new Map();
  for (const { name, text, meaning } of carriers.flatMap((one) => one.flags ?? [])) {
    const entry = by_name.get(name) ?? { name, meaning, texts: new Set() };
    entry.texts.add(text);
    by_name.set(name, entry);
  }
  return [...by_name.values()];
}

export function summary_of(means, quantity) {
  const { points } = means;
  if (points.length === 0) {
    return "no valid point yet";
  }
  return `${quantity} at ${points.length} frequencies from ` +
    `${significant(points[0].frequency_hz)} Hz to ${significant(points.at(-1).frequency_hz)} Hz`;
}
