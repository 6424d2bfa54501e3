// Whole poses of the joints that a controller commands: home, zero, those that a person has saved, and a way through them.

import { element } from "./dom.js";

const STORED = "drake_twin poses";
const BETWEEN = 2; // s from one saved pose to the next
const TRAJECTORY = "trajectory_msgs/msg/JointTrajectory";

function stored() {
  try {
    const found = JSON.parse(localStorage.getItem(STORED) ?? "{}");
    return found && typeof found === "object" ? found : {};
  } catch {
    return {}; // storage is switched off, or holds something else
  }
}

export class Poses {
  constructor(robot, group, ask) {
    Object.assign(this, { group, ask });
    const joints = robot.joints.map(({ joint }) => joint);
    this.indices = group.sliders.map(({ joint }) => joints.indexOf(joint));
    this.arePositions = group.sliders.every((slider) => slider.interface === "position");
    const button = (text, title, onclick) => element("button", { class: "small", text, title, "aria-label": `${group.controller}: ${title}`, onclick });
    this.buttons = [button("Zero", "All to zero", () => this.move(group.sliders.map(() => 0)))];
    this.node = element("div", { class: "poses" }, ...this.buttons);
    if (!this.arePositions) return;
    this.buttons.unshift(button("Home", "All to where they started", () => this.move(group.home)));
    if (group.sliders.length === 1) {
      const [{ lower, upper }] = group.sliders;
      this.buttons.push(button("Lower", `To the lower limit, ${lower.toFixed(3)}`, () => this.move([lower])));
      this.buttons.push(button("Upper", `To the upper limit, ${upper.toFixed(3)}`, () => this.move([upper])));
    }
    this.name = element("input", { maxlength: 30, placeholder: "Name", "aria-label": `${group.controller}: name of the pose to save` });
    this.saved = element("span", { class: "saved" });
    const save = button("Save pose", "Save the joints' present positions", () => this.save());
    this.node.replaceChildren(...this.buttons, this.saved, this.name, save);
    this.list();
  }

  get poses() {
    const found = stored()[this.group.topic];
    const fits = (pose) => typeof pose?.name === "string" && Array.isArray(pose.values) && pose.values.length === this.group.sliders.length;
    return Array.isArray(found) ? found.filter(fits) : [];
  }

  set poses(poses) {
    try {
      localStorage.setItem(STORED, JSON.stringify({ ...stored(), [this.group.topic]: poses }));
    } catch {
      // storage is switched off
    }
    this.list();
  }

  // Each joint's slider commands its number and keeps the others.
  move(values) {
    values.forEach((value, index) => this.ask("MoveJoint", { topic: this.group.topic, index, value }));
  }

  save() {
    if (!this.present) return;
    const name = this.name.value.trim() || `pose ${this.poses.length + 1}`;
    this.poses = [...this.poses.filter((pose) => pose.name !== name), { name, values: this.present }];
    this.name.value = "";
  }

  // One trajectory through all saved poses, in the order in which they were saved.
  follow() {
    const points = this.poses.map(({ values }, index) => ({ positions: values, time_from_start: BETWEEN * (index + 1) }));
    const text = JSON.stringify({ joint_names: this.group.sliders.map(({ joint }) => joint), points });
    this.ask("AskPanel", { panel: "topics", data: JSON.stringify({ do: "Publish", topic: this.group.topic, text, key: "" }) });
  }

  list() {
    const { poses } = this;
    const chip = (pose) => {
      const go = element("button", { class: "small", text: pose.name, title: `Move to ${pose.name}`, onclick: () => this.move(pose.values) });
      const remove = () => (this.poses = this.poses.filter(({ name }) => name !== pose.name));
      return element("span", { class: "chip" }, go, element("button", { class: "small", text: "×", title: `Forget ${pose.name}`, "aria-label": `Forget ${pose.name}`, onclick: remove }));
    };
    const follow = element("button", { class: "small", text: "Through all", title: `One trajectory through the saved poses, ${BETWEEN} s each`, onclick: () => this.follow() });
    const isWay = this.group.type === TRAJECTORY && poses.length > 1;
    this.saved.replaceChildren(...poses.map(chip), ...(isWay ? [follow] : []));
  }

  state({ positions }, isActive) {
    this.present = this.indices.map((index) => positions[index]);
    for (const button of this.node.querySelectorAll("button")) button.disabled = !isActive;
  }
}
