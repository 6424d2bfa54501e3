// A plot of numbers over simulation time by uPlot: axes, a legend that shows and hides curves, a cursor and zoom.
// It is drawn at most once per animation frame, and only while it can be seen.

import { element, formatted, oncePerFrame, setText } from "./dom.js";
import { csvOf, pictureOf } from "./plot_export.js";
import { cursor } from "./time_cursor.js";

const { uPlot } = window; // uplot.js, its authors' build, which is a script and no module
const KEPT = 3000; // samples of a curve
const COLORS = 8; // --line-1 to --line-8; further lines are gray
const CLOSER = 0.5;
const CLICK = 3; // px that the mouse may move between press and release of a click

const lineName = (index) => (index < COLORS ? `--line-${index + 1}` : "--muted");
const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(name);

function axis(more) {
  return {
    stroke: () => color("--muted"),
    grid: { stroke: () => color("--line"), width: 1 },
    ticks: { stroke: () => color("--line"), width: 1, size: 4 },
    font: "11px system-ui, sans-serif",
    ...more,
  };
}

// Numbers with some room around them; a constant value is a line in the middle.
function around(lowest, highest) {
  const [middle, half] = [(lowest + highest) / 2, 0.55 * Math.max(highest - lowest, 1e-3)];
  return [middle - half, middle + half];
}

function shown(value) {
  if (value == null) return "–";
  return value !== 0 && (Math.abs(value) >= 1e6 || Math.abs(value) < 1e-4) ? value.toExponential(3) : formatted(value, 1e-4);
}

// The index of the last of ascending times that is not after a time; 0 if all are.
function lastUntil(times, time) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time + 1e-9) low = middle + 1;
    else high = middle;
  }
  return Math.max(0, low - 1);
}

