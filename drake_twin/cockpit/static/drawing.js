// The diagram of the twin as a picture in a dialog; a press on a system or a port of it tells its names.

import { element, setText } from "./dom.js";

export class Drawing {
  constructor(draw, chosen) {
    this.chosen = chosen;
    this.text = element("p", { role: "status", text: "Graphviz draws the diagram…" });
    this.picture = element("div", { class: "picture", tabindex: 0, role: "region", "aria-label": "Picture of the diagram" });
    const close = element("button", { text: "Close", onclick: () => this.dialog.close() });
    const size = (text, label, factor) => element("button", { class: "small", text, title: label, "aria-label": label, onclick: () => this.resize(factor) });
    this.dialog = element("dialog", { class: "drawing", "aria-label": "Diagram" }, element("menu", {}, size("−", "Smaller", 0.8), size("+", "Larger", 1.25), close), this.text, this.picture);
    this.picture.addEventListener("click", ({ target }) => this.press(target));
    this.picture.addEventListener("keydown", (event) => {
      if (!["Enter", " "].includes(event.key) || !event.target.matches("g.node")) return;
      event.preventDefault();
      this.press(event.target);
    });
    const open = () => {
      setText(this.text, "Graphviz draws the diagram…");
      this.text.hidden = false;
      this.picture.replaceChildren();
      document.body.append(this.dialog);
      this.dialog.showModal();
      draw();
    };
    this.node = element("div", { class: "row" }, element("button", { class: "small", text: "Diagram…", onclick: open }));
  }

  get isOpen() {
    return this.dialog.open;
  }

  show({ svg, problem }) {
    if (!this.isOpen || (this.picture.childElementCount && !problem)) return;
    setText(this.text, problem);
    this.text.hidden = !problem;
    if (!svg) return;
    const drawn = document.importNode(new DOMParser().parseFromString(svg, "image/svg+xml").documentElement, true);
    for (const title of drawn.querySelectorAll("title")) title.remove(); // Graphviz's own names of nodes
    for (const node of drawn.querySelectorAll("g.node")) {
      node.setAttribute("tabindex", "0");
      node.setAttribute("role", "button");
      node.setAttribute("aria-label", textsOf(node).slice(0, 2).join(" ") || "system");
    }
    this.picture.replaceChildren(drawn);
    this.width = null;
  }

  resize(factor) {
    const svg = this.picture.querySelector("svg");
    if (!svg) return;
    this.width = (this.width ?? svg.getBoundingClientRect().width) * factor;
    svg.removeAttribute("height");
    svg.setAttribute("width", this.width);
  }

  // Tell the names of what was pressed, the most specific first: a port, its system, the diagrams around it.
  press(target) {
    const node = target.closest("g.node, g.cluster");
    if (!node) return;
    const port = target.matches("text") ? [target.textContent.trim()] : [];
    const around = [...this.picture.querySelectorAll("g.cluster")].filter((cluster) => cluster !== node && encloses(cluster, node));
    around.sort((one, other) => widthOf(one) - widthOf(other));
    const names = [...port, ...[node, ...around].flatMap((each) => textsOf(each))].map((text) => text.replace(/^name=/, ""));
    if (this.chosen(names)) this.dialog.close();
  }
}

const textsOf = (node) => [...node.querySelectorAll("text")].map((text) => text.textContent.trim()).filter(Boolean).filter((text, index) => index < 2 || text.startsWith("name="));
const widthOf = (node) => node.getBoundingClientRect().width;

function encloses(cluster, node) {
  const [outer, inner] = [cluster.getBoundingClientRect(), node.getBoundingClientRect()];
  return outer.left <= inner.left && outer.right >= inner.right && outer.top <= inner.top && outer.bottom >= inner.bottom;
}
