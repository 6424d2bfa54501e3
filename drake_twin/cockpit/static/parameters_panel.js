// The panel of parameters: a filtered list, and a field for the chosen one.

import { element, reveal, setText } from "../dom.js";
import { keep, kept } from "../kept.js";
import { Rows } from "../rows.js";

const LOOK = 1000; // ms between two requests for data
const SHORT = 30; // letters of a value in the list

export default class ParametersPanel {
  constructor(ask) {
    this.ask = ask;
    this.version = 0;
    [this.all, this.listed] = [[], []];
    this.sent = 0;
    this.filter = element("input", { type: "search", placeholder: "Filter", "aria-label": "Filter parameters", oninput: () => this.filterBy(this.filter.value) });
    this.filter.value = kept().parameters ?? "";
    this.names = element("ul", { class: "parameters", "aria-label": "Parameters", "data-listed": true }); // by `commands`
    this.rows = new Rows(this.names, (index) => this.item(this.listed[index]));
    this.head = element("h3", {});
    this.about = element("p", { class: "muted" });
    this.value = element("input", { "aria-label": "Value", spellcheck: false });
    this.button = element("button", { type: "submit", text: "Set", title: "Set the parameter, as ros2 param set does" });
    this.problem = element("p", { class: "refusal", role: "status", hidden: true });
    this.form = element("form", { class: "parameter", onsubmit: (event) => this.submit(event) }, element("div", { class: "row" }, this.value, this.button), this.problem);
    this.details = element("details", {}, element("summary", { text: "Parameters" }), this.filter, this.names, this.head, this.about, this.form);
    this.node = element("div", { class: "parameters-panel" }, this.details);
    this.details.addEventListener("toggle", () => this.look());
    this.choose(null);
    setInterval(() => this.look(), LOOK);
  }

  // Ask for data, while somebody can see them.
  look() {
    if (document.visibilityState !== "visible" || document.body.matches(".gone, .display-only, .playback")) return;
    if (this.details.open && this.node.checkVisibility()) this.ask({ do: "Look", version: this.version });
  }

  filterBy(words) {
    this.filter.value = words;
    keep({ parameters: words });
    this.list();
  }

  list() {
    const wanted = this.filter.value.trim().toLowerCase().split(/\s+/);
    this.listed = this.all.filter(({ node, name }) => wanted.every((word) => `${node} ${name}`.toLowerCase().includes(word)));
    this.rows.show(this.listed.length);
  }

  item(row) {
    const isChosen = row.node === this.chosen?.node && row.name === this.chosen?.name;
    const value = row.value.length > SHORT ? `${row.value.slice(0, SHORT)}…` : row.value;
    const about = `${value}, ${row.node}`;
    const button = element("button", { "aria-pressed": String(isChosen), title: `${row.node} ${row.name}`, onclick: () => this.choose(isChosen ? null : row) }, row.name, element("small", { text: about }));
    return element("li", {}, button);
  }

  choose(row) {
    this.chosen = row;
    this.list();
    this.head.hidden = this.about.hidden = this.form.hidden = !row;
    this.problem.hidden = true;
    if (!row) return;
    setText(this.head, `${row.name} of ${row.node}`);
    setText(this.about, row.read_only ? `${row.about} It cannot be set while the twin runs.`.trim() : row.about);
    this.value.value = row.value;
    this.value.disabled = this.button.disabled = row.read_only;
  }

  submit(event) {
    event.preventDefault();
    this.sent += 1;
    const { node, name } = this.chosen;
    this.ask({ do: "SetParameter", node, name, text: this.value.value, key: `${node} ${name} ${this.sent}` });
  }

  // The parameters, to be found; those that were asked for are there a moment later.
  commands(asks) {
    if (asks) this.ask({ do: "Look", version: this.version });
    return this.all.map((row) => ({ text: `${row.name} ${row.node}`, about: "parameter", run: () => this.find(row) }));
  }

  find(row) {
    this.details.open = true;
    this.filterBy("");
    this.choose(row);
    reveal(this.node);
    this.rows.bring(this.listed.indexOf(row));
  }

  state(data) {
    if (!data) return;
    const { version, rows, outcome } = data;
    if (rows) {
      Object.assign(this, { all: rows, version });
      const now = rows.find(({ node, name }) => node === this.chosen?.node && name === this.chosen?.name) ?? null;
      if (now && now.value !== this.chosen.value && document.activeElement !== this.value) this.value.value = now.value;
      if (this.chosen && !now) this.choose(null);
      else this.chosen = now;
      this.list();
    } else if (version !== this.version) this.look();
    if (this.chosen && outcome.key === `${this.chosen.node} ${this.chosen.name} ${this.sent}`) {
      setText(this.problem, outcome.problem);
      this.problem.hidden = !outcome.problem;
    }
  }
}
