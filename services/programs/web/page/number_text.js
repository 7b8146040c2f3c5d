/**
 * Numbers as people read them: a value and its uncertainty with the digits that mean something, as
 * services/views/report/rounding.hpp has them on the terminal, and plain ones with a unit.
 *
 * What is not known (null) is an en dash.
 */

export const UNKNOWN = "–";

const MIN_WITHOUT_EXPONENT = 1e-3; // of the larger of value and u
const MAX_WITHOUT_EXPONENT = 1e7;
const DEGREES = 180 / Math.PI;

export function is_number(value) {
  return typeof value === "number" && Number.isFinite(value);
}

// Of the leading digit once it is rounded to `digits` digits: 0.0996 is 0.10.
function exponent_of(value, digits) {
  const text = value.toExponential(digits - 1);
  return Number(text.slice(text.indexOf("e") + 1));
}

// Two digits at least in the exponent, as on the terminal: 8.1e-06.
function exponential(value, digits) {
  return value.toExponential(digits - 1).replace(/e([+-])(\d)$/, "e$10$2");
}

function round_to_place(value, place) {
  const unit = 10 ** place;
  const rounded = place > 0 ? Math.round(value / unit) * unit : value;
  const text = rounded.toFixed(Math.max(-place, 0));
  return /[1-9]/.test(text) ? text : text.replace("-", ""); // "-0.00" is 0
}

function with_exponent(value, place) {
  if (Math.abs(value) < 0.5 * 10 ** place) {
    return "0";
  }
  const digits_of = (x) => Math.min(Math.max(exponent_of(x, 17) - place + 1, 1), 17);
  const rounded = Number(value.toExponential(digits_of(value) - 1));
  return exponential(rounded, digits_of(rounded));
}

/**
 * u with two significant digits, the value to the same place.
 * @returns {{value: string, u: string}}
 */
export function rounded_by_uncertainty(value, u) {
  if (!is_number(value) || !is_number(u) || u <= 0) {
    return { value: significant(value, 6), u: is_number(u) ? significant(u, 2) : UNKNOWN };
  }
  const place = exponent_of(u, 2) - 1;
  const size = Math.max(Math.abs(value), u);
  if (size < MIN_WITHOUT_EXPONENT || size >= MAX_WITHOUT_EXPONENT) {
    return { value: with_exponent(value, place), u: exponential(u, 2) };
  }
  return {
    value: round_to_place(value, Math.max(place, -17)),
    u: u < 1e-9 ? exponential(u, 2) : round_to_place(u, place),
  };
}

/**
 * In both units, each rounded by its own u, and of one turn: what rounds to -180 degrees is stated as
 * +180 degrees (round_phase() of the same header).
 * @returns {{radians: {value: string, u: string}, degrees: {value: string, u: string}}}
 */
export function rounded_phase(phase_rad, u_rad) {
  const rounded = (phase) => ({
    radians: rounded_by_uncertainty(phase, u_rad),
    degrees: rounded_by_uncertainty(is_number(phase) ? phase * DEGREES : phase,
                                    is_number(u_rad) ? u_rad * DEGREES : u_rad),
  });
  const result = rounded(phase_rad);
  return Number(result.degrees.value) === -180 ? rounded(phase_rad + 2 * Math.PI) : result;
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
