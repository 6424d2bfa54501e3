// The overlays, the camera, recording, spawning.

import { $, element, setText, toggle } from "./dom.js";

export class View {
  constructor(ask) {
    this.ask = ask;
    this.toggles = {};
    $("follow").addEventListener("change", () => ask("Follow", { robot: $("follow").value }));
    $("record").addEventListener("click", () => {
      this.wanted = this.recording;
      ask("Record", { on: !this.recording });
    });
    this.setUpSpawn();
  }

  setUpSpawn() {
    const form = $("spawn-form");
    $("spawn").addEventListener("click", () => {
      form.elements.name.value = this.freeName();
      $("spawn-dialog").showModal();
    });
    $("spawn-cancel").addEventListener("click", () => $("spawn-dialog").close());
    form.addEventListener("submit", () => {
      const number = (name) => form.elements[name].valueAsNumber || 0;
      this.ask("Spawn", {
        file: form.elements.file.value.trim(),
        name: form.elements.name.value.trim(),
        xyz: [number("x"), number("y"), number("z")],
        rpy: [0, 0, number("yaw")],
      });
    });
  }

  freeName() {
    for (let index = 1; ; index += 1) if (!this.names?.includes(`robot_${index}`)) return `robot_${index}`;
  }

  addOverlay({ name, label, hint }) {
    const { node, input } = toggle(label, label, (on) => this.ask("Show", { what: name, on }));
    node.title = hint;
    this.toggles[name] = input;
    $("overlays").append(node);
  }

  structure({ robots, overlays, display_only: displayOnly }) {
    for (const overlay of overlays) if (!(overlay.name in this.toggles)) this.addOverlay(overlay);
    this.names = robots.map((robot) => robot.name);
    $("follow").replaceChildren(
      element("option", { value: "", text: "no robot" }),
      ...this.names.map((name) => element("option", { value: name, text: name })),
    );
    $("spawn").hidden = displayOnly;
    $("record").hidden = displayOnly;
    $("stop-all").hidden = displayOnly;
    document.title = `${this.names.length === 1 ? this.names[0] : `${this.names.length} robots`} – drake_twin`;
  }

  state(state) {
    for (const [what, input] of Object.entries(this.toggles)) input.checked = state.shown.includes(what);
    if (document.activeElement !== $("follow")) $("follow").value = state.followed;
    this.recording = state.recording;
    $("recording-badge").hidden = !state.recording;
    setText($("record"), state.recording ? "Save as HTML" : "Record");
    if (this.wanted && this.recordings !== undefined && state.recordings > this.recordings) {
      this.wanted = false;
      element("a", { href: "files/run.html", download: "run.html" }).click();
    }
    this.recordings = state.recordings;
  }
}
