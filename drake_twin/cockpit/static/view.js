// What the camera follows, recording.

import { $, element, setText } from "./dom.js";

export class View {
  constructor(ask) {
    this.ask = ask;
    $("follow").addEventListener("change", () => ask("Follow", { robot: $("follow").value }));
    $("record").addEventListener("click", () => {
      this.wanted = this.recording;
      ask("Record", { on: !this.recording });
    });
  }

  structure({ robots, display_only: displayOnly }) {
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
    if (document.activeElement !== $("follow")) $("follow").value = state.followed;
    this.recording = state.recording;
    $("recording-badge").hidden = !state.recording;
    setText($("record"), state.recording ? "Save as HTML" : "Record page");
    if (this.wanted && this.recordings !== undefined && state.recordings > this.recordings) {
      this.wanted = false;
      element("a", { href: "files/run.html", download: "run.html" }).click();
    }
    this.recordings = state.recordings;
  }
}
