// A translucent box that follows the mouse on the surfaces of the scene, before something is placed with a click.

const { THREE } = MeshCat;

export class Placing {
  constructor(tools) {
    this.tools = tools;
    this.box = null;
  }

  // Tell who has the clicks, if it has hovered(hit), what is under the pointer: once for each picture.
  hover(event) {
    if (!this.tools.clickOwner?.hovered) return;
    if (!this.pointed) requestAnimationFrame(() => this.point());
    this.pointed = event;
  }

  point() {
    const { tools, pointed } = this;
    this.pointed = null;
    tools.clickOwner?.hovered?.(tools.pick(pointed));
  }

  // Show a box of a size (m), turned about the vertical (rad), with its middle (m) seen from a point; without one, none.
  show(box) {
    this.box?.removeFromParent();
    this.box?.geometry.dispose();
    this.box = null;
    if (box) {
      const material = new THREE.MeshBasicMaterial({ color: 0xd9690b, transparent: true, opacity: 0.45 });
      this.box = new THREE.Mesh(new THREE.BoxGeometry(...box.size), material);
      this.box.position.set(...box.middle).applyAxisAngle(new THREE.Vector3(0, 0, 1), box.yaw).add(box.at);
      this.box.rotation.z = box.yaw;
      this.tools.twin.add(this.box);
    }
    viewer.set_dirty();
  }
}
