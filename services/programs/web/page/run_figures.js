/**
 * The figures of a run's channel: asked for when the run's results have another number, or another
 * channel or other bars are chosen. One request at a time; an answer that came too late for what is
 * chosen now, or for a view that was left, draws nothing.
 */

import { bench_path, get } from "./api.js";
import { element, set_attribute, set_shown, set_text } from "./element.js";
import { PictureList } from "./picture_list.js";

const RETRY_MS = 2000;
const NOTHING = "There is no result yet.";
const ASKED = "The figures are on their way.";

export class RunFigures {
  /** on_pick: called with the step of a point that was clicked */
  constructor(on_pick) {
    this.wanted = null;
    this.shown = null;
    this.is_asking = false;
    this.is_left = false;
    this.message = element("p", { class: "quiet" }, NOTHING);
    this.response = new PictureList({ on_pick });
    this.clock = new PictureList({ is_pair: true });
    this.interferometer = new PictureList();
    this.interferometer_panel = element("section", { class: "panel",
                                                     "data-panel": "interferometer" },
                                        element("h2", {}, "Interferometer"),
                                        this.interferometer.root);
    set_shown(this.interferometer_panel, false);
    this.root = element("section", { class: "panel", "data-panel": "figures",
                                     "aria-label": "Transfer function" },
                        element("h2", {}, "Transfer function"), this.message, this.response.root);
  }

  /** wanted: {bench, run, number, generation, channel, bars}; channel null: there is none yet. */
  update(wanted) {
    this.wanted = wanted;
    if (wanted.channel === null) {
      this.clear(NOTHING);
    } else if (this.message.textContent === NOTHING) {
      set_text(this.message, ASKED);
    }
    this.ask();
  }

  async ask() {
    const is_needed = this.wanted.channel !== null && !is_same(this.wanted, this.shown);
    if (this.is_asking || this.is_left || !is_needed) {
      return;
    }
    clearTimeout(this.retry);
    this.is_asking = true;
    const asked = this.wanted;
    const { run, channel, bars } = asked;
    let answer = null;
    let problem = null;
    try {
      answer = await get(bench_path(asked.bench, "/figures"), { run, channel, bars });
    } catch (error) {
      problem = error;
    }
    this.is_asking = false;
    if (this.is_left) {
      return;
    }
    if (is_same({ ...asked, number: null }, { ...this.wanted, number: null })) {
      this.take(asked, answer, problem);
    }
    if (asked !== this.wanted) {
      this.ask(); // something else is wanted meanwhile
    }
  }

  take(asked, answer, problem) {
    if (problem !== null) {
      // Rather none than one that does not belong to the table.
      this.clear(`✕ No figures: ${problem.message}`);
      this.retry = setTimeout(() => this.ask(), RETRY_MS);
      return;
    }
    this.shown = asked;
    const pictures = answer.pictures ?? [];
    const named = (...starts) => pictures.filter(({ name }) =>
      starts.some((start) => String(name).startsWith(start)));
    this.response.show(named("transfer-function", "deviation"));
    this.clock.show(named("interval-"));
    this.show_interferometer(named("ellipse"));
    set_shown(this.message, false);
    set_attribute(this.root, "data-number", answer.number);
    set_attribute(this.root, "data-channel", answer.channel);
  }

  show_interferometer(pictures) {
    set_shown(this.interferometer_panel, pictures.length > 0);
    this.interferometer.show(pictures);
  }

  clear(message) {
    this.shown = null;
    this.response.show([]);
    this.clock.show([]);
    this.show_interferometer([]);
    set_text(this.message, message);
    set_shown(this.message, true);
    set_attribute(this.root, "data-number", null);
  }

  leave() {
    this.is_left = true;
    clearTimeout(this.retry);
    this.response.destroy();
    this.clock.destroy();
    this.interferometer.destroy();
  }
}

function is_same(one, other) {
  return other !== null &&
    ["bench", "run", "number", "generation", "channel", "bars"].every((key) =>
      one[key] === other[key]);
}
