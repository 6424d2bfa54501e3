// What a person does in the scene: the page calls these through its iframe. Paths are below the twin's folder.

import { Handles } from "./handles.js";
import { Labels } from "./labels.js";
import { Placing } from "./placing.js";

const { THREE } = MeshCat;
const CLICK = 4; // pixels that the pointer may move in a click
const GLOW = new THREE.Color(0x2563a8);
const PULL = 33; // ms between two requests while a link is dragged
const SMALLEST = 0.05; // m: the camera comes no closer than to a ball of this radius
const MARGIN = 1.25; // of the picture to what it shows
const EDGE = { side: 0.98, top: 0.98, bottom: 0.86 }; // of half the picture: what is farther out leaves it; the timeline is below
const CORE = 0.7; // of a link's reach is seen while it is in the picture
const LINGER = 500; // ms that a preview stays until the twin has moved what it shows

class SceneTools {
  constructor() {
    this.onclick = null; // is given { path, point } of what was clicked, or null
    this.onfocus = null; // is given { path, point } of what was double-clicked
    this.entityAt = null; // path → the name of the link there, if it can be dragged
    this.onpull = null; // is given { entity, at, target }: a link, the point on it and where to draw it (m)
    this.onrelease = null; // is given { entity }
    this.pulls = false; // whether a press on a link drags it; with Ctrl it always does
    this.onplace = null; // is given { xyz, rpy } of what the handles have moved
    this.clickOwner = null; // is given clicks in place of onclick, and if it has hovered(hit), what is under the pointer
    this.glowing = new Map(); // material → its own color
    this.paths = [];
    this.ray = new THREE.Raycaster();
    this.handles = new Handles();
    this.placing = new Placing(this);
    this.pane = viewer.dom_element; // which captures the pointer for the camera
    this.pane.addEventListener("pointerdown", (event) => this.press(event), true);
    this.isTouched = false;
    for (const kind of ["pointerdown", "wheel"]) this.pane.addEventListener(kind, () => (this.isTouched = true), { capture: true, passive: true });
    this.pane.addEventListener("pointermove", (event) => this.move(event), true);
    this.pane.addEventListener("pointerup", (event) => this.release(event), true);
    this.pane.addEventListener("pointercancel", () => this.cancel(), true);
    this.pane.addEventListener("dblclick", (event) => {
      const hit = this.clickOwner || this.handles.taken ? null : this.pick(event);
      if (hit) this.onfocus?.(hit);
    });
    this.selected = []; // the paths that glow
    this.labels = new Labels(this);
    this.reaches = new WeakMap(); // link → how far its meshes reach, and how many they are
    viewer.render_callback = () => {
      this.handles.fit();
      this.labels.place();
    };
  }

  press(event) {
    this.pressed = event;
    if (event.button !== 0) return;
    this.aim(event);
    if (this.handles.take(this.ray) || ((this.pulls || event.ctrlKey) && this.startPull(event))) this.grab(event);
  }

  // Keep the pointer from the camera until it is released.
  grab(event) {
    event.stopPropagation();
    this.pane.setPointerCapture(event.pointerId);
  }

  cancel() {
    this.pressed = null;
    this.endPull();
    this.handles.release();
    this.endPreview();
  }

