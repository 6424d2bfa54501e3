// The plots below the scene: any numbers of any topics, kept for the scenario in this browser.

import { $, element, setText } from "./dom.js";
import { Plot } from "./plot.js";
import { save } from "./plot_export.js";

const STORED = "drake_twin plots ";
const MOST_CURVES = 40;

// The topic of a path such as /robot_1/joint_states.velocity[2], and the field in its messages.
export const partsOf = (path) => path.split(/\.(.*)/s).slice(0, 2);

// A browser may forbid storage; the plots work without it.
function stored(key) {
  try {
    const layout = JSON.parse(localStorage.getItem(STORED + key));
    return Array.isArray(layout) ? layout.filter(Array.isArray).map((paths) => paths.filter((path) => typeof path === "string")) : [];
  } catch {
    return [];
  }
}

function store(key, layout) {
  try {
    localStorage.setItem(STORED + key, JSON.stringify(layout));
  } catch {
    // It is not kept then.
  }
}

// What the curves of a plot show, without those that are laid beside them.
const pathsOf = (plot) => [...plot.curves].filter(([, { like }]) => !like).map(([path]) => path);

class Figure {
  constructor(plots) {
    this.plot = new Plot({ label: "", name: "Plot", height: 150, onremove: (path) => plots.remove(this, path) });
    const button = (text, label, onclick) => element("button", { class: "small", text, title: label, "aria-label": label, onclick });
    this.problems = element("p", { class: "refusal", hidden: true });
    this.choice = element("button", { class: "small", text: "Add here", title: "What is chosen next comes to this plot", onclick: () => plots.choose(this) });
    const tools = element(
      "div",
      { class: "plot-tools", role: "group", "aria-label": "Plot" },
      this.choice,
      element("span", { class: "spacer" }),
      button("◂", "Earlier", () => this.plot.zoomBy(1, -0.25)),
      button("▸", "Later", () => this.plot.zoomBy(1, 0.25)),
      button("+", "Zoom in", () => this.plot.closer()),
      button("−", "Zoom out", () => this.plot.farther()),
      button("Fit", "Show all times", () => this.plot.fit()),
      button("CSV", "Save the numbers as a table (CSV)", () => save(new Blob([this.plot.csv()], { type: "text/csv" }), "plot.csv")),
      button("PNG", "Save a picture of the plot (PNG)", () => this.plot.picture()?.toBlob((blob) => save(blob, "plot.png"))),
      button("×", "Close the plot", () => plots.close(this)),
    );
    this.plot.node.prepend(tools);
    this.node = element("div", { class: "kept-plot" }, this.plot.node, this.problems);
  }
}

class Plots {
  constructor() {
    this.figures = [];
    this.chosen = null;
    this.key = null;
    this.onask = () => {};
    this.onchange = () => {}; // of what is compared
    this.beside = ""; // the name of what is compared
    this.number = 0; // of the last batch
    this.grid = element("div", { class: "plot-grid" });
    this.note = element("span", { class: "muted", role: "status" });
    $("plots").append(
      element(
        "div",
        { class: "heading" },
        element("h2", { text: "Plots" }),
        this.note,
        element("button", { class: "small", text: "New plot", onclick: () => this.open() }),
      ),
      this.grid,
    );
  }

  get paths() {
    return [...new Set(this.figures.flatMap(({ plot }) => pathsOf(plot)))];
  }

  // The curves of a bag that are not there yet; they come whole.
  get missing() {
    return this.paths.filter((path) => this.figures.some(({ plot }) => plot.curves.has(path) && !plot.curves.get(path).isWhole));
  }

  // Plot a number in the chosen plot.
  add(path) {
    if (document.body.matches(".display-only")) return;
    const figure = this.chosen ?? this.open();
    figure.plot.addCurve(path);
    this.keep();
    this.onask();
    this.onchange();
    figure.node.scrollIntoView({ block: "nearest" });
  }

  open() {
    const figure = new Figure(this);
    this.figures.push(figure);
    this.grid.append(figure.node);
    this.choose(figure);
    return figure;
  }

  choose(figure) {
    this.chosen = figure;
    for (const each of this.figures) {
      each.node.classList.toggle("chosen", each === figure);
      each.choice.setAttribute("aria-pressed", String(each === figure));
    }
    this.keep();
  }

  remove(figure, path) {
    figure.plot.removeCurve(path);
    if (figure.plot.curves.size === 0) this.close(figure);
    this.keep();
  }

  close(figure) {
    figure.node.remove();
    this.figures = this.figures.filter((each) => each !== figure);
    this.choose(this.figures.at(-1) ?? null);
  }

  // Show the layout that was kept for a scenario, once it is known.
  restore(key) {
    if (this.key !== null) return;
    this.key = key;
    if (this.figures.length) this.keep();
    else {
      for (const paths of stored(key)) {
        const { plot } = this.open();
        for (const path of paths.slice(0, MOST_CURVES)) plot.addCurve(path);
      }
    }
    this.onask();
  }

  keep() {
    $("plots").hidden = this.figures.length === 0;
    if (this.key !== null) store(this.key, this.figures.map(({ plot }) => pathsOf(plot)));
  }

  // Take whole curves of a bag.
  takeWhole(curves) {
    for (const [path, { times, values, unit }] of Object.entries(curves)) {
      for (const { plot } of this.figures) {
        const curve = plot.curves.get(path);
        if (!curve || curve.isWhole) continue;
        curve.isWhole = true;
        plot.setUnit(path, unit);
        plot.set(path, times, values);
      }
    }
  }

  // Lay the curves of something beside those that are there, from now on; "" takes them away.
  layBeside(name) {
    for (const { plot } of this.figures) {
      for (const [path, { like }] of plot.curves) if (like) plot.removeCurve(path);
      for (const curve of plot.curves.values()) curve.hasBeside = false;
    }
    this.beside = name;
  }

  // The topics and fields of the curves that have none beside them yet.
  missingBeside() {
    const missing = this.figures.flatMap(({ plot }) => pathsOf(plot).filter((path) => !plot.curves.get(path).hasBeside));
    return [...new Set(missing)].map(partsOf);
  }

  takeBeside(curves) {
    for (const [path, { times, values, unit }] of Object.entries(curves)) {
      for (const { plot } of this.figures) {
        const curve = plot.curves.get(path);
        if (!curve || curve.hasBeside) continue;
        curve.hasBeside = true;
        if (times.length === 0) continue;
        const name = `${this.beside}: ${path}`;
        plot.addCurve(name, name, path);
        plot.setUnit(name, unit);
        plot.set(name, times, values);
      }
    }
  }

  // Take batches of samples; those that came before are known by their numbers.
  take(batches, problems, units) {
    const fresh = batches.filter(({ number }) => number > this.number || number + batches.length < this.number);
    this.number = fresh.at(-1)?.number ?? this.number;
    for (const { plot, problems: node } of this.figures) {
      const paths = pathsOf(plot);
      for (const path of paths) if (path in units) plot.setUnit(path, units[path]);
      for (const { samples } of fresh) {
        for (const path of paths) {
          if (path in samples) plot.extend(path, samples[path].map(([time]) => time), samples[path].map(([, value]) => value));
        }
      }
      setText(node, paths.filter((path) => path in problems).map((path) => problems[path]).join(" "));
      node.hidden = !node.textContent;
    }
  }
}

export const plots = new Plots();
