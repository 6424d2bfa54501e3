// A folder for each robot: sliders, drive, controllers, joints, plots.

import { $, element, Slider, setText, toggle } from "./dom.js";
import { Plot } from "./plot.js";
import { plots } from "./plots.js";
import { Poses } from "./poses.js";

const STATES = ["position", "velocity", "effort"]; // fields of a JointState

const FEW = 3; // robots: more are folded, and have a filter
const MANY = 20; // robots: of more, only the rows near the ones in view are in the page
const LOOK = 1000; // ms between two requests for efforts

function shortName(joint, robot) {
  return joint.replace(new RegExp(`^${robot}[_/]`), "").replace(/_joint$/, "");
}

class RobotFolder {
  constructor(robot, { ask, teleop, displayOnly }) {
    Object.assign(this, { ask, teleop, displayOnly, robot, name: robot.name, kind: robot.kind });
    this.pill = element("span", { class: "pill", hidden: true, text: "stopped" });
    this.stop = element("button", { class: "danger small", text: "Stop", "data-stops": robot.name, "aria-label": `Emergency stop of ${robot.name}` });
    this.stop.addEventListener("click", () => {
      ask(this.stopped ? "ClearEmergencyStop" : "EmergencyStop", { robot: robot.name });
    });
    const remove = element("button", { class: "small quiet", text: "Delete", "aria-label": `Delete ${robot.name}` });
    remove.addEventListener("click", () => ask("Delete", { robot: robot.name }));
    this.node = element("div", { class: "robot", "data-robot": robot.name });
    const summary = element("summary", {}, element("span", { class: "name", text: robot.name }), this.pill);
    this.details = element("details", {}, summary);
    this.details.addEventListener("toggle", () => (this.details.open ? this.fill() : this.body?.remove()));
    // Beside the summary, not in it: a button in a button cannot be reached by all who need it.
    this.buttons = element("div", { class: "robot-buttons" }, ...(displayOnly ? [] : [this.stop]), remove);
    this.body = null;
  }

  // Have the row in the page, or only its place; what is open stays.
  lay(isNear) {
    if (isNear && !this.details.parentElement) this.node.append(this.details, this.buttons);
    else if (!isNear && !this.details.open) this.node.replaceChildren();
  }

  open() {
    this.lay(true);
    this.fill();
    this.details.open = true;
  }

  // Have the body in the page.
  fill() {
    this.make();
    this.isForFind = false;
    if (!this.body.parentElement) this.details.append(this.body);
  }

  make() {
    if (this.body) return;
    this.body = element("div", { class: "robot-body" });
    const { robot } = this;
    if (this.displayOnly) this.addPoses(robot);
    else {
      this.addCommands(robot);
      this.addDrives(robot);
      this.addControllers(robot);
    }
    this.addJoints(robot);
    if (!this.displayOnly) this.addPlots(robot);
  }

  // What is not in the page, made for Find: what can be operated in it.
  get apart() {
    this.isForFind ||= !this.body;
    this.make();
    return [this.details, this.buttons, this.body].filter((part) => !part.isConnected && !(part === this.body && part.parentElement));
  }

  // Forget a body that only Find has seen.
  forget() {
    if (!this.isForFind) return;
    this.teleop.forget(this.name);
    const none = { body: null, poses: null, groups: null, drives: null, switches: null, joints: null, plots: null, plotted: null };
    Object.assign(this, none, { isForFind: false });
  }

  addPoses(robot) {
    this.poses = robot.joints.map((joint, index) => {
      if (joint.follows) return null;
      const slider = new Slider({
        ...joint,
        label: shortName(joint.joint, robot.name),
        name: `${robot.name} ${joint.joint} position`,
        onmove: (position) => this.ask("PoseJoint", { robot: robot.name, joint: joint.joint, position }),
      });
      this.body.append(slider.node);
      return { slider, index };
    });
  }

