// The panel of topics: their list, echo and publishing of one of them, plots of its numbers, frames, the diagram.

import { element, reveal, setText } from "../dom.js";
import { Drawing } from "../drawing.js";
import { Frames } from "../frames.js";
import { keep, kept } from "../kept.js";
import { partsOf, plots } from "../plots.js";
import { PublishForm } from "../publish_form.js";
import { Rows } from "../rows.js";

const LOOK = 1000; // ms between two requests for data
const OUT = { published: "", commanded: "listened to", action: "action" };

export default class TopicsPanel {
  constructor(ask) {
    this.ask = ask;
    this.version = 0;
    this.topics = [];
    this.chosen = "";
    this.frames = new Frames();
    this.drawing = new Drawing(() => ask({ do: "Draw" }), (names) => this.find(names));
    this.filter = element("input", { type: "search", placeholder: "Filter", "aria-label": "Filter topics", oninput: () => this.filterBy(this.filter.value) });
    this.filter.value = kept().topics ?? "";
    this.names = element("ul", { class: "topics", "aria-label": "Topics", "data-listed": true }); // by `commands`
    this.rows = new Rows(this.names, (index) => this.item(this.listed[index]));
    this.head = element("h3", {});
    this.values = element("tbody");
    this.echo = element("div", { class: "echo", tabindex: 0, role: "region", "aria-label": "Last message" }, element("table", {}, this.values));
    this.form = new PublishForm(ask);
    this.details = element("details", {}, element("summary", { text: "Topics" }), this.filter, this.names, this.head, this.echo, this.form.node);
    this.node = element("div", { class: "topics-panel" }, element("h2", { text: "ROS" }), this.details, this.frames.node, this.drawing.node);
    for (const part of [this.details, this.frames.node]) part.addEventListener("toggle", () => this.look());
    plots.onask = () => this.look();
    this.show();
    ask({ do: "Look", version: 0, echo: "", frames: false }); // for the plots that were kept
    setInterval(() => this.look(), LOOK);
    requestAnimationFrame(() => this.look());
  }

  // Ask for data, while somebody can see them.
  look() {
    if (document.visibilityState !== "visible" || document.body.matches(".gone, .display-only")) return;
    const isShown = this.node.checkVisibility();
    const [topics, frames] = [this.details, this.frames.node].map(({ open }) => isShown && open);
    const wanted = document.body.matches(".playback") ? plots.missing : plots.paths;
    if (!topics && !frames && !wanted.length && !this.drawing.isOpen) return;
    this.ask({ do: "Look", version: this.version, echo: topics ? this.chosen : "", frames });
    for (const [topic, field = ""] of wanted.map(partsOf)) this.ask({ do: "Plot", topic, field });
  }

  filterBy(words) {
    this.filter.value = words;
    keep({ topics: words });
    this.list();
  }

  list() {
    const wanted = this.filter.value.trim().toLowerCase();
    this.listed = this.topics.filter(({ name, type }) => `${name} ${type}`.toLowerCase().includes(wanted));
    const { activeElement: focused } = document;
    const name = this.names.contains(focused) ? focused.title : "";
    this.rows.show(this.listed.length);
    if (name) this.rows.made.get(this.listed.findIndex((topic) => topic.name === name))?.firstChild.focus();
  }

  item({ name, kind, type, rate, latched }) {
    const about = [OUT[kind], type, rate ? `${Number(rate.toFixed(1))} Hz` : latched ? "once" : ""].filter(Boolean).join(", ");
    const press = () => this.choose(name);
    const button = element("button", { "aria-pressed": String(name === this.chosen), title: name, onclick: press }, name, element("small", { text: about }));
    return element("li", {}, button);
  }

  choose(name) {
    this.chosen = name === this.chosen ? "" : name;
    for (const [index, row] of this.rows.made) row.firstChild.setAttribute("aria-pressed", String(this.listed[index].name === this.chosen));
    this.show();
    this.look();
  }

  // The topics, to be found; those that were asked for are there a moment later.
  commands(asks) {
    if (asks) this.ask({ do: "Look", version: this.version, echo: "", frames: false });
    return this.topics.map(({ name, type }) => ({ text: name, about: type, run: () => this.find([name]) }));
  }

  // Select what names of the diagram tell of, the most specific first: a topic, a controller's or a robot's first one.
  find(names) {
    const robot = names.find((name) => this.topics.some((topic) => topic.robot === name));
    const near = this.topics.filter((topic) => !robot || topic.robot === robot);
    let found = null;
    for (const name of names) {
      found ??= this.topics.find((topic) => [name, `/${name}`].includes(topic.name)) ?? near.find((topic) => topic.name.endsWith(`/${name}`) || topic.controller === name);
    }
    found ??= robot ? near[0] : null;
    if (!found) return false;
    const folder = document.querySelector(`.robot[data-robot="${CSS.escape(found.robot)}"] > details`);
    if (folder) folder.open = true;
    this.details.open = true;
    this.filterBy("");
    if (found.name !== this.chosen) this.choose(found.name);
    reveal(this.node);
    this.rows.bring(this.listed.indexOf(found));
    return true;
  }

  show(echo) {
    const topic = this.topics.find(({ name }) => name === this.chosen);
    this.head.hidden = this.echo.hidden = !topic;
    this.form.show(topic?.name ?? "", echo?.form ?? null);
    if (!topic) return;
    const rows = echo?.rows ?? [];
    const time = echo?.time;
    const about = [time == null ? "" : ` at ${time.toFixed(3)} s`, echo?.rate ? `, ${echo.rate.toFixed(1)} Hz` : ""].join("");
    setText(this.head, rows.length ? topic.name + about : `${topic.name}: no message`);
    const paths = JSON.stringify(rows.map(([path]) => path));
    if (paths !== this.paths) {
      this.paths = paths;
      this.values.replaceChildren(...rows.map((row) => this.row(topic, row)));
    }
    rows.forEach(([, text], index) => setText(this.values.children[index].children[1], text));
  }

  row({ name, kind }, [path, text, isNumber]) {
    const cells = [element("th", { scope: "row", text: path }), element("td", { text })];
    const buttons = [];
    if (isNumber && kind === "published") {
      const button = (label, isNew, title) => element("button", { class: "small", text: label, title, "aria-label": `${title}: ${path}`, onclick: () => this.plot(name, path, isNew) });
      buttons.push(button("Plot", false, "Plot"), button("+", true, "Plot in a plot of its own"));
    }
    return element("tr", {}, ...cells, element("td", { class: "act" }, ...buttons));
  }

  plot(topic, field, isNew = false) {
    if (isNew) plots.open();
    plots.add(`${topic}.${field}`);
  }

  state(data) {
    if (!data) return;
    plots.restore(data.layout);
    if (data.topics) {
      Object.assign(this, { topics: data.topics, version: data.version });
      this.list();
    }
    if (data.version !== this.version) this.look();
    const isShown = this.node.checkVisibility();
    if (isShown && this.details.open && this.chosen in data.echoes) this.show(data.echoes[this.chosen]);
    plots.takeWhole(data.curves ?? {});
    plots.take(data.batches, data.problems, data.units);
    this.form.heard(data.outcome);
    if (data.frames && isShown && this.frames.node.open) this.frames.show(data.frames);
    if (data.diagram) this.drawing.show(data.diagram);
  }
}
