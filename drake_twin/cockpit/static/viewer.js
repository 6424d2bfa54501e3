// Meshcat's viewer, drawn in the page's pane whenever something has changed.
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