export class Plot {
  // `onremove(name)`, if there is one, gives each curve of the legend a button that removes it.
  constructor({ label, name, unit = "", height = 110, onremove }) {
    this.label = name ?? label;
    this.unit = unit;
    this.height = height;
    this.onremove = onremove;
    this.curves = new Map();
    this.zoom = null; // the times that are shown; null for all
    this.uplot = null;
    this.chart = element("div", { class: "chart", role: "img", "aria-label": `${this.label} over time` });
    this.legend = element("ul", { class: "legend" });
    this.node = element(
      "figure",
      { class: "plot" },
      element("figcaption", {}, label, element("span", { class: "unit", text: unit ? `, ${unit}` : "" })),
      this.chart,
      this.legend,
    );
    this.shownLine = element("i", { class: "time-line" });
    this.hoveredLine = element("i", { class: "time-line hovered" });
    this.draw = oncePerFrame(() => this.drawNow());
    new ResizeObserver(() => this.draw()).observe(this.chart);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.uplot?.redraw());
  }

  // Add values at a time (s), one for each curve; a curve is named by its place unless `names` says otherwise.
  add(time, values, names = values.map((_, index) => String(index + 1))) {
    names.forEach((name, index) => this.extend(name, [time], [values[index]]));
  }

  // Add a curve; one that is `like` another one has its color and is dashed.
  addCurve(name, label = name, like = null) {
    if (this.curves.has(name)) return;
    const taken = [...this.curves.values()].filter((curve) => !curve.like).map((curve) => curve.place);
    const place = this.curves.get(like)?.place ?? [...Array(taken.length + 1).keys()].find((index) => !taken.includes(index));
    const curve = { label, like, unit: "", times: [], values: [], place, hidden: false, value: element("output", { "aria-live": "off" }) };
    curve.about = element("span", { class: "unit" });
    const toggle = element(
      "button",
      { class: "small quiet", "aria-pressed": "true", title: `Show or hide ${label}` },
      element("span", { class: like ? "dash like" : "dash" }),
      element("span", { class: "curve", text: label }),
      curve.value,
      curve.about,
    );
    toggle.style.setProperty("--color", `var(${lineName(place)})`);
    toggle.addEventListener("click", () => {
      curve.hidden = !curve.hidden;
      toggle.setAttribute("aria-pressed", String(!curve.hidden));
      this.rebuild();
    });
    curve.node = element("li", {}, toggle);
    if (this.onremove && !like) {
      curve.node.append(
        element("button", { class: "small quiet", text: "×", "aria-label": `Remove ${label}`, title: "Remove", onclick: () => this.onremove(name) }),
      );
    }
    this.legend.append(curve.node);
    this.curves.set(name, curve);
    this.rebuild();
  }

  removeCurve(name) {
    for (const [other, { like, node }] of this.curves) {
      if (other !== name && like !== name) continue;
      node.remove();
      this.curves.delete(other);
    }
    this.rebuild();
  }

  setUnit(name, unit) {
    const curve = this.curves.get(name);
    if (!curve || curve.unit === unit) return;
    curve.unit = unit;
    setText(curve.about, unit);
    this.rebuild(); // for the axis
  }

  // Replace all samples of a curve.
  set(name, times, values) {
    Object.assign(this.curves.get(name), { times, values });
    this.draw();
  }

  // Add samples to a curve; those after a time to which the twin has returned are taken away.
  extend(name, times, values) {
    if (!this.curves.has(name)) this.addCurve(name);
    const curve = this.curves.get(name);
    for (let index = 0; index < times.length; index += 1) {
      for (; curve.times.at(-1) >= times[index]; curve.times.pop()) curve.values.pop();
      curve.times.push(times[index]);
      curve.values.push(values[index]);
    }
    const surplus = curve.times.length - KEPT;
    if (surplus > KEPT / 10) {
      curve.times.splice(0, surplus);
      curve.values.splice(0, surplus);
    }
    if (times.length) this.draw();
  }

  clear() {
    for (const curve of this.curves.values()) curve.times.length = curve.values.length = 0;
    this.zoom = null;
  }

  // Show less time or more, around the middle, or move in time; factors of the width.
  zoomBy(factor, shift = 0) {
    const [first, last] = this.zoom ?? this.bounds();
    const [middle, half] = [(first + last) / 2 + shift * (last - first), (factor * (last - first)) / 2];
    if (half > 0) this.zoom = [middle - half, middle + half];
    this.draw();
  }

  closer() {
    this.zoomBy(CLOSER);
  }

  farther() {
    this.zoomBy(1 / CLOSER);
  }

  fit() {
    this.zoom = null;
    this.draw();
  }

  bounds() {
    const times = [...this.curves.values()].filter((curve) => curve.times.length).flatMap((curve) => [curve.times[0], curve.times.at(-1)]);
    return times.length ? [Math.min(...times), Math.max(...times)] : [0, 1];
  }

  // The unit that all visible curves have; empty if they differ.
  get commonUnit() {
    const units = new Set([...this.curves.values()].filter((curve) => !curve.hidden).map((curve) => curve.unit));
    return units.size === 1 ? [...units][0] : "";
  }

  // All that is kept, as CSV.
  csv() {
    return csvOf([...this.curves.values()]);
  }

  // A canvas with what is drawn and the legend; null while nothing is.
  picture() {
    if (!this.uplot) return null;
    const legend = this.visible.map(({ label, unit, place, like }) => ({ text: unit ? `${label}, ${unit}` : label, color: color(lineName(place)), dashed: Boolean(like) }));
    return pictureOf(this.uplot.ctx.canvas, legend, { background: color("--raised"), text: color("--text") });
  }

  rebuild() {
    this.uplot?.destroy();
    this.uplot = null;
    this.draw();
  }

  build(width) {
    const visible = [...this.curves.values()].filter((curve) => !curve.hidden);
    this.visible = visible;
    this.uplot = new uPlot(
      {
        width,
        height: this.height,
        legend: { show: false },
        padding: [8, 12, 0, 0],
        cursor: {
          sync: { key: "time", scales: ["x", null] },
          drag: { x: true, y: false, setScale: false },
          points: { size: 6 },
          bind: { dblclick: () => null },
        },
        scales: { x: { time: false, range: (_, first, last) => [first ?? 0, last > first ? last : (first ?? 0) + 1] }, y: { range: (_, lowest, highest) => around(lowest ?? 0, highest ?? 1) } },
        axes: [axis({ size: 26, values: (_, ticks) => ticks.map((tick) => `${tick} s`) }), axis({ ...(this.commonUnit && { label: this.commonUnit, labelSize: 16, labelGap: 0, labelFont: "11px system-ui, sans-serif" }), size: (_, ticks) => 18 + 7 * Math.max(3, ...(ticks ?? []).map((tick) => String(tick).length)) })],
        series: [{}, ...visible.map(({ place, like }) => ({ stroke: () => color(lineName(place)), width: 1.5, dash: like ? [5, 3] : undefined, points: { show: false } }))],
        hooks: {
          setCursor: [() => this.showValues()],
          setSelect: [(plot) => this.select(plot)],
          setScale: [() => this.placeLines()],
        },
      },
      this.data(),
      this.chart,
    );
    const { over } = this.uplot;
    over.append(this.shownLine, this.hoveredLine);
    over.addEventListener("dblclick", () => this.fit());
    over.addEventListener("mousemove", ({ offsetX }) => cursor.hover(this.timeAt(offsetX), this));
    over.addEventListener("mouseleave", () => cursor.hover(null, this));
    let pressed = 0;
    over.addEventListener("mousedown", ({ clientX }) => (pressed = clientX));
    over.addEventListener("click", ({ clientX, offsetX, detail }) => {
      if (detail < 2 && Math.abs(clientX - pressed) < CLICK) cursor.seek(this.timeAt(offsetX));
    });
    cursor.follow(() => this.followTime(over));
  }

  timeAt(left) {
    return this.uplot.posToVal(left, "x");
  }

  // Show the page's time; false once this drawing is gone, so that it hears no more.
  followTime(over) {
    if (this.uplot?.over !== over || !over.isConnected) return false;
    this.placeLines();
    this.showValues();
    return true;
  }

  placeLines() {
    if (!this.uplot) return; // it is being made
    const { min, max } = this.uplot.scales.x;
    const place = (line, time) => {
      line.hidden = time === null || !(time >= min && time <= max);
      if (!line.hidden) line.style.left = `${this.uplot.valToPos(time, "x")}px`;
    };
    place(this.shownLine, cursor.shown);
    place(this.hoveredLine, cursor.hoverer instanceof Plot ? null : cursor.hovered); // else uPlot draws it
  }

  data() {
    if (this.visible.length === 0) return [[]];
    return uPlot.join(this.visible.map(({ times, values }) => [times, values]), this.visible.map(() => [0, 1]));
  }

  select(plot) {
    const { left, width } = plot.select;
    if (width < 3) return;
    this.zoom = [plot.posToVal(left, "x"), plot.posToVal(left + width, "x")];
    plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
    this.draw();
  }

  // The values at the mouse, or else at the moment that is shown, or the last ones.
  showValues() {
    const at = this.uplot?.cursor.idx;
    const time = at == null ? (cursor.hovered ?? cursor.shown) : this.uplot.data[0][at];
    for (const { times, values, value } of this.curves.values()) setText(value, shown(values[time === null ? times.length - 1 : lastUntil(times, time)]));
  }

  drawNow() {
    const width = this.chart.clientWidth;
    if (width === 0 || this.curves.size === 0) return;
    if (this.uplot === null) this.build(width);
    else if (this.uplot.width !== width) this.uplot.setSize({ width, height: this.height });
    this.uplot.setData(this.data());
    if (this.zoom) this.uplot.setScale("x", { min: this.zoom[0], max: this.zoom[1] });
    this.placeLines();
    this.showValues();
  }
}
