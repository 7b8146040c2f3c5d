/**
 * The action that starts a run from one of the bench files that lie on the server.
 */

import { ask } from "./dialog.js";
import { element } from "./element.js";
import { shortened } from "./foreign_text.js";

// Of members of a run.
const LABELS = {
  run: "Name of the run (empty: the time) ", operator: "Operator ", comment: "Comment ",
  sensor: "Sensor, serial number in the library ",
};
const MAX_TEXT = 200;

/** A button for ActionPanel. */
export function start_button(actions) {
  return { text: "Start a run …", act: () => choose_and_start(actions) };
}

async function choose_and_start(actions) {
  let files;
  let members;
  try {
    ({ files = [], members = [] } = await actions.bench_files());
  } catch (problem) {
    return { ok: false, text: problem.message };
  }
  if (files.length === 0) {
    return { ok: false, text: "there is no bench file in the daemon's folder" };
  }
  const select = element("select", {}, files.map((file) =>
    element("option", { value: name_of(file) }, label_of(file))));
  const inputs = members.filter((name) => Object.hasOwn(LABELS, name)).map((name) =>
    element("input", { type: "text", name, autocomplete: "off", maxlength: MAX_TEXT }));
  const file = await ask({
    title: "Start a run",
    lines: ["The bench's exciter will move: nobody may be working on it."],
    field: element("div", { class: "fields" }, element("label", {}, "Bench file ", select),
                   inputs.map((input) => element("label", {}, LABELS[input.name], input))),
    yes: "Start the run",
    danger: true,
  });
  const said = inputs.map(({ name, value }) => [name, value.trim()]).filter(([, text]) => text);
  return file === null ? null : actions.start({ file, ...Object.fromEntries(said) });
}

function name_of(file) {
  return typeof file === "string" ? file : (file.file ?? file.name);
}

function label_of(file) {
  const bench = typeof file === "string" ? null : file.bench;
  return shortened(bench ? `${name_of(file)} (bench ${bench})` : name_of(file), 80);
}
