// The shape of the page: how wide the side panel is, its tab, and which of its groups are folded. A browser keeps them.

import { $, element } from "./dom.js";
import { OTHERS, Tabs } from "./tabs.js";

const STORED = "drake_twin.layout";
const USUAL = 372; // px
const ENDS = [300, 1200]; // px; the scene keeps some room, too (page.css)
const STEP = 20; // px that a key moves the edge

function stored() {
  try {
    return JSON.parse(localStorage.getItem(STORED)) ?? {};
  } catch {
    return {}; // another program's, or none may be kept
  }
}

function store(change) {
  try {
    localStorage.setItem(STORED, JSON.stringify({ ...stored(), ...change }));
  } catch {
    // it is as wide as it was at the next visit
  }
}

export class Layout {
  // `onchoose` is called when another tab is shown.
  constructor(onchoose) {
    this.edge = element("div", { class: "edge", role: "separator", tabindex: 0, "aria-orientation": "vertical", "aria-label": "Width of the controls", title: "Drag, or press the left and right arrow; double click for the usual width" });
    $("panel").before(this.edge);
    this.setWidth(Number(stored().width) || USUAL);
    this.edge.addEventListener("pointerdown", (event) => {
      this.edge.setPointerCapture(event.pointerId);
      document.body.classList.add("resizing"); // so that the scene's frame does not take the pointer
    });
    this.edge.addEventListener("pointermove", (event) => {
      if (this.edge.hasPointerCapture(event.pointerId)) this.setWidth(innerWidth - event.clientX);
    });
    this.edge.addEventListener("lostpointercapture", () => {
      document.body.classList.remove("resizing");
      store({ width: this.width });
    });
    this.edge.addEventListener("dblclick", () => this.resize(USUAL));
    this.edge.addEventListener("keydown", (event) => {
      const widths = { ArrowLeft: this.width + STEP, ArrowRight: this.width - STEP, Home: USUAL };
      if (!(event.key in widths)) return;
      event.preventDefault();
      event.stopPropagation();
      this.resize(widths[event.key]);
    });
    this.tabs = new Tabs((tab) => {
      store({ tab });
      onchoose();
    });
    this.tabs.choose(stored().tab);
    $("panel").addEventListener("reveal", ({ target }) => this.show(target));
    for (const group of $("panel").querySelectorAll(".group")) this.addFold(group);
  }

  // Take up a panel's section. Other packages' panels are what a page is opened for, unless another tab was chosen.
  add(section) {
    this.tabs.add(section);
    this.addFold(section);
    if (section.dataset.tab === (stored().tab ?? OTHERS)) this.tabs.choose(section.dataset.tab);
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
    store({ width: this.width });
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
    fold((stored().folded ?? []).includes(name));
    button.addEventListener("click", () => {
      const isFolded = !group.classList.contains("folded");
      fold(isFolded);
      const others = (stored().folded ?? []).filter((each) => each !== name);
      store({ folded: isFolded ? [...others, name] : others });
    });
  }
}