  // A button that activates an inactive controller in place of those that command the same joints.
  switchTo(controller, verb) {
    const text = `${verb} with ${controller}`;
    return element("button", {
      class: "small switch-to",
      hidden: true,
      text,
      "aria-label": `${this.name}: ${text}`,
      title: `Activates ${controller} and deactivates the controllers that command the same joints`,
      onclick: () => this.ask("SwitchTo", { robot: this.name, controller }),
    });
  }

  addCommands(robot) {
    this.groups = robot.groups.map((group) => {
      const heading = element("h3", { text: group.controller, title: group.topic });
      const sliders = group.sliders.map(
        (slider, index) =>
          new Slider({
            ...slider,
            label: shortName(slider.joint, robot.name),
            name: `${robot.name} ${slider.joint} ${slider.interface}`,
            onmove: (value) => this.ask("MoveJoint", { topic: group.topic, index, value }),
          }),
      );
      const button = this.switchTo(group.controller, "Move");
      const poses = new Poses(robot, group, this.ask);
      this.body.append(element("div", { class: "commands" }, heading, button, ...sliders.map((slider) => slider.node), poses.node));
      return { ...group, sliders, button, poses };
    });
  }

  addDrives(robot) {
    this.drives = robot.drives.map((drive) => {
      const pad = this.teleop.pad(robot.name, drive);
      const button = this.switchTo(drive.controller, "Drive");
      pad.node.firstChild.after(button);
      this.body.append(pad.node);
      return { ...drive, pad, button };
    });
  }

  addControllers(robot) {
    this.switches = {};
    if (robot.controllers.length === 0) return;
    const list = element("div", { class: "controllers" }, element("h3", { text: "Controllers" }));
    for (const { name, type, problem } of robot.controllers) {
      const { node, input, show } = toggle(name, `${robot.name} ${name}`, (active) => {
        this.ask("Switch", { robot: robot.name, controller: name, active });
      });
      node.title = problem ? `${type}: ${problem}` : type;
      input.disabled = Boolean(problem);
      this.switches[name] = { show, state: element("span", { class: "muted" }) };
      list.append(element("div", { class: "controller" }, node, this.switches[name].state));
    }
    this.body.append(list);
  }

  addJoints(robot) {
    const head = element("tr", {}, ...["Joint", "Position", "Velocity", "Effort"].map((text) => element("th", { text, scope: "col" })));
    const body = element("tbody");
    this.cells = robot.joints.map((joint) => {
      const units = joint.slides ? ["m", "m/s", "N"] : ["rad", "rad/s", "N·m"];
      const cells = units.map((unit, column) => this.plotButton(robot, joint, STATES[column], `Plot the ${STATES[column]} of ${joint.joint}, ${unit}`));
      const name = this.plotButton(robot, joint, STATES[0], `Plot ${joint.joint}`, shortName(joint.joint, robot.name));
      body.append(element("tr", {}, element("th", { scope: "row" }, name), ...cells.map((cell) => element("td", {}, cell))));
      return cells;
    });
    if (robot.joints.length === 0) return;
    this.joints = element("details", { class: "joints" }, element("summary", { text: "Joint states" }), element("table", {}, element("thead", {}, head), body));
    this.body.append(this.joints);
  }

  // A button that plots a joint's position, velocity or effort below the scene.
  plotButton(robot, { joint }, what, title, text) {
    return element("button", { class: "plot-joint", title, text, onclick: () => plots.add(`${robot.joint_states}.${what}[${joint}]`) });
  }

  addPlots(robot) {
    if (robot.joints.length === 0) return;
    const slides = new Set(robot.joints.map((joint) => joint.slides));
    const units = (turning, sliding) => [slides.has(false) && turning, slides.has(true) && sliding].filter(Boolean).join(", ");
    this.plots = {
      positions: new Plot({ label: "Position", name: `${robot.name} position`, unit: units("rad", "m") }),
      velocities: new Plot({ label: "Velocity", name: `${robot.name} velocity`, unit: units("rad/s", "m/s") }),
      efforts: new Plot({ label: "Effort", name: `${robot.name} effort`, unit: units("N·m", "N") }),
    };
    this.jointNames = robot.joints.map((joint) => shortName(joint.joint, robot.name));
    const figures = Object.values(this.plots).map((plot) => plot.node);
    this.plotted = element("details", { class: "plots" }, element("summary", { text: "Plots" }), ...figures);
    this.body.append(this.plotted);
  }

