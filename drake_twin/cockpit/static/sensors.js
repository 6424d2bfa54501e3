// The sensors: a switch for each, pictures as tiles, numbers as plots; points are drawn in the scene by the twin.

import { $, element, toggle } from "./dom.js";
import { Plot } from "./plot.js";

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
    this.node = element("div", { class: "sensor" }, element("div", { class: "row" }, node, this.about), this.topics, this.body);
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
    for (const group of shown[key]?.groups ?? []) this.plot(shown[key].time, group);
  }

  plot(time, { name, unit, labels, values }) {
    if (!this.plots.has(name)) {
      const plot = new Plot({ label: name.replaceAll("_", " "), unit });
      this.plots.set(name, plot);
      this.body.append(plot.node);
    }
    this.plots.get(name).add(time, values, labels);
  }

  picture({ topic, width, height }, bytes) {
    if (!this.input.checked) return;
    if (!this.tiles.has(topic)) {
      const canvas = element("canvas", { role: "img", "aria-label": `Picture of ${topic}` });
      this.tiles.set(topic, canvas);
      this.body.append(element("figure", { class: "picture" }, canvas, element("figcaption", { text: topic, title: topic })));
    }
    const canvas = this.tiles.get(topic);
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
