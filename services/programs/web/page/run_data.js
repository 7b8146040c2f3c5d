/**
 * What a run's answer holds of one channel: its points, means and flags, for the table and the
 * panels beside the figures.
 */

import { is_number } from "./number_text.js";

export const BARS = [
  { value: "U", text: "U (95.45 %)" },
  { value: "u", text: "u (k = 1)" },
  { value: "none", text: "none" },
];

/** Channels with results, by name; and the one with the best known values, to be shown first. */
export function channels_of(run) {
  const transfer = (run.transfer_function ?? []).map((one) => one.channel);
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
  return of_channel(run.points, channel);
}

function valid_points(run, channel) {
  return points_of(run, channel).filter((p) => p.valid && is_number(p.magnitude));
}

function by_frequency(a, b) {
  return a.frequency_hz - b.frequency_hz || a.level_m_s2 - b.level_m_s2;
}

function of_channel(list, channel) {
  return (list ?? []).filter((one) => one.channel === channel);
}

/** The run's means of a channel with what belongs to them; null while the run lasts. */
export function transfer_of(run, channel) {
  const points = of_channel(run.transfer_function, channel).sort(by_frequency);
  return points.length ? { ...of_channel(run.channels, channel)[0], points } : null;
}

/** The report of the sample clock of the channel's source; null: there is none yet. */
export function clock_of(run, channel) {
  return (run.sample_clock ?? []).find(({ source }) => channel.startsWith(`${source}/`)) ?? null;
}

/** Every flag of the channel once, with what it says and what it means. */
export function flags_of(run, channel) {
  const clock = clock_of(run, channel);
  const carriers = [...of_channel(run.points, channel), ...of_channel(run.channels, channel),
                    ...of_channel(run.transfer_function, channel), ...(clock ? [clock] : [])];
  const meanings = new Map((run.flag_legend ?? []).map(({ name, meaning }) => [name, meaning]));
  const by_name = new Map();
  for (const { flags, flag_names } of carriers) {
    (flag_names ?? []).forEach((name, i) => {
      const entry = by_name.get(name) ?? { name, meaning: meanings.get(name), texts: new Set() };
      entry.texts.add(flags[i]);
      by_name.set(name, entry);
    });
  }
  return [...by_name.values()];
}
