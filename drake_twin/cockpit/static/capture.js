// Pictures and videos of the scene, as the browser draws it, and distances between two points that are clicked in it.

import { $, element, setText } from "./dom.js";
import { save } from "./plot_export.js";

const FRAMES = 30; // of a video, per second
const PART = 500; // ms of a video that are handed over at once: what is recorded is not held in the encoder
const KINDS = ["video/webm;codecs=vp9", "video/webm", "video/mp4"];

export class Capture {
  constructor() {
    const button = (text, title, onclick) => element("button", { class: "small", text, title, onclick });
    this.video = button("Video", "Record a video, a film of the scene", () => this.toggleVideo());
    this.measured = button("Measure", "Measure a distance: press two points in the scene", () => this.toggleMeasure());
    this.measured.setAttribute("aria-pressed", "false");
    this.distance = element("output", { class: "distance" });
    const picture = button("Picture", "Save a picture of the scene", () => this.savePicture());
    $("capture").append(picture, this.video, this.measured, this.distance);
    this.points = [];
    window.addEventListener("keydown", ({ code }) => code === "Escape" && this.endMeasure());
  }

  get tools() {
    return $("scene").contentWindow?.sceneTools ?? null;
  }

  savePicture() {
    this.tools?.picture().toBlob((blob) => save(blob, "drake_twin.png"));
  }

  toggleVideo() {
    if (this.recorder) {
      this.recorder.stop();
      return;
    }
    const kind = KINDS.find((each) => window.MediaRecorder?.isTypeSupported(each));
    if (!this.tools || !kind) {
      setText(this.video, "No video here");
      return;
    }
    const parts = [];
    const end = this.tools.drawWhole(); // a film's pictures are of one size
    this.recorder = new MediaRecorder(this.tools.picture().captureStream(FRAMES), { mimeType: kind });
    this.recorder.addEventListener("dataavailable", ({ data }) => parts.push(data));
    this.recorder.addEventListener("stop", () => {
      end();
      this.recorder = null;
      setText(this.video, "Video");
      save(new Blob(parts, { type: kind }), `drake_twin.${kind.includes("mp4") ? "mp4" : "webm"}`);
    });
    this.recorder.start(PART);
    setText(this.video, "End video");
  }

  toggleMeasure() {
    if (this.measured.getAttribute("aria-pressed") === "true") {
      this.endMeasure();
      return;
    }
    if (!this.tools) return;
    this.points = [];
    this.measured.setAttribute("aria-pressed", "true");
    setText(this.distance, "Press the first point");
    this.tools.showLine([]);
    this.tools.takeClicks(this);
  }

  clicked(hit) {
    if (!hit) return;
    const { point } = hit;
    this.points.push([point.x, point.y, point.z]);
    if (this.points.length === 1) {
      setText(this.distance, "Press the second point");
      return;
    }
    const [from, to] = this.points;
    const along = to.map((number, axis) => number - from[axis]);
    setText(this.distance, `${Math.hypot(...along).toFixed(3)} m (${along.map((number) => (number + 0).toFixed(3)).join(", ")})`);
    this.tools.showLine(this.points);
    this.tools.dropClicks(this);
    this.points = [];
  }

  clicksTaken() {
    this.endMeasure();
  }

  endMeasure() {
    if (this.measured.getAttribute("aria-pressed") !== "true") return;
    this.measured.setAttribute("aria-pressed", "false");
    setText(this.distance, "");
    this.tools.dropClicks(this);
    this.tools.showLine([]);
  }
}
