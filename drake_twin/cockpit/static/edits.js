// Buttons and fields that move, duplicate, delete, drag and push things, and undo edits.

import { element, setText } from "./dom.js";

const FIELDS = ["x", "y", "z", "roll", "pitch", "yaw"];

export class Edits {
  // `ask` sends a request to the panel of the world.
  constructor(ask) {
    this.details = null;
    this.isMoving = false;
    const send = (what) => () => ask({ do: what, entity: this.details.owner });
    this.move = element("button", { class: "small", "aria-pressed": "false", onclick: () => this.toggle() });
    this.duplicate = element("button", { class: "small", text: "Duplicate", onclick: send("Duplicate") });
    this.remove = element("button", { class: "small", text: "Delete", onclick: send("Remove") });
    this.undo = element("button", { class: "small", text: "Undo", "aria-label": "Undo the last edit", onclick: () => ask({ do: "Undo" }) });
    this.isPulling = false;
    const pull = () => this.pull.setAttribute("aria-pressed", String((this.isPulling = !this.isPulling)));
    const hint = "Drag links in the scene with the mouse, as with a spring (Ctrl and drag does it at any time)";
    this.pull = element("button", { class: "small", text: "Drag", title: hint, "aria-pressed": "false", onclick: pull });
    this.push = element("button", { class: "small", text: "Push…", "aria-expanded": "false", onclick: () => this.togglePush() });
    this.addPush(ask);
    this.inputs = FIELDS.map((name) => element("input", { type: "number", step: "any", name, "aria-label": name }));
    this.form = element(
      "form",
      { class: "pose", hidden: true },
      ...FIELDS.map((name, index) => element("label", {}, element("span", { text: name }), this.inputs[index], element("span", { class: "unit", text: index < 3 ? "m" : "rad" }))),
      element("button", { type: "submit", class: "small", text: "Move there" }),
    );
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.changed = false;
      const numbers = this.inputs.map((input) => input.valueAsNumber || 0);
      ask({ do: "Place", entity: this.details.owner, xyz: numbers.slice(0, 3), rpy: numbers.slice(3) });
    });
    this.form.addEventListener("input", () => (this.changed = true));
    this.node = element("div", { class: "edits" }, element("div", { class: "buttons" }, this.pull, this.move, this.push, this.duplicate, this.remove, this.undo), this.form, this.pushForm);
    this.show(null, "");
  }

  addPush(ask) {
    const field = (name, value, unit, min) => {
      const input = element("input", { type: "number", step: "any", value, min, "aria-label": name });
      return { input, node: element("label", {}, element("span", { text: name }), input, element("span", { class: "unit", text: unit })) };
    };
    const fields = [field("Fx", 20, "N"), field("Fy", 0, "N"), field("Fz", 0, "N"), field("for", 0.2, "s", 0)];
    const impulse = element("output", { class: "muted" });
    const numbers = () => fields.map(({ input }) => input.valueAsNumber || 0);
    const show = () => {
      const [x, y, z, duration] = numbers();
      setText(impulse, `${(Math.hypot(x, y, z) * duration).toFixed(2)} N·s`);
    };
    this.pushForm = element("form", { class: "pose", hidden: true }, ...fields.map(({ node }) => node), impulse, element("button", { type: "submit", class: "small", text: "Push" }));
    this.pushForm.addEventListener("input", show);
    this.pushForm.addEventListener("submit", (event) => {
      event.preventDefault();
      const [x, y, z, duration] = numbers();
      ask({ do: "Push", entity: this.details.entity, force: [x, y, z], duration });
    });
    show();
  }

  togglePush(on = this.pushForm.hidden) {
    this.pushForm.hidden = !on;
    this.push.setAttribute("aria-expanded", String(on));
  }

  toggle(on = !this.isMoving) {
    this.isMoving = on;
    this.changed = false;
    this.move.setAttribute("aria-pressed", String(on));
    this.show(this.details, this.undo.title);
  }

  // Show what can be done with the selected thing, and what can be undone.
  show(details, undone) {
    if (details?.owner !== this.details?.owner) this.changed = false;
    this.details = details;
    const can = (what) => Boolean(details?.edits.includes(what));
    if (this.isMoving && !can("Place")) this.toggle(false);
    this.move.hidden = !can("Place");
    this.duplicate.hidden = !can("Duplicate");
    this.push.hidden = !can("Push");
    if (this.push.hidden) this.togglePush(false);
    this.push.title = details ? `Push ${details.entity}` : "";
    this.remove.hidden = !can("Remove");
    this.undo.hidden = !undone;
    this.undo.title = undone;
    this.form.hidden = !this.isMoving;
    if (!details) return;
    setText(this.move, "Move");
    for (const button of [this.move, this.duplicate, this.remove]) button.title = `${button.textContent} ${details.owner}`;
    if (this.form.hidden || this.changed || this.form.contains(document.activeElement)) return;
    [...details.xyz, ...details.rpy].forEach((value, index) => (this.inputs[index].value = Number(value.toFixed(4))));
  }

  // Where the handles belong; null for none.
  get pose() {
    return this.isMoving && this.details ? { xyz: this.details.xyz, rpy: this.details.rpy } : null;
  }
}
