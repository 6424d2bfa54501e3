// Foxglove's own client: does what lines of JSON on stdin say, and prints what it is told as such lines.
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const WebSocket = require("ws");
const readline = require("readline");

const say = (event, value) =>
  console.log(JSON.stringify({ event, ...value }, (_, item) => (typeof item === "bigint" ? Number(item) : item)));
const base64 = (view) => Buffer.from(view.buffer, view.byteOffset, view.byteLength).toString("base64");
const view = (text) => new DataView(Uint8Array.from(Buffer.from(text, "base64")).buffer);

const socket = new WebSocket(process.argv[2], ["foxglove.sdk.v1"]);
const client = new FoxgloveClient({ ws: socket });
const channels = new Map(), topics = new Map(), services = new Map(), offered = new Map(), subscriptions = new Map();

client.on("serverInfo", (info) => say("info", { info }));
client.on("advertise", (found) => {
  for (const channel of found) {
    channels.set(channel.topic, channel);
    topics.set(channel.id, channel.topic);
    say("channel", { channel });
  }
});
client.on("unadvertise", (ids) => ids.forEach((id) => say("channel gone", { topic: topics.get(id) })));
client.on("advertiseServices", (found) => {
  for (const service of found) {
    services.set(service.name, service);
    say("service", { service });
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) =>
  say("message", { topic: subscriptions.get(subscriptionId), time: timestamp, data: base64(data) }));
client.on("time", ({ timestamp }) => say("time", { time: timestamp }));
client.on("status", (status) => say("status", { status }));
client.on("serviceCallResponse", ({ data }) => say("response", { data: base64(data) }));
client.on("serviceCallFailure", (failure) => say("failure", { failure }));
client.on("fetchAssetResponse", ({ requestId, status, data, error }) =>
  say("asset", { requestId, status, error, data: data === undefined ? null : base64(data) }));
client.on("close", () => process.exit(0));
client.on("error", (error) => say("error", { error: String(error) }));

readline.createInterface({ input: process.stdin }).on("line", (line) => {
  const { op, ...what } = JSON.parse(line);
  if (op === "subscribe") subscriptions.set(client.subscribe(channels.get(what.topic).id), what.topic);
  if (op === "unsubscribe")
    for (const [id, topic] of subscriptions) if (topic === what.topic) client.unsubscribe(id);
  if (op === "publish") {
    if (!offered.has(what.topic))
      offered.set(what.topic, client.advertise({ topic: what.topic, encoding: what.encoding, schemaName: what.type }));
    client.sendMessage(offered.get(what.topic), new Uint8Array(view(what.data).buffer));
  }
  if (op === "call")
    client.sendServiceCallRequest({
      serviceId: services.get(what.service).id, callId: 1, encoding: "cdr", data: view(what.data) });
  if (op === "asset") client.fetchAsset(what.uri, what.id);
  if (op === "close") client.close();
}).on("close", () => process.exit(0));
