/**
 * Keeps the children of an element in step with a list of things: a child is made once for every
 * key, updated in place and taken away with its thing, so that focus and scroll position survive.
 */

import { visible } from "./foreign_text.js";

export class KeyedList {
  /**
   * @param {Element} parent
   * @param {(thing) => string} key_of
   * @param {(thing) => {root: Element, update: (thing) => void}} make
   */
  constructor(parent, key_of, make) {
    this.parent = parent;
    this.key_of = key_of;
    this.make = make;
    this.rows = new Map();
  }

  update(things) {
    const present = new Set();
    let place = this.parent.firstElementChild;
    for (const thing of things) {
      const key = visible(this.key_of(thing));
      if (present.has(key)) {
        continue;
      }
      present.add(key);
      const row = this.row_of(key, thing);
      row.update(thing);
      if (row.root === place) {
        place = place.nextElementSibling;
      } else {
        this.parent.insertBefore(row.root, place);
      }
    }
    for (const [key, row] of this.rows) {
      if (!present.has(key)) {
        row.root.remove();
        this.rows.delete(key);
      }
    }
  }

  row_of(key, thing) {
    if (!this.rows.has(key)) {
      this.rows.set(key, this.make(thing));
    }
    return this.rows.get(key);
  }
}
