// The tree of frames, as /tf and /tf_static give it.

import { element, setText } from "./dom.js";

const numbers = (values) => values.map((value) => value.toFixed(3)).join(" ");

export class Frames {
  constructor() {
    this.tree = element("ul", { class: "frames", tabindex: 0, "aria-label": "Frames" });
    this.node = element("details", {}, element("summary", { text: "Frames" }), this.tree);
    this.poses = new Map();
  }

  show(frames) {
    const key = JSON.stringify(frames.map(({ frame, parent }) => [frame, parent]));
    if (key !== this.key) {
      this.key = key;
      this.poses.clear();
      const known = new Set(frames.map(({ frame }) => frame));
      const roots = [...new Set(frames.map(({ parent }) => parent))].filter((name) => !known.has(name));
      this.tree.replaceChildren(...roots.map((name) => this.item(name, frames)));
    }
    for (const { frame, xyz, rpy, static: isStatic } of frames) {
      const node = this.poses.get(frame);
      if (node) setText(node, ` ${numbers(xyz)} m, ${numbers(rpy)} rad${isStatic ? ", static" : ""}`);
    }
  }

  item(name, frames) {
    const pose = element("span", { class: "muted" });
    this.poses.set(name, pose);
    const below = frames.filter(({ parent }) => parent === name).map(({ frame }) => this.item(frame, frames));
    return element("li", {}, name, pose, ...(below.length ? [element("ul", {}, ...below)] : []));
  }
}
