// The web socket to the twin: requests out, the latest text of each channel in.

const RETRY = 1000; // ms

export class Connection {
  constructor({ on, status }) {
    this.on = on;
    this.status = status;
    this.open();
  }

  open() {
    const address = new URL("socket", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    this.socket = new WebSocket(address);
    this.socket.onopen = () => this.status(true);
    this.socket.onmessage = ({ data }) => {
      const message = JSON.parse(data);
      this.on[message.channel]?.(message.data);
    };
    this.socket.onclose = () => {
      this.status(false);
      setTimeout(() => this.open(), RETRY);
    };
  }

  ask(what, fields = {}) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ do: what, ...fields }));
  }
}
