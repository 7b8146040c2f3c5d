/**
 * What was flagged, what it says and what it means: nobody has to look it up elsewhere. Also the
 * steps that have no result, with the reason.
 */

import { element, name_element, set_shown } from "./element.js";

export class FlagPanel {
  constructor() {
    this.none = element("p", { class: "quiet" }, "✓ Nothing is flagged, every step has a result.");
    this.list = element("dl", { class: "flags" });
    this.problems = element("ul", { class: "problems" });
    this.shown = "";
    this.root = element("section", { class: "panel", "data-panel": "flags" },
                        element("h2", {}, "Flags"), this.none, this.list, this.problems);
  }

  update(flags, points) {
    const problems = points.filter(({ valid }) => !valid).map((p) =>
      `✕ step ${p.step}, ${p.frequency_text_hz} Hz, repetition ${p.repetition}: ` +
      `${p.problem || "no result"}`);
    const entries = flags.map(({ name, texts, meaning }) => [name, sentences(texts), meaning ?? ""]);
    const as_text = JSON.stringify([entries, problems]);
    if (as_text === this.shown) {
      return;
    }
    this.shown = as_text;
    set_shown(this.none, entries.length + problems.length === 0);
    this.list.replaceChildren(...entries.flatMap(([name, text, meaning]) => [
      element("dt", {}, "▲ ", name_element(name, 48)),
      element("dd", {}, element("span", { class: "flag-text" }, name_element(text, 400)), ": ",
              name_element(meaning, 600)),
    ]));
    this.problems.replaceChildren(...problems.slice(0, 100).map((text) =>
      element("li", {}, name_element(text, 300))));
  }
}

// As the terminal has them: three, and how many more.
function sentences(texts) {
  const all = [...texts];
  return all.length <= 3 ? all.join("; ")
                         : `${all.slice(0, 3).join("; ")}; and ${all.length - 3} more`;
}
