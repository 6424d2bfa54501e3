// A bag laid over the run or the bag that is shown: its curves are dashed, its robots ghosts, the largest differences a table.

import { element, setText } from "../dom.js";
import { plots } from "../plots.js";
import { cursor } from "../time_cursor.js";

const LOOK = 1000; // ms between two requests for curves
const short = (number) => (number !== 0 && (number >= 1e4 || number < 1e-3) ? number.toExponential(2) : String(Number(number.toPrecision(3))));

// What the comparison has come to so far.
function found(progress, topics, meet, until, count) {
  const both = topics === 1 ? "the topic" : `the ${topics} topics`;
  if (progress !== null) return `Reading: ${(100 * progress).toFixed(0)} %`;
  if (topics === 0) return "The two have no topic in common that can be compared.";
  if (!meet) return `Nothing is compared yet: no message of the run is of a time that the bag has, which ends at ${until.toFixed(2)} s. Reset (R) begins at 0 s again.`;
  return count ? `Of ${both} that both have` : `No difference in ${both} that both have.`;
}

export default class ComparePanel {
  constructor(ask) {
    this.ask = ask;
    this.name = "";
    this.folder = element("input", { type: "text", spellcheck: "false", maxlength: 900, placeholder: "Folder of a bag", "aria-label": "Bag to compare with, a folder where the twin runs" });
    this.form = element("form", { class: "row" }, this.folder, element("button", { class: "small", type: "submit", text: "Lay over", title: "Lay the bag over what is shown" }));
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      if (this.folder.value.trim()) ask({ do: "Open", bag: this.folder.value.trim() });
    });
    this.problem = element("p", { class: "refusal", role: "alert", hidden: true });
    this.with = element("span", {});
    this.head = element("div", { class: "row" }, this.with, element("button", { class: "small", text: "End", title: "Compare no more", "aria-label": "End the comparison", onclick: () => ask({ do: "Close" }) }));
    this.status = element("p", { class: "muted", role: "status" });
    this.rows = element("tbody");
    const heads = ["Number", "Difference", "At"].map((text) => element("th", { scope: "col", text }));
    this.table = element("table", {}, element("caption", { class: "muted", text: "Largest differences, by the range of the values" }), element("thead", {}, element("tr", {}, ...heads)), this.rows);
    this.scroll = element("div", { class: "differences", tabindex: 0, role: "region", "aria-label": "Largest differences" }, this.table);
    this.node = element("div", { class: "compare-panel" }, element("h2", { text: "Compare" }), this.form, this.problem, this.head, this.status, this.scroll);
    plots.onchange = () => this.look();
    setInterval(() => this.look(), LOOK);
    this.state({ name: "", problem: "" });
  }

  // Ask for the curves that are still missing, while somebody can see them.
  look() {
    if (!this.name || document.visibilityState !== "visible" || document.body.matches(".gone")) return;
    for (const [topic, field = ""] of plots.missingBeside()) this.ask({ do: "Plot", topic, field });
  }

  state({ name, problem, progress = null, topics = 0, meet = true, until = 0, table = [], curves = {} }) {
    if (name !== this.name) {
      this.name = name;
      plots.layBeside(name);
      this.look();
    }
    setText(this.problem, problem);
    this.problem.hidden = !problem;
    this.form.hidden = Boolean(name);
    this.head.hidden = this.status.hidden = !name;
    this.scroll.hidden = !name || table.length === 0;
    setText(this.with, `With ${name}: dashed curves, pale robots`);
    setText(this.status, found(progress, topics, meet, until, table.length));
    plots.takeBeside(curves);
    const text = JSON.stringify(table);
    if (text === this.text) return;
    this.text = text;
    this.rows.replaceChildren(...table.map((row) => this.row(row)));
  }

  row({ topic, field, difference, at, unit }) {
    const path = `${topic}.${field}`;
    const press = () => {
      plots.add(path);
      cursor.seek(at, true);
    };
    const button = element("button", { class: "small quiet", text: path, title: `Plot ${path}, and show ${at.toFixed(2)} s`, onclick: press });
    return element("tr", {}, element("th", { scope: "row" }, button), element("td", { text: `${short(difference)} ${unit}`.trim() }), element("td", { text: `${at.toFixed(2)} s` }));
  }
}
