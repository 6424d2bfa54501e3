// Panels, the page's own and those of other packages: each is a script whose default export is a class, made with `ask(data)`
// and with a function that lets the headings of further sections fold them.

import { element } from "./dom.js";

export class Panels {
  // `onadd` is given the section of each panel that was made, to place it.
  constructor(ask, onadd) {
    this.ask = ask;
    this.onadd = onadd;
    this.panels = new Map();
  }

  structure({ panels }) {
    for (const name of panels) {
      if (!this.panels.has(name)) this.add(name);
    }
    for (const panel of this.panels.values()) panel?.structure?.();
  }

  // Let those that are shown now ask for data.
  look() {
    for (const panel of this.panels.values()) panel?.look?.();
  }

  async add(name) {
    this.panels.set(name, null); // while its script is loading
    const { default: Panel } = await import(`./files/panel_${name}.js`);
    const panel = new Panel((data) => this.ask("AskPanel", { panel: name, data: JSON.stringify(data) }), this.onadd);
    this.panels.set(name, panel);
    if (!panel.node) return; // a dialog
    // The page's own panels have a place.
    const section = document.querySelector(`[data-panel="${name}"]`) ?? element("section", { class: "group", "data-panel": name });
    section.append(panel.node);
    this.onadd(section);
  }

  // What panels offer to be found: { text, about, run }; they ask for more of it if `asks` is true.
  commands(asks) {
    return [...this.panels.values()].flatMap((panel) => panel?.commands?.(asks) ?? []);
  }

  state({ panels, paused }) {
    for (const [name, panel] of this.panels) {
      if (panel && name in panels) panel.state(panels[name], { paused });
    }
  }
}
