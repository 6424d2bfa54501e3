// Meshcat's viewer, drawn in the page's pane whenever something has changed.
"use strict";
const viewer = new MeshCat.Viewer(document.getElementById("meshcat-pane"), false); // draws nothing by itself
viewer.animate = () => {
  viewer.animator.update();
  if (viewer.needs_render) viewer.render();
};
function animate() {
  requestAnimationFrame(animate); // first: a picture that fails is not the last
  if (!("waits" in document.body.dataset)) viewer.animate(); // a picture without robots would only delay the one with them
}
requestAnimationFrame(animate);

// Meshcat frees the geometry of a path's own object; what a file was read into lies below it.
{
  const paths = Object.getPrototypeOf(viewer.scene_tree);
  const { dispose_recursive: dispose } = paths;
  paths.dispose_recursive = function () {
    this.object?.traverse(({ geometry, material }) => {
      geometry?.dispose();
      for (const each of [material ?? []].flat()) for (const part of [each, ...Object.values(each)]) if (part?.isTexture || part?.isMaterial) part.dispose();
    });
    dispose.call(this);
  };
}
