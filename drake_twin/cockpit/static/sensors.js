// The sensors: a switch for each, pictures as tiles, numbers as plots; points are drawn in the scene by the twin.

import { $, element, formatted, setText, toggle } from "./dom.js";
import { Plot } from "./plot.js";

// A bar of colors with the values of its ends.
class ColorBar {
  constructor() {
    const end = () => element("output", { "aria-live": "off" });
    [this.lower, this.upper] = [end(), end()];
    this.bar = element("span", { class: "bar-of-colors", role: "img" });
    this.node = element("div", { class: "color-bar", hidden: true }, this.lower, this.bar, this.upper);
  }

  show(legend) {
    this.node.hidden = !legend;
    if (!legend) return;
    const { quantity, unit, lower, upper, stops } = legend;
    const step = Math.max(upper - lower, 1e-4) / 100;
    const [from, to] = [lower, upper].map((value) => `${formatted(value, step)} ${unit}`.trim());
    setText(this.lower, from);
    setText(this.upper, to);
    const background = `linear-gradient(to right, ${stops.map((color) => `rgb(${color.map(Number).join(" ")})`).join(", ")})`;
    if (this.background !== background) this.bar.style.background = this.background = background;
    this.bar.title = `${quantity}, from ${from} to ${to}`;
    this.bar.setAttribute("aria-label", `Colors: ${this.bar.title}`);
  }
}

export class Sensors {
  constructor(ask) {
    this.ask = ask;
    this.sensors = new Map();
  }

  structure({ sensors }) {
    const known = new Set(sensors.map((sensor) => sensor.key));
    for (const [key, sensor] of this.sensors) {
      if (known.has(key)) continue;
      sensor.node.remove();
      this.sensors.delete(key);
    }
    for (const sensor of sensors) {
      if (this.sensors.has(sensor.key)) continue;
      const made = new Sensor(sensor, this.ask);
      this.sensors.set(sensor.key, made);
      $("sensors").append(made.node);
    }
    $("sensors").hidden = sensors.length === 0;
  }

  state({ sensors }) {
    for (const [key, sensor] of this.sensors) sensor.state(sensors, key);
  }

  picture(head, bytes) {
    this.sensors.get(head.key)?.picture(head, bytes);
  }
}

class Sensor {
  constructor({ key, robot, name, kind, on, topics, rate, views }, ask) {
    const { node, input, show } = toggle(`${robot} ${name}`, `Show ${robot}'s ${name}`, (shown) =>
      ask("ShowSensor", { sensor: key, on: shown }),
    );
    this.input = input;
    this.show = show;
    input.disabled = views.length === 0;
    node.title = views.length ? `${kind} on ${on}` : "No bridge carries it to ROS";
    const about = rate ? `${kind}, ${rate} Hz` : kind;
    this.about = element("span", { class: "muted", text: about });
    this.topics = element("div", { class: "topic muted", title: topics.join(", "), text: topics.join(", ") });
    this.body = element("div", {});
    this.rate = rate;
    this.choice = element("select", { "aria-label": `What colors the points of ${robot}'s ${name}`, title: "What colors the points" });
    this.choice.addEventListener("change", () => ask("ColorSensor", { sensor: key, by: this.choice.value }));
    this.bar = new ColorBar();
    this.colors = element("div", { class: "colors", hidden: true }, this.choice, this.bar.node);
    this.node = element("div", { class: "sensor" }, element("div", { class: "row" }, node, this.about), this.topics, this.colors, this.body);
    this.tiles = new Map();
    this.plots = new Map();
  }

  state(shown, key) {
    const on = key in shown;
    this.show(on);
    if (!on && this.body.childElementCount) {
      this.body.replaceChildren();
      this.tiles.clear();
      this.plots.clear();
    }
    this.colorBy(shown[key] ?? {});
    for (const group of shown[key]?.groups ?? []) this.plot(shown[key].time, group);
  }

  // Show what the points in the scene are colored by.
  colorBy({ legend = null, choices = [], colored_by: by }) {
    this.colors.hidden = choices.length === 0;
    if (this.choice.options.length !== choices.length) this.choice.replaceChildren(...choices.map((choice) => element("option", { value: choice, text: choice })));
    if (by && document.activeElement !== this.choice) this.choice.value = by;
    this.bar.show(legend);
  }

  plot(time, { name, unit, labels, values }) {
    if (!this.plots.has(name)) {
      const plot = new Plot({ label: name.replaceAll("_", " "), unit });
      this.plots.set(name, plot);
      this.body.append(plot.node);
    }
    this.plots.get(name).add(time, values, labels);
  }

  picture({ topic, width, height, size, encoding, legend }, bytes) {
    if (!this.input.checked) return;
    if (!this.tiles.has(topic)) {
      const tile = { canvas: element("canvas", { role: "img", "aria-label": `Picture of ${topic}` }), bar: new ColorBar(), about: element("span", { class: "about" }) };
      this.tiles.set(topic, tile);
      const caption = element("figcaption", {}, element("span", { class: "topic", text: topic, title: topic }), tile.about);
      this.body.append(element("figure", { class: "picture" }, tile.canvas, tile.bar.node, caption));
    }
    const { canvas, bar, about } = this.tiles.get(topic);
    bar.show(legend);
    setText(about, [size.join(" × "), encoding, this.rate ? `${this.rate} Hz` : ""].filter(Boolean).join(", "));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const image = new ImageData(width, height);
    for (let from = 0, to = 0; from < bytes.length; from += 3, to += 4) {
      image.data[to] = bytes[from];
      image.data[to + 1] = bytes[from + 1];
      image.data[to + 2] = bytes[from + 2];
      image.data[to + 3] = 255;
    }
    canvas.getContext("2d").putImageData(image, 0, 0);
    canvas.dataset.pictures = Number(canvas.dataset.pictures ?? 0) + 1;
  }
}
