// Puts the page together: what comes from the twin is shown, what a person does is asked for.

import { Connection } from "./connection.js";
import { $, setIcon, setText } from "./dom.js";
import { Messages } from "./messages.js";
import { Robots } from "./robots.js";
import { Stops } from "./stops.js";
import { Teleop } from "./teleop.js";
import { TimeControls } from "./time_controls.js";
import { View } from "./view.js";

let connection = null;
const stops = new Stops(showBanner);
function ask(what, fields) {
  if (what === "EmergencyStop") stops.ask(fields.robot);
  if (what === "ClearEmergencyStop") stops.asked.delete(fields.robot);
  return connection.ask(what, fields);
}
const time = new TimeControls(ask);
const view = new View(ask);
const teleop = new Teleop(ask);
const robots = new Robots(ask, teleop);
const messages = new Messages();
let names = [];
let status = "closed";
let lost = "";
let busy = 0; // s

connection = new Connection({
  on: {
    robots(structure) {
      names = structure.robots.map((robot) => robot.name);
      for (const part of [time, view, robots]) part.structure(structure);
    },
    state(state) {
      for (const part of [time, view, robots]) part.state(state);
      stops.state(state.robots);
      document.body.classList.add("ready");
    },
    messages: (lines) => messages.show(lines),
    alive(seconds) {
      busy = seconds > BUSY ? seconds : 0;
      showBanner();
    },
  },
  status(now) {
    status = now;
    lost = "";
    for (const id of ["transport", "panel", "stop-all"]) $(id).inert = now !== "open";
    document.body.classList.toggle("gone", now !== "open");
    showBanner();
  },
  lost(what) {
    lost = ` ${LOST[what] ?? "What you have just done"} did not reach it.`;
    showBanner();
  },
});

const LOST = { EmergencyStop: "The emergency stop", Drive: "What you drive" };
const BUSY = 2; // s
const GONE = {
  closed: "The twin has ended or cannot be reached: what you see is its last state. Trying again; if it was started elsewhere, open the address that it printed.",
  silent: "The twin has not answered for more than a second: what you see may be old.",
};

// What is wrong, in one place: the twin is gone, or has not confirmed a stop.
function showBanner() {
  const late = stops.unconfirmed;
  const said = [];
  if (status !== "open") said.push(GONE[status] + lost);
  else if (busy) said.push(`The twin has been busy for ${busy.toFixed(0)} s: what you ask for waits.`);
  if (late.length) said.push(`Not stopped yet: ${late.join(", ")}.`);
  const text = said.join(" ");
  $("connection").hidden = !text;
  setText($("connection"), text);
  $("stop-all").classList.toggle("waiting", stops.isWaiting());
  for (const button of document.querySelectorAll("[data-stops]")) {
    button.classList.toggle("waiting", stops.isWaiting(button.dataset.stops));
  }
}

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
