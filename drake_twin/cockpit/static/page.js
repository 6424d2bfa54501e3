// Puts the page together: what comes from the twin is shown, what a person does is asked for.

import { Connection } from "./connection.js";
import { $, setIcon } from "./dom.js";
import { Messages } from "./messages.js";
import { Robots } from "./robots.js";
import { Teleop } from "./teleop.js";
import { TimeControls } from "./time_controls.js";
import { View } from "./view.js";

let connection = null;
const ask = (what, fields) => connection.ask(what, fields);
const time = new TimeControls(ask);
const view = new View(ask);
const teleop = new Teleop(ask);
const robots = new Robots(ask, teleop);
const messages = new Messages();
let names = [];

connection = new Connection({
  on: {
    robots(structure) {
      names = structure.robots.map((robot) => robot.name);
      for (const part of [time, view, robots]) part.structure(structure);
    },
    state(state) {
      for (const part of [time, view, robots]) part.state(state);
      document.body.classList.add("ready");
    },
    messages: (lines) => messages.show(lines),
  },
  status(connected) {
    $("connection").hidden = connected;
    $("connection").textContent =
      "The twin does not answer. Trying again; if it was started anew, open the address that it printed.";
  },
});

setIcon($("panel-toggle"), "panel");
function togglePanel() {
  const open = document.body.classList.toggle("panel-closed");
  $("panel-toggle").setAttribute("aria-expanded", String(!open));
}
$("panel-toggle").addEventListener("click", togglePanel);
$("stop-all").addEventListener("click", () => names.forEach((robot) => ask("EmergencyStop", { robot })));

const SHORTCUTS = {
  Space: () => time.playOrPause(),
  KeyN: () => time.step(),
  KeyR: () => ask("Reset"),
  KeyP: togglePanel,
};

function onKey(event, down) {
  const target = event.target;
  if (target.closest?.("dialog, select, textarea, input:not([type=range]):not([type=checkbox])")) return;
  if (event.code.startsWith("Arrow") && target.closest?.("input[type=range]")) return;
  if (teleop.key(event, down)) {
    event.preventDefault();
    return;
  }
  if (!down || event.repeat || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.code === "Space" && target.closest?.("button, summary, input, a")) return;
  if (document.body.classList.contains("display-only") && event.code !== "KeyP") return;
  if (event.code in SHORTCUTS) {
    event.preventDefault();
    SHORTCUTS[event.code]();
  }
}

function listenForKeys(to) {
  to.addEventListener("keydown", (event) => onKey(event, true));
  to.addEventListener("keyup", (event) => onKey(event, false));
}
listenForKeys(window);
const scene = $("scene");
scene.addEventListener("load", () => listenForKeys(scene.contentWindow));
if (scene.contentDocument?.readyState === "complete" && scene.contentWindow.location.href !== "about:blank") {
  listenForKeys(scene.contentWindow);
}
