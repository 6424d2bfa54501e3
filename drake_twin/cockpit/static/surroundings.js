// What is around the robots: the sky, the sun with its shadows, and a ground with a grid that fades far away.
"use strict";
{
  const { THREE } = MeshCat;
  const SUN = new THREE.Vector3(0.5, -0.35, 1).normalize(); // towards the sun, in the world
  const LIT = { sky: 1.3, sun: 2.1 };
  const SKY = {
    light: { top: [0.5, 0.67, 0.86], bottom: [0.93, 0.95, 0.97], ground: 1.0, light: 1.0 },
    dark: { top: [0.07, 0.09, 0.12], bottom: [0.2, 0.23, 0.27], ground: 0.35, light: 0.85 },
  };
  const SEEN = { least: 60, most: 900, times: 25 }; // m: how far the ground is seen, from a camera that far from its target
  const SIDE = 4000; // m, of the ground
  const SHADOWED = { least: 1, most: 60 }; // m around the camera's target
  const OPAQUE = 0.5; // what is less so has no shadow

  const gl = viewer.renderer.getContext();
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  const isSoftware = /swiftshader|llvmpipe|software/i.test(names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : "");
  const theme = matchMedia("(prefers-color-scheme: dark)");
  const seen = { value: SEEN.least };
  const shade = { value: 1 };

  const set = (path, property, value) => viewer.handle_command({ type: "set_property", path, property, value });
  for (const path of ["/Axes/<object>", "/Grid/<object>", "/Lights"]) set(path, "visible", false);

  const sky = new THREE.HemisphereLight(0xffffff, 0x9a958c);
  const sun = new THREE.DirectionalLight(0xfffaf0);
  sun.castShadow = true;
  sun.shadow.mapSize.setScalar(isSoftware ? 1024 : 2048);
  sky.position.set(0, 0, 1);
  viewer.scene.add(sky, sun, sun.target); // its axes are the world's
  viewer.renderer.shadowMap.type = THREE.PCFSoftShadowMap;
  viewer.renderer.toneMapping = THREE.NeutralToneMapping; // materials look as their files say

  function paint() {
    const { top, bottom, ground, light } = SKY[theme.matches ? "dark" : "light"];
    set("/Background/<object>", "top_color", top);
    set("/Background/<object>", "bottom_color", bottom);
    shade.value = ground;
    sky.intensity = light * LIT.sky;
    sun.intensity = light * LIT.sun;
    viewer.set_dirty();
  }
  theme.addEventListener("change", paint);
  paint();

  // Lines 0.1, 1 and 10 m apart; those that would be closer than some pixels are left out.
  const GRID = `
    varying vec3 vGround;
    uniform float uSeen, uShade;
    float lines(float apart, float weight) {
      vec2 at = vGround.xy / apart, pixel = fwidth(at);
      vec2 near = abs(fract(at - 0.5) - 0.5) / max(pixel, 1e-6);
      return weight * (1.0 - min(min(near.x, near.y), 1.0)) * (1.0 - smoothstep(0.06, 0.3, max(pixel.x, pixel.y)));
    }`;

  function groundMaterial({ color, opacity }, toWorld) {
    const material = new THREE.MeshLambertMaterial({ color, opacity, transparent: true });
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, { uSeen: seen, uShade: shade, uToWorld: { value: toWorld } });
      shader.vertexShader = shader.vertexShader
        .replace("void main() {", "varying vec3 vGround;\nuniform mat4 uToWorld;\nvoid main() {")
        .replace("#include <project_vertex>", "#include <project_vertex>\nvGround = (uToWorld * vec4(position, 1.0)).xyz;");
      shader.fragmentShader = shader.fragmentShader
        .replace("void main() {", `${GRID}\nvoid main() {`)
        .replace(
          "#include <color_fragment>",
          `#include <color_fragment>
          float grid = max(max(lines(0.1, 0.12), lines(1.0, 0.3)), lines(10.0, 0.45));
          diffuseColor.rgb *= uShade * (1.0 - grid);
          diffuseColor.a *= 1.0 - smoothstep(0.3, 1.0, length(vViewPosition) / uSeen);`,
        );
    };
    return material;
  }

  // Lay a ground where a plate without an end is drawn.
  function lay(plate) {
    const top = plate.geometry.parameters.depth / 2;
    plate.geometry.dispose();
    plate.geometry = new THREE.PlaneGeometry(SIDE, SIDE).translate(0, 0, top);
    plate.material = groundMaterial(plate.material, plate.matrixWorld.clone());
    plate.renderOrder = -1;
    plate.castShadow = false;
  }

  function dress(object) {
    object.updateMatrixWorld(true);
    object.traverse((part) => {
      if (!part.isMesh) return;
      part.receiveShadow = true;
      part.castShadow = part.material.opacity > OPAQUE;
      part.material.shadowSide = THREE.BackSide; // a lit side has no shadow of its own
      if (part.userData.isGround) lay(part);
    });
  }

  const { set_object: setObject } = viewer;
  viewer.set_object = function (path, object, ...more) {
    if (path[0] === "twin" && object.isObject3D) dress(object);
    return setObject.call(this, path, object, ...more);
  };

  // Let the camera see as far as it looks from, and the sun shine where it looks.
  function look() {
    const { camera, controls } = viewer;
    const distance = camera.getWorldPosition(new THREE.Vector3()).distanceTo(controls.target);
    seen.value = THREE.MathUtils.clamp(SEEN.times * distance, SEEN.least, SEEN.most);
    camera.near = THREE.MathUtils.clamp(distance / 200, 0.002, 0.1);
    camera.far = Math.max(1.2 * seen.value, 4 * distance);
    const reach = THREE.MathUtils.clamp(distance, SHADOWED.least, SHADOWED.most);
    viewer.scene.worldToLocal(sun.target.position.copy(controls.target));
    sun.position.copy(sun.target.position).addScaledVector(SUN, 3 * reach);
    const { camera: eye, mapSize } = sun.shadow;
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
