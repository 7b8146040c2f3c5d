/**
 * Text of others (names of benches, messages, files) made fit to be shown: what would be invisible
 * or turn the reading direction of its surroundings stands there as its code point, and what is too
 * long ends in an ellipsis. Markup needs no treatment here: text only ever becomes a text node.
 */

const INVISIBLE = new RegExp(
  "[\\u0000-\\u0008\\u000b-\\u001f\\u007f-\\u009f\\u00ad\\u061c\\u200b-\\u200f\\u2028-\\u202e" +
    "\\u2060-\\u206f\\ufeff\\ufff9-\\ufffb]",
  "g",
);

function code_point(character) {
  return `⟨U+${character.codePointAt(0).toString(16).toUpperCase().padStart(4, "0")}⟩`;
}

/** @param {unknown} text  @returns {string} */
export function visible(text) {
  return String(text ?? "").replace(INVISIBLE, code_point);
}

/** At most `limit` characters; what is left out can be read in a title. */
export function shortened(text, limit = 60) {
  const characters = Array.from(visible(text));
  return characters.length <= limit
    ? characters.join("")
    : characters.slice(0, limit - 1).join("") + "…";
}

/** Only a path below the folder of downloads, on this server; anything else is no link. */
export function download_path(href) {
  try {
    const url = new URL(String(href), window.location.origin);
    const is_own = url.origin === window.location.origin && url.pathname.startsWith("/files/");
    return is_own ? url.pathname + url.search : null;
  } catch {
    return null;
  }
}
