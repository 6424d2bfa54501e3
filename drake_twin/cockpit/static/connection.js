// The web socket to the twin: requests out, the latest text of each channel in; and whether the twin still answers.

const RETRY = 1000; // ms
const SILENT = 1500; // ms without a word, after which the twin is said not to answer
const BROKEN = 5000; // ms without a word, after which another connection is tried
const LOOK = 250; // ms

export class Connection {
  // `status` is told "open", "silent" or "closed"; `lost` what did not reach the twin.
  constructor({ on, status, lost }) {
    Object.assign(this, { on, status, lost });
    this.told = null;
    this.open();
    setInterval(() => this.look(), LOOK);
  }

  open() {
    const address = new URL("socket", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    const socket = new WebSocket(address);
    this.socket = socket;
    this.heard = performance.now();
    socket.onmessage = ({ data }) => {
      if (this.socket !== socket) return;
      this.heard = performance.now();
      this.tell("open");
      const message = JSON.parse(data);
      this.on[message.channel]?.(message.data);
    };
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.tell("closed");
      setTimeout(() => this.socket === socket && this.open(), RETRY);
    };
  }

  look() {
    const silence = performance.now() - this.heard;
    if (this.told === "open" && silence > SILENT) this.tell("silent");
    if (this.told !== "closed" && silence > BROKEN) {
      const before = this.socket;
      this.open();
      before.close();
    }
  }

  tell(what) {
    if (what === this.told) return;
    this.told = what;
    this.status(what);
  }

  ask(what, fields = {}) {
    if (this.told !== "open") {
      this.lost(what);
      return false;
    }
    this.socket.send(JSON.stringify({ do: what, ...fields }));
    return true;
  }
}
