// The overlays, the camera, recording.

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
  }

  addOverlay({ name, label, hint }) {
    const { node, show } = toggle(label, label, (on) => this.ask("Show", { what: name, on }));
    node.title = hint;
    this.toggles[name] = show;
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
    for (const [what, show] of Object.entries(this.toggles)) show(state.shown.includes(what));
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
