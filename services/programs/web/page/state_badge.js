/**
 * States and severities as a word, a sign and a tone: never the colour alone.
 */

import { element, set_attribute, set_text } from "./element.js";

const STATES = {
  idle: ["○", "stale", "idle"],
  arming: ["◔", "note", "arming"],
  running: ["▶", "note", "running"],
  paused: ["‖", "warning", "paused"],
  done: ["✓", "ok", "done"],
  aborted: ["✕", "error", "aborted"],
  silent: ["◌", "stale", "silent"],
  gone: ["∅", "stale", "not there"],
  unknown: ["?", "stale", "not known"],
  planned: ["○", "note", "planned"],
  open: ["○", "stale", "open"],
  settling: ["◔", "warning", "settling"],
  steady: ["▶", "note", "steady"],
  starting: ["◔", "note", "starting"],
  ended: ["■", "stale", "ended"],
  failed: ["✕", "error", "failed"],
  ok: ["✓", "ok", "ok"],
  note: ["i", "note", "note"],
  warning: ["▲", "warning", "warning"],
  error: ["✕", "error", "error"],
  stale: ["◌", "stale", "stale"],
  waiting: ["◔", "note", "waiting"],
};

const SEVERITIES = ["ok", "note", "stale", "warning", "error"];

export function sign_of(state) {
  return (STATES[state] ?? ["?", "stale", ""])[0];
}

export function tone_of(state) {
  return (STATES[state] ?? ["?", "stale", ""])[1];
}

export function word_of(state) {
  return Object.hasOwn(STATES, state ?? "") ? STATES[state][2] : String(state ?? "not known");
}

/** From 0, nothing to see, to 4, an error; a word that this page does not know counts as 0. */
export function rank_of(severity) {
  return Math.max(0, SEVERITIES.indexOf(severity));
}

export class StateBadge {
  constructor(field) {
    this.sign = element("span", { "aria-hidden": "true" });
    this.word = element("span", { "data-field": field });
    this.root = element("span", { class: "badge" }, this.sign, " ", this.word);
  }

  update(state, word = word_of(state)) {
    set_text(this.sign, sign_of(state));
    set_text(this.word, word);
    set_attribute(this.root, "data-tone", tone_of(state));
  }
}

export function badge(state, word) {
  const made = new StateBadge("state");
  made.update(state, word);
  return made.root;
}
