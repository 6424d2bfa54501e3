// Handles that move and turn a thing: three arrows and three rings along the world's axes, over everything else.

const { THREE } = MeshCat;
const COLORS = [0xc0392b, 0x2c8a3d, 0x2563a8]; // x, y, z
const SIZE = 0.16; // of the distance from the camera
const AXES = [new THREE.Vector3(1, 0, 0), new THREE.Vector3(0, 1, 0), new THREE.Vector3(0, 0, 1)];

function part(geometry, color, axis, turns) {
  const material = new THREE.MeshBasicMaterial({ color, depthTest: false, transparent: true, opacity: 0.85 });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.renderOrder = 1000;
  mesh.userData = { axis, turns };
  return mesh;
}

function along(axis, mesh) {
  mesh.quaternion.setFromUnitVectors(AXES[2], AXES[axis]);
  return mesh;
}

export class Handles {
  constructor() {
    this.group = new THREE.Group();
    this.group.name = "handles";
    this.pose = null; // position and quaternion in the world
    for (const axis of [0, 1, 2]) {
      const shaft = new THREE.CylinderGeometry(0.025, 0.025, 1.1).rotateX(Math.PI / 2).translate(0, 0, 0.55);
      const tip = new THREE.ConeGeometry(0.09, 0.26).rotateX(Math.PI / 2).translate(0, 0, 1.2);
      const ring = new THREE.TorusGeometry(0.8, 0.03, 8, 48);
      this.group.add(...[shaft, tip].map((each) => along(axis, part(each, COLORS[axis], axis, false))));
      this.group.add(along(axis, part(ring, COLORS[axis], axis, true)));
    }
  }

  // Show the handles at a pose below `world`, whose axes are the world's; or hide them.
  show(world, pose) {
    if (this.taken) return;
    if (!pose) return this.hide();
    const { xyz, rpy } = pose;
    this.pose = {
      position: new THREE.Vector3(...xyz),
      quaternion: new THREE.Quaternion().setFromEuler(new THREE.Euler(...rpy, "ZYX")),
    };
    if (this.group.parent !== world) world.add(this.group);
    this.group.position.copy(this.pose.position);
    this.fit();
  }

  hide() {
    this.group.removeFromParent();
    this.pose = null;
  }

  // Keep the same size in the picture.
  fit() {
    if (!this.pose) return;
    const distance = viewer.camera.getWorldPosition(new THREE.Vector3()).distanceTo(this.group.getWorldPosition(new THREE.Vector3()));
    this.group.scale.setScalar(SIZE * distance);
  }

  // Take the handle that a ray meets; true if there is one.
  take(raycaster) {
    if (!this.pose) return false;
    this.group.updateMatrixWorld(true);
    const hit = raycaster.intersectObject(this.group, true)[0];
    if (!hit) return false;
    this.taken = { ...hit.object.userData, from: { position: this.pose.position.clone(), quaternion: this.pose.quaternion.clone() } };
    this.taken.start = this.measure(raycaster);
    return true;
  }

  // How far along the axis, or at what angle about it, a ray points; null where it does not.
  measure(raycaster) {
    const { axis, turns, from } = this.taken;
    const ray = raycaster.ray.clone().applyMatrix4(this.group.parent.matrixWorld.clone().invert());
    if (turns) {
      const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(AXES[axis], from.position);
      const at = ray.intersectPlane(plane, new THREE.Vector3())?.sub(from.position);
      return at ? Math.atan2(at.dot(AXES[(axis + 2) % 3]), at.dot(AXES[(axis + 1) % 3])) : null;
    }
    const between = from.position.clone().sub(ray.origin);
    const cosine = ray.direction.dot(AXES[axis]);
    const square = 1 - cosine * cosine; // of the sine between ray and axis
    return square < 1e-4 ? null : (cosine * between.dot(ray.direction) - between.dot(AXES[axis])) / square;
  }

  // Move with a ray; returns the pose as xyz and rpy, and the matrix that takes the old pose to it.
  drag(raycaster) {
    const now = this.measure(raycaster);
    const { axis, turns, from, start } = this.taken;
    if (now !== null && start !== null) {
      if (turns) this.pose.quaternion.setFromAxisAngle(AXES[axis], now - start).multiply(from.quaternion);
      else this.pose.position.copy(from.position).addScaledVector(AXES[axis], now - start);
    }
    this.group.position.copy(this.pose.position);
    const [roll, pitch, yaw] = new THREE.Euler().setFromQuaternion(this.pose.quaternion, "ZYX").toArray();
    const one = new THREE.Vector3(1, 1, 1);
    const before = new THREE.Matrix4().compose(from.position, from.quaternion, one);
    const after = new THREE.Matrix4().compose(this.pose.position, this.pose.quaternion, one);
    return { xyz: this.pose.position.toArray(), rpy: [roll, pitch, yaw], change: after.multiply(before.invert()) };
  }

  release() {
    this.taken = null;
  }
}
