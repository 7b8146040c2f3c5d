/**
 * What acts on benches: asked for with a token, which is kept in memory only and forgotten with the
 * page; each action is confirmed, and its answer is shown and read out.
 */

import { bench_path, get, post } from "./api.js";
import { ask } from "./dialog.js";
import { element, set_attribute, set_shown, set_text } from "./element.js";
import { shortened } from "./foreign_text.js";

export class Actions {
  constructor() {
    this.token = null;
    this.is_allowed = false;
    this.panels = new Set();
  }

  /** Whether the daemon takes commands at all. */
  set_allowed(is_allowed) {
    if (is_allowed !== this.is_allowed) {
      this.is_allowed = is_allowed;
      this.show_all();
    }
  }

  show_all() {
    for (const panel of this.panels) {
      panel.show();
    }
  }

  /** A panel of buttons; leave() it with its view. */
  panel(title, buttons) {
    const panel = new ActionPanel(this, title, buttons);
    this.panels.add(panel);
    panel.show();
    return panel;
  }

  /** Asks for the token and lets the daemon judge it. Returns a sentence, or null if all is well. */
  async unlock() {
    const field = element("label", {}, "Token ",
                          element("input", { type: "password", autocomplete: "off", required: true,
                                             spellcheck: "false" }));
    const token = await ask({
      title: "Act on benches",
      lines: ["The token is in the daemon's configuration. It is kept until this page is closed."],
      field,
      yes: "Unlock",
    });
    if (token === null) {
      return "";
    }
    try {
      await get("/api/bench-files", {}, token);
    } catch (problem) {
      return refusal(problem);
    }
    this.token = token;
    this.show_all();
    return null;
  }

  lock() {
    this.token = null;
    this.show_all();
  }

  /** {files, members}: what may be said of a run besides its file. */
  bench_files() {
    return get("/api/bench-files", {}, this.token);
  }

  /** command: {command, step?, run?} */
  command(bench, command) {
    return this.answer(post(bench_path(bench, "/command"), command, this.token));
  }

  /** run: {file, and what `members` of bench_files() names} */
  start(run) {
    return this.answer(post("/api/run", run, this.token));
  }

  async answer(request) {
    try {
      const { answer = "answered", by, message } = await request;
      const who = by ? ` by ${shortened(by, 80)}` : "";
      return { ok: answer !== "refused",
               text: `${answer}${who}${message ? `: ${shortened(message, 300)}` : ""}` };
    } catch (problem) {
      if (problem.status === 401 || problem.status === 403) {
        this.lock();
      }
      return { ok: false, text: refusal(problem) };
    }
  }
}

function refusal(problem) {
  if (problem.status === 429) {
    return "too many wrong tokens: wait a minute and try again";
  }
  return problem.status === 401 ? "the token is not the daemon's" : shortened(problem.message, 300);
}

class ActionPanel {
  /** buttons: [{text, danger?, act: () => Promise<{ok, text}|null>}] */
  constructor(actions, title, buttons) {
    this.actions = actions;
    this.unlock = element("button", { type: "button", onclick: () => this.try_unlock() },
                          "Act with a token …");
    this.lock = element("button", { type: "button", onclick: () => actions.lock() }, "Forget token");
    this.buttons = buttons.map(({ text, danger, act }) =>
      element("button", { type: "button", class: danger ? "danger" : null,
                          onclick: () => this.run(text, act) }, text));
    this.answer = element("p", { class: "answer", role: "status", "aria-live": "polite" });
    this.root = element("section", { class: "actions no-print", "aria-label": title },
                        element("div", { class: "buttons" }, this.unlock, this.buttons, this.lock),
                        this.answer);
  }

  show() {
    const { is_allowed, token } = this.actions;
    set_shown(this.root, is_allowed);
    set_shown(this.unlock, token === null);
    for (const button of [...this.buttons, this.lock]) {
      set_shown(button, token !== null);
    }
  }

  async try_unlock() {
    const problem = await this.actions.unlock();
    this.say(problem === null ? "unlocked" : problem, problem === null || problem === "");
    if (problem === null) {
      this.buttons[0]?.focus();
    }
  }

  async run(text, act) {
    const answer = await act();
    if (answer !== null) {
      this.say(`${text}: ${answer.text}`, answer.ok);
    }
  }

  say(text, is_ok) {
    set_text(this.answer, text === "" ? "" : `${is_ok ? "✓" : "✕"} ${text}`);
    set_attribute(this.answer, "data-tone", is_ok ? "ok" : "error");
  }

  leave() {
    this.actions.panels.delete(this);
  }
}
