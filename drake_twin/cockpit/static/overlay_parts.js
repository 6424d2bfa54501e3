// What the scene does with overlays: moves folders with links, draws lines as thick as they are seen, shows the ranges of joints.
"use strict";
{
  const { THREE } = MeshCat;
  const THICK = 2.5; // CSS pixels of a line
  const GHOST = 0.4; // opacity
  const tools = () => window.sceneTools; // they come after the first frame
  const isOverlay = ([root]) => root === "overlays";

  // Move …/on/MODEL/BODY with what is drawn of that body: no pose is sent for it.
  function follow() {
    const { twin, overlays } = viewer.scene_tree.children;
    for (const { children } of Object.values(overlays?.children ?? {})) {
      if (children.on) followOf(Object.entries(children.on.children), twin?.children ?? {});
    }
  }

  function followOf(models, drawn) {
    for (const [model, { children: bodies }] of models) {
      const isChosen = models.length === 1 || (tools()?.selected ?? []).some((path) => path.split("/")[0] === model);
      for (const [body, { object: folder, children }] of Object.entries(bodies)) {
        const moved = drawn[model]?.children[body]?.object;
        folder.visible = Boolean(moved);
        if (children.limits) children.limits.object.visible = isChosen;
        if (!moved) continue;
        folder.position.copy(moved.position);
        folder.quaternion.copy(moved.quaternion);
      }
    }
  }

  // Lines of three.js are one pixel wide: draw each segment as a rectangle that faces the camera.
  const CORNERS = new Float32Array([0, -1, 0, 0, 1, 0, 1, -1, 0, 1, 1, 0]); // along, across
  const VERTEX = `
    attribute vec3 from, to, tint;
    uniform vec2 uSize;
    varying vec3 vTint;
    void main() {
      vTint = tint;
      vec4 one = modelViewMatrix * vec4(from, 1.0), other = modelViewMatrix * vec4(to, 1.0);
      float near = -0.001; // what is behind the camera has no place in the picture
      if (one.z > near && other.z < near) one = mix(other, one, (near - other.z) / (one.z - other.z));
      if (other.z > near && one.z < near) other = mix(one, other, (near - one.z) / (other.z - one.z));
      vec4 a = projectionMatrix * one, b = projectionMatrix * other;
      vec2 along = (b.xy / b.w - a.xy / a.w) * uSize;
      along = dot(along, along) > 1e-12 ? normalize(along) : vec2(1.0, 0.0);
      gl_Position = position.x < 0.5 ? a : b;
      gl_Position.xy += position.y * vec2(-along.y, along.x) / uSize * gl_Position.w;
    }`;
  const FRAGMENT = `
    uniform float uOpacity;
    varying vec3 vTint;
    void main() {
      gl_FragColor = vec4(vTint, uOpacity);
      #include <colorspace_fragment>
    }`;
  const size = { value: new THREE.Vector2(1, 1) };

  function thicken(lines) {
    const { position, color } = lines.geometry.attributes;
    const { material } = lines;
    const count = position.count / 2;
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(CORNERS, 3));
    geometry.setIndex([0, 2, 1, 1, 2, 3]);
    const ends = new THREE.InstancedInterleavedBuffer(position.array, 6, 1);
    geometry.setAttribute("from", new THREE.InterleavedBufferAttribute(ends, 3, 0));
    geometry.setAttribute("to", new THREE.InterleavedBufferAttribute(ends, 3, 3));
    const tint = new Float32Array(3 * count);
    for (let index = 0; index < count; index++) {
      const own = color ? new THREE.Color().setRGB(color.getX(2 * index), color.getY(2 * index), color.getZ(2 * index), THREE.SRGBColorSpace) : material.color;
      own.toArray(tint, 3 * index);
    }
    geometry.setAttribute("tint", new THREE.InstancedBufferAttribute(tint, 3));
    geometry.instanceCount = count;
    const { depthTest, depthWrite, transparent, opacity } = material;
    const thick = new THREE.Mesh(
      geometry,
      new THREE.ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: { uSize: size, uOpacity: { value: opacity } }, side: THREE.DoubleSide, depthTest, depthWrite, transparent }),
    );
    thick.frustumCulled = false;
    thick.renderOrder = lines.renderOrder;
    lines.parent.add(thick);
    lines.removeFromParent();
    lines.geometry.dispose();
    material.dispose();
  }

  // What a lidar measures is on surfaces, but for its noise: draw points in front of what is that little before them.
  const NOISE = 0.05; // m

  function lift(points) {
    points.material.onBeforeCompile = (shader) => {
      shader.vertexShader = shader.vertexShader.replace(
        "#include <project_vertex>",
        `#include <project_vertex>
        vec4 nearer = projectionMatrix * (mvPosition + vec4(0.0, 0.0, ${NOISE}, 0.0));
        if (nearer.w > 0.0) gl_Position.z = nearer.z / nearer.w * gl_Position.w;`,
      );
    };
  }

  // Copies of what is drawn of bodies, one material for each color; they are filled again when anything is drawn anew.
  const ghosts = new Set();
  const tints = new Map();
  let areStale = false;

  function tintOf(color) {
    const key = String(color);
    if (!tints.has(key)) {
      const tint = new THREE.MeshLambertMaterial({ color: new THREE.Color(...color), transparent: true, opacity: GHOST, depthWrite: false });
      tint.dispose = () => {}; // others are drawn with it
      tints.set(key, tint);
    }
    return tints.get(key);
  }

  function fillGhosts() {
    if (!areStale || !tools()) return;
    areStale = false;
    for (const ghost of ghosts) {
      if (!isInScene(ghost)) {
        ghosts.delete(ghost);
        continue;
      }
      ghost.clear();
      const drawn = tools().object(ghost.userData.copyOf);
      for (const child of drawn?.children ?? []) ghost.add(child.clone());
      ghost.traverse((part) => {
        if (!part.isMesh) return;
        part.material = tintOf(ghost.userData.color);
        part.castShadow = part.receiveShadow = false;
      });
    }
  }

  function isInScene(object) {
    for (let each = object; each; each = each.parent) if (each === viewer.scene) return true;
    return false;
  }

  // Labels of objects; the scene's tools place them. Those of objects that are gone go.
  const labels = new Map(); // object → its label, with its size

  function labelOf(text) {
    const label = document.createElement("div");
    label.className = "name small";
    label.textContent = text;
    document.body.append(label);
    return { label, width: label.offsetWidth, height: label.offsetHeight };
  }

  function labelsInScene() {
    for (const [object, { label }] of labels) {
      if (isInScene(object)) continue;
      label.remove();
      labels.delete(object);
    }
    return labels;
  }

  const { set_object: setObject, render } = viewer;
  viewer.set_object = function (path, object, ...more) {
    if (path[0] === "twin") areStale = ghosts.size > 0;
    if (isOverlay(path) && object.userData?.copyOf) {
      ghosts.add(object);
      areStale = true;
    }
    if (isOverlay(path) && object.isObject3D) {
      const found = [];
      object.traverse((part) => (part.isPoints ? lift(part) : part.isLineSegments && found.push(part)));
      found.forEach(thicken);
      if (object.userData?.label) labels.set(object, labelOf(object.userData.label));
    }
    return setObject.call(this, path, object, ...more);
  };

  viewer.render = function (...given) {
    follow();
    fillGhosts();
    if (tools()) tools().labels.objects = labelsInScene();
    const { width, height } = viewer.renderer.getDrawingBufferSize(new THREE.Vector2());
    size.value.set(width, height).divideScalar(THICK * viewer.renderer.getPixelRatio());
    return render.apply(this, given);
  };
}
