// What is drawn besides the robots: one menu with a switch and a key for each; the browser keeps what is on for a scenario.

import { $, element, setText, toggle } from "./dom.js";
import { keep, kept } from "./kept.js";

const MENU_KEY = "V";
const SAID = 1500; // ms that the page says what a key has switched

export class Show {
  constructor(ask) {
    this.ask = ask;
    this.items = new Map(); // name → its switch
    this.isRestored = false;
    this.search = element("input", { type: "search", placeholder: "Search", "aria-label": "Search what can be shown", spellcheck: "false", autocomplete: "off" });
    this.list = element("ul", {});
    this.none = element("p", { class: "muted", role: "status" });
    const close = element("button", { class: "small quiet", text: "✕", title: "Close (Esc)", "aria-label": "Close", onclick: () => this.close() });
    this.menu = element("div", { id: "show-menu", role: "dialog", "aria-label": "Show", hidden: true }, element("div", { class: "row" }, this.search, close), this.list, this.none);
    const about = `What is drawn besides the robots (${MENU_KEY})`;
    const button = (attributes) => element("button", { title: about, "aria-haspopup": "dialog", "aria-expanded": "false", "aria-controls": "show-menu", onclick: () => this.toggleMenu(), ...attributes });
    this.buttons = [button({ id: "show-button" }), button({ id: "show-in-panel", class: "small" })];
    this.said = element("div", { id: "show-said", role: "status", hidden: true });
    $("scene-tools").append(this.buttons[0], this.said, this.menu);
    $("overlays").append(this.buttons[1]);
    this.search.addEventListener("input", () => this.filter());
    this.menu.addEventListener("keydown", (event) => this.key(event));
    this.count();
  }

  // Add a switch: { name, label, hint, key, set }. Without `set` the twin draws it.
  add({ name, label, hint, key, set }) {
    if (this.items.has(name)) return;
    const change = (on) => {
      (set ?? ((value) => this.ask("Show", { what: name, on: value })))(on);
      this.keep();
    };
    const { node, input, show } = toggle(label, label, change);
    const isFree = key && ![...this.items.values()].some((item) => item.key === key);
    node.title = [hint, isFree && `(${key})`].filter(Boolean).join(" ");
    const row = element("li", {}, node, element("kbd", { text: isFree ? key : "" }));
    this.items.set(name, { label, hint, key: isFree ? key : "", input, show, row, isOwn: Boolean(set) });
    this.list.append(row);
  }

  // Switch on what was kept; another twin at the same address has nothing of this one.
  structure({ overlays, isNew }) {
    for (const overlay of overlays) this.add(overlay);
    if (this.isRestored && !isNew) return;
    this.isRestored = true;
    const { shown } = kept();
    for (const [name, { input }] of this.items) {
      const on = (Array.isArray(shown) && shown.includes(name)) || (input.checked && !isNew);
      if (on === input.checked) continue;
      input.checked = on;
      input.dispatchEvent(new Event("change"));
    }
  }

  state({ shown }) {
    for (const [name, { isOwn, show }] of this.items) if (!isOwn) show(shown.includes(name));
    this.count();
  }

  // The connection has ended: a twin that is started again draws nothing yet.
  lost() {
    this.isRestored = false;
  }

  get names() {
    return [...this.items].filter(([, { input }]) => input.checked).map(([name]) => name);
  }

  keep() {
    if (this.isRestored) keep({ shown: this.names });
    this.count();
  }

  count() {
    const { length } = this.names;
    setText(this.buttons[0], length ? `Show (${length})` : "Show");
    setText(this.buttons[1], length ? `Show… (${length})` : "Show…");
  }

  // The keys of a keyboard, by code.
  get keys() {
    const switches = [...this.items.values()].filter(({ key }) => key).map((item) => [`Key${item.key}`, () => this.press(item)]);
    return { ...Object.fromEntries(switches), [`Key${MENU_KEY}`]: () => this.toggleMenu() };
  }

  press({ label, input }) {
    input.click();
    setText(this.said, `${label}: ${input.checked ? "on" : "off"}`);
    this.said.hidden = false;
    clearTimeout(this.saying);
    this.saying = setTimeout(() => (this.said.hidden = true), SAID);
  }

  // What Find offers.
  commands() {
    return [...this.items.values()].map((item) => ({
      text: item.label,
      about: ["Show", item.input.checked ? "on" : "off", item.key].filter(Boolean).join(" · "),
      run: () => this.press(item),
    }));
  }

  // The keys, for the help.
  described() {
    const rows = [...this.items.values()].filter(({ key }) => key).map(({ key, label }) => [key, `Show: ${label}`]);
    return [[MENU_KEY, "Menu of what is shown"], ...rows];
  }

  toggleMenu() {
    if (this.menu.hidden) this.open();
    else this.close();
  }

  open() {
    this.opener = document.activeElement;
    this.menu.hidden = false;
    this.search.value = "";
    this.filter();
    this.search.focus();
    this.tell();
  }

  close() {
    const hadFocus = this.menu.contains(document.activeElement);
    this.menu.hidden = true;
    if (hadFocus) (this.opener?.isConnected && this.opener !== document.body ? this.opener : this.buttons[0]).focus();
    this.tell();
  }

  tell() {
    for (const button of this.buttons) button.setAttribute("aria-expanded", String(!this.menu.hidden));
  }

  filter() {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    let count = 0;
    for (const { label, hint, row } of this.items.values()) {
      row.hidden = !words.every((word) => `${label} ${hint}`.toLowerCase().includes(word));
      count += row.hidden ? 0 : 1;
    }
    setText(this.none, count ? "" : "Nothing has these words.");
  }

  key(event) {
    const inputs = [...this.items.values()].filter(({ row }) => !row.hidden).map(({ input }) => input);
    const at = inputs.indexOf(document.activeElement);
    const moves = { ArrowDown: inputs[at + 1], ArrowUp: at > 0 ? inputs[at - 1] : this.search };
    if (event.key in moves) moves[event.key]?.focus();
    else if (event.key === "Enter" && (at >= 0 || event.target === this.search)) inputs[Math.max(at, 0)]?.click();
    else if (event.key === "Escape") this.close();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
