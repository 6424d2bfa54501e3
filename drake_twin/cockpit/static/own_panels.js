// The panels of a user's own, drawn from plain data that own_panels.py sends: one section for each.

import { $, Slider, element, setText, toggle } from "../dom.js";
import { Plot } from "../plot.js";

const LOOK = 1000; // ms between two requests for data
const PATIENCE = 600; // ms for which a value that was just set is kept on the page

// A labelled field. `write` shows a value; while a person edits it, and shortly after, it is left alone.
function field({ label, unit, hint }, input, write) {
  let until = 0;
  const caption = element("span", { title: hint || label, text: label });
  const node = element("label", { class: "field" }, caption, input, element("span", { class: "unit", text: unit ?? "" }));
  if (hint) input.title = hint;
  input.addEventListener("input", () => (until = Infinity));
  input.addEventListener("blur", () => (until = Math.min(until, performance.now() + PATIENCE)));
  return {
    node,
    asked: () => (until = performance.now() + PATIENCE),
    show: (value) => performance.now() > until && write(value),
    disable(on) {
      input.disabled = on;
      node.classList.toggle("disabled", on);
    },
  };
}

const KINDS = {
  slider({ label, lower, upper, step, unit, hint }, set) {
    const slider = new Slider({ label, unit, lower, upper, step: step ?? undefined, onmove: set });
    if (hint) slider.node.title = hint;
    return { node: slider.node, show: (value) => slider.show(value), disable: (on) => (slider.disabled = on) };
  },
  number({ lower, upper, ...about }, set) {
    const input = element("input", { type: "number", step: "any", min: lower, max: upper });
    const made = field(about, input, (value) => input.value !== String(value) && (input.value = value));
    input.addEventListener("change", () => {
      made.asked();
      if (Number.isFinite(input.valueAsNumber)) set(input.valueAsNumber);
    });
    return made;
  },
  text(about, set) {
    const input = element("input", { type: "text", maxlength: 1000, spellcheck: "false", autocomplete: "off" });
    const made = field(about, input, (value) => input.value !== value && (input.value = value));
    input.addEventListener("change", () => {
      made.asked();
      set(input.value);
    });
    return made;
  },
  choice({ choices, ...about }, set) {
    const options = choices.map((choice) => element("option", { value: choice, text: choice }));
    const select = element("select", {}, ...options);
    const made = field(about, select, (value) => select.value !== value && (select.value = value));
    select.addEventListener("change", () => {
      made.asked();
      set(select.value);
    });
    return made;
  },
  checkbox({ label, hint }, set) {
    const { node, input, show } = toggle(label, label, set);
    node.title = hint || label;
    return { node, show, disable: (on) => (input.disabled = on) };
  },
  marker({ label, hint, color }, set) {
    const made = KINDS.checkbox({ label, hint: hint || "Show it in the scene" }, set);
    const swatch = element("span", { class: "swatch" });
    swatch.style.setProperty("--color", `rgb(${color.map(Number).join(" ")})`);
    made.node.append(swatch);
    return made;
  },
  button({ label, hint }, set, press) {
    const node = element("button", { class: "press", text: label, title: hint || label, onclick: press });
    return { node, show() {}, disable: (on) => (node.disabled = on) };
  },
  plot({ label, unit, hint }) {
    const plot = new Plot({ label, unit });
    if (hint) plot.node.title = hint;
    return { node: plot.node, read: (numbers, time) => plot.add(time, Object.values(numbers), Object.keys(numbers)) };
  },
  table({ label, hint, columns }) {
    const body = element("tbody");
    const head = columns.length ? [element("thead", {}, element("tr", {}, ...columns.map((text) => element("th", { scope: "col", text }))))] : [];
    const table = element("table", { "aria-label": label }, ...head, body);
    const scrolled = element("div", { class: "scrolled", tabindex: 0, role: "region", "aria-label": label }, table);
    const node = element("figure", { title: hint || null }, element("figcaption", { text: label }), scrolled);
    return { node, read: (rows) => fill(body, rows) };
  },
  image({ label, hint }) {
    const image = element("img", { alt: label, hidden: true });
    const node = element("figure", { title: hint || null }, element("figcaption", { text: label }), image);
    return {
      node,
      picture(png) {
        image.src = `data:image/png;base64,${png}`;
        image.hidden = false;
      },
    };
  },
};

