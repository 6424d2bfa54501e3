// Meshcat's viewer, drawn where its page has a place for it, whenever something has changed.
"use strict";
const viewer = new MeshCat.Viewer(document.getElementById("meshcat-pane"));
viewer.animate = () => {
  viewer.animator.update();
  if (viewer.needs_render) viewer.render();
};
function animate() {
  viewer.animate();
  requestAnimationFrame(animate);
}
requestAnimationFrame(animate);
