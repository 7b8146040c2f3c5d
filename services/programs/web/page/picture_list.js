/**
 * Pictures as the daemon describes them: each with its title and a chart for every panel. What is
 * shown anew keeps its charts, and their zoom while it is the same picture.
 */

import { element, set_name, set_shown } from "./element.js";
import { PanelChart } from "./panel_chart.js";

export class PictureList {
  /** on_pick: called with the step of a point that was clicked; is_pair: pictures side by side */
  constructor({ on_pick = null, is_pair = false } = {}) {
    this.on_pick = on_pick;
    this.pictures = [];
    this.root = element("div", { class: is_pair ? "pair" : null });
  }

  /** described: pictures of the daemon's answer; the same kinds in the same order each time. */
  show(described) {
    this.pictures.splice(described.length).forEach((picture) => picture.destroy());
    described.forEach((one, index) => {
      if (!this.pictures[index]) {
        this.pictures[index] = new Picture(one, this.on_pick);
        this.root.append(this.pictures[index].root);
      }
      this.pictures[index].show(one);
    });
  }

  destroy() {
    this.show([]);
  }
}

class Picture {
  constructor({ panel_height }, on_pick) {
    this.description = { height: panel_height, on_pick };
    this.name = null;
    this.panels = [];
    this.title = element("h3");
    this.subtitle = element("p", { class: "quiet" });
    this.charts = element("div", { class: "pair" });
    this.root = element("div", { class: "picture" }, this.title, this.subtitle, this.charts);
  }

  show({ name, title, subtitle, panels }) {
    set_name(this.title, title, 100);
    set_name(this.subtitle, subtitle, 300);
    set_shown(this.subtitle, subtitle !== "");
    this.panels.splice(panels.length).forEach((panel) => this.drop(panel));
    panels.forEach((panel, index) => {
      if (!this.panels[index]) {
        this.panels[index] = new PanelChart(this.description);
        this.charts.append(this.panels[index].root);
      } else if (name !== this.name) {
        this.panels[index].unzoom();
      }
      this.panels[index].show(panel);
    });
    this.name = name;
  }

  drop(panel) {
    panel.root.remove();
    panel.destroy();
  }

  destroy() {
    this.panels.forEach((panel) => this.drop(panel));
    this.root.remove();
  }
}