// Write the rows of a table into the cells that are there.
function fill(body, rows) {
  while (body.rows.length > rows.length) body.deleteRow(-1);
  rows.forEach((texts, place) => {
    const row = body.rows[place] ?? body.insertRow();
    while (row.cells.length > texts.length) row.deleteCell(-1);
    texts.forEach((text, at) => setText(row.cells[at] ?? row.appendChild(element(at ? "td" : "th", at ? {} : { scope: "row" })), text));
  });
}

class Section {
  constructor(panel, ask) {
    this.ask = ask;
    this.parts = new Map();
    const problem = panel.problem ? [element("p", { class: "refusal", role: "alert", text: panel.problem })] : [];
    const heading = element("h2", { text: panel.label });
    this.node = element("section", { class: "group own-panel", "aria-label": panel.label }, heading, ...problem, this.list(panel.items));
  }

  list(items) {
    return element("div", { class: "own" }, ...items.flatMap((item) => this.part(item)));
  }

  part(item) {
    if (item.kind === "folder") return [element("details", { open: true }, element("summary", { text: item.label, title: item.label }), this.list(item.items))];
    const set = (value) => this.ask({ do: "Set", control: item.id, value });
    const part = KINDS[item.kind](item, set, () => this.ask({ do: "Press", control: item.id }));
    part.problem = element("p", { class: "refusal", role: "status", hidden: true });
    this.parts.set(String(item.id), part);
    return [part.node, part.problem];
  }

  get isShown() {
    return this.node.offsetParent !== null && !this.node.classList.contains("folded");
  }

  state({ time, values, disabled, read, images, problems }) {
    const off = new Set(disabled.map(String));
    for (const [id, part] of this.parts) {
      if (id in values) {
        part.show(values[id]);
        part.disable?.(off.has(id));
      }
      if (id in read) part.read(read[id], time);
      if (id in images) part.picture(images[id]);
      setText(part.problem, problems[id] ?? "");
      part.problem.hidden = !(id in problems);
    }
  }
}

export default class OwnPanels {
  // `onsection` lets the heading of a section fold it.
  constructor(ask, onsection) {
    this.ask = ask;
    this.onsection = onsection;
    this.node = element("div");
    this.version = 0;
    this.newest = 0;
    this.sections = new Map(); // by the panel's number: its section, and the layout that it was made from
  }

  look() {
    if (document.visibilityState !== "visible") return;
    const shown = [...this.sections].filter(([, { section }]) => section.isShown).map(([id]) => id);
    this.ask({ do: "Look", version: this.version, images: this.newest, shown });
  }

  // Draw what has come or changed.
  layout(panels) {
    const left = new Set(panels.map(({ id }) => id));
    for (const [id, { section }] of this.sections) {
      if (left.has(id)) continue;
      section.node.remove();
      this.sections.delete(id);
    }
    for (const panel of panels) {
      const made = JSON.stringify(panel);
      const known = this.sections.get(panel.id);
      if (known?.made === made) continue;
      const section = new Section(panel, this.ask);
      if (known) known.section.node.replaceWith(section.node);
      else this.node.append(section.node);
      this.sections.set(panel.id, { section, made });
      this.onsection(section.node);
    }
  }

  state(own) {
    if (!own) return;
    this.timer ??= setInterval(() => this.look(), LOOK);
    if (own.panels) {
      this.layout(own.panels);
      this.version = own.version;
      this.look();
    } else if (own.version !== this.version && own.version !== this.asked) {
      this.asked = own.version;
      this.look();
    }
    if (!own.values) return;
    this.newest = own.newest_image;
    for (const { section } of this.sections.values()) section.state(own);
  }
}
