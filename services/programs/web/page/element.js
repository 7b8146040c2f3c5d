/**
 * Builds elements of the page. Strings become text nodes, so that no text can become markup; this
 * is the only way in which the page makes elements.
 */

import { shortened, visible } from "./foreign_text.js";

/**
 * element("p", {class: "note", onclick: act}, "text", other_element)
 * Attributes: "on..." is a listener, true an attribute without a value, false and null none.
 */
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) {
      made.addEventListener(key.slice(2), value);
    } else if (value !== null && value !== undefined && value !== false) {
      made.setAttribute(key, value === true ? "" : visible(value));
    }
  }
  append(made, children);
  return made;
}

function append(parent, children) {
  for (const child of children.flat()) {
    if (child instanceof Node) {
      parent.append(child);
    } else if (child !== null && child !== undefined && child !== false) {
      parent.append(document.createTextNode(visible(child)));
    }
  }
}

/** Sets the text only where it differs, so that screen readers and selections are left alone. */
export function set_text(node, text) {
  const shown = visible(text);
  if (node.textContent !== shown) {
    node.textContent = shown;
  }
}

/** Text that may be long: shortened, whole in the title. */
export function set_name(node, text, limit = 60) {
  set_text(node, shortened(text, limit));
  set_attribute(node, "title", shortened(text, limit) === visible(text) ? null : text);
}

export function name_element(text, limit = 60) {
  const made = element("bdi");
  set_name(made, text, limit);
  return made;
}

export function set_attribute(node, key, value) {
  if (value === null || value === undefined || value === false) {
    node.removeAttribute(key);
  } else if (node.getAttribute(key) !== visible(value)) {
    node.setAttribute(key, visible(value));
  }
}

export function set_shown(node, is_shown) {
  if (node.hidden === is_shown) {
    node.hidden = !is_shown;
  }
}

/** A table that scrolls in itself, so that the page never scrolls sideways. */
export function table_in_scroll(label, headings) {
  const body = element("tbody");
  const head = element("thead", {}, element("tr", {}, headings.map(heading_cell)));
  const root = element(
    "div",
    { class: "scroll", tabindex: "0", role: "region", "aria-label": label },
    element("table", {}, element("caption", { class: "only-read" }, label), head, body),
  );
  return { root, body, head };
}

function heading_cell(heading) {
  const { text, number = false, title = null } =
    typeof heading === "string" ? { text: heading } : heading;
  return element("th", { scope: "col", class: number ? "number" : null, title }, text);
}

/** A select whose choices are replaced without losing what is chosen. */
export class Choice {
  constructor(label, on_change) {
    this.select = element("select", {
      onchange: () => {
        this.wanted = this.select.value;
        on_change(this.select.value);
      },
    });
    this.root = element("label", { class: "choice" }, label, " ", this.select);
    this.wanted = null;
    this.shown = "";
  }

  get value() {
    return this.select.value || null;
  }

  /** choices: [{value, text}]; what is chosen stays while it is there; at first it is `preferred`. */
  offer(choices, preferred = null) {
    const as_text = JSON.stringify(choices);
    const before = this.value;
    if (as_text !== this.shown) {
      this.shown = as_text;
      this.select.replaceChildren(
        ...choices.map(({ value, text }) => element("option", { value }, shortened(text, 48))),
      );
    }
    const want = this.wanted ?? before ?? preferred;
    if (want !== null && this.select.value !== want && choices.some((c) => c.value === want)) {
      this.select.value = want;
    }
  }
}
