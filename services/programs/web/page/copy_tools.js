/**
 * A table as text for spreadsheets: a line a row, cells between tabs, values and uncertainties in
 * cells of their own as the table shows them. Numbers have a decimal point, or the sign that this
 * browser's language has, if that is asked for.
 */

import { element, set_text } from "./element.js";

/** To be put beside a table of table_in_scroll(). */
export function copy_tools(scroll) {
  const sign = decimal_sign();
  const box = element("input", { type: "checkbox" });
  const said = element("span", { role: "status", class: "quiet" });
  const button = element("button", { type: "button", class: "small", onclick: () => {
    const text = table_text(scroll.querySelector("table"), box.checked ? sign : ".");
    set_text(said, copy(text) ? "copied" : "this browser does not copy: select the table");
  } }, "Copy table");
  const choice = sign === "." ? null
    : element("label", {}, box, ` numbers with “${sign}”`);
  return element("p", { class: "tools no-print" }, button, choice, said);
}

function decimal_sign() {
  const parts = new Intl.NumberFormat().formatToParts(1.5);
  return parts.find(({ type }) => type === "decimal")?.value ?? ".";
}

/** Without columns of buttons. */
export function table_text(table, sign = ".") {
  const rows = [...table.rows].filter((row) => !row.closest("[hidden]"));
  const width = rows.map((row) => [...row.cells].findIndex((cell) => cell.querySelector("button")))
    .find((column) => column >= 0);
  return rows.map((row) => [...row.cells].filter((_, column) => column !== width)
    .map((cell) => cell_text(cell, sign)).join("\t")).join("\n") + "\n";
}

function cell_text(cell, sign) {
  const text = cell.textContent.replace(/\s/g, " ").trim();
  return cell.tagName === "TD" && cell.classList.contains("number")
    || cell.getAttribute("scope") === "row" && cell.classList.contains("number")
    ? text.replace(/(\d) (?=\d)/g, "$1").replace(".", sign) : text;
}

// Also where the page comes without encryption, and navigator.clipboard is not there.
function copy(text) {
  let is_done = false;
  document.addEventListener("copy", (event) => {
    event.clipboardData.setData("text/plain", text);
    event.preventDefault();
    is_done = true;
  }, { once: true, capture: true });
  return document.execCommand("copy") && is_done;
}
