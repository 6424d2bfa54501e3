// What is around the robots: the sky, the sun with its shadows, and a ground with a grid that fades far away.
"use strict";
{
  const { THREE } = MeshCat;
  const gl = viewer.renderer.getContext();
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  const isSoftware = /swiftshader|llvmpipe|software/i.test(names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : "");
  const SUN = new THREE.Vector3(0.5, -0.1, 0.9).normalize(); // towards the sun, in the world: as in Gazebo's worlds
  const LIT = { sky: 1.25, sun: 1.9 }; // π in all: what faces the sun has its file's color
  const FIELD = 50; // °, of view from below to above
  const SKY = {
    light: { top: [0.5, 0.67, 0.86], bottom: [0.93, 0.95, 0.97], ground: 1.0, light: 1.0 },
    dark: { top: [0.07, 0.09, 0.12], bottom: [0.2, 0.23, 0.27], ground: 0.3, light: 0.85 },
  };
  const SEEN = { least: 60, most: 900, times: 25 }; // m: how far the ground is seen, from a camera that far from its target
  const [CLOSE, AFAR] = [0.4, 60]; // m: where the grid is ten times finer and coarser
  const SIDE = 4000; // m, of the ground
  const SEGMENTS = 40; // of the ground: the depth of larger triangles is not exact enough beside a floor at the same height
  const ENDLESS = 100; // m, of sides from which on a plane is that of a world, which has no end
  const SHADOWED = { least: 0.15, most: 60, times: 1.3, ahead: 0.5, step: 0.25 }; // m around the camera's target, that far from it; of that, behind the target
  const CLOSED = ["BoxGeometry", "SphereGeometry", "CylinderGeometry"]; // whose insides nobody sees
  const TEXELS = isSoftware ? 1024 : 2048; // along each side of the shadows
  const OPAQUE = 0.5; // what is less so has no shadow
  const GLOSS = { most: 0.025, least: 0.004 }; // of the light that dark and bright paint reflects

  // A smooth surface reflects the sky, more so towards its edges: what is black would have no form else.
  const MIRROR = `
    uniform float uMirrored;
    vec3 mirror(float gloss, vec3 toEye, vec3 normal) {
      float upwards = dot(reflect(-toEye, normal), viewMatrix[1].xyz);
      float edge = 1.0 - clamp(dot(toEye, normal), 0.0, 1.0);
      return uMirrored * gloss * (1.0 + 10.0 * pow(edge, 4.0)) * mix(vec3(0.12), vec3(0.75, 0.85, 1.0), smoothstep(-0.4, 0.8, upwards));
    }
  `;

  const theme = matchMedia("(prefers-color-scheme: dark)");
  const seen = { value: SEEN.least };
  const shade = { value: 1 };
  const apart = { value: 0.1 }; // m, the finest lines
  const mirrored = { value: 1 };

  const set = (path, property, value) => viewer.handle_command({ type: "set_property", path, property, value });
  for (const path of ["/Axes/<object>", "/Grid/<object>", "/Lights"]) set(path, "visible", false);

  const sky = new THREE.HemisphereLight(0xffffff, 0x9a958c);
  const sun = new THREE.DirectionalLight(0xfffaf0);
  sun.castShadow = true;
  sky.position.set(0, 0, 1);
  viewer.scene.add(sky, sun, sun.target); // its axes are the world's
  viewer.lights = { sky, sun, mirrored, mirror: MIRROR };
  viewer.renderer.shadowMap.type = THREE.PCFSoftShadowMap;
  if (isSoftware) {
    // Nine texels with the weights of a quadratic spline in place of 25: half of a picture's time went there.
    const { ShaderChunk } = THREE;
    ShaderChunk.shadowmap_pars_fragment = ShaderChunk.shadowmap_pars_fragment.replace(
      /(defined\( SHADOWMAP_TYPE_PCF_SOFT \)\s)[^#]*(#)/,
      `$1
      vec2 at = fract(shadowCoord.xy * shadowMapSize), texel = 1.0 / shadowMapSize, middle = shadowCoord.xy + (0.5 - at) * texel;
      vec2 low = 0.5 * (1.0 - at) * (1.0 - at), high = 0.5 * at * at;
      vec3 across = vec3(low.x, 1.0 - low.x - high.x, high.x), along = vec3(low.y, 1.0 - low.y - high.y, high.y);
      shadow = 0.0;
      for (int y = 0; y < 3; y++) for (int x = 0; x < 3; x++)
        shadow += across[x] * along[y] * texture2DCompare(shadowMap, middle + vec2(x - 1, y - 1) * texel, shadowCoord.z);
      $2`,
    );
  }
  viewer.renderer.toneMapping = THREE.NoToneMapping; // materials look as their files say
  viewer.camera.fov = FIELD;

  function paint() {
    const { top, bottom, ground, light } = SKY[theme.matches ? "dark" : "light"];
    set("/Background/<object>", "top_color", top);
    set("/Background/<object>", "bottom_color", bottom);
    shade.value = ground;
    sky.intensity = light * LIT.sky;
    sun.intensity = light * LIT.sun;
    mirrored.value = ground;
    viewer.set_dirty();
  }
  theme.addEventListener("change", paint);
  paint();

  // Lines of three distances, 0.1, 1 and 10 m but for very near or far cameras; those some pixels apart are left out.
  const GRID = `
    varying vec3 vGround;
    uniform float uSeen, uShade, uLines;
    float lines(vec2 at, vec2 pixel, float weight) {
      vec2 near = abs(fract(at - 0.5) - 0.5) / pixel;
      return weight * (1.0 - min(min(near.x, near.y), 1.0)) * (1.0 - smoothstep(0.06, 0.3, max(pixel.x, pixel.y)));
    }`;

  function groundMaterial({ color, opacity }, toWorld) {
    const farther = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 64 }; // than a floor at the same height
    const material = new THREE.MeshLambertMaterial({ color, opacity, transparent: true, ...farther });
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, { uSeen: seen, uShade: shade, uLines: apart, uToWorld: { value: toWorld } });
      shader.vertexShader = shader.vertexShader
        .replace("void main() {", "varying vec3 vGround;\nuniform mat4 uToWorld;\nvoid main() {")
        .replace("#include <project_vertex>", "#include <project_vertex>\nvGround = (uToWorld * vec4(position, 1.0)).xyz;");
      shader.fragmentShader = shader.fragmentShader
        .replace("void main() {", `${GRID}\nvoid main() {`)
        .replace(
          "#include <color_fragment>",
          `#include <color_fragment>
          vec2 at = vGround.xy / uLines, pixel = max(fwidth(at), 1e-6);
          float grid = max(max(lines(at, pixel, 0.12), lines(0.1 * at, 0.1 * pixel, 0.3)), lines(0.01 * at, 0.01 * pixel, 0.45));
          diffuseColor.rgb *= uShade;
          diffuseColor.rgb = dot(diffuseColor.rgb, vec3(0.3, 0.6, 0.1)) > 0.15 ? diffuseColor.rgb * (1.0 - grid) : diffuseColor.rgb + 0.2 * grid;
          diffuseColor.a *= 1.0 - smoothstep(0.3, 1.0, length(vViewPosition) / uSeen);`,
        );
    };
    return material;
  }

  // Lay a ground where a plate is drawn for it.
  function lay(plate) {
    const { width, height, depth } = plate.geometry.parameters;
    const sides = plate.userData.isEndless || Math.min(width, height) >= ENDLESS ? [SIDE, SIDE] : [width, height];
    plate.geometry.dispose();
    plate.geometry = new THREE.PlaneGeometry(...sides, SEGMENTS, SEGMENTS).translate(0, 0, depth / 2);
    plate.material = groundMaterial(plate.material, plate.matrixWorld.clone());
    plate.renderOrder = -1;
    plate.castShadow = false;
  }

  function reflect(shader) {
    shader.uniforms.uMirrored = mirrored;
    shader.fragmentShader = shader.fragmentShader
      .replace("void main() {", `${MIRROR}void main() {`)
      .replace("#include <envmap_fragment>", "outgoingLight += mirror(specular.r, normalize(vViewPosition), normal);");
  }

  function dress(object) {
    object.updateMatrixWorld(true);
    object.traverse((part) => {
      if (!part.isMesh) return;
      part.receiveShadow = true;
      part.castShadow = part.material.opacity > OPAQUE;
      part.material.shadowSide = THREE.BackSide; // a lit side has no shadow of its own
      if (CLOSED.includes(part.geometry.type) && !part.geometry.parameters.openEnded && !part.material.transparent) part.material.side = THREE.FrontSide;
      if (part.userData.isGround) lay(part);
      else if (part.material.isMeshPhongMaterial) {
        const { r, g, b } = part.material.color;
        part.material.specular.setScalar(THREE.MathUtils.lerp(GLOSS.most, GLOSS.least, Math.max(r, g, b)));
        part.material.shininess = 40;
        part.material.onBeforeCompile = reflect;
      }
    });
  }

  const { set_object: setObject } = viewer;
  viewer.set_object = function (path, object, ...more) {
    if (path[0] === "twin" && object.isObject3D) dress(object);
    if (path[0] === "overlays" && object.isObject3D) object.traverse((part) => (part.castShadow = part.receiveShadow = false));
    return setObject.call(this, path, object, ...more);
  };

  let pictures = 0;
  const lit = new THREE.Vector3(); // where the shadows' middle is

  // Let the camera see as far as it looks from, and the sun shine where it looks.
  function look() {
    const { camera, controls } = viewer;
    const distance = camera.getWorldPosition(new THREE.Vector3()).distanceTo(controls.target);
    seen.value = THREE.MathUtils.clamp(SEEN.times * distance, SEEN.least, SEEN.most);
    apart.value = distance < CLOSE ? 0.01 : distance > AFAR ? 1 : 0.1;
    camera.near = THREE.MathUtils.clamp(distance / 200, 0.002, 0.1);
    camera.far = Math.max(1.2 * seen.value, 4 * distance);
    const reach = THREE.MathUtils.clamp(SHADOWED.times * distance, SHADOWED.least, SHADOWED.most);
    const middle = camera.getWorldDirection(new THREE.Vector3()).setY(0).multiplyScalar(SHADOWED.ahead * reach).add(controls.target);
    middle.divideScalar(SHADOWED.step * reach).round().multiplyScalar(SHADOWED.step * reach); // else edges crawl with the camera
    const texels = TEXELS * (viewer.sharpness ?? 1);
    viewer.shadowed = { target: middle, reach, texel: (2 * reach) / texels };
    viewer.scene.worldToLocal(sun.target.position.copy(middle));
    sun.position.copy(sun.target.position).addScaledVector(SUN, 3 * reach);
    const { camera: eye, mapSize } = sun.shadow;
    const { shadowMap } = viewer.renderer;
    shadowMap.autoUpdate = (viewer.sharpness ?? 1) === 1;
    if (mapSize.x !== texels) {
      mapSize.setScalar(texels);
      sun.shadow.map?.dispose();
      sun.shadow.map = null;
      eye.right = 0;
    }
    const isElsewhere = eye.right !== reach || !lit.equals(middle);
    shadowMap.needsUpdate = isElsewhere || pictures++ % 2 === 0; // where pictures come slowly, each second one
    lit.copy(middle);
    if (eye.right !== reach) {
      Object.assign(eye, { left: -reach, right: reach, bottom: -reach, top: reach, near: 0.1 * reach, far: 6 * reach });
      eye.updateProjectionMatrix();
      sun.shadow.normalBias = (3 * reach) / mapSize.x;
    }
  }

  const { render } = viewer;
  viewer.render = function (...given) {
    look();
    return render.apply(this, given);
  };
}
