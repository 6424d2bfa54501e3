// Find (Ctrl K): everything on the page that can be pressed, switched, set or opened, and the topics, by words of its name.

import { $, element, reveal } from "./dom.js";

const MOST = 40; // results that are listed
const SHORT = 60; // characters of a button's text, above which its title names it
const OPERABLE = "button, summary, select, input:not([type=hidden])";
const HERE = ".bar, #panel, #plots, footer"; // where they are looked for

export class Palette {
  // `more` returns further commands, { text, about, run }, and asks for others if it is given true; `robots` has what can be
  // operated of robots that are not in the page.
  constructor(more, robots) {
    Object.assign(this, { more, robots });
    this.input = element("input", {
      type: "text", role: "combobox", spellcheck: "false", autocomplete: "off", placeholder: "Find a button, a robot, a joint, a topic…",
      "aria-label": "Find", "aria-expanded": "true", "aria-controls": "found", "aria-autocomplete": "list",
    });
    this.results = element("ul", { id: "found", role: "listbox", "aria-label": "Found" });
    this.none = element("p", { class: "muted", role: "status" });
    this.dialog = element("dialog", { id: "palette", "aria-label": "Find" }, this.input, this.results, this.none);
    document.body.append(this.dialog);
    this.input.addEventListener("input", () => this.find());
    this.input.addEventListener("keydown", (event) => this.key(event));
    this.dialog.addEventListener("click", ({ target }) => target === this.dialog && this.dialog.close());
    this.dialog.addEventListener("close", () => this.robots.forgetApart());
    $("find-button").addEventListener("click", () => this.open());
  }

  open() {
    if (document.querySelector("dialog[open]")) return;
    this.offered = [...document.querySelectorAll(OPERABLE)].filter(isOffered).map((node) => commandOf(node));
    const isUsable = ({ node }) => !node.disabled && !node.closest("[hidden]");
    this.offered.push(...this.robots.apart().filter(isUsable).map(({ node, robot, open }) => commandOf(node, robot, open)));
    this.input.value = "";
    this.others = this.more(true);
    this.dialog.showModal();
    this.find();
  }

  find() {
    const words = this.input.value.toLowerCase().split(/\s+/).filter(Boolean);
    const found = [...this.others, ...this.offered].filter(({ text, about }) => words.every((word) => `${text} ${about}`.toLowerCase().includes(word)));
    // What has the words in its own name comes first, then what switches nothing on or off, then the shorter name.
    const rank = ({ text }) => words.filter((word) => !text.toLowerCase().includes(word)).length;
    if (words.length) found.sort((one, other) => rank(one) - rank(other) || isSwitch(one) - isSwitch(other) || one.text.length - other.text.length);
    this.found = found.slice(0, MOST);
    this.results.replaceChildren(...this.found.map((command, index) => this.row(command, index)));
    this.none.textContent = found.length ? (found.length > MOST ? `${found.length - MOST} more` : "") : "Nothing has these words.";
    this.mark(0);
  }

  // List what was asked for and has come.
  state() {
    if (!this.dialog.open) return;
    const others = this.more(false);
    if (others.length === this.others.length && others.at(-1)?.text === this.others.at(-1)?.text) return;
    this.others = others;
    this.find();
  }

  row({ text, about }, index) {
    const row = element("li", { id: `found-${index}`, role: "option" }, element("span", { text }), element("small", { text: about }));
    row.addEventListener("click", () => this.run(index));
    return row;
  }

  mark(index) {
    this.at = Math.max(0, Math.min(index, this.found.length - 1));
    [...this.results.children].forEach((row, place) => row.setAttribute("aria-selected", String(place === this.at)));
    const row = this.results.children[this.at];
    row?.scrollIntoView({ block: "nearest" });
    if (row) this.input.setAttribute("aria-activedescendant", row.id);
    else this.input.removeAttribute("aria-activedescendant");
  }

  key(event) {
    const moves = { ArrowDown: this.at + 1, ArrowUp: this.at - 1, PageDown: this.at + 10, PageUp: this.at - 10 };
    if (event.key in moves) this.mark(moves[event.key]);
    else if (event.key === "Enter") this.run(this.at);
    else return;
    event.preventDefault();
  }

  run(index) {
    const command = this.found[index];
    if (!command) return;
    this.dialog.close();
    command.run();
  }
}

const isSwitch = ({ node }) => Number(node?.type === "checkbox");

// Whether somebody could operate it now, if what is around it were unfolded.
function isOffered(node) {
  if (!node.closest(HERE) || node.disabled || node.closest("[inert], [data-listed]")) return false;
  for (let each = node; each !== document.body; each = each.parentElement) {
    if (each.matches(".page")) continue; // its tab can be chosen
    if (each.hidden || (!each.closest(".folded") && each.id !== "panel" && getComputedStyle(each).display === "none")) return false;
  }
  return true;
}

function nameOf(node) {
  const { title = "" } = node;
  const seen = [...node.childNodes].filter((each) => !each.hidden).map(({ textContent }) => textContent);
  const text = seen.join(" ").replace(/\s+/g, " ").trim();
  const label = node.getAttribute("aria-label") || [...(node.labels ?? [])].map((each) => each.textContent.trim()).join(" ");
  return label || (title && (node.localName !== "summary" || text.length > SHORT) ? title : text);
}

// A command of what can be operated: it is unfolded and shown; buttons and switches are pressed, all else gets the focus.
// One that is not in the page is put there by `open`.
function commandOf(node, robot = node.closest("[data-robot]")?.dataset.robot ?? "", open = () => {}) {
  const group = [node.closest(".group")?.dataset.tab, node.closest(".own-panel")?.ariaLabel].filter(Boolean).join(" · ");
  const name = nameOf(node);
  const state = node.type === "checkbox" ? `switch, ${node.checked ? "on" : "off"}` : node.localName === "summary" ? "open" : "";
  return { text: name, about: [name.includes(robot) ? "" : robot, group, state].filter(Boolean).join(" · "), node, run: () => (open(), operate(node)) };
}

function operate(node) {
  reveal(node);
  node.focus();
  if (node.localName === "summary") node.parentElement.open = true;
  else if (node.localName === "button" || node.type === "checkbox") node.click();
}
