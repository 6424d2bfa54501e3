// The last minute on a slider: look at a moment again, go on from there or from now. A bag's slider moves the bag.

import { $, element, oncePerFrame, setText } from "./dom.js";

const memory = (bytes) => (bytes < 1e6 ? `${(bytes / 1e3).toFixed(0)} kB` : `${(bytes / 1e6).toFixed(1)} MB`);
const seconds = (time) => `${time.toFixed(2)} s`;

export class Timeline {
  constructor(ask) {
    this.ask = ask;
    this.data = null;
    this.held = false;
    const look = oncePerFrame((time) => this.look(time));
    this.range = element("input", { type: "range", min: 0, max: 1, step: "any", value: 1, "aria-label": "Time to look at" });
    this.range.addEventListener("input", () => {
      this.held = true;
      clearTimeout(this.release);
      this.release = setTimeout(() => (this.held = false), 300);
      look(this.range.valueAsNumber);
    });
    this.marks = element("div", { class: "marks", "aria-hidden": "true" });
    this.text = element("span", { class: "muted" });
    this.goOn = element("button", { class: "small primary", onclick: () => ask("GoOnFrom", { time: this.data.looked }) });
    this.toNow = element("button", { class: "small", text: "Back to now", onclick: () => ask("LookAtNow") });
    $("timeline").append(element("div", { class: "track-of-time" }, this.marks, this.range), this.text, this.goOn, this.toNow);
    this.showButtons();
  }

  look(time) {
    this.ask(!this.isBag && time >= this.now ? "LookAtNow" : "Look", this.isBag || time < this.now ? { time } : {});
  }

  structure({ playback, display_only: displayOnly }) {
    this.isBag = playback;
    this.isOff = displayOnly && !playback;
  }

  show(data) {
    this.data = data;
    this.showButtons();
    this.showMarks();
  }

  state({ time, duration }) {
    this.now = this.isBag ? duration : time;
    const first = this.isBag ? 0 : this.data?.first;
    const empty = this.isOff || first === undefined || this.now <= first;
    $("timeline").hidden = empty;
    if (empty) return;
    this.range.min = first;
    this.range.max = this.now;
    const looked = this.data?.looked ?? null;
    const shown = this.isBag ? time : (looked ?? time);
    if (!this.held) this.range.value = shown;
    this.range.setAttribute("aria-valuetext", seconds(shown));
    this.range.style.setProperty("--filled", `${(100 * (this.range.value - first)) / (this.now - first)}%`);
    if (this.isBag) setText(this.text, `${seconds(time)} of ${seconds(duration)}`);
    else if (looked !== null) setText(this.text, `At ${seconds(looked)}, ${seconds(time - looked)} ago`);
    else setText(this.text, `Last ${(time - first).toFixed(0)} s in ${memory(this.data.bytes)}`);
    this.placeMarks(first);
  }

  showButtons() {
    const looks = this.data?.looked != null;
    const from = this.data?.back_to ?? null;
    $("timeline").classList.toggle("looking", looks);
    this.toNow.hidden = !looks;
    this.goOn.hidden = !looks || from === null;
    if (from !== null) setText(this.goOn, `Go on from ${seconds(from)}`);
  }

  showMarks() {
    const marks = this.data?.marks ?? [];
    this.marks.replaceChildren(...marks.map(({ kind, text, start }) => element("i", { "data-kind": kind, title: `${seconds(start)}: ${kind}: ${text}` })));
  }

  placeMarks(first) {
    const across = 100 / (this.now - first);
    (this.data?.marks ?? []).forEach(({ start, end }, index) => {
      const { style } = this.marks.children[index];
      style.left = `${across * (start - first)}%`;
      style.width = `${across * (end - start)}%`;
    });
  }
}
