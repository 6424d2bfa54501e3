// A tree of the world's things, with the keys that trees have: arrows, Home, End, Enter. Only rows in view are there.

import { element } from "./dom.js";
import { Rows } from "./rows.js";

export class Tree {
  constructor(onselect) {
    this.onselect = onselect;
    this.open = new Set();
    this.nodes = new Map();
    this.shown = []; // the ids of the rows that no closed node is above of
    this.selected = "";
    this.current = ""; // the row that the Tab key comes to
    this.node = element("ul", { class: "tree", role: "tree", "aria-label": "World" });
    this.rows = new Rows(this.node, (index) => this.row(this.nodes.get(this.shown[index])));
    this.node.addEventListener("keydown", (event) => this.key(event));
    this.node.addEventListener("focusin", ({ target }) => (this.current = target.dataset.node ?? this.current));
  }

  show(nodes) {
    this.nodes = new Map();
    const add = (node, level, parent) => {
      this.nodes.set(node.id, { ...node, parent, level });
      for (const child of node.children) add(child, level + 1, node.id);
    };
    for (const node of nodes) add(node, 1, "");
    if (!this.nodes.has(this.selected)) this.selected = "";
    this.lay();
  }

  row({ id, kind, name, level, children }) {
    const isOpen = this.open.has(id);
    const twisty = element("span", { class: "twisty", "aria-hidden": "true", text: children.length ? (isOpen ? "▾" : "▸") : "" });
    const item = element(
      "li",
      {
        role: "treeitem",
        "aria-level": level,
        "aria-selected": String(id === this.selected),
        "aria-expanded": children.length ? String(isOpen) : null,
        "data-node": id,
        tabindex: id === this.current ? "0" : "-1",
        title: `${kind} ${name}`,
      },
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
    const closed = [];
    for (let above = this.nodes.get(id)?.parent; above; above = this.nodes.get(above).parent) {
      if (!this.open.has(above)) closed.push(above);
    }
    for (const above of closed) this.open.add(above);
    if (closed.length) this.lay();
    else this.mark();
    this.rows.bring(this.shown.indexOf(id));
  }

  toggle(id, open = !this.open.has(id)) {
    if (open) this.open.add(id);
    else this.open.delete(id);
    this.lay();
  }

  // Lay the rows anew, after nodes have come, opened or closed.
  lay() {
    const hadFocus = this.node.contains(document.activeElement);
    this.shown = [];
    const add = (id) => {
      this.shown.push(id);
      if (this.open.has(id)) for (const child of this.nodes.get(id).children) add(child.id);
    };
    for (const [id, { level }] of this.nodes) if (level === 1) add(id);
    if (!this.shown.includes(this.current)) this.current = this.shown.includes(this.selected) ? this.selected : (this.shown[0] ?? "");
    this.rows.show(this.shown.length);
    if (hadFocus) this.go(this.shown.indexOf(this.current));
  }

  mark() {
    for (const [index, item] of this.rows.made) {
      const id = this.shown[index];
      item.setAttribute("aria-selected", String(id === this.selected));
      item.tabIndex = id === this.current ? 0 : -1;
    }
  }

  go(index) {
    if (!(index in this.shown)) return;
    this.current = this.shown[index];
    this.rows.bring(index)?.focus();
    this.mark();
  }

  key(event) {
    const at = this.shown.indexOf(this.current);
    if (at < 0 || event.ctrlKey || event.metaKey || event.altKey) return;
    const id = this.current;
    const { children, parent } = this.nodes.get(id);
    const press = () => {
      this.select(id);
      this.onselect(id);
    };
    const actions = {
      ArrowDown: () => this.go(at + 1),
      ArrowUp: () => this.go(at - 1),
      Home: () => this.go(0),
      End: () => this.go(this.shown.length - 1),
      ArrowRight: () => (children.length && !this.open.has(id) ? this.toggle(id, true) : children.length && this.go(at + 1)),
      ArrowLeft: () => (this.open.has(id) ? this.toggle(id, false) : this.go(this.shown.indexOf(parent))),
      Enter: press,
      Space: press,
    };
    const action = actions[event.code];
    if (!action) return;
    event.preventDefault();
    event.stopPropagation();
    action();
  }
}
