// A form for a message, made from the one that the twin gives: a field for each number, or the whole as YAML.

import { element, setText } from "./dom.js";

const CLOSED = ["header", "layout"]; // parts that are seldom filled in

// A part of the form: its node, and a function that reads its value.
function part(label, value, labels) {
  if (value !== null && typeof value === "object" && !Array.isArray(value)) return group(label, value, labels);
  if (Array.isArray(value) && labels.length === value.length && value.length) return elements(label, value, labels);
  if (Array.isArray(value) && typeof value[0] === "object") return elements(label, value, value.map((_, index) => `${label}[${index}]`));
  if (typeof value === "boolean") return field(label, { type: "checkbox", checked: value }, (input) => input.checked);
  if (typeof value === "number") return field(label, { type: "text", inputmode: "decimal", value: String(value) }, (input) => parsed(label, input.value));
  if (typeof value === "string") return field(label, { type: "text", value }, (input) => input.value);
  return field(`${label} (a JSON list)`, { type: "text", value: JSON.stringify(value), spellcheck: "false" }, (input) => parsed(label, input.value));
}

function parsed(label, text) {
  try {
    return JSON.parse(text);
  } catch {
    throw new SyntaxError(`${label}: ${text || "nothing"} is not a value`);
  }
}

function field(label, attributes, read) {
  const input = element("input", attributes);
  return { node: element("label", {}, element("span", { text: label }), input), read: () => read(input) };
}

function group(label, value, labels) {
  const parts = Object.entries(value).map(([name, item]) => [name, part(name, item, name === "data" ? labels : [])]);
  const nodes = parts.map(([, { node }]) => node);
  const read = () => Object.fromEntries(parts.map(([name, item]) => [name, item.read()]));
  if (!label) return { node: element("div", {}, ...nodes), read };
  return { node: element("details", { open: !CLOSED.includes(label) }, element("summary", { text: label }), ...nodes), read };
}

function elements(label, value, labels) {
  const parts = value.map((item, index) => part(labels[index], item, []));
  return { node: element("div", { role: "group", "aria-label": label }, ...parts.map(({ node }) => node)), read: () => parts.map((item) => item.read()) };
}

export class PublishForm {
  constructor(ask) {
    this.ask = ask;
    this.key = "";
    this.topic = "";
    this.fields = element("div", { role: "group", "aria-label": "Message" });
    this.text = element("textarea", { spellcheck: "false", "aria-label": "Message as YAML" });
    this.asText = element("details", {}, element("summary", { text: "As YAML" }), this.text);
    this.asText.addEventListener("toggle", () => (this.fields.hidden = this.asText.open));
    this.refusal = element("p", { class: "refusal", role: "alert", hidden: true });
    this.outcome = element("output", { class: "muted", role: "status" });
    const button = element("button", { type: "submit", class: "small primary", text: "Publish" });
    this.node = element("form", { class: "publish", novalidate: true, hidden: true }, this.fields, this.asText, this.refusal, button, this.outcome);
    this.node.addEventListener("submit", (event) => this.publish(event));
  }

  // Show the form of a topic; null hides it. What is filled in stays while the topic is shown.
  show(topic, form) {
    this.node.hidden = !form;
    if (!form) this.topic = "";
    if (!form || this.topic === topic) return;
    this.topic = topic;
    this.refuse("");
    setText(this.outcome, "");
    this.made = part("", form.fields, form.labels);
    this.fields.replaceChildren(this.made.node);
    this.text.value = form.text;
  }

  publish(event) {
    event.preventDefault();
    this.key = ""; // what comes of the last message is over
    this.refuse("");
    setText(this.outcome, "");
    try {
      const text = this.asText.open ? this.text.value : JSON.stringify(this.made.read());
      this.key = crypto.getRandomValues(new Uint32Array(2)).join("-");
      this.ask({ do: "Publish", topic: this.topic, text, key: this.key });
    } catch (error) {
      if (!(error instanceof SyntaxError)) throw error;
      this.refuse(error.message);
    }
  }

  refuse(text) {
    this.refusal.hidden = !text;
    setText(this.refusal, text);
  }

  heard({ key, problem, text }) {
    if (!key || key !== this.key) return;
    this.refuse(problem);
    setText(this.outcome, text);
  }
}
