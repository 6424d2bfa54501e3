// What is known of the selected thing: sections of labelled values, as the twin's `Details` has them.

import { element, setText } from "./dom.js";

function inWords({ values, unit, text }) {
  const numbers = values.map((value) => {
    const short = Math.abs(value) >= 1e5 || (value !== 0 && Math.abs(value) < 1e-3) ? value.toExponential(2) : value.toFixed(3);
    return Number(short) === 0 ? "0.000" : short;
  });
  return [numbers.join("  "), numbers.length ? unit : "", text].filter(Boolean).join(" ");
}

export class Inspector {
  constructor() {
    this.node = element("div", { class: "inspector", hidden: true });
    this.form = "";
    this.cells = [];
  }

  show(details) {
    this.node.hidden = !details;
    if (!details) return;
    const form = JSON.stringify([details.id, details.sections.map(({ title, rows }) => [title, rows.map(({ label }) => label)])]);
    if (form !== this.form) this.build(details);
    this.form = form;
    const rows = details.sections.flatMap((section) => section.rows);
    rows.forEach((row, index) => setText(this.cells[index], inWords(row)));
  }

  build({ kind, name, sections }) {
    this.cells = [];
    const closed = new Set([...this.node.querySelectorAll("details:not([open])")].map((each) => each.dataset.title));
    const parts = sections.map(({ title, rows }) => {
      const list = element("dl");
      for (const { label } of rows) {
        const cell = element("dd");
        this.cells.push(cell);
        list.append(element("dt", { text: label, title: label }), cell);
      }
      return element("details", { open: !closed.has(title), "data-title": title }, element("summary", { text: title }), list);
    });
    this.node.replaceChildren(element("h3", { text: `${kind} ${name}` }), ...parts);
  }
}
