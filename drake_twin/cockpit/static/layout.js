// The shape of the page: the side panel's width, side and tab, which of its groups are folded. A browser keeps them (kept.js).

import { $, element } from "./dom.js";
import { keep, kept } from "./kept.js";
import { OTHERS, Tabs } from "./tabs.js";

const USUAL = 372; // px
const ENDS = [300, 1200]; // px; the scene keeps some room, too (page.css)
const FILTERS = ["robots-filter", "messages-search"];
const STEP = 20; // px that a key moves the edge

export class Layout {
  // `onchoose` is called when another tab is shown.
  constructor(onchoose) {
    this.edge = element("div", { class: "edge", role: "separator", tabindex: 0, "aria-orientation": "vertical", "aria-label": "Width of the controls", title: "Drag, or press the left and right arrow; double click for the usual width" });
    $("panel").before(this.edge);
    this.edge.addEventListener("pointerdown", (event) => {
      this.edge.setPointerCapture(event.pointerId);
      document.body.classList.add("resizing"); // so that the scene's frame does not take the pointer
    });
    this.edge.addEventListener("pointermove", (event) => {
      if (this.edge.hasPointerCapture(event.pointerId)) this.setWidth(this.isLeft ? event.clientX : innerWidth - event.clientX);
    });
    this.edge.addEventListener("lostpointercapture", () => {
      document.body.classList.remove("resizing");
      keep({ width: this.width });
    });
    this.edge.addEventListener("dblclick", () => this.resize(USUAL));
    this.edge.addEventListener("keydown", (event) => {
      const step = this.isLeft ? -STEP : STEP;
      const widths = { ArrowLeft: this.width + step, ArrowRight: this.width - step, Home: USUAL };
      if (!(event.key in widths)) return;
      event.preventDefault();
      event.stopPropagation();
      this.resize(widths[event.key]);
    });
    this.tabs = new Tabs((tab) => {
      keep({ tab });
      onchoose();
    });
    this.folds = [];
    $("panel-side").addEventListener("click", () => {
      this.setSide(this.isLeft ? "right" : "left");
      keep({ side: this.isLeft ? "left" : "right" });
    });
    for (const id of FILTERS) $(id)?.addEventListener("input", ({ target }) => keep({ [id]: target.value }));
    $("panel").addEventListener("reveal", ({ target }) => this.show(target));
    for (const group of $("panel").querySelectorAll(".group")) this.addFold(group);
    this.restore();
  }

  // Show what was kept, once it is known which scenario the page shows.
  structure({ isNew }) {
    if (isNew) this.restore();
    this.tabs.tidy();
  }

  restore() {
    const { width, side, tab, ...more } = kept();
    this.setWidth(Number(width) || USUAL);
    this.setSide(side);
    this.tabs.choose(tab);
    for (const fold of this.folds) fold();
    for (const id of FILTERS) {
      if (typeof more[id] !== "string" || !$(id)) continue;
      $(id).value = more[id];
      $(id).dispatchEvent(new Event("input"));
    }
  }

  get isLeft() {
    return document.body.classList.contains("panel-left");
  }

  setSide(side) {
    document.body.classList.toggle("panel-left", side === "left");
  }

  // Take up a panel's section. Other packages' panels are what a page is opened for, unless another tab was chosen.
  add(section) {
    this.tabs.add(section);
    this.addFold(section);
    if (section.dataset.tab === (kept().tab ?? OTHERS)) this.tabs.choose(section.dataset.tab);
    this.tabs.tidy();
  }

  // Bring what is in the side panel into view, whatever tab or group it is in.
  show(node) {
    if (node.closest(".panel-closed #panel")) $("panel-toggle").click();
    const { tab } = node.closest(".group")?.dataset ?? {};
    if (tab && tab !== this.tabs.chosen) this.tabs.press(tab);
    node.closest(".folded")?.querySelector(".fold").click();
    for (let each = node.parentElement; each; each = each.parentElement) if (each.localName === "details") each.open = true;
    node.scrollIntoView({ block: "nearest" });
  }

  resize(width) {
    this.setWidth(width);
    keep({ width: this.width });
  }

  setWidth(width) {
    const [least, most] = ENDS;
    this.width = Math.round(Math.min(Math.max(width, least), most));
    document.documentElement.style.setProperty("--panel", `${this.width}px`);
    const values = { valuenow: this.width, valuemin: least, valuemax: most };
    for (const [name, value] of Object.entries(values)) this.edge.setAttribute(`aria-${name}`, value);
  }

  // Let the heading of a group fold it, if it is not alone in its tab.
  addFold(group) {
    const heading = group.querySelector("h2");
    const isAlone = group.matches(":only-child") && group.dataset.tab !== OTHERS;
    if (!heading || isAlone || heading.querySelector(".fold")) return;
    const name = heading.textContent;
    const button = element("button", { class: "fold", text: name, "aria-expanded": "true" });
    const fold = (isFolded) => {
      group.classList.toggle("folded", isFolded);
      button.setAttribute("aria-expanded", String(!isFolded));
    };
    heading.replaceChildren(button);
    const restore = () => fold((kept().folded ?? []).includes(name));
    this.folds.push(restore);
    restore();
    button.addEventListener("click", () => {
      const isFolded = !group.classList.contains("folded");
      fold(isFolded);
      const others = (kept().folded ?? []).filter((each) => each !== name);
      keep({ folded: isFolded ? [...others, name] : others });
    });
  }
}
