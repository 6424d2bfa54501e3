// Names in the scene: above robots, and at objects of overlays; where they would overlap, the nearer ones are seen.

const { THREE } = MeshCat;
const LIFTS = [0, 1.2, 2.4]; // lines that a name may stand higher to overlap no other

export class Labels {
  constructor(tools) {
    this.tools = tools;
    this.robots = new Map(); // path of a robot → its label, with its size and its height above the first link
    this.objects = new Map(); // object → its label, with its size
  }

  // Show the names of these robots, and no others.
  show(names) {
    for (const { label } of this.robots.values()) label.remove();
    this.robots.clear();
    for (const name of names) {
      const label = document.createElement("div");
      label.className = "name";
      label.textContent = name;
      document.body.append(label);
      this.robots.set(name, { label, width: label.offsetWidth, height: label.offsetHeight, top: null });
    }
  }

  // Place the names; of those that would overlap, the farther robots' are higher by some lines, or hidden.
  place() {
    if (!this.robots.size && !this.objects.size) return;
    const eye = viewer.camera.getWorldPosition(new THREE.Vector3());
    const found = [...this.robots].map(([path, name]) => {
      const top = this.topOf(path);
      return { ...name, at: top && this.tools.onPicture(this.tools.twin.worldToLocal(top.clone()).toArray()), distance: top?.distanceTo(eye) };
    });
    for (const [object, label] of this.objects) {
      const at = object.getWorldPosition(new THREE.Vector3());
      found.push({ ...label, at: this.tools.onPicture(this.tools.twin.worldToLocal(at.clone()).toArray()), distance: at.distanceTo(eye), isSmall: true });
    }
    const shown = [];
    // Robots' names first, then what is nearest.
    for (const { label, width, height, at } of found.sort((one, other) => (one.isSmall ?? 0) - (other.isSmall ?? 0) || one.distance - other.distance)) {
      const isFree = (y) => shown.every((other) => Math.abs(at.x - other.at.x) > (width + other.width) / 2 || Math.abs(y - other.at.y) > height);
      const y = at?.isAhead ? LIFTS.map((lines) => at.y - lines * height).find(isFree) : undefined;
      label.hidden = y === undefined;
      if (label.hidden) continue;
      at.y = y;
      shown.push({ at, width });
      label.style.transform = `translate(${at.x.toFixed(1)}px, ${at.y.toFixed(1)}px) translate(-50%, -130%)`;
    }
  }

  // Where a robot's name is: above its first link, by the robot's height when it was named.
  topOf(path) {
    const link = this.tools.object(path)?.children[0];
    if (!link) return null;
    const at = link.getWorldPosition(new THREE.Vector3());
    const known = this.robots.get(path);
    if (known.top === null) {
      const box = this.tools.boxOf([path]);
      if (box) known.top = box.max.y - at.y;
    }
    return at.setY(at.y + (known.top ?? 0));
  }
}
