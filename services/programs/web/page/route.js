/**
 * Which view is asked for, in the part of the address behind "#": the server never sees it.
 *
 *   #/                    laboratory
 *   #/bench/NAME          a bench; without a name the first one
 *   #/run/NAME/RUN        a run; without RUN the current one of the bench
 *   #/history/SENSOR      earlier runs of a sensor
 */

const VIEWS = ["laboratory", "bench", "run", "history"];

function decoded(part) {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

export function parse_route(hash) {
  const [, view = "", first = null, second = null] = hash
    .replace(/^#/, "")
    .split("/")
    .map(decoded);
  const named = VIEWS.includes(view) ? view : "laboratory";
  if (named === "history") {
    return { view: named, sensor: first || null };
  }
  return { view: named, bench: first || null, run: named === "run" ? second || null : null };
}

export function href_of(view, ...names) {
  const known = names.filter((name) => name !== null && name !== undefined && name !== "");
  return `#/${[view, ...known.map(encodeURIComponent)].join("/")}`;
}
