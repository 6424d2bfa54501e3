// The camera: it fits what is selected, or all robots, also at the start; presets; names above robots.

import { $, element } from "./dom.js";
import { keep, kept } from "./kept.js";

const KEEP = 2000; // ms between two looks at where the camera is
const VIEWS = {
  Angle: [0.75, -0.65, 0.4],
  Front: [1, 0, 0.15],
  Left: [0, 1, 0.15],
  Top: [0, 0, 1],
};

export class Camera {
  constructor() {
    this.names = [];
    this.isSettled = false;
    this.hasNames = false;
    this.named = []; // those that are shown; null until they are written
    const button = (text, title, onclick) => element("button", { class: "small", text, title, "aria-label": title, onclick });
    const views = Object.keys(VIEWS).map((name, index) => button(name, `${name} view (${index + 1})`, () => this.view(name)));
    // Where a person has moved the camera, it is there again when the page is opened.
    window.addEventListener("pagehide", () => this.keepPlace());
    setInterval(() => this.keepPlace(), KEEP);
    $("camera").append(button("Fit", "Fit the selection, or all robots (F)", () => this.fit()), ...views);
  }

  // The scene's tools; null until its frame is loaded.
  get tools() {
    return $("scene").contentWindow?.sceneTools ?? null;
  }

  get keys() {
    const views = Object.keys(VIEWS).map((name, index) => [`Digit${index + 1}`, () => this.view(name)]);
    return { KeyF: () => this.fit(), ...Object.fromEntries(views) };
  }

  keepPlace() {
    if (!this.tools?.isTouched) return;
    const camera = this.tools.cameraPlace();
    if (camera.join() === this.placeKept) return;
    this.placeKept = camera.join();
    keep({ camera });
  }

  // Return the camera to where a person had it; whether somebody had.
  goBack() {
    const { camera } = kept();
    if (!Array.isArray(camera) || camera.length !== 6 || !camera.every(Number.isFinite)) return false;
    this.tools.placeCamera(camera);
    this.isSettled = true;
    return true;
  }

  // Returns whether there is anything to fit.
  fit(direction = null) {
    const selected = this.tools?.selected ?? [];
    return this.tools?.fit(selected.length ? selected : this.names, direction) ?? false;
  }

  view(name) {
    this.isSettled = true;
    this.fit(VIEWS[name]);
  }

  structure({ robots }) {
    this.names = robots.map((robot) => robot.name);
    this.named = null;
  }

  // Show the names of robots, or no more.
  showNames(on) {
    this.hasNames = on;
    this.named = null;
    this.writeNames();
  }

  writeNames() {
    if (this.named || !this.tools) return; // its frame is not loaded yet
    this.named = this.hasNames ? this.names : [];
    this.tools.showNames(this.named);
  }

  state({ followed }) {
    this.writeNames();
    if (this.isSettled) return;
    // Meshes are loaded one by one, robots come and drive away, the pane changes its size: fit again, until somebody moves
    // the camera.
    const drawn = this.tools?.measure(this.names);
    if (!drawn) return;
    if (drawn.meshes && this.goBack()) return; // the scene places its camera first
    this.isSettled = Boolean(followed) || drawn.isTouched;
    const key = `${drawn.meshes} ${drawn.aspect}`;
    if (!this.isSettled && (key !== this.fitted || !this.tools.areSeen(this.names)) && this.fit()) this.fitted = key;
  }
}
