// Driving: pad, keyboard (WASD and arrows, Q and E sideways, R and F up and down) and gamepad. A robot drives while the command is repeated.

import { element, Slider } from "./dom.js";

const PERIOD = 100; // ms
const DEAD_ZONE = 0.12;
const KEYS = {
  KeyW: [1, 0, 0, 0],
  ArrowUp: [1, 0, 0, 0],
  KeyS: [-1, 0, 0, 0],
  ArrowDown: [-1, 0, 0, 0],
  KeyA: [0, 0, 1, 0],
  ArrowLeft: [0, 0, 1, 0],
  KeyD: [0, 0, -1, 0],
  ArrowRight: [0, 0, -1, 0],
  KeyQ: [0, 1, 0, 0],
  KeyE: [0, -1, 0, 0],
  KeyR: [0, 0, 0, 1],
  KeyF: [0, 0, 0, -1],
};
const PAD = [
  ["KeyQ", "◀", "Sideways left"],
  ["KeyW", "▲", "Forwards"],
  ["KeyE", "▶", "Sideways right"],
  ["KeyA", "↺", "Turn left"],
  ["KeyS", "▼", "Backwards"],
  ["KeyD", "↻", "Turn right"],
];
const HEIGHTS = [
  ["KeyR", "⤒", "Upwards"],
  ["KeyF", "⤓", "Downwards"],
];

export class Teleop {
  constructor(ask) {
    this.ask = ask;
    this.held = new Set(); // codes of keys and of pad buttons
    this.pads = new Map(); // topic → pad
    this.driven = null; // the pad that the keyboard and the gamepad drive
    setInterval(() => this.tick(), PERIOD);
    window.addEventListener("blur", () => this.release());
    document.addEventListener("visibilitychange", () => this.release());
  }

  pad(robot, { topic, flies }) {
    const speed = new Slider({ label: "Speed", name: `${robot} speed`, unit: "m/s", lower: 0, upper: 2, step: 0.01, onmove: () => {} });
    const turn = new Slider({ label: "Turning", name: `${robot} turning`, unit: "rad/s", lower: 0, upper: 4, step: 0.01, onmove: () => {} });
    speed.show(0.5);
    turn.show(1);
    const pad = { robot, topic, flies, speed, turn, wasMoving: false };
    pad.button = element("button", {
      class: "drive",
      "aria-pressed": "false",
      text: "Keys and gamepad",
      title: `WASD or arrows drive, Q and E go sideways, ${flies ? "R and F up and down, " : ""}Esc ends it`,
      onclick: () => this.choose(this.driven === pad ? null : pad),
    });
    const buttons = [...PAD, ...(flies ? HEIGHTS : [])].map(([code, text, name]) => {
      const button = element("button", { text, "aria-label": `${robot} ${name}`, title: `${name} (${code.slice(3)})` });
      const press = (event) => {
        this.choose(pad);
        this.held.add(code);
        this.tick();
        if (event.pointerId !== undefined) button.setPointerCapture(event.pointerId);
      };
      const release = () => {
        this.held.delete(code);
        this.tick();
      };
      button.addEventListener("pointerdown", press);
      for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) button.addEventListener(end, release);
      button.addEventListener("keydown", (event) => event.code === "Enter" && press(event));
      button.addEventListener("keyup", (event) => event.code === "Enter" && release());
      return button;
    });
    pad.node = element(
      "div",
      { class: "teleop" },
      element("h3", { text: "Drive", title: topic }),
      element("div", { class: "teleop-grid" }, element("div", { class: "pad" }, ...buttons), element("div", {}, speed.node, turn.node, pad.button)),
    );
    Object.defineProperty(pad, "disabled", {
      set: (value) => {
        for (const button of [...buttons, pad.button]) button.disabled = value;
        speed.disabled = turn.disabled = value;
        if (value && this.driven === pad) this.choose(null);
      },
    });
    this.pads.set(topic, pad);
    return pad;
  }

  choose(pad) {
    if (this.driven && this.driven !== pad) {
      this.release();
      this.driven.button.setAttribute("aria-pressed", "false");
    }
    this.driven = pad;
    pad?.button.setAttribute("aria-pressed", "true");
  }

  forget(robot) {
    for (const [topic, pad] of this.pads) {
      if (pad.robot !== robot) continue;
      if (this.driven === pad) this.choose(null);
      this.pads.delete(topic);
    }
  }

  // Process a key; return whether it is one that drives.
  key(event, down) {
    if (!this.driven) return false;
    if (event.code === "Escape" && down) {
      this.choose(null);
      return true;
    }
    if (!(event.code in KEYS) || event.ctrlKey || event.metaKey || event.altKey) return false;
    if (down === this.held.has(event.code)) return true;
    if (down) this.held.add(event.code);
    else this.held.delete(event.code);
    this.tick();
    return true;
  }

  release() {
    this.held.clear();
    this.tick();
  }

  tick() {
    const pad = this.driven;
    if (!pad) return;
    const sum = [0, 0, 0, 0];
    for (const code of this.held) KEYS[code].forEach((value, index) => (sum[index] += value));
    this.gamepad().forEach((value, index) => (sum[index] += value));
    const [x, y, turn, up] = sum.map((value) => Math.max(-1, Math.min(1, value)));
    const climb = pad.flies ? up : 0;
    const moving = x !== 0 || y !== 0 || turn !== 0 || climb !== 0;
    if (!moving && !pad.wasMoving) return;
    pad.wasMoving = moving;
    const speed = pad.speed.number.valueAsNumber || 0;
    this.ask("Drive", { topic: pad.topic, x: x * speed, y: y * speed, turn: turn * (pad.turn.number.valueAsNumber || 0), up: climb * speed });
  }

  gamepad() {
    const pad = [...(navigator.getGamepads?.() ?? [])].find((each) => each?.connected);
    if (!pad) return [0, 0, 0, 0];
    const axis = (index) => (Math.abs(pad.axes[index] ?? 0) > DEAD_ZONE ? -pad.axes[index] : 0);
    return [axis(1), pad.axes.length > 3 ? axis(0) : 0, pad.axes.length > 3 ? axis(2) : axis(0), axis(3)];
  }
}
