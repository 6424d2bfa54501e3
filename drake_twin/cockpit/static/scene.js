// Passes the scene to Meshcat's viewer; each message of the page's server is an array of commands.

const RETRY = 1000; // ms

function connect() {
  const address = new URL("socket", location.href);
  address.protocol = address.protocol.replace("http", "ws");
  const socket = new WebSocket(address);
  socket.binaryType = "arraybuffer";
  let isFirst = true;
  socket.onmessage = (message) => {
    if (isFirst) for (const path of ["/twin", "/overlays"]) viewer.handle_command({ type: "delete", path });
    isFirst = false;
    for (const command of viewer.decode(message)) viewer.handle_command(command);
    delete document.body.dataset.waits;
    document.body.dataset.frames = Number(document.body.dataset.frames ?? 0) + 1;
  };
  socket.onclose = () => {
    delete document.body.dataset.waits;
    setTimeout(connect, RETRY);
  };
}
connect();
