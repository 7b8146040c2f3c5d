/**
 * Ticks of logarithmic axes, for dygraphs' "ticker": those of frequency at frequencies that were
 * measured, else at third octaves or every third of them (10, 20, 40, 80 ...); others at decades.
 */

import { significant } from "./number_text.js";

const THIRDS = [1, 1.25, 1.6, 2, 2.5, 3.15, 4, 5, 6.3, 8];
const STRIDES = [1, 3, 10]; // of third octaves: all, octaves, decades
const ROOM = 46; // pixels of a label
const LINE_ROOM = 22; // beside a vertical axis
const MOST_MEASURED = 60; // more are no list of somebody's

/** measured: the frequencies of the points. */
export function frequency_ticker(measured) {
  const distinct = [...new Set(measured)].sort((a, b) => a - b);
  return (low, high, pixels, ...others) => {
    const place = (x) => (pixels * Math.log(x / low)) / Math.log(high / low);
    const shown = distinct.filter((x) => x >= low && x <= high);
    const own = shown.length <= MOST_MEASURED ? spread(shown, place) : [];
    return own.length > 1 || shown.length === 1 && distinct.length === 1 ? ticks_of(own)
      : plain_ticks(spread(thirds_between(low, high), place), low, high, pixels, others);
  };
}

/** is_vertical: labels stand beside each other's lines, not beside each other. */
export function decade_ticker(is_vertical) {
  return (low, high, pixels, ...others) => {
    const place = (x) => (pixels * Math.log(x / low)) / Math.log(high / low);
    const room = is_vertical ? LINE_ROOM : ROOM;
    const decades = between(low, high, [1]);
    const chosen = decades.length > 2 ? decades : between(low, high, [1, 2, 5]);
    return plain_ticks(with_room(chosen, place, room), low, high, pixels, others);
  };
}

// A stretch too short for them has the library's.
function plain_ticks(chosen, low, high, pixels, others) {
  return chosen.length > 1 ? ticks_of(chosen)
                           : window.Dygraph.numericTicks(low, high, pixels, ...others);
}

function ticks_of(values) {
  return values.map((v) => ({ v, label: significant(v, 4) }));
}

function between(low, high, mantissas) {
  const decades = [];
  for (let n = Math.floor(Math.log10(low)); n <= Math.ceil(Math.log10(high)); n += 1) {
    decades.push(...mantissas.map((m) => Number((m * 10 ** n).toPrecision(4))));
  }
  return decades.filter((x) => x >= low && x <= high);
}

function thirds_between(low, high) {
  return between(low, high, THIRDS);
}

// Counted from 1 Hz; null: not a third octave.
function number_of_third(x) {
  const decade = Math.floor(Math.log10(x) + 1e-9);
  const place = THIRDS.findIndex((third) => Math.abs(x / (third * 10 ** decade) - 1) < 0.01);
  return place < 0 ? null : 10 * decade + place;
}

function with_room(values, place, room = ROOM) {
  let before = -Infinity;
  return values.filter((x) => {
    const has_room = place(x) - before >= room;
    before = has_room ? place(x) : before;
    return has_room;
  });
}

// All, octaves from 10 Hz, or decades of what are third octaves; else as many as have room.
function spread(values, place) {
  const numbers = values.map(number_of_third);
  const strides = numbers.includes(null) ? [] : STRIDES;
  for (const stride of strides) {
    const chosen = values.filter((_, i) => (numbers[i] - 10) % stride === 0);
    if (chosen.length > 1 && with_room(chosen, place).length === chosen.length) {
      return chosen;
    }
  }
  return with_room(values, place);
}
