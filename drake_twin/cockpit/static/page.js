// Connects the parts of the page with the twin: shows what it publishes, sends what a person requests.

import { Camera } from "./camera.js";
import { Capture } from "./capture.js";
import { Connection } from "./connection.js";
import { $, setIcon, setText } from "./dom.js";
import { Help } from "./help.js";
import { isNew } from "./kept.js";
import { Layout } from "./layout.js";
import { Messages } from "./messages.js";
import { MoreViews } from "./more_views.js";
import { Palette } from "./palette.js";
import { Panels } from "./panels.js";
import { Robots } from "./robots.js";
import { Sensors } from "./sensors.js";
import { Show } from "./show.js";
import { Stops } from "./stops.js";
import { Teleop } from "./teleop.js";
import { Timeline } from "./timeline.js";
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
const show = new Show(ask);
const teleop = new Teleop(ask);
const robots = new Robots(ask, teleop);
const messages = new Messages();
const camera = new Camera();
show.add({ name: "names", label: "Names", hint: "Names above robots", key: "L", set: (on) => camera.showNames(on) });
new Capture();
const moreViews = new MoreViews();
const help = new Help(() => show.described());
const layout = new Layout(() => panels.look());
const panels = new Panels(ask, (section) => (section ? layout.add(section) : layout.tabs.tidy()));
const palette = new Palette((asks) => [...show.commands(), ...panels.commands(asks), ...timeline.commands()], robots);
const sensors = new Sensors(ask);
const timeline = new Timeline(ask);
let names = [];
let status = "closed";
let lost = "";
let pending = 0; // s that requests have been pending

connection = new Connection({
  on: {
    robots(structure) {
      names = structure.robots.map((robot) => robot.name);
      structure.isNew = isNew(structure.layout);
      for (const part of [time, timeline, view, show, robots, sensors, panels, camera, moreViews]) part.structure(structure);
      layout.structure(structure);
    },
    state(state) {
      for (const part of [time, timeline, view, show, robots, sensors, panels, camera, palette]) part.state(state);
      stops.state(state.robots);
      document.body.classList.add("ready");
    },
    bytes: (head, bytes) => sensors.picture(head, bytes),
    timeline: (data) => timeline.show(data),
    messages: (lines) => messages.show(lines),
    alive(seconds) {
      pending = seconds > PATIENCE ? seconds : 0;
      showBanner();
    },
  },
  status(now) {
    status = now;
    if (now === "closed") show.lost();
    lost = "";
    for (const id of ["transport", "timeline", "panel", "stop-all"]) $(id).inert = now !== "open";
    document.body.classList.toggle("gone", now !== "open");
    showBanner();
  },
  lost(what) {
    lost = ` ${LOST[what] ?? "Your last request"} did not reach it.`;
    showBanner();
  },
});

const LOST = { EmergencyStop: "The emergency stop", Drive: "Your drive command" };
const PATIENCE = 2; // s
const GONE = {
  closed: "The twin has ended or cannot be reached: the page shows its last state. Trying again; if it was started elsewhere, open the address that it printed.",
  silent: "The twin has not answered for more than a second: the page may show an old state.",
};

// Show the problems in one place: the twin is gone or does not process requests, or a stop is not confirmed.
function showBanner() {
  const late = stops.unconfirmed;
  const lines = [];
  if (status !== "open") lines.push(GONE[status] + lost);
  else if (pending) lines.push(`The twin has processed no requests for ${pending.toFixed(0)} s: yours are pending.`);
  if (late.length) lines.push(`Not stopped yet: ${late.join(", ")}.`);
  const text = lines.join(" ");
  $("connection").hidden = !text;
  setText($("connection"), text);
  $("stop-all").classList.toggle("waiting", stops.isWaiting());
  for (const button of document.querySelectorAll("[data-stops]")) {
    button.classList.toggle("waiting", stops.isWaiting(button.dataset.stops));
  }
}

setIcon($("panel-toggle"), "panel");
setIcon($("find-button"), "find");
function togglePanel() {
  const open = document.body.classList.toggle("panel-closed");
  $("panel-toggle").setAttribute("aria-expanded", String(!open));
}
$("panel-toggle").addEventListener("click", togglePanel);
$("stop-all").addEventListener("click", () => names.forEach((robot) => ask("EmergencyStop", { robot })));

const SHORTCUTS = {
  ...camera.keys,
  Space: () => time.playOrPause(),
  KeyN: () => time.step(),
  KeyR: () => ask("Reset"),
  KeyP: togglePanel,
};

function onKey(event, down) {
  const target = event.target;
  if (down && event.code === "KeyK" && (event.ctrlKey || event.metaKey) && !event.shiftKey) {
    event.preventDefault(); // the browser's own search
    palette.open();
    return;
  }
  if (target.closest?.("dialog, select, textarea, input:not([type=range]):not([type=checkbox])")) return;
  if (event.code.startsWith("Arrow") && target.closest?.("input[type=range]")) return;
  if (teleop.key(event, down)) {
    event.preventDefault();
    return;
  }
  if (down && event.key === "?") help.open();
  if (down && !event.repeat && event.code === "KeyZ" && (event.ctrlKey || event.metaKey) && !event.shiftKey) {
    event.preventDefault();
    panels.panels.get("world")?.undo();
  }
  if (!down || event.repeat || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.code === "Space" && target.closest?.("button, summary, input, a")) return;
  const shortcuts = { ...show.keys, ...SHORTCUTS };
  const isOfView = event.code === "KeyP" || event.code in camera.keys || event.code in show.keys;
  if (document.body.classList.contains("display-only") && !isOfView) return;
  if (event.code === "KeyN" && event.shiftKey) {
    timeline.stepBy(-1);
    return;
  }
  if (event.code in shortcuts) {
    event.preventDefault();
    shortcuts[event.code]();
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
