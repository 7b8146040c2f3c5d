/**
 * What of a channel's range a signal uses: a bar, a percentage and a word. Above 95 % of the range
 * is an overload; below 1 % the resolution of the channel is wasted, but for one that is idle.
 */

import { element, set_attribute, set_text } from "./element.js";
import { count_text, full, is_number, significant, UNKNOWN, with_unit } from "./number_text.js";
import { unit_text } from "./unit_text.js";

export const OVERLOAD = 0.95;
const UNDERLOAD = 0.01;

/** Both ends are the same, or missing, where the range is not known. */
export function has_range({ minimum, maximum }) {
  return is_number(minimum) && is_number(maximum) && maximum > minimum;
}

/** Part of the range that is used, from 0; null where that is not known. */
export function range_use(channel) {
  const { level_peak, minimum, maximum } = channel;
  return is_number(level_peak) && has_range(channel)
    ? Math.abs(level_peak) / Math.max(Math.abs(minimum), Math.abs(maximum)) : null;
}

/** [tone, word] of it; is_excited: something is to be seen. */
export function judge_use(use, over_range, is_excited) {
  if (over_range > 0 || (use !== null && use > OVERLOAD)) {
    return ["error", "✕ overload"];
  }
  if (use === null) {
    return ["stale", "range not known"];
  }
  if (use >= UNDERLOAD) {
    return ["ok", "✓ in range"];
  }
  return is_excited ? ["warning", "▲ underload"] : ["stale", "○ quiet"];
}

export class LevelMeter {
  constructor() {
    this.bar = element("span", { class: "meter-bar" });
    this.meter = element("span", { class: "meter", role: "meter", "aria-valuemin": 0,
                                   "aria-valuemax": 100, "aria-label": "part of the range used" },
                         this.bar);
    this.text = element("span", { "data-field": "level" });
    this.root = element("p", { class: "level" }, this.meter, " ", this.text);
  }

  update(channel, is_excited) {
    const { level_peak, level_rms, minimum, maximum, over_range, unit } = channel;
    const use = range_use(channel);
    const [tone, word] = judge_use(use, over_range, is_excited);
    const percent = use === null ? 0 : Math.min(100, 100 * use);
    const short = unit_text(unit);
    this.bar.style.width = `${percent.toFixed(1)}%`;
    set_attribute(this.meter, "aria-valuenow", percent.toFixed(1));
    set_attribute(this.root, "data-tone", tone);
    const part = use === null ? "" : ` (${significant(100 * use, 3)} % of the range)`;
    const range = has_range(channel)
      ? `${significant(minimum)} to ${with_unit(maximum, short)}` : UNKNOWN;
    set_text(this.text, `${word}: peak ${with_unit(level_peak, short)}${part}, ` +
      `rms ${with_unit(level_rms, short)}; range ${range}` +
      (over_range > 0 ? `; ${count_text(Number(over_range))} samples at its ends` : ""));
    set_attribute(this.text, "title", `peak ${full(level_peak, short)}, rms ${full(level_rms, short)}`);
  }
}
