/**
 * Numbers as people read them: a value and its uncertainty with the digits that mean something, as
 * services/base/rounding.hpp has them on the terminal, and plain ones with a unit.
 *
 * What is not known (null) is an en dash.
 */

export const UNKNOWN = "–";

export function is_number(value) {
  return typeof value === "number" && Number.isFinite(value);
}

// Two digits at least in the exponent, as on the terminal: 8.1e-06.
function exponential(value, digits) {
  return value.toExponential(digits - 1).replace(/e([+-])(\d)$/, "e$10$2");
}

/**
 * Of a value and its uncertainty, which the daemon rounds (services/base/rounding.hpp): {value, u},
 * null where one is not known.
 * @returns {{value: string, u: string}}
 */
export function rounded_text(text) {
  return {
    value: text?.value ?? UNKNOWN, u: text?.u ?? UNKNOWN, U: text?.U ?? UNKNOWN,
    k: text?.k ?? UNKNOWN,
  };
}

/** So many significant digits, without trailing zeros. */
export function significant(value, digits = 4) {
  if (!is_number(value)) {
    return UNKNOWN;
  }
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e7)) {
    return exponential(Number(value.toPrecision(digits)), digits).replace(/\.?0+e/, "e");
  }
  return String(Number(value.toPrecision(digits)));
}

export function with_unit(value, unit, digits = 4) {
  if (!is_number(value)) {
    return UNKNOWN;
  }
  return unit ? `${significant(value, digits)} ${unit}` : significant(value, digits);
}

/** Counters come as numbers, or as text beyond 2^53: digits in groups of three. */
export function count_text(count) {
  if (count === null || count === undefined || !/^\d+$/.test(String(count))) {
    return UNKNOWN;
  }
  return String(count).replace(/\B(?=(\d{3})+$)/g, "\u202f");
}

const TIME_UNITS = [
  [1, "s"],
  [1e-3, "ms"],
  [1e-6, "µs"],
  [1e-9, "ns"],
];

/** 12.3 µs: seconds in the unit that reads best. */
export function short_time(seconds, digits = 3) {
  if (!is_number(seconds)) {
    return UNKNOWN;
  }
  const size = Math.abs(seconds);
  const [factor, unit] = TIME_UNITS.find(([least]) => size >= least) ?? TIME_UNITS.at(-1);
  return size === 0 ? "0 s" : `${significant(seconds / factor, digits)} ${unit}`;
}

/** 1 h 04 min, 3 min 12 s, 8 s: how long something takes. */
export function duration_text(seconds) {
  if (!is_number(seconds) || seconds < 0) {
    return UNKNOWN;
  }
  const whole = Math.round(seconds);
  const [h, min, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  if (h > 0) {
    return `${h} h ${String(min).padStart(2, "0")} min`;
  }
  return min > 0 ? `${min} min ${String(s).padStart(2, "0")} s` : `${s} s`;
}

export function bytes_text(bytes) {
  if (bytes === null || bytes === undefined || bytes === "" || !Number.isFinite(Number(bytes))) {
    return UNKNOWN;
  }
  const steps = ["B", "kB", "MB", "GB", "TB"];
  const step = Math.min(Math.floor(Math.log10(Math.max(Number(bytes), 1)) / 3), steps.length - 1);
  return `${significant(Number(bytes) / 1000 ** step, 3)} ${steps[step]}`;
}

/** 2026-11-22 23:04:05, UTC as the foot of the page says. */
export function utc_text(utc_ms, with_day = true) {
  if (!is_number(utc_ms) || utc_ms <= 0 || Math.abs(utc_ms) > 8.64e15) {
    return UNKNOWN;
  }
  const text = new Date(utc_ms).toISOString().replace("T", " ").slice(0, 19);
  return with_day ? text : text.slice(11);
}

/** The number itself, every digit: for the title of what was rounded. */
export function full(value, unit = "") {
  return is_number(value) ? `${value}${unit ? ` ${unit}` : ""}` : "not known";
}
