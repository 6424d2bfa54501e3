// A folder for each robot: sliders, drive, controllers, joints, plots.

import { $, element, Slider, setText, toggle } from "./dom.js";
import { lineColor, Plot } from "./plot.js";

function shortName(joint, robot) {
  return joint.replace(new RegExp(`^${robot}[_/]`), "").replace(/_joint$/, "");
}

class RobotFolder {
  constructor(robot, { ask, teleop, displayOnly }) {
    this.ask = ask;
    this.name = robot.name;
    this.teleop = teleop;
    this.pill = element("span", { class: "pill", hidden: true, text: "stopped" });
    this.stop = element("button", { class: "danger small", text: "Stop", "data-stops": robot.name, "aria-label": `Emergency stop of ${robot.name}` });
    this.stop.addEventListener("click", (event) => {
      event.preventDefault();
      ask(this.stopped ? "ClearEmergencyStop" : "EmergencyStop", { robot: robot.name });
    });
    const summary = element("summary", {}, element("span", { class: "name", text: robot.name }), this.pill, element("span", { class: "spacer" }));
    if (!displayOnly) summary.append(this.stop);
    const remove = element("button", { class: "small quiet", text: "Delete", "aria-label": `Delete ${robot.name}` });
    remove.addEventListener("click", (event) => {
      event.preventDefault();
      ask("Delete", { robot: robot.name });
    });
    summary.append(remove);
    this.node = element("details", { class: "robot", open: true, "data-robot": robot.name }, summary);
    if (displayOnly) this.addPoses(robot);
    else {
      this.addCommands(robot);
      this.addDrives(robot);
      this.addControllers(robot);
    }
    this.addJoints(robot);
    if (!displayOnly) this.addPlots(robot);
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
      this.node.append(slider.node);
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
      this.node.append(element("div", { class: "commands" }, heading, button, ...sliders.map((slider) => slider.node)));
      return { ...group, sliders, button };
    });
  }

  addDrives(robot) {
    this.drives = robot.drives.map((drive) => {
      const pad = this.teleop.pad(robot.name, drive.topic);
      const button = this.switchTo(drive.controller, "Drive");
      pad.node.firstChild.after(button);
      this.node.append(pad.node);
      return { ...drive, pad, button };
    });
  }

  addControllers(robot) {
    this.switches = {};
    if (robot.controllers.length === 0) return;
    const list = element("div", { class: "controllers" }, element("h3", { text: "Controllers" }));
    for (const { name, type, problem } of robot.controllers) {
      const { node, input } = toggle(name, `${robot.name} ${name}`, (active) => {
        this.ask("Switch", { robot: robot.name, controller: name, active });
      });
      node.title = problem ? `${type}: ${problem}` : type;
      input.disabled = Boolean(problem);
      this.switches[name] = { input, state: element("span", { class: "muted" }) };
      list.append(element("div", { class: "controller" }, node, this.switches[name].state));
    }
    this.node.append(list);
  }

  addJoints(robot) {
    const head = element("tr", {}, ...["Joint", "Position", "Velocity", "Effort"].map((text) => element("th", { text, scope: "col" })));
    const body = element("tbody");
    this.cells = robot.joints.map((joint) => {
      const units = joint.slides ? ["m", "m/s", "N"] : ["rad", "rad/s", "N·m"];
      const cells = units.map((unit) => element("td", { title: unit }));
      body.append(element("tr", {}, element("th", { scope: "row", title: joint.joint, text: shortName(joint.joint, robot.name) }), ...cells));
      return cells;
    });
    if (robot.joints.length === 0) return;
    this.joints = element("details", { class: "joints" }, element("summary", { text: "Joint states" }), element("table", {}, element("thead", {}, head), body));
    this.node.append(this.joints);
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
    const key = robot.joints.map((joint, index) => {
      const item = element("li", { title: joint.joint, text: shortName(joint.joint, robot.name) });
      item.style.setProperty("--color", lineColor(index));
      return item;
    });
    const figures = Object.values(this.plots).map((plot) => plot.node);
    this.plotted = element("details", { class: "plots" }, element("summary", { text: "Plots" }), ...figures, element("ul", {}, ...key));
    this.node.append(this.plotted);
  }

  plot(time, state) {
    const open = this.node.open && this.plotted?.open;
    for (const [what, plot] of Object.entries(this.plots ?? {})) {
      if (open) plot.add(time, state[what]);
      else plot.clear();
    }
  }

  state(state, commands) {
    this.stopped = state.stopped;
    this.pill.hidden = !state.stopped;
    setText(this.stop, state.stopped ? "Release" : "Stop");
    this.stop.setAttribute("aria-label", `${state.stopped ? "Clear emergency stop" : "Emergency stop"} of ${this.name}`);
    this.node.classList.toggle("stopped", state.stopped);
    if (!this.node.open) return;
    for (const pose of this.poses ?? []) pose?.slider.show(state.positions[pose.index]);
    for (const { topic, controller, sliders } of this.groups ?? []) {
      const active = state.controllers[controller] === "active" && !state.stopped;
      sliders.forEach((slider, index) => {
        slider.disabled = !active;
        slider.show(commands[topic][index]);
      });
    }
    for (const { controller, pad } of this.drives ?? []) pad.disabled = state.controllers[controller] !== "active" || state.stopped;
    for (const { controller, button } of [...(this.groups ?? []), ...(this.drives ?? [])]) {
      button.hidden = state.controllers[controller] !== "inactive";
    }
    for (const [name, { input, state: shown }] of Object.entries(this.switches ?? {})) {
      const now = state.controllers[name] ?? "unloaded";
      input.checked = now === "active";
      setText(shown, now === "active" ? "" : now);
    }
    if (!this.joints?.open) return;
    this.cells.forEach((cells, index) => {
      [state.positions, state.velocities, state.efforts].forEach((values, column) => {
        setText(cells[column], (Math.abs(values[index]) < 5e-5 ? 0 : values[index]).toFixed(column === 2 ? 3 : 4));
      });
    });
  }
}

export class Robots {
  constructor(ask, teleop) {
    this.ask = ask;
    this.teleop = teleop;
    this.folders = new Map();
  }

  structure({ robots, display_only: displayOnly }) {
    for (const [name, { folder, text }] of this.folders) {
      const robot = robots.find((each) => each.name === name);
      if (robot && JSON.stringify(robot) === text) continue;
      folder.node.remove();
      this.teleop.forget(name);
      this.folders.delete(name);
    }
    for (const robot of robots) {
      if (!this.folders.has(robot.name)) {
        const folder = new RobotFolder(robot, { ask: this.ask, teleop: this.teleop, displayOnly });
        if (robots.length > 3) folder.node.open = false;
        this.folders.set(robot.name, { folder, text: JSON.stringify(robot) });
      }
      $("robots").append(this.folders.get(robot.name).folder.node);
    }
  }

  state(state) {
    for (const [name, { folder }] of this.folders) {
      if (!(name in state.robots)) continue;
      folder.state(state.robots[name], state.commands);
      folder.plot(state.time, state.robots[name]);
    }
  }
}
