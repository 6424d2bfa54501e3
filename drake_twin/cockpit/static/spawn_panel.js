// The dialog that spawns a robot; it stays open, with the reason, when the twin refuses the robot.

import { $, element, setText } from "../dom.js";

const LOOK = 200; // ms between two requests for data while the dialog is open
const LONGEST = 1000; // characters of a request
const RECENT = "drake_twin recent robots";
const MOST_RECENT = 8;
const UNKNOWN = { lower: [-0.2, -0.2, 0], upper: [0.2, 0.2, 0.3] }; // m: a robot that is still measured

function recent() {
  try {
    const files = JSON.parse(localStorage.getItem(RECENT) ?? "[]");
    return Array.isArray(files) ? files.filter((file) => typeof file === "string") : [];
  } catch {
    return []; // storage is switched off, or holds something else
  }
}

function remember(file) {
  try {
    localStorage.setItem(RECENT, JSON.stringify([file, ...recent().filter((known) => known !== file)].slice(0, MOST_RECENT)));
  } catch {
    // storage is switched off
  }
}

export default class SpawnPanel {
  constructor(ask) {
    this.ask = ask;
    this.form = $("spawn-form");
    this.fields = this.form.elements;
    this.dialog = $("spawn-dialog");
    this.arguments = new Map(); // name → input
    $("spawn").addEventListener("click", () => this.open());
    $("spawn-cancel").addEventListener("click", () => this.dialog.close());
    $("spawn-click").addEventListener("click", () => this.choosePlace());
    this.fields.found.addEventListener("change", () => {
      if (this.fields.found.value) this.fields.file.value = this.fields.found.value;
      this.fields.found.value = "";
    });
    this.preview = $("spawn-preview");
    this.preview.addEventListener("toggle", () => this.askPreview());
    this.form.addEventListener("change", () => {
      this.askBox();
      this.askPreview();
    });
    for (const axis of ["x", "y"]) this.fields[axis].addEventListener("input", () => (this.isPlaced = true));
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.spawn();
    });
    window.addEventListener("keydown", (event) => {
      if (event.code !== "Escape" || $("spawn-hint").hidden) return;
      event.preventDefault(); // else it closes the dialog again
      this.clicked(null);
    });
    setInterval(() => this.dialog.open && this.look(), LOOK);
  }

  look() {
    this.ask({ do: "Look", file: this.fields.file.value.trim() });
  }

  open() {
    const names = [...document.querySelectorAll(".robot")].map((node) => node.dataset.robot);
    let number = 1;
    while (names.includes(`robot_${number}`)) number += 1;
    this.fields.name.value = `robot_${number}`;
    this.isPlaced = false; // by a person; else it stands beside what is there
    this.measured = null;
    this.say("");
    this.dialog.showModal();
    this.look();
    this.askBox();
    this.askPreview();
  }

  say(text) {
    $("spawn-message").hidden = !text;
    setText($("spawn-message"), text);
  }

  givenArguments() {
    const given = [...this.arguments].filter(([, input]) => input.value !== "");
    return JSON.stringify(Object.fromEntries(given.map(([key, input]) => [key, input.value])));
  }

  // Ask how large the robot is, and for a free place for it.
  askBox() {
    const file = this.fields.file.value.trim();
    const key = JSON.stringify([file, this.givenArguments()]);
    if (!file || key === this.measured) return;
    const request = { do: "Measure", key, file, arguments: this.givenArguments() };
    if (JSON.stringify(request).length > LONGEST) return;
    this.measured = key;
    this.box = null;
    this.ask(request);
  }

  showBox(box) {
    this.box = box;
    if (this.isPlaced) return;
    [this.fields.x.value, this.fields.y.value] = box.place;
  }

  // Ask for a picture of the robot, while somebody wants to see it and it is not there yet.
  askPreview() {
    const file = this.fields.file.value.trim();
    const key = JSON.stringify([file, this.givenArguments()]);
    if (!this.preview.open || !file || key === this.previewed) return;
    const request = { do: "Preview", key, file, arguments: this.givenArguments() };
    if (JSON.stringify(request).length > LONGEST) return;
    this.previewed = key;
    this.showPreview({ picture: "", problem: "Drawing…" });
    this.ask(request);
  }

  showPreview({ picture, problem }) {
    const image = this.preview.querySelector("img");
    image.hidden = !picture;
    if (picture) {
      image.src = `data:image/png;base64,${picture}`;
      image.alt = `The robot of ${this.fields.file.value}`;
    }
    setText(this.preview.querySelector("p"), problem);
  }

  spawn() {
    const number = (name) => this.fields[name].valueAsNumber || 0;
    const file = this.fields.file.value.trim();
    const name = this.fields.name.value.trim();
    if (!file || !name) return this.say(file ? "The robot needs a name." : "Choose a robot file.");
    const request = {
      do: "Spawn",
      key: Math.random().toString(36).slice(2),
      file,
      name,
      xyz: [number("x"), number("y"), number("z")],
      rpy: [0, 0, number("yaw")],
      stands: this.fields.stands.checked,
      beside: !this.isPlaced,
      arguments: this.givenArguments(),
      controllers: this.fields.controllers.value.trim(),
    };
    if (JSON.stringify(request).length > LONGEST) return this.say(`The request is longer than ${LONGEST} characters.`);
    this.asked = request;
    this.say("");
    this.ask(request);
  }

  // Hide the dialog until a place in the scene is clicked.
  choosePlace() {
    const tools = $("scene").contentWindow?.sceneTools;
    if (!tools) return;
    this.dialog.close();
    $("spawn-hint").hidden = false;
    tools.takeClicks(this);
  }

  // Show the robot's box where the mouse points.
  hovered(hit) {
    const tools = $("scene").contentWindow?.sceneTools;
    const { lower, upper } = this.box ?? UNKNOWN;
    const size = upper.map((end, axis) => end - lower[axis]);
    const middle = upper.map((end, axis) => (end + lower[axis]) / 2);
    if (this.fields.stands.checked) middle[2] = size[2] / 2;
    tools?.placing.show(hit && { size, middle, at: hit.point, yaw: this.fields.yaw.valueAsNumber || 0 });
  }

  clicksTaken() {
    this.clicked(null);
  }

  clicked(hit) {
    if ($("spawn-hint").hidden) return;
    $("spawn-hint").hidden = true;
    const tools = $("scene").contentWindow?.sceneTools;
    tools?.dropClicks(this);
    tools?.placing.show(null);
    if (hit) {
      this.isPlaced = true;
      for (const axis of ["x", "y", "z"]) this.fields[axis].value = Number(hit.point[axis].toFixed(3)) + 0;
    }
    this.dialog.showModal();
  }

  showFiles({ files, here }) {
    const key = JSON.stringify([files, here, recent()]);
    if (key === this.shownFiles) return;
    this.shownFiles = key;
    const group = (label, addresses) => {
      const options = addresses.map((value) => element("option", { value, text: value.replace(/^package:\/\//, "") }));
      return options.length ? [element("optgroup", { label }, ...options)] : [];
    };
    const packages = Map.groupBy ? Map.groupBy(files ?? [], (file) => file.split("/")[2]) : new Map([["Packages", files ?? []]]);
    const hint = files ? `${files.length} robot files in ${packages.size} packages` : "Looking for robots…";
    this.fields.found.replaceChildren(
      element("option", { value: "", text: hint }),
      ...group("Recent", recent()),
      ...group("In this world", here),
      ...[...packages].flatMap(([name, addresses]) => group(name, addresses)),
    );
    $("spawn-files").replaceChildren(...(files ?? []).map((value) => element("option", { value })));
  }

  showArguments({ file, arguments: declared }) {
    const key = JSON.stringify([file, declared]);
    if (key === this.shownArguments || file !== this.fields.file.value.trim()) return;
    this.shownArguments = key;
    this.arguments = new Map();
    const labels = Object.entries(declared).map(([name, value]) => {
      const input = element("input", { placeholder: value, spellcheck: "false", maxlength: 200, "aria-label": `Argument ${name}` });
      this.arguments.set(name, input);
      return element("label", {}, element("span", { text: name }), input);
    });
    $("spawn-arguments").hidden = !labels.length;
    $("spawn-arguments").lastElementChild.replaceChildren(...labels);
  }

  state(state) {
    if (!state || !this.dialog.open) return;
    this.showFiles(state);
    this.showArguments(state);
    if (state.box && !this.box && state.box.place && state.box.key === this.measured) this.showBox(state.box);
    if (state.preview && state.preview.key === this.previewed) this.showPreview(state.preview);
    if (state.key !== this.asked?.key) return;
    this.form.inert = state.status === "reading";
    if (state.status === "refused") this.say(state.message);
    if (state.status === "done") {
      remember(this.asked.file);
      this.dialog.close();
    }
    if (state.status !== "reading") this.asked = null;
  }
}
