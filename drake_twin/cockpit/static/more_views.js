// Up to three more views of the scene beside the first one, each with a camera of its own.

import { $, element } from "./dom.js";

const VIEWS = { Front: [1, 0, 0.15], Left: [0, 1, 0.15], Top: [0, 0, 1] }; // from where the camera looks, in the world
const FIT = 250; // ms between two tries, until all meshes are loaded
const TRIES = 80; // without a change, after which the view stays as it is

export class MoreViews {
  constructor() {
    this.frames = [];
    this.names = [];
    this.button = element("button", { class: "small", title: "One, two or four views of the scene", text: "Views", onclick: () => this.next() });
    $("capture").append(this.button);
  }

  structure({ robots }) {
    this.names = robots.map(({ name }) => name);
  }

  next() {
    const wanted = { 0: 1, 1: 3, 3: 0 }[this.frames.length];
    while (this.frames.length > wanted) this.frames.pop().remove();
    const names = Object.keys(VIEWS);
    while (this.frames.length < wanted) this.add(names[this.frames.length]);
    $("scene").parentElement.dataset.views = wanted + 1;
  }

  add(name) {
    const frame = element("iframe", { src: "scene/", title: `Robots seen from: ${name.toLowerCase()}` });
    frame.addEventListener("load", () => this.fit(frame, VIEWS[name], "", TRIES));
    this.frames.push(frame);
    $("scene").after(frame);
  }

  // Fit again as long as meshes are loaded, until somebody moves the camera.
  fit(frame, direction, fitted, left) {
    const tools = frame.contentWindow?.sceneTools;
    if (!tools || tools.isTouched || !left) return;
    const { meshes, aspect } = tools.measure(this.names);
    const key = `${meshes} ${aspect}`;
    const done = key !== fitted && tools.fit(this.names, direction);
    setTimeout(() => this.fit(frame, direction, done ? key : fitted, done ? TRIES : left - 1), FIT);
  }
}
