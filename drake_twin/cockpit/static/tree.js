// A tree of the world's things, with the keys that trees have: arrows, Home, End, Enter.

import { element, setText } from "./dom.js";

export class Tree {
  constructor(onselect) {
    this.onselect = onselect;
    this.open = new Set();
    this.rows = [];
    this.nodes = new Map();
    this.selected = "";
    this.node = element("ul", { class: "tree", role: "tree", "aria-label": "World" });
    this.node.addEventListener("keydown", (event) => this.key(event));
  }

  show(nodes) {
    this.nodes = new Map();
    const rows = [];
    const add = (node, level, parent) => {
      this.nodes.set(node.id, { ...node, parent, level });
      rows.push(node.id);
      for (const child of node.children) add(child, level + 1, node.id);
    };
    for (const node of nodes) add(node, 1, "");
    const hadFocus = this.node.contains(document.activeElement);
    this.rows = rows.map((id) => ({ id, item: this.row(this.nodes.get(id)) }));
    this.node.replaceChildren(...this.rows.map(({ item }) => item));
    if (!this.nodes.has(this.selected)) this.select("");
    this.refresh();
    if (hadFocus) this.focused()?.item.focus();
  }

  row({ id, kind, name, level, children }) {
    const twisty = element("span", { class: "twisty", "aria-hidden": "true" });
    const item = element(
      "li",
      { role: "treeitem", "aria-level": level, "data-node": id, tabindex: "-1", title: `${kind} ${name}` },
      twisty,
      element("span", { class: "kind", text: kind }),
      element("span", { class: "name", text: name }),
    );
    item.style.setProperty("--level", level - 1);
    twisty.addEventListener("click", (event) => {
      event.stopPropagation();
      if (children.length) this.toggle(id);
    });
    item.addEventListener("click", () => {
      this.select(id);
      this.onselect(id);
    });
    item.addEventListener("dblclick", () => this.toggle(id));
    return item;
  }

  // Select a node, open what it is in, and bring it into view.
  select(id) {
    this.selected = id;
    for (let above = this.nodes.get(id)?.parent; above; above = this.nodes.get(above).parent) this.open.add(above);
    this.refresh();
    this.rows.find((row) => row.id === id)?.item.scrollIntoView({ block: "nearest" });
  }

  toggle(id, open = !this.open.has(id)) {
    if (open) this.open.add(id);
    else this.open.delete(id);
    this.refresh();
  }

  isShown(id) {
    for (let above = this.nodes.get(id).parent; above; above = this.nodes.get(above).parent) {
      if (!this.open.has(above)) return false;
    }
    return true;
  }

  refresh() {
    for (const { id, item } of this.rows) {
      const { children } = this.nodes.get(id);
      item.hidden = !this.isShown(id);
      item.setAttribute("aria-selected", String(id === this.selected));
      if (children.length) item.setAttribute("aria-expanded", String(this.open.has(id)));
      setText(item.firstChild, children.length ? (this.open.has(id) ? "▾" : "▸") : "");
    }
    const first = this.focused();
    for (const row of this.rows) row.item.tabIndex = row === first ? 0 : -1;
  }

  // The row that the Tab key comes to.
  focused() {
    const shown = this.rows.filter(({ item }) => !item.hidden);
    return shown.find(({ item }) => item === document.activeElement) ?? shown.find(({ id }) => id === this.selected) ?? shown[0];
  }

  key(event) {
    const shown = this.rows.filter(({ item }) => !item.hidden);
    const at = shown.findIndex(({ item }) => item === document.activeElement);
    if (at < 0 || event.ctrlKey || event.metaKey || event.altKey) return;
    const { id } = shown[at];
    const { children, parent } = this.nodes.get(id);
    const go = (row) => row?.item.focus();
    const actions = {
      ArrowDown: () => go(shown[at + 1]),
      ArrowUp: () => go(shown[at - 1]),
      Home: () => go(shown[0]),
      End: () => go(shown.at(-1)),
      ArrowRight: () => (children.length && !this.open.has(id) ? this.toggle(id, true) : children.length && go(shown[at + 1])),
      ArrowLeft: () => (this.open.has(id) ? this.toggle(id, false) : go(shown.find((row) => row.id === parent))),
      Enter: () => shown[at].item.click(),
      Space: () => shown[at].item.click(),
    };
    const action = actions[event.code];
    if (!action) return;
    event.preventDefault();
    event.stopPropagation();
    action();
    this.refresh();
  }
}
