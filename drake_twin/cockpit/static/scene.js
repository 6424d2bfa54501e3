// Runs inside the scene's frame before Meshcat does: Meshcat's page comes through this server, its web socket does not.
"use strict";
const port = document.currentScript.dataset.port;
const PageSocket = window.WebSocket;
window.WebSocket = class extends PageSocket {
  constructor() {
    super(`ws://${location.hostname}:${port}/`);
  }
};
