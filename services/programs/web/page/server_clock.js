/**
 * The server's clock as its answers tell it: ages are differences within one clock, whatever the
 * clock of the browser shows.
 */

import { duration_text, is_number } from "./number_text.js";

export const SILENT_AFTER_MS = 2500;

export class ServerClock {
  constructor() {
    this.offset_ms = null;
  }

  /** Of every answer. */
  learn(now_utc_ms) {
    if (is_number(now_utc_ms)) {
      this.offset_ms = now_utc_ms - performance.now();
    }
  }

  now_utc_ms() {
    return this.offset_ms === null ? null : this.offset_ms + performance.now();
  }

  /** How long ago; null while that is not known. */
  age_ms(utc_ms) {
    const now = this.now_utc_ms();
    return now === null || !is_number(utc_ms) || utc_ms <= 0 ? null : Math.max(0, now - utc_ms);
  }

  is_stale(utc_ms) {
    const age = this.age_ms(utc_ms);
    return age !== null && age > SILENT_AFTER_MS;
  }

  /** "heard just now", "silent for 12 s", "never heard". */
  age_text(utc_ms) {
    const age = this.age_ms(utc_ms);
    if (age === null) {
      return "never heard";
    }
    return age <= SILENT_AFTER_MS ? "heard just now" : `silent for ${duration_text(age / 1000)}`;
  }
}
