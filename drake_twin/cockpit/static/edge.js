// The edge of an area, which is dragged or moved with arrow keys. A browser keeps where it is (kept.js).

import { element } from "./dom.js";
import { keep } from "./kept.js";

const STEP = 20; // px that a key moves it

export class Edge {
  // An edge of the area `name`, which is `usual` px wide or high and may be from `least` to `most`; `keys` makes it smaller and
  // larger, `sizeAt` returns the size for a pointer's event, `onsize` is given each size. It is kept by the name `kept`.
  constructor({ kept, className, orientation, label, title, usual, least, most, keys, sizeAt, onsize }) {
    Object.assign(this, { kept, usual, least, most, onsize });
    this.node = element("div", { class: `edge ${className}`, role: "separator", tabindex: 0, "aria-orientation": orientation, "aria-label": label, title });
    this.node.addEventListener("pointerdown", (event) => {
      this.node.setPointerCapture(event.pointerId);
      document.body.classList.add("resizing"); // so that the scene's frame does not take the pointer
    });
    this.node.addEventListener("pointermove", (event) => {
      if (this.node.hasPointerCapture(event.pointerId)) this.set(sizeAt(event));
    });
    this.node.addEventListener("lostpointercapture", () => {
      document.body.classList.remove("resizing");
      keep({ [kept]: this.size });
    });
    this.node.addEventListener("dblclick", () => this.resize(usual));
    this.node.addEventListener("keydown", (event) => {
      const [smaller, larger] = keys();
      const sizes = { [smaller]: this.size - STEP, [larger]: this.size + STEP, Home: usual };
      if (!(event.key in sizes)) return;
      event.preventDefault();
      event.stopPropagation();
      this.resize(sizes[event.key]);
    });
  }

  resize(size) {
    this.set(size);
    keep({ [this.kept]: this.size });
  }

  set(size) {
    this.size = Math.round(Math.min(Math.max(Number(size) || this.usual, this.least), this.most));
    this.onsize(this.size);
    const values = { valuenow: this.size, valuemin: this.least, valuemax: this.most };
    for (const [name, value] of Object.entries(values)) this.node.setAttribute(`aria-${name}`, value);
  }
}
