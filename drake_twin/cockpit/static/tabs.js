// The tabs of the side panel. A group is in the tab that its `data-tab` names; only the chosen tab is shown and updated.

import { $, element } from "./dom.js";

const SHEET = matchMedia("(max-width: 760px)"); // as in page.css
export const OTHERS = "Panels"; // the tab of groups that name none: other packages' panels

export class Tabs {
  // `onchoose` is called when a person has chosen a tab, with its name.
  constructor(onchoose) {
    this.onchoose = onchoose;
    this.tabs = new Map(); // name → { button, page }
    this.chosen = "";
    this.bar = element("div", { class: "tabs", role: "tablist", "aria-label": "Controls" });
    this.bar.addEventListener("keydown", (event) => this.key(event));
    const groups = [...$("panel").children];
    $("panel").prepend(this.bar);
    for (const group of groups) this.add(group);
    this.choose([...this.tabs.keys()][0]);
  }

  // Put a group into its tab, if it is not there.
  add(group) {
    const name = (group.dataset.tab ??= OTHERS);
    if (!this.tabs.has(name)) this.tabs.set(name, this.make(name));
    const { page } = this.tabs.get(name);
    if (group.parentElement !== page) page.append(group);
  }

  make(name) {
    const id = name.toLowerCase();
    const button = element("button", { role: "tab", id: `tab-${id}`, "aria-controls": `page-${id}`, text: name, onclick: () => this.tap(name) });
    const page = element("div", { class: "page", role: "tabpanel", id: `page-${id}`, "aria-labelledby": button.id, hidden: true });
    this.bar.append(button);
    $("panel").append(page);
    return { button, page };
  }

  // In a sheet, whose tabs stay when it is closed, the chosen tab closes and opens it.
  tap(name) {
    const isClosed = document.body.classList.contains("panel-closed");
    if (isClosed || (name === this.chosen && SHEET.matches)) $("panel-toggle").click();
    this.press(name);
  }

  press(name) {
    this.choose(name);
    this.onchoose(name);
  }

  // Show a tab; an unknown one changes nothing.
  choose(name) {
    if (!this.tabs.has(name)) return;
    this.chosen = name;
    for (const [each, { button, page }] of this.tabs) {
      page.hidden = each !== name;
      button.setAttribute("aria-selected", String(each === name));
      button.tabIndex = each === name ? 0 : -1;
    }
  }

  // Hide the tabs that have nothing to show.
  tidy() {
    for (const { button, page } of this.tabs.values()) {
      button.hidden = [...page.children].every((group) => getComputedStyle(group).display === "none");
    }
    if (this.tabs.get(this.chosen).button.hidden) this.choose(this.offered[0]);
  }

  get offered() {
    return [...this.tabs.keys()].filter((name) => !this.tabs.get(name).button.hidden);
  }

  key(event) {
    const { offered } = this;
    const at = offered.indexOf(this.chosen);
    const places = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: -1 };
    if (!(event.key in places) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation(); // arrows drive, too
    const { button } = this.tabs.get(offered.at(places[event.key] % offered.length));
    button.focus();
    button.click();
  }
}
