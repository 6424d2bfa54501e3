// Draws small parts that look alike, such as the wheels of all rovers, in one call: calls are what a picture of many robots costs.
// (Instances of WebGL would not do: software GL draws each of them as a call.)
"use strict";
{
  const { THREE } = MeshCat;
  const LEAST = 2; // parts alike from which on they are drawn together
  const SMALL = 4000; // vertices; with more, a call costs little beside them
  const SEGMENTS = [6, 12, 24]; // of round parts that are small in the picture, in place of their own
  const ERROR = 0.35; // pixels by which fewer segments may be seen
  const TINY = 11; // pixels of radius up to which parts have no gloss and no shadows on them
  const SHADOWED = 3.5; // times half the width of the sun's shadows: what is farther from the camera's target has none
  const CALL = 64000; // vertices in a call at most
  const MOST = 64; // parts in a call: their places are 192 of the at least 256 vectors that shaders are given
  const PLACE = 12; // numbers of a place: three rows of a matrix

  const looks = new WeakMap(); // geometry → what it looks like, as text
  let groups = []; // of parts alike, with the meshes that draw them
  let isStale = true; // something was drawn or deleted

  function hash(values) {
    const bits = values.byteLength % 4 || values.byteOffset % 4 ? values : new Uint32Array(values.buffer, values.byteOffset, values.byteLength >> 2);
    let [one, other] = [0x811c9dc5, 0x9e3779b9];
    for (let index = 0; index < bits.length; index++) {
      one = Math.imul(one ^ bits[index], 0x01000193);
      other = Math.imul(other ^ (bits[index] >>> 7), 0x85ebca6b) ^ bits[index];
    }
    return `${bits.length} ${one} ${other}`;
  }

  function lookOf(geometry) {
    if (!looks.has(geometry)) {
      const { type, parameters, attributes, index } = geometry;
      const arrays = () => [index, ...Object.values(attributes)].map((each) => each && hash(each.array));
      looks.set(geometry, `${type} ${parameters ? JSON.stringify(parameters) : [Object.keys(attributes), ...arrays()]}`);
    }
    return looks.get(geometry);
  }

  function kindOf({ geometry, material }) {
    const { color, emissive, specular, shininess, side, vertexColors, flatShading, wireframe, alphaTest } = material;
    const hexes = [color, emissive, specular].map((each) => each.getHex());
    const textures = Object.entries(material).map(([use, each]) => (each?.isTexture ? use + each.uuid : ""));
    return [...hexes, shininess, side, vertexColors, flatShading, wireframe, alphaTest, ...textures, lookOf(geometry)].join();
  }

  // What is mirrored has its faces the other way round, and what is behind translucent parts is drawn by distance.
  function canShare({ isMesh, userData, geometry, material, matrixWorld }) {
    const isSmall = isMesh && !userData.isGround && geometry.attributes.position?.count <= SMALL;
    const isPlain = isSmall && Object.values(geometry.attributes).every((each) => each.isBufferAttribute);
    return isPlain && material.isMeshPhongMaterial && !material.transparent && matrixWorld.determinant() > 0;
  }

  function gather() {
    isStale = false;
    for (const { levels } of groups) levels.forEach(discard);
    const found = new Map();
    viewer.scene_tree.children.twin?.object.traverse((part) => {
      if (!canShare(part)) return;
      const kind = kindOf(part);
      if (!found.has(kind)) found.set(kind, []);
      found.get(kind).push(part);
    });
    groups = [...found.values()].filter((parts) => parts.length >= LEAST).map((parts) => ({ parts, levels: levelsOf(parts) }));
  }

  // What draws these parts, from tiny ones to those as they are; each with the largest radius, in pixels, that it draws.
  function levelsOf(parts) {
    const [{ geometry, material }] = parts;
    const light = material.emissive.getHex() || !geometry.attributes.normal ? material : lightly(material);
    const level = (shape, segments) => {
      const most = segments ? ERROR / (1 - Math.cos(Math.PI / segments)) : Infinity;
      return { ...drawTogether(shape, most <= TINY ? light : material, parts.length), most };
    };
    const levels = SEGMENTS.map((segments) => [coarse(geometry, segments), segments]).filter(([shape]) => shape).map(([shape, segments]) => level(shape, segments));
    if (!levels.length && light !== material) levels.push({ ...drawTogether(geometry, light, parts.length), most: TINY });
    return [...levels, level(geometry)];
  }

  // A material with the scene's light, computed at vertices: less than half the cost where triangles are as small as pixels.
  function lightly({ color, vertexColors, map, alphaTest, side, shadowSide, specular }) {
    const light = new THREE.MeshBasicMaterial({ color, vertexColors, map, alphaTest, side, shadowSide });
    light.userData.gloss = specular.r;
    light.onBeforeCompile = shineAtVertices;
    return light;
  }

  function shineAtVertices(shader) {
    Object.assign(shader.uniforms, lights, { uMirrored: viewer.lights.mirrored, uGloss: { value: this.userData.gloss } });
    shader.vertexShader = shader.vertexShader
      .replace("void main() {", `uniform vec3 uSky, uGround, uSun, uToSun;\nuniform float uGloss;\nvarying vec3 vLight, vGloss;\n${viewer.lights.mirror}void main() {`)
      .replace(
        "#include <project_vertex>",
        `#include <project_vertex>
        mat3 turn = mat3(instanceMatrix);
        vec3 upright = normalize(turn * (normal / vec3(dot(turn[0], turn[0]), dot(turn[1], turn[1]), dot(turn[2], turn[2]))));
        vLight = mix(uGround, uSky, 0.5 + 0.5 * upright.y) + uSun * max(dot(upright, uToSun), 0.0);
        vGloss = mirror(uGloss, normalize(-mvPosition.xyz), normalize(mat3(viewMatrix) * upright));`,
      );
    shader.fragmentShader = shader.fragmentShader
      .replace("void main() {", "varying vec3 vLight, vGloss;\nvoid main() {")
      .replace("#include <color_fragment>", "#include <color_fragment>\ndiffuseColor.rgb *= vLight;")
      .replace("#include <envmap_fragment>", "outgoingLight += vGloss;");
  }

  const lights = { uSky: { value: new THREE.Color() }, uGround: { value: new THREE.Color() }, uSun: { value: new THREE.Color() }, uToSun: { value: new THREE.Vector3() } };

  // As three.js' hemisphere and directional lights on what reflects in all directions.
  function light({ sky, sun }) {
    lights.uSky.value.copy(sky.color).multiplyScalar(sky.intensity / Math.PI);
    lights.uGround.value.copy(sky.groundColor).multiplyScalar(sky.intensity / Math.PI);
    lights.uSun.value.copy(sun.color).multiplyScalar(sun.intensity / Math.PI);
    lights.uToSun.value.setFromMatrixPosition(sun.matrixWorld).sub(new THREE.Vector3().setFromMatrixPosition(sun.target.matrixWorld)).normalize();
  }

  function coarse({ type, parameters: its }, segments) {
    if (type === "CylinderGeometry" && its.radialSegments > segments)
      return new THREE.CylinderGeometry(its.radiusTop, its.radiusBottom, its.height, segments, 1, its.openEnded);
    if (type === "SphereGeometry" && its.widthSegments > segments) return new THREE.SphereGeometry(its.radius, segments, segments / 2);
    return null;
  }

  // Meshes of copies of a geometry, of which `place` draws as many as are seen.
  function drawTogether(geometry, material, count) {
    if (!geometry.boundingSphere) geometry.computeBoundingSphere();
    const each = Math.max(1, Math.min(count, MOST, Math.floor(CALL / geometry.attributes.position.count)));
    const shape = copies(geometry, each);
    const meshes = Array.from({ length: Math.ceil(count / each) }, () => {
      const drawn = new THREE.Mesh(sharing(shape), material.clone());
      drawn.customDepthMaterial = new THREE.MeshDepthMaterial({ depthPacking: THREE.RGBADepthPacking });
      drawn.places = new Float32Array(PLACE * MOST);
      placedBy(drawn.places, drawn.material, material.onBeforeCompile);
      placedBy(drawn.places, drawn.customDepthMaterial, () => {});
      drawn.castShadow = drawn.receiveShadow = true;
      drawn.frustumCulled = false; // each part is, below
      drawn.updateMatrixWorld = () => {}; // the places are in the scene's own axes
      viewer.scene.add(drawn);
      return drawn;
    });
    return { meshes, each, ball: geometry.boundingSphere, indices: (geometry.index ?? geometry.attributes.position).count };
  }

  // A geometry with the same arrays, and a range of its own.
  function sharing({ attributes, index }) {
    const geometry = new THREE.BufferGeometry().setIndex(index);
    for (const [name, attribute] of Object.entries(attributes)) geometry.setAttribute(name, attribute);
    return geometry;
  }

  function copies(geometry, count) {
    const many = new THREE.BufferGeometry();
    const vertices = geometry.attributes.position.count;
    const repeat = ({ array, itemSize, normalized }) => {
      const all = new array.constructor(array.length * count);
      for (let copy = 0; copy < count; copy++) all.set(array, copy * array.length);
      return new THREE.BufferAttribute(all, itemSize, normalized);
    };
    for (const [name, attribute] of Object.entries(geometry.attributes)) many.setAttribute(name, repeat(attribute));
    const parts = Float32Array.from({ length: vertices * count }, (_, vertex) => Math.floor(vertex / vertices));
    many.setAttribute("part", new THREE.BufferAttribute(parts, 1));
    const own = geometry.index?.array ?? Array.from({ length: vertices }, (_, vertex) => vertex);
    const indices = Uint32Array.from({ length: own.length * count }, (_, at) => own[at % own.length] + vertices * Math.floor(at / own.length));
    many.setIndex(new THREE.BufferAttribute(indices, 1));
    return many;
  }

  // Let a material take the place of each part from a list, where three.js' own code takes that of an instance.
  function placedBy(places, material, before) {
    material.onBeforeCompile = function (shader) {
      before.call(this, shader);
      shader.uniforms.uPlaces = { value: places };
      shader.vertexShader = `
        uniform vec4 uPlaces[${(PLACE / 4) * MOST}];
        attribute float part;
        mat4 placeOfPart;
        #define USE_INSTANCING
        #define instanceMatrix placeOfPart
        ${shader.vertexShader.replace(
          "void main() {",
          `void main() {
          int row = ${PLACE / 4} * int(part);
          placeOfPart = transpose(mat4(uPlaces[row], uPlaces[row + 1], uPlaces[row + 2], vec4(0.0, 0.0, 0.0, 1.0)));`,
        )}`;
    };
    material.customProgramCacheKey = () => `alike ${before}`;
  }

  function discard({ meshes }) {
    for (const mesh of meshes) {
      mesh.removeFromParent();
      for (const each of [mesh.geometry, mesh.material, mesh.customDepthMaterial]) each.dispose();
    }
  }

  // Place those of the parts that may be seen, or whose shadows may be.
  function place({ parts, levels }, { frustum, eye, pixels }) {
    const ball = new THREE.Sphere();
    const { target, reach, texel } = viewer.shadowed;
    let largest = 0; // m, of the balls around them
    for (const level of levels) level.count = 0;
    for (const part of parts) {
      if (!isShown(part)) continue;
      ball.copy(levels[0].ball).applyMatrix4(part.matrixWorld);
      largest = Math.max(largest, ball.radius);
      if (!frustum.intersectsSphere(ball) && ball.center.distanceTo(target) - ball.radius > SHADOWED * reach) continue;
      const radius = (pixels * ball.radius) / Math.max(eye.distanceTo(ball.center) - ball.radius, 1e-6);
      const level = levels.find(({ most }) => radius <= most);
      const { elements } = part.matrixWorld;
      const { places } = level.meshes[Math.floor(level.count / level.each)];
      for (let row = 0, at = PLACE * (level.count % level.each); row < 3; row++) for (let column = 0; column < 4; column++) places[at++] = elements[4 * column + row];
      level.count++;
    }
    for (const { meshes, each, count, indices } of levels) {
      meshes.forEach((mesh, number) => {
        const left = Math.min(Math.max(count - each * number, 0), each);
        mesh.visible = left > 0;
        mesh.castShadow = largest > texel; // a smaller one is not seen
        mesh.geometry.setDrawRange(0, left * indices);
      });
    }
  }

  // Whether a part is in the scene and visible; a preview that is over is not.
  function isShown(object) {
    for (let each = object; each?.visible; each = each.parent) if (each === viewer.scene) return true;
    return false;
  }

  // Draw again after materials have changed.
  viewer.redraw = () => {
    isStale = true;
    viewer.set_dirty();
  };

  const { set_object: setObject } = viewer;
  viewer.set_object = function (path, ...more) {
    isStale ||= path[0] === "twin";
    return setObject.call(this, path, ...more);
  };
  const paths = Object.getPrototypeOf(viewer.scene_tree);
  const { dispose_recursive: dispose } = paths;
  paths.dispose_recursive = function () {
    isStale = true;
    dispose.call(this);
  };

  const { renderer } = viewer;
  const { render } = renderer;
  renderer.render = function (scene, camera) {
    if (scene !== viewer.scene) return render.call(renderer, scene, camera); // such as the sky's, for what it lights
    scene.updateMatrixWorld();
    if (!camera.parent) camera.updateMatrixWorld();
    if (isStale) gather();
    light(viewer.lights);
    const seen = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const view = {
      frustum: new THREE.Frustum().setFromProjectionMatrix(seen),
      eye: new THREE.Vector3().setFromMatrixPosition(camera.matrixWorld),
      pixels: (camera.projectionMatrix.elements[5] * renderer.domElement.height) / 2, // of 1 m at a distance of 1 m
    };
    const hidden = [];
    for (const group of groups) {
      place(group, view);
      for (const part of group.parts) if (part.visible) hidden.push(part);
    }
    for (const part of hidden) part.visible = false;
    scene.matrixWorldAutoUpdate = false; // it was just done
    try {
      render.call(renderer, scene, camera);
    } finally {
      scene.matrixWorldAutoUpdate = true;
      for (const part of hidden) part.visible = true;
    }
  };
}
