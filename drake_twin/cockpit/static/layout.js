// The shape of the page: the side panel's width, side and tab, the plots' height, which groups are folded. A browser keeps them (kept.js).

import { $, element } from "./dom.js";
import { Edge } from "./edge.js";
import { keep, kept } from "./kept.js";
import { OTHERS, Tabs } from "./tabs.js";

// The scene keeps some room, too (page.css, plots.css).
const WIDTH = {
  kept: "width",
  className: "beside",
  orientation: "vertical",
  label: "Width of the controls",
  title: "Drag, or press the left and right arrow; double click for the usual width",
  ...{ usual: 372, least: 300, most: 1200 }, // px
};
const HEIGHT = {
  kept: "height",
  className: "below",
  orientation: "horizontal",
  label: "Height of the plots",
  title: "Drag, or press the up and down arrow; double click for the usual height",
  ...{ usual: 296, least: 120, most: 1200 }, // px
};
const FILTERS = ["robots-filter", "messages-search"];

export class Layout {
  // `onchoose` is called when another tab is shown.
  constructor(onchoose) {
    const sized = (name) => (size) => document.documentElement.style.setProperty(name, `${size}px`);
    this.width = new Edge({
      ...WIDTH,
      keys: () => (this.isLeft ? ["ArrowLeft", "ArrowRight"] : ["ArrowRight", "ArrowLeft"]),
      sizeAt: ({ clientX }) => (this.isLeft ? clientX : innerWidth - clientX),
      onsize: sized("--panel"),
    });
    this.height = new Edge({
      ...HEIGHT,
      keys: () => ["ArrowDown", "ArrowUp"],
      sizeAt: ({ clientY }) => $("plots").getBoundingClientRect().bottom - clientY,
      onsize: sized("--plots"),
    });
    $("panel").before(this.width.node);
    $("plots").before(this.height.node);
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
    const { width, height, side, tab, ...more } = kept();
    this.width.set(width);
    this.height.set(height);
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
