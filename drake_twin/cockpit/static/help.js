// The keys and the mouse, in a dialog.

import { $, element } from "./dom.js";

const KEYS = [
  ["Space", "Play or pause"],
  ["N", "Step"],
  ["Shift N", "One picture of the last minute, or a step of a bag, back"],
  ["R", "Reset"],
  ["W A S D, arrows", "Drive the robot whose pad drives by keys; Q and E sideways"],
  ["F", "Fit the selection, or all robots, into the picture"],
  ["1 2 3 4", "Look from an angle, the front, the left, the top"],
  ["P", "Side panel"],
  ["Ctrl K", "Find a button, a robot, a joint, a topic"],
  ["Ctrl Z", "Undo the last move, duplicate or delete"],
  ["Esc", "Close a dialog"],
  ["?", "This help"],
  ["Click", "Select a link or model; the ground selects nothing"],
  ["Double click", "Bring a link or model into the picture"],
  ["Drag", "Turn the camera; with the right button move it; wheel: closer and farther"],
  ["Ctrl and drag", "Drag a link with a spring"],
];

export class Help {
  // `more` returns further keys, each with what it does.
  constructor(more) {
    this.more = more;
    this.list = element("dl", {});
    const close = element("button", { class: "primary", text: "Close", onclick: () => this.dialog.close() });
    this.dialog = element("dialog", { id: "help", "aria-labelledby": "help-title" }, element("h2", { id: "help-title", text: "Keys and mouse" }), this.list, element("menu", {}, close));
    document.body.append(this.dialog);
    $("help-button").addEventListener("click", () => this.open());
  }

  open() {
    const rows = [...KEYS, ...this.more()].flatMap(([keys, what]) => [element("dt", {}, element("kbd", { text: keys })), element("dd", { text: what })]);
    this.list.replaceChildren(...rows);
    this.dialog.showModal();
  }
}