  plot(time, state) {
    const open = this.details.open && this.plotted?.open && state.positions;
    for (const [what, plot] of Object.entries(this.plots ?? {})) {
      if (!open) plot.clear();
      else if (state[what]) plot.add(time, state[what], this.jointNames);
    }
  }

  // Whether efforts are shown, which the twin tells only to those who look: the plant solves a step for them.
  get showsEfforts() {
    return this.details.open && Boolean(this.joints?.open || this.plotted?.open);
  }

  state(state, commands) {
    this.stopped = state.stopped;
    if (!this.details.isConnected) return;
    this.pill.hidden = !state.stopped;
    setText(this.stop, state.stopped ? "Release" : "Stop");
    this.stop.setAttribute("aria-label", `${state.stopped ? "Clear emergency stop" : "Emergency stop"} of ${this.name}`);
    this.node.classList.toggle("stopped", state.stopped);
    if (!this.details.open || !this.body || !state.positions) return; // the twin has yet to hear of who looks
    for (const pose of this.poses ?? []) pose?.slider.show(state.positions[pose.index]);
    for (const { topic, controller, sliders, poses } of this.groups ?? []) {
      const active = state.controllers[controller] === "active" && !state.stopped;
      poses.state(state, active);
      sliders.forEach((slider, index) => {
        slider.disabled = !active;
        slider.show(commands[topic][index]);
      });
    }
    for (const { controller, pad } of this.drives ?? []) pad.disabled = state.controllers[controller] !== "active" || state.stopped;
    for (const { controller, button } of [...(this.groups ?? []), ...(this.drives ?? [])]) {
      button.hidden = state.controllers[controller] !== "inactive";
    }
    for (const [name, { show, state: shown }] of Object.entries(this.switches ?? {})) {
      const now = state.controllers[name] ?? "unloaded";
      show(now === "active");
      setText(shown, now === "active" ? "" : now);
    }
    if (!this.joints?.open) return;
    this.cells.forEach((cells, index) => {
      [state.positions, state.velocities, state.efforts].forEach((values, column) => {
        const value = values && (Math.abs(values[index]) < 5e-5 ? 0 : values[index]);
        setText(cells[column], value?.toFixed(column === 2 ? 3 : 4) ?? "–");
      });
    });
  }
}

export class Robots {
  constructor(ask, teleop) {
    this.ask = ask;
    this.teleop = teleop;
    this.folders = new Map(); // robot → its folder, and what that was made of
    this.asked = -Infinity; // when efforts were asked for
    $("robots-filter").addEventListener("input", () => this.filter());
    $("robots-filter").addEventListener("keydown", (event) => {
      if (event.key !== "Enter") return;
      event.preventDefault(); // it would fold what it opens
      this.openFirst();
    });
  }

  layRow(node, isNear) {
    if (node.contains(document.activeElement)) return;
    this.folders.get(node.dataset.robot)?.folder.lay(isNear || this.folders.size <= MANY);
  }

  // Show the robots whose names, or whose kind, have what is in the filter.
  filter() {
    const wanted = $("robots-filter").value.trim().toLowerCase();
    for (const { folder } of this.folders.values()) {
      folder.node.hidden = !`${folder.name} ${folder.kind}`.toLowerCase().includes(wanted);
    }
    for (const group of $("robots").querySelectorAll(".kind")) {
      group.hidden = !group.querySelector(".robot:not([hidden])");
      if (wanted && !group.hidden) group.open = true;
    }
  }

  openFirst() {
    const first = $("robots").querySelector(".robot:not([hidden])");
    if (!first) return;
    const { folder } = this.folders.get(first.dataset.robot);
    folder.open();
    folder.details.querySelector("summary").focus();
  }

