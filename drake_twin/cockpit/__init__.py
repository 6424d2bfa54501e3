"""The page in the browser: the scene, drawn by Drake's Meshcat, and the controls beside it."""
