// A small plot of the last seconds, one line for each value; drawn only while it is open.

import { element, formatted, setText } from "./dom.js";

const KEPT = 300; // some 20 s of watching
const HEIGHT = 56;
const MARGIN = 3;
const COLORS = 8; // --line-1 to --line-8; further lines are gray

export const lineColor = (index) => (index < COLORS ? `var(--line-${index + 1})` : "var(--track)");

function bounds(samples) {
  let [lower, upper] = [Infinity, -Infinity];
  for (const { values } of samples) {
    for (const value of values) {
      if (value < lower) lower = value;
      if (value > upper) upper = value;
    }
  }
  const missing = Math.max(0, 1e-3 - (upper - lower)); // a constant value is a line in the middle
  return [lower - missing / 2, upper + missing / 2];
}

export class Plot {
  constructor({ label, name, unit }) {
    this.samples = [];
    this.upper = element("output", { class: "plot-upper" });
    this.lower = element("output", { class: "plot-lower" });
    this.canvas = element("canvas", { role: "img", "aria-label": `${name ?? label} over time` });
    this.node = element(
      "figure",
      { class: "plot" },
      element("figcaption", {}, label, element("span", { class: "unit", text: unit ? `, ${unit}` : "" })),
      this.canvas,
      this.upper,
      this.lower,
    );
  }

  // Add values at a time (s); a time before the last one, as after a reset, clears the plot first.
  add(time, values) {
    const last = this.samples.at(-1);
    if (last && time === last.time) return;
    if (last && time < last.time) this.clear();
    this.samples.push({ time, values });
    if (this.samples.length > KEPT) this.samples.shift();
    this.draw();
  }

  clear() {
    this.samples.length = 0;
  }

  draw() {
    const width = this.canvas.clientWidth;
    if (width === 0) return;
    const density = devicePixelRatio;
    this.canvas.width = width * density; // which also clears it
    this.canvas.height = HEIGHT * density;
    const [lower, upper] = bounds(this.samples);
    const step = (upper - lower) / 100;
    setText(this.upper, formatted(upper, step));
    setText(this.lower, formatted(lower, step));
    const first = this.samples[0].time;
    const across = (width - 2 * MARGIN) / Math.max(this.samples.at(-1).time - first, 1e-9);
    const down = (HEIGHT - 2 * MARGIN) / (upper - lower);
    const context = this.canvas.getContext("2d");
    const style = getComputedStyle(this.canvas);
    context.scale(density, density);
    context.lineWidth = 1.5;
    context.lineJoin = "round";
    for (let index = this.samples[0].values.length - 1; index >= 0; index -= 1) {
      context.strokeStyle = style.getPropertyValue(index < COLORS ? `--line-${index + 1}` : "--track");
      context.beginPath();
      for (const { time, values } of this.samples) {
        context.lineTo(MARGIN + (time - first) * across, MARGIN + (upper - values[index]) * down);
      }
      context.stroke();
    }
  }
}
