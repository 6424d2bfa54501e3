// Elements, icons and sliders.

const PATIENCE = 2000; // ms

export const $ = (id) => document.getElementById(id);

export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (name === "text") made.textContent = value;
    else made.setAttribute(name, value === true ? "" : value);
  }
  made.append(...children);
  return made;
}

// Bring something of the side panel into view, whatever tab or group it is in (layout.js).
export const reveal = (node) => node.dispatchEvent(new Event("reveal", { bubbles: true }));

const ICONS = {
  play: "M5 3.5v9l7.500-4.500z",
  pause: "M4.500 3.500h2.500v9H4.500zM9 3.500h2.500v9H9z",
  step: "M3.500 3.500v9l6.500-4.500zM11 3.500h2v9h-2z",
  reset: "M8 3a5 5 0 1 0 4.700 3.300l-1.500.5A3.400 3.400 0 1 1 8 4.600V7l4-3.100L8 .800z",
  find: "M7 2a5 5 0 1 0 3 9l3.500 3.500 1.100-1.100L11 10a5 5 0 0 0-4-8zm0 1.600a3.400 3.400 0 1 1 0 6.800 3.400 3.400 0 0 1 0-6.800z",
  panel: "M2 3h12v10H2zM3.500 4.500v7h5.500v-7z",
};

export function icon(name) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(svg.namespaceURI, "path");
  path.setAttribute("d", ICONS[name]);
  path.setAttribute("fill-rule", "evenodd");
  svg.append(path);
  return svg;
}

export function setIcon(button, name) {
  if (button.dataset.icon === name) return;
  button.dataset.icon = name;
  button.replaceChildren(icon(name));
}

export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

// Call back at most once per animation frame of the browser, with the last value.
export function oncePerFrame(callback) {
  let pending = false;
  let last;
  return (value) => {
    last = value;
    if (pending) return;
    pending = true;
    requestAnimationFrame(() => {
      pending = false;
      callback(last);
    });
  };
}

function stepOf(lower, upper) {
  return 10 ** Math.floor(Math.log10(Math.max(upper - lower, 1e-3) / 100));
}

export function formatted(value, step) {
  const digits = Math.max(0, Math.min(6, Math.ceil(-Math.log10(step) - 1e-9)));
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace("-", "") : text;
}

// A labelled slider with a number beside it. `scale` converts the slider's position to the value and back.
export class Slider {
  constructor({ label, name, unit, lower, upper, step, scale, onmove }) {
    const { toValue, toPosition } = scale ?? { toValue: (position) => position, toPosition: (value) => value };
    this.step = step ?? stepOf(lower, upper);
    this.toPosition = toPosition;
    this.held = false;
    const move = oncePerFrame(onmove);
    const ends = [toPosition(lower), toPosition(upper)];
    this.range = element("input", {
      type: "range",
      min: ends[0],
      max: ends[1],
      step: scale ? "any" : this.step,
      "aria-label": name ?? label,
    });
    this.number = element("input", { type: "number", min: lower, max: upper, step: "any", "aria-label": `${name ?? label}, number` });
    this.range.addEventListener("input", () => {
      const value = scale?.snap ? scale.snap(toValue(this.range.valueAsNumber)) : toValue(this.range.valueAsNumber);
      this.hold();
      this.number.value = formatted(value, this.step);
      this.fill();
      move(value);
    });
    this.number.addEventListener("change", () => {
      const value = this.number.valueAsNumber;
      if (!Number.isFinite(value)) return;
      this.hold();
      this.range.value = toPosition(value);
      this.fill();
      move(value);
    });
    this.node = element(
      "div",
      { class: "slider" },
      element("span", { class: "slider-label", title: name ?? label, text: label }),
      this.range,
      this.number,
      element("span", { class: "unit", text: unit }),
    );
  }

  // Keep the value that a person has just set until the twin has had time to apply it.
  hold() {
    this.held = true;
    clearTimeout(this.release);
    this.release = setTimeout(() => (this.held = false), 300);
  }

  fill() {
    const { min, max, value } = this.range;
    this.range.style.setProperty("--filled", `${(100 * (value - min)) / (max - min || 1)}%`);
  }

  show(value) {
    if (this.held || document.activeElement === this.number) return;
    const text = formatted(value, this.step);
    if (this.number.value !== text) this.number.value = text;
    const position = String(this.toPosition(value));
    if (this.range.value !== position) {
      this.range.value = position;
      this.fill();
    }
  }

  set disabled(value) {
    this.range.disabled = value;
    this.number.disabled = value;
    this.node.classList.toggle("disabled", value);
  }
}

// `show` shows what the twin says; for a while after the user has operated the switch only if it is what the user asked for,
// as states that were sent before the twin heard of it are still under way.
export function toggle(label, name, onchange) {
  const input = element("input", { type: "checkbox", role: "switch", "aria-label": name ?? label });
  let asked = -Infinity;
  input.addEventListener("change", () => {
    asked = performance.now();
    onchange(input.checked);
  });
  const show = (on) => {
    if (on === input.checked) asked = -Infinity;
    else if (performance.now() - asked > PATIENCE) input.checked = on;
  };
  const node = element("label", { class: "toggle" }, input, element("span", { class: "track" }), element("span", { text: label }));
  return { node, input, show };
}
