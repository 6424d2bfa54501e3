// Draws with fewer pixels while pictures come too slowly, and sharp again once nothing moves.
"use strict";
{
  const STEPS = [1, 0.7, 0.5, 0.4]; // of the screen's pixels, along each side
  const [SLOW, FAST] = [80, 35]; // ms from one picture to the next
  const MANY = 8; // pictures whose mean changes the step
  const STILL = 400; // ms without a change

  const { animate } = viewer;
  const gl = viewer.renderer.getContext();
  let fence = null; // of the last picture
  let step = 0; // of what moves
  let present = 0; // of the last picture
  let held = 0; // how many need each pixel
  let mean = 0; // ms, of the last pictures
  let count = 0; // pictures since the last change of the step
  let last = 0; // ms, of the last picture
  let isNext = false; // whether the picture before was drawn in the frame before

  function use(wanted) {
    if (wanted === present) return;
    present = wanted;
    viewer.sharpness = STEPS[present];
    viewer.renderer.setPixelRatio(viewer.sharpness * window.devicePixelRatio);
  }

  function learn(took) {
    count++;
    mean += (took - mean) / Math.min(count, MANY);
    if (count < MANY) return;
    const change = mean > SLOW ? 1 : mean < FAST ? -1 : 0;
    const next = Math.min(Math.max(step + change, 0), STEPS.length - 1);
    if (next !== step) count = 0;
    step = next;
  }

  // Whether the last picture is drawn: without this, several begin in a row, and are seen late and at once.
  function isDrawn() {
    if (fence && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED && !gl.isContextLost()) return false;
    gl.deleteSync(fence);
    fence = null;
    return true;
  }

  viewer.animate = () => {
    if (!isDrawn()) return;
    const now = performance.now();
    if (isNext) learn(now - last);
    const isMoving = viewer.needs_render;
    if (isMoving) last = now;
    isNext = isMoving;
    const wanted = held || now - last > STILL ? 0 : step;
    if (isMoving || wanted < present) {
      use(wanted);
      viewer.set_dirty();
    }
    animate();
    if (isMoving) {
      fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
      gl.flush();
    }
  };

  // Draw each pixel until the function that is returned is called.
  viewer.drawWhole = () => {
    held++;
    use(0);
    return () => held--;
  };
}
