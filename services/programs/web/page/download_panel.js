/**
 * What a run left on the server's disk, to be downloaded; its figures also as pictures: the ones
 * that the files hold, drawn by services/views/figures.
 */

import { element, name_element, set_shown } from "./element.js";
import { download_path } from "./foreign_text.js";
import { bytes_text } from "./number_text.js";

export class DownloadPanel {
  constructor() {
    this.shown = "";
    this.none = element("p", { class: "quiet" }, "No file of this run is on the server's disk.");
    this.list = element("ul", { class: "files" });
    this.figures = element("div", { class: "pair" });
    this.details = element("details", { ontoggle: () => this.show_figures() },
                           element("summary", {}, "Figures as in the files"), this.figures);
    this.root = element("section", { class: "panel no-print", "data-panel": "files" },
                        element("h2", {}, "Downloads"), this.none, this.list, this.details);
  }

  update(files, extra) {
    const usable = (files ?? []).map((file) => ({ ...file, path: download_path(file.href) }))
      .filter(({ path }) => path !== null);
    const as_text = JSON.stringify(usable);
    if (as_text === this.shown) {
      return;
    }
    this.shown = as_text;
    this.pictures = usable.filter(({ name }) => String(name).endsWith(".svg"));
    set_shown(this.none, usable.length === 0);
    set_shown(this.details, this.pictures.length > 0);
    this.list.replaceChildren(
      ...usable.map(({ name, bytes, path }) =>
        element("li", {}, element("a", { href: path, download: "" }, name_element(name, 80)), " ",
                element("span", { class: "quiet" }, bytes_text(bytes)))),
      element("li", {}, extra));
    this.show_figures();
  }

  // Only asked for when they are to be seen.
  show_figures() {
    this.figures.replaceChildren(...(this.details.open ? this.pictures : []).map(({ name, path }) =>
      element("img", { src: path, alt: `figure ${name}`, loading: "lazy", class: "paper" })));
  }
}