  // Rows far away have no elements but their places.
  watch() {
    const lay = (entries) => entries.forEach(({ target, isIntersecting }) => this.layRow(target, isIntersecting));
    this.near ??= new IntersectionObserver(lay, { root: $("robots").closest(".page"), rootMargin: "400px" });
  }

  structure({ robots, display_only: displayOnly }) {
    this.watch();
    for (const [name, { folder, text }] of this.folders) {
      const robot = robots.find((each) => each.name === name);
      if (robot && JSON.stringify(robot) === text) continue;
      this.near.unobserve(folder.node);
      folder.node.remove();
      this.teleop.forget(name);
      this.folders.delete(name);
    }
    for (const robot of robots) {
      if (this.folders.has(robot.name)) continue;
      const folder = new RobotFolder(robot, { ask: this.ask, teleop: this.teleop, displayOnly });
      this.folders.set(robot.name, { folder, text: JSON.stringify(robot) });
      if (robots.length <= FEW) folder.open();
      else folder.lay(robots.length <= MANY);
      this.near.observe(folder.node);
    }
    this.group(robots);
    const filter = $("robots-filter");
    filter.hidden = robots.length <= FEW;
    if (filter.hidden) filter.value = "";
    this.filter();
  }

  // Place the folders; many robots of several kinds are in groups that fold.
  group(robots) {
    const kinds = [...new Set(robots.map(({ kind }) => kind))];
    const nodesOf = (kind) => robots.filter((robot) => robot.kind === kind).map(({ name }) => this.folders.get(name).folder.node);
    const key = JSON.stringify(robots.map(({ name, kind }) => [name, kind]));
    if (key === this.key) return;
    this.key = key;
    if (robots.length <= FEW || kinds.length < 2) {
      $("robots").replaceChildren(...robots.map(({ name }) => this.folders.get(name).folder.node));
      return;
    }
    const closed = [...$("robots").querySelectorAll(".kind:not([open])")].map((group) => group.dataset.kind);
    const groups = kinds.map((kind) => {
      const nodes = nodesOf(kind);
      const summary = element("summary", {}, kind, element("span", { class: "muted", text: ` ${nodes.length}` }));
      return element("details", { class: "kind", "data-kind": kind, open: !closed.includes(kind) }, summary, ...nodes);
    });
    $("robots").replaceChildren(...groups);
  }

  // What can be operated of robots that are folded or far away, for Find: { node, robot, open } each.
  apart() {
    return [...this.folders.values()].flatMap(({ folder }) => {
      const open = () => folder.open();
      return folder.apart.flatMap((part) => [...part.querySelectorAll("button, summary, select, input")].map((node) => ({ node, robot: folder.name, open })));
    });
  }

  forgetApart() {
    for (const { folder } of this.folders.values()) folder.forget();
  }

  // Tell the twin whose joints and controllers are shown: it tells of no others.
  look(robots) {
    const key = robots.join();
    if (key === this.looked && performance.now() - this.lookedAt < LOOK) return;
    Object.assign(this, { looked: key, lookedAt: performance.now() });
    this.ask("LookAtRobots", { robots });
  }

  state(state) {
    const folders = [...this.folders.values()].map(({ folder }) => folder);
    const isShown = $("robots").checkVisibility(); // else only what is driven by keys is told of a stop
    if (isShown && folders.some(({ showsEfforts }) => showsEfforts) && performance.now() - this.asked > LOOK) {
      this.asked = performance.now();
      this.ask("LookAtEfforts");
    }
    this.look(folders.filter(({ name, details }) => (isShown && details.open) || this.teleop.driven?.robot === name).map(({ name }) => name));
    for (const folder of folders) {
      const { name } = folder;
      if (!(name in state.robots) || !(isShown || this.teleop.driven?.robot === name)) continue;
      folder.state(state.robots[name], state.commands);
      folder.plot(state.time, state.robots[name]);
    }
  }
}
