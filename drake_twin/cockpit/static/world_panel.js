// The panel of the world: its tree, what is selected in it or in the scene, its details, and what is done to it.

import { $, element, reveal } from "../dom.js";
import { Edits } from "../edits.js";
import { Inspector } from "../inspector.js";
import { Tree } from "../tree.js";

const LOOK = 1000; // ms between two requests for data

export default class WorldPanel {
  constructor(ask) {
    this.ask = (request) => {
      ask(request);
      if (["Place", "Duplicate", "Remove", "Undo"].includes(request.do)) this.look();
    };
    this.version = 0;
    this.isOld = true; // whether the tree may be another one
    this.tree = new Tree((id) => this.select(id));
    this.inspector = new Inspector();
    this.edits = new Edits(this.ask);
    this.node = element("div", { class: "world" }, element("h2", { text: "World" }), this.tree.node, this.edits.node, this.inspector.node);
    setInterval(() => this.look(), LOOK);
    requestAnimationFrame(() => this.look());
  }

  // The scene's tools; null until its frame is loaded.
  get tools() {
    const tools = $("scene").contentWindow?.sceneTools ?? null;
    if (tools && !tools.onclick) {
      const ask = (what, fields) => this.ask({ do: what, ...fields });
      tools.onclick = (hit) => this.clicked(hit);
      tools.onfocus = ({ path }) => this.goTo(this.at(path));
      tools.entityAt = (path) => this.draggable(path);
      tools.onpull = (fields) => ask("Drag", fields);
      tools.onrelease = (fields) => ask("Release", fields);
      tools.onplace = ({ xyz, rpy }) => this.ask({ do: "Place", entity: this.edits.details.owner, xyz, rpy });
    }
    return tools;
  }

  // Robots, models and links, to be found: it is selected, and the camera goes there.
  commands() {
    const { nodes } = this.tree;
    const ownerOf = (node) => (nodes.has(node.parent) ? ownerOf(nodes.get(node.parent)) : node);
    const found = [...nodes.values()].filter(({ kind }) => ["robot", "model", "link"].includes(kind));
    return found.map((node) => {
      const owner = ownerOf(node);
      return { text: node.name, about: owner === node ? node.kind : `${node.kind} of ${owner.name}`, run: () => this.find(node.id) };
    });
  }

  find(id) {
    reveal(this.node);
    this.goTo(id);
  }

  // Select it and let it fill the picture.
  goTo(id) {
    if (!id) return; // the ground
    this.tree.select(id);
    this.select(id);
    this.tools?.fit(this.tree.nodes.get(id).paths);
  }

  undo() {
    if (!document.body.matches(".display-only, .playback")) this.ask({ do: "Undo" });
  }

  // Robots or models have come or gone: the scene needs the tree also while nobody sees it.
  structure() {
    this.isOld = true;
    this.look();
  }

  // Ask for data, while somebody can see them.
  look() {
    const isSeen = document.visibilityState === "visible" && this.node.checkVisibility();
    if (!this.tools || !(isSeen || this.isOld)) return;
    this.ask({ do: "Look", version: this.version, node: this.tree.selected });
  }

  select(id) {
    this.look();
    if (!id) this.show(null);
    this.mark();
  }

  // Tint what is selected, also where it has been drawn again.
  mark() {
    this.tools?.highlight(this.tree.nodes.get(this.tree.selected)?.paths ?? []);
  }

  // Select the link or model that was clicked in the scene; the ground and the sky select nothing.
  clicked(hit) {
    const found = hit ? this.at(hit.path) : "";
    this.tree.select(found);
    this.select(found);
  }

  // The link, or else the model, that is drawn at a path.
  at(path) {
    for (const kind of ["link", "model"]) {
      for (const node of this.tree.nodes.values()) {
        if (node.kind === kind && node.paths.some((own) => path === own || path.startsWith(`${own}/`))) return node.id;
      }
    }
    return "";
  }

  // The link that can be dragged at a path; nothing of a static model, and nothing where nothing moves.
  draggable(path) {
    const node = this.tree.nodes.get(this.at(path));
    const isStill = document.body.matches(".display-only, .playback");
    return node?.kind === "link" && !isStill ? node.entity : null;
  }

  show(details, undone = this.undone) {
    this.undone = undone;
    this.inspector.show(details);
    this.edits.show(details, undone);
    const owner = [...this.tree.nodes.values()].find(({ kind, name }) => ["robot", "model"].includes(kind) && name === details?.owner);
    this.tools?.showHandles(this.edits.pose, owner?.paths ?? []);
  }

  state(world) {
    if (!world) return;
    if (world.tree) {
      this.tree.show(world.tree);
      this.version = world.version;
    }
    this.isOld = world.version !== this.version;
    if (this.isOld) this.look();
    const { selected } = this.tree;
    if (!selected || selected in world.details) this.show(world.details[selected] ?? null, world.undo);
    this.mark();
    if (this.tools) this.tools.pulls = this.edits.isPulling;
  }
}
