// The web socket to the twin: sends requests, receives the latest text of each channel, notices when the twin is silent.

const RETRY = 1000; // ms
const SILENT = 1500; // ms without a message, after which the status is "silent"
const BROKEN = 5000; // ms without a message, after which a new connection is tried
const CHECK = 250; // ms

export class Connection {
  // `status` is called with "open", "silent" or "closed"; `lost` with a request that was not sent.
  constructor({ on, status, lost }) {
    Object.assign(this, { on, status, lost });
    this.current = null;
    this.open();
    setInterval(() => this.check(), CHECK);
  }

  open() {
    const address = new URL("socket", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.heard = performance.now();
    socket.onmessage = ({ data }) => {
      if (this.socket !== socket) return;
      this.heard = performance.now();
      this.report("open");
      if (data instanceof ArrayBuffer) return this.hearBytes(data);
      const message = JSON.parse(data);
      this.on[message.channel]?.(message.data);
    };
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.report("closed");
      setTimeout(() => this.socket === socket && this.open(), RETRY);
    };
  }

  // A line of JSON, then bytes.
  hearBytes(data) {
    const end = new Uint8Array(data).indexOf(10);
    this.on.bytes?.(JSON.parse(new TextDecoder().decode(data.slice(0, end))), new Uint8Array(data, end + 1));
  }

  check() {
    const silence = performance.now() - this.heard;
    if (this.current === "open" && silence > SILENT) this.report("silent");
    if (this.current !== "closed" && silence > BROKEN) {
      const before = this.socket;
      this.open();
      before.close();
    }
  }

  report(status) {
    if (status === this.current) return;
    this.current = status;
    this.status(status);
  }

  ask(what, fields = {}) {
    if (this.current !== "open") {
      this.lost(what);
      return false;
    }
    this.socket.send(JSON.stringify({ do: what, ...fields }));
    return true;
  }
}
