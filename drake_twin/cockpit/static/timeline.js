// The last minute on a slider: look at a moment again or play it, go on from there or from now. A bag's slider moves the bag.

import { $, element, oncePerFrame, setIcon, setText } from "./dom.js";
import { cursor } from "./time_cursor.js";

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
    this.hovered = element("i", { class: "hovered", hidden: true });
    const track = element("div", { class: "track-of-time" }, this.marks, this.hovered, this.range);
    track.addEventListener("mousemove", ({ clientX }) => cursor.hover(this.timeAt(clientX), this));
    track.addEventListener("mouseleave", () => cursor.hover(null, this));
    track.addEventListener("click", ({ target }) => target.dataset.time && this.seek(Number(target.dataset.time), true));
    this.text = element("span", { class: "muted" });
    const button = (text, label, onclick) => element("button", { class: "small", text, title: label, "aria-label": label, onclick });
    const back = button("‹", "One picture back (Shift N)", () => this.stepBy(-1));
    this.replay = button("", "Play the last minute again", () => ask("Replay", { on: !this.data?.replaying }));
    const forward = button("›", "One picture on", () => this.stepBy(1));
    this.loop = button("Loop", "Begin again at the end", () => ask("Loop", { on: !this.loops }));
    this.player = element("span", { class: "player", role: "group", "aria-label": "Play again" }, back, this.replay, forward, this.loop);
    this.goOn = element("button", { class: "small primary", onclick: () => ask("GoOnFrom", { time: this.data.looked }) });
    this.toNow = element("button", { class: "small", text: "Back to now", onclick: () => ask("LookAtNow") });
    $("timeline").append(track, this.player, this.text, this.goOn, this.toNow);
    this.showButtons();
    cursor.onseek = (time, insists) => this.seek(time, insists);
    cursor.follow(() => this.showHovered());
  }

  look(time) {
    this.ask(!this.isBag && time >= this.now ? "LookAtNow" : "Look", this.isBag || time < this.now ? { time } : {});
  }

  // Look at a moment that a plot, a message or a mark tells of; a twin that runs is paused for it only if somebody insists,
  // also for one that has just been.
  seek(time, insists) {
    if ($("timeline").hidden || this.first === undefined) return;
    if (insists && !this.isBag) this.ask("Look", { time: Math.max(time, this.first) });
    else if (this.isBag || this.isPaused) this.look(Math.min(Math.max(time, this.first), this.now));
  }

  stepBy(count) {
    if (!$("timeline").hidden) this.ask("LookBy", { count });
  }

  timeAt(clientX) {
    const { left, width } = this.marks.getBoundingClientRect();
    return this.first + Math.min(1, Math.max(0, (clientX - left) / width)) * (this.now - this.first);
  }

  showHovered() {
    const time = cursor.hovered;
    this.hovered.hidden = time === null || !(time >= this.first && time <= this.now);
    if (!this.hovered.hidden) this.hovered.style.left = `calc(7px + (100% - 14px) * ${(time - this.first) / (this.now - this.first)})`;
  }

  // What happened, to be found.
  commands() {
    return (this.data?.marks ?? []).map(({ kind, text, start }) => ({ text, about: `${kind} at ${seconds(start)}`, run: () => this.seek(start, true) }));
  }

  structure({ playback, display_only: displayOnly }) {
    this.isBag = playback;
    this.isOff = displayOnly && !playback;
    this.showButtons();
  }

  show(data) {
    this.data = data;
    this.showButtons();
    this.showMarks();
  }

  state({ time, duration, paused, loop }) {
    this.isPaused = paused;
    this.now = this.isBag ? duration : time;
    const first = this.isBag ? 0 : this.data?.first;
    this.first = first;
    this.loops = this.isBag ? loop : this.data?.loop;
    this.loop.setAttribute("aria-pressed", String(Boolean(this.loops)));
    cursor.show(this.isBag ? time : (this.data?.looked ?? null));
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
    this.showHovered();
  }

  showButtons() {
    const looks = this.data?.looked != null;
    const from = this.data?.back_to ?? null;
    $("timeline").classList.toggle("looking", looks);
    this.replay.hidden = Boolean(this.isBag);
    setIcon(this.replay, this.data?.replaying ? "pause" : "play");
    this.toNow.hidden = !looks;
    this.goOn.hidden = !looks || from === null;
    if (from !== null) setText(this.goOn, `Go on from ${seconds(from)}`);
  }

  showMarks() {
    const marks = this.data?.marks ?? [];
    this.marks.replaceChildren(...marks.map(({ kind, text, start }) => element("i", { "data-kind": kind, "data-time": start, title: `${seconds(start)}: ${kind}: ${text}` })));
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
