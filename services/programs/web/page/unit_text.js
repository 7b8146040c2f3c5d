/**
 * Units of the contract (D-SI) as people read them, the short forms of services/contract/unit.cpp
 * with real exponents: \metre\second\tothe{-2} is m/s².
 */

const SHORT_FORMS = new Map([
  ["\\metre\\second\\tothe{-2}", "m/s²"],
  ["\\metre\\second\\tothe{-1}", "m/s"],
  ["\\radian\\second\\tothe{-1}", "rad/s"],
  ["\\radian", "rad"],
  ["\\metre", "m"],
  ["\\second", "s"],
  ["\\hertz", "Hz"],
  ["\\volt", "V"],
  ["\\milli\\volt", "mV"],
  ["\\pascal", "Pa"],
  ["\\newton", "N"],
  ["\\newton\\metre", "N m"],
  ["\\micro\\tesla", "µT"],
  ["\\degreecelsius", "°C"],
  ["\\kelvin", "K"],
  ["\\degree", "°"],
  ["\\degree\\second\\tothe{-1}", "°/s"],
  ["\\percent", "%"],
  ["m/s^2", "m/s²"],
  ["degC", "°C"],
  ["uT", "µT"],
]);

const ONE = ["\\one", "1"];

/** The short form; empty for the unit one and for one that is not known. */
export function unit_text(unit) {
  const text = String(unit ?? "");
  return ONE.includes(text) ? "" : (SHORT_FORMS.get(text) ?? with_signs(text));
}

// Units of what has no name of its own: "(uT)/(m/s^2)" is (µT)/(m/s²).
function with_signs(text) {
  return text.replace(/\^2(?!\d)/g, "²").replace(/\buT\b/g, "µT").replace(/\bdegC\b/g, "°C");
}

/** For an axis, as the figures of files have it: "magnitude in V", "magnitude". */
export function quantity_in(quantity, unit) {
  const short = unit_text(unit);
  if (short) {
    return `${quantity} in ${short}`;
  }
  return ONE.includes(String(unit)) ? `${quantity} (unit one)` : quantity;
}
