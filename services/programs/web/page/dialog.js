/**
 * A question that waits for an answer: title, sentences, and what is to be filled in. Escape and
 * "Cancel" answer with nothing. Focus returns to where it was.
 */

import { element } from "./element.js";

/**
 * @param {{title: string, lines?: string[], field?: HTMLElement, yes: string, danger?: boolean}}
 *        description  field: a labelled input whose `value` is the answer
 * @returns {Promise<string|null>}  the value, "" without a field; null: cancelled
 */
export function ask({ title, lines = [], field = null, yes, danger = false }) {
  const input = field?.querySelector("input, select") ?? null;
  const before = document.activeElement;
  const heading = element("h2", { id: "dialog-title" }, title);
  const cancel = element("button", { type: "button" }, "Cancel");
  const accept = element("button", { type: "submit", class: danger ? "danger" : "main" }, yes);
  const form = element("form", { method: "dialog" }, heading,
                       lines.map((line) => element("p", {}, line)), field,
                       element("div", { class: "buttons" }, cancel, accept));
  const dialog = element("dialog", { "aria-labelledby": "dialog-title" }, form);
  return new Promise((answer) => {
    let given = null;
    cancel.addEventListener("click", () => dialog.close());
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      given = input === null ? "" : input.value;
      dialog.close();
    });
    dialog.addEventListener("close", () => {
      dialog.remove();
      before?.focus?.();
      answer(given);
    });
    document.body.append(dialog);
    dialog.showModal();
    (input ?? cancel).focus();
  });
}