  // Start to drag the link under the pointer; true if there is one.
  startPull(event) {
    const hit = this.pick(event);
    const entity = hit && this.entityAt?.(hit.path);
    if (!entity) return false;
    const body = this.object(hit.path.split("/").slice(0, 2).join("/"));
    const point = this.twin.localToWorld(hit.point.clone());
    const facing = viewer.camera.getWorldDirection(new THREE.Vector3());
    const line = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1), new THREE.MeshBasicMaterial({ color: 0xd9690b, depthTest: false, transparent: true }));
    line.renderOrder = 1000;
    viewer.scene.add(line);
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(facing, point);
    this.pulled = { entity, body, line, plane, at: body.worldToLocal(point.clone()), target: point, again: setInterval(() => this.pull(), PULL) };
    this.pull();
    return true;
  }

  pull() {
    const { entity, at, target } = this.pulled;
    this.onpull?.({ entity, at: at.toArray(), target: this.twin.worldToLocal(target.clone()).toArray() });
    this.drawPull();
  }

  drawPull() {
    if (!this.pulled) return;
    const { body, line, at, target } = this.pulled;
    const from = body.localToWorld(at.clone());
    const along = target.clone().sub(from);
    const length = Math.max(along.length(), 1e-6);
    const thickness = 0.004 * viewer.camera.getWorldPosition(new THREE.Vector3()).distanceTo(target);
    line.position.copy(from).addScaledVector(along, 0.5);
    line.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.divideScalar(length));
    line.scale.set(thickness, length, thickness);
    viewer.set_dirty();
  }

  endPull() {
    if (!this.pulled) return;
    clearInterval(this.pulled.again);
    this.pulled.line.removeFromParent();
    this.onrelease?.({ entity: this.pulled.entity });
    this.pulled = null;
    viewer.set_dirty();
  }

  move(event) {
    if (this.pulled) {
      event.stopPropagation();
      this.aim(event);
      this.ray.ray.intersectPlane(this.pulled.plane, this.pulled.target);
      this.drawPull();
      return;
    }
    if (!this.handles.taken) return this.placing.hover(event);
    event.stopPropagation();
    this.aim(event);
    this.moved = this.handles.drag(this.ray);
    this.preview(this.moved.change);
  }

  release(event) {
    const from = this.pressed;
    this.pressed = null;
    if (this.pulled) {
      event.stopPropagation();
      this.endPull();
      return;
    }
    if (this.handles.taken) {
      event.stopPropagation();
      this.handles.release();
      if (this.moved) this.onplace?.(this.moved);
      this.moved = null;
      setTimeout(() => this.endPreview(), LINGER);
      return;
    }
    if (!from || event.button !== 0 || Math.hypot(event.clientX - from.clientX, event.clientY - from.clientY) > CLICK) return;
    const hit = this.pick(event);
    if (this.clickOwner) this.clickOwner.clicked(hit);
    else this.onclick?.(hit);
  }

  // Give clicks to `owner`: its clicked(hit) is called, or its clicksTaken() when another one takes them.
  takeClicks(owner) {
    const before = this.clickOwner;
    this.clickOwner = owner;
    if (before !== owner) before?.clicksTaken();
  }

  dropClicks(owner) {
    if (this.clickOwner === owner) this.clickOwner = null;
  }

  // Show what is selected at another place, too.
  preview(change) {
    if (!this.ghost) {
      this.ghost = new THREE.Group();
      this.ghost.matrixAutoUpdate = false;
      for (const path of this.paths) {
        const object = this.object(path);
        if (object) this.ghost.add(object.clone());
      }
      this.twin.add(this.ghost);
    }
    this.ghost.matrix.copy(change);
    viewer.set_dirty();
  }

  endPreview() {
    this.ghost?.removeFromParent();
    this.ghost = null;
    viewer.set_dirty();
  }

  // Show handles at a pose of xyz (m) and rpy (rad) that move what is drawn at these paths; without a pose, none.
  showHandles(pose, paths) {
    if (this.handles.taken || this.ghost) return;
    this.paths = paths;
    this.handles.show(this.twin, pose);
    viewer.set_dirty();
  }

  // The object at a path below the twin's folder; null if nothing is drawn there.
  object(path) {
    let node = viewer.scene_tree.children.twin;
    for (const part of path.split("/")) node = node?.children[part];
    return node?.object ?? null;
  }

  // Where a point of the world (m) is in the picture (pixels).
  onPicture([x, y, z]) {
    const { width, height } = viewer.renderer.domElement.getBoundingClientRect();
    viewer.camera.updateMatrixWorld();
    const at = this.twin.localToWorld(new THREE.Vector3(x, y, z)).project(viewer.camera);
    return { x: ((at.x + 1) / 2) * width, y: ((1 - at.y) / 2) * height, isAhead: at.z < 1 };
  }

  // Where the camera is, and its target, in the axes of three.js.
  cameraPlace() {
    return [...viewer.camera.getWorldPosition(new THREE.Vector3()).toArray(), ...viewer.controls.target.toArray()];
  }

  // Place the camera where `cameraPlace` said it was.
  placeCamera(place) {
    viewer.camera.position.fromArray(place);
    viewer.controls.target.fromArray(place, 3);
    viewer.controls.update();
    this.isTouched = true;
    viewer.set_dirty();
  }

  // The folder of all that is drawn of the twin; its axes are the world's.
  get twin() {
    return viewer.scene_tree.find(["twin"]).object;
  }

  aim({ clientX, clientY }) {
    const { left, top, width, height } = viewer.renderer.domElement.getBoundingClientRect();
    const at = new THREE.Vector2((2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height);
    viewer.camera.updateMatrixWorld();
    this.ray.setFromCamera(at, viewer.camera);
  }

  // What is at a place of the picture: its path and the point in the world (m); null if nothing is.
  pick(place) {
    this.aim(place);
    const drawn = this.twin.children.filter((child) => ![this.handles.group, this.ghost, this.line, this.placing.box].includes(child));
    const hit = this.ray.intersectObjects(drawn, true).find(({ object }) => isSeen(object));
    if (!hit) return null;
    const names = [];
    for (let object = hit.object; object !== this.twin; object = object.parent) names.unshift(object.name);
    return { path: names.join("/"), point: this.twin.worldToLocal(hit.point) };
  }

  // The box around what is drawn at these paths, in the axes of three.js; null if nothing is.
  boxOf(paths) {
    const box = new THREE.Box3();
    for (const path of paths) {
      const object = this.object(path);
      if (object) box.expandByObject(object);
    }
    return box.isEmpty() ? null : box;
  }

  // What `fit` depends on: how many meshes are drawn at these paths, and the shape of the picture; whether somebody has
  // moved the camera.
  measure(paths) {
    let meshes = 0;
    for (const path of paths) this.object(path)?.traverse(({ isMesh }) => (meshes += isMesh ? 1 : 0));
    return { meshes, aspect: viewer.camera.aspect.toFixed(3), isTouched: this.isTouched };
  }

  // Place the camera so that what is at these paths fills the picture, seen from its side or from a direction in the
  // world; false if nothing is drawn there yet.
  fit(paths, direction) {
    viewer.scene.updateMatrixWorld(true); // nothing may have been rendered yet
    const boxes = paths.map((path) => this.boxOf([path])).filter((box) => box);
    if (!boxes.length || viewer.camera.aspect <= 0) return false;
    const all = boxes.reduce((one, other) => one.clone().union(other));
    const target = all.getCenter(new THREE.Vector3());
    const [x, y, z] = direction ?? [];
    const from = direction ? new THREE.Vector3(x, z, -y) : viewer.camera.position.clone().sub(viewer.controls.target);
    from.normalize();
    viewer.controls.target.copy(target);
    viewer.camera.position.copy(target).addScaledVector(from, this.distanceTo(boxes, target, from));
    viewer.controls.update();
    viewer.set_dirty();
    return true;
  }

  // How far from a target a camera that looks at it from a direction sees the corners of boxes, with a margin.
  distanceTo(boxes, target, from) {
    const height = Math.tan((viewer.camera.fov * Math.PI) / 360) / MARGIN;
    const width = height * viewer.camera.aspect;
    const axes = new THREE.Matrix4().lookAt(from, new THREE.Vector3(), new THREE.Vector3(0, 1, 0)).transpose();
    let distance = SMALLEST / Math.min(height, width);
    for (const { min, max } of boxes) {
      for (const x of [min.x, max.x]) for (const y of [min.y, max.y]) for (const z of [min.z, max.z]) {
        const corner = new THREE.Vector3(x, y, z).sub(target).applyMatrix4(axes);
        distance = Math.max(distance, corner.z + Math.abs(corner.x) / width, corner.z + Math.abs(corner.y) / height);
      }
    }
    return distance;
  }

  // Whether all links of these robots are in the picture.
  areSeen(paths) {
    const { camera, scene } = viewer;
    for (const each of [scene, camera]) each.updateMatrixWorld();
    const [at, height] = [new THREE.Vector3(), Math.tan((camera.fov * Math.PI) / 360)];
    const isInside = (link) => {
      const { x, y, z } = at.setFromMatrixPosition(link.matrixWorld).applyMatrix4(camera.matrixWorldInverse);
      const [half, core] = [-z * height, CORE * this.reachOf(link)];
      return z < 0 && Math.abs(x) + core < EDGE.side * half * camera.aspect && y + core < EDGE.top * half && core - y < EDGE.bottom * half;
    };
    return paths.every((path) => this.object(path)?.children.every(isInside) ?? true);
  }

  // How far a link's meshes reach from its origin (m), as of when they were drawn.
  reachOf(link) {
    if (this.reaches.get(link)?.parts !== link.children.length) {
      const { min, max } = new THREE.Box3().setFromObject(link);
      this.reaches.set(link, { parts: link.children.length, reach: min.x > max.x ? 0 : min.distanceTo(max) / 2 });
    }
    return this.reaches.get(link).reach;
  }

  // The canvas, with the present picture on it until the next frame.
  picture() {
    const end = this.drawWhole();
    viewer.render();
    end();
    return viewer.renderer.domElement;
  }

  // Draw each pixel, however long it takes, until the function that is returned is called.
  drawWhole() {
    return viewer.drawWhole();
  }

  // Draw a line through points of the world (m) over all else; without points, none.
  showLine(points) {
    this.line?.removeFromParent();
    this.line = null;
    if (points.length) {
      const geometry = new THREE.BufferGeometry().setFromPoints(points.map((point) => new THREE.Vector3(...point)));
      this.line = new THREE.Line(geometry, new THREE.LineBasicMaterial({ color: 0xd9690b, depthTest: false, transparent: true }));
      this.line.renderOrder = 1000;
      this.twin.add(this.line);
    }
    viewer.set_dirty();
  }

  // Show the names of these robots above them, and no others.
  showNames(names) {
    this.labels.show(names);
    viewer.set_dirty();
  }

  // Tint what is at these paths, and nothing else.
  highlight(paths) {
    this.selected = paths;
    const now = new Set();
    for (const path of paths) {
      this.object(path)?.traverse(({ material }) => {
        for (const each of [material].flat()) if (each?.emissive) now.add(each);
      });
    }
    for (const [material, own] of this.glowing) {
      if (now.has(material)) continue;
      material.emissive.copy(own);
      this.glowing.delete(material);
      viewer.redraw();
    }
    for (const material of now) {
      if (this.glowing.has(material)) continue;
      this.glowing.set(material, material.emissive.clone());
      material.emissive.copy(GLOW);
      viewer.redraw();
    }
  }
}

function isSeen(object) {
  for (let each = object; each; each = each.parent) if (!each.visible) return false;
  return true;
}

window.sceneTools = new SceneTools();
