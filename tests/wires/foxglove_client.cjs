// A client of Foxglove's protocol, driven by lines of JSON: each line in is done, each event is a line out.
// Protocol, schemas and messages are read by Foxglove's own packages, which are found in NODE_PATH.
const readline = require("readline");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader, MessageWriter } = require("@foxglove/rosmsg2-serialization");
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const WebSocket = require("ws");

const [address] = process.argv.slice(2);
const socket = new WebSocket(address, ["foxglove.sdk.v1"]);
const client = new FoxgloveClient({ ws: socket });
const base64 = (view) => Buffer.from(view.buffer, view.byteOffset, view.byteLength).toString("base64");
const tell = (event, done) => process.stdout.write(JSON.stringify(event, plain) + "\n", done);
const plain = (key, value) => (typeof value === "bigint" ? String(value) : ArrayBuffer.isView(value) ? [...value] : value);
const channels = new Map(); // id → channel
const services = new Map(); // id → service
const subscribed = new Map(); // subscription → channel
const calls = new Map(); // number → service
const schema = (text) => parse(text, { ros2: true });

client.on("open", () => tell({ event: "open" }));
client.on("close", () => tell({ event: "close" }, () => process.exit(0)));
client.on("error", (error) => tell({ event: "error", text: String(error) }));
client.on("status", (status) => tell({ event: "status", text: status.message, level: status.level }));
client.on("serverInfo", (info) => tell({ event: "serverInfo", ...info }));
client.on("time", ({ timestamp }) => tell({ event: "time", time: String(timestamp) }));
client.on("advertise", (items) => {
  for (const item of items) channels.set(item.id, item);
  tell({ event: "advertise", channels: items });
});
client.on("unadvertise", (ids) => tell({ event: "unadvertise", topics: ids.map((id) => channels.get(id).topic) }));
client.on("advertiseServices", (items) => {
  for (const item of items) services.set(item.id, item);
  tell({ event: "advertiseServices", services: items });
});
client.on("unadvertiseServices", (ids) =>
  tell({ event: "unadvertiseServices", names: ids.map((id) => services.get(id).name) }),
);
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const { topic, schema: text } = subscribed.get(subscriptionId);
  const message = new MessageReader(schema(text)).readMessage(data);
  tell({ event: "message", topic, time: String(timestamp), message, data: base64(data) });
});
client.on("serviceCallResponse", ({ callId, encoding, data }) => {
  if (encoding === "json") return tell({ event: "response", callId, message: JSON.parse(Buffer.from(data.buffer, data.byteOffset, data.byteLength)) });
  const reader = new MessageReader(schema(calls.get(callId).response.schema));
  tell({ event: "response", callId, message: reader.readMessage(data) });
});
client.on("serviceCallFailure", ({ callId, message }) => tell({ event: "failure", callId, text: message }));
client.on("parameterValues", ({ parameters, id }) => tell({ event: "parameters", parameters, id }));
client.on("connectionGraphUpdate", (update) => tell({ event: "graph", ...update }));
client.on("fetchAssetResponse", (asset) =>
  tell({ event: "asset", requestId: asset.requestId, text: asset.error, data: asset.data && base64(asset.data) }),
);

// Play, pause and speed: the newest part of the protocol, which this client's package does not know.
const STATUS = ["playing", "paused", "buffering", "ended"];
socket.on("message", (bytes, isBinary) => {
  const data = Buffer.from(bytes);
  if (!isBinary || data[0] !== 5) return;
  const [status, time, speed, seeked] = [STATUS[data[1]], data.readBigUInt64LE(2), data.readFloatLE(10), data[14] !== 0];
  tell({ event: "playback", status, time, speed, seeked, id: data.toString("utf8", 19) });
});
const playback = ({ play, speed, seek, id }) => {
  const bytes = Buffer.alloc(19);
  bytes.writeUInt8(3, 0);
  bytes.writeUInt8(play ? 0 : 1, 1);
  bytes.writeFloatLE(speed, 2);
  bytes.writeUInt8(seek === undefined ? 0 : 1, 6);
  bytes.writeBigUInt64LE(BigInt(seek ?? 0), 7);
  bytes.writeUInt32LE(Buffer.byteLength(id), 15);
  socket.send(Buffer.concat([bytes, Buffer.from(id)]));
};

// Another client that subscribes, advertises, calls, and is gone without a word once it has a message.
const joinAndLeave = (topic, service) =>
  new Promise((resolve) => {
    const own = new WebSocket(address, ["foxglove.sdk.v1"]);
    const other = new FoxgloveClient({ ws: own });
    let offered = [];
    other.on("advertise", (items) => items.filter((item) => item.topic === topic).forEach(({ id }) => other.subscribe(id)));
    other.on("advertiseServices", (items) => (offered = [...offered, ...items]));
    other.on("message", () => {
      const { id, request } = offered.find((item) => item.name === service);
      const data = new MessageWriter(schema(request.schema)).writeMessage({});
      other.advertise({ topic: "/commands", encoding: "cdr", schemaName: "std_msgs/msg/Float64MultiArray" });
      other.sendServiceCallRequest({ serviceId: id, callId: 1, encoding: "cdr", data });
      own.terminate();
      resolve();
    });
  });

const actions = {
  subscribe: ({ topic }) => {
    const channel = [...channels.values()].filter((item) => item.topic === topic).pop();
    subscribed.set(client.subscribe(channel.id), channel);
  },
  unsubscribe: ({ topic }) => {
    for (const [id, channel] of subscribed) if (channel.topic === topic) client.unsubscribe(id);
  },
  parseAll: () => {
    const offered = [...services.values()];
    const texts = [...channels.values(), ...offered.flatMap(({ request, response }) => [request, response])];
    const json = ({ schemaEncoding }) => schemaEncoding === "jsonschema";
    texts.forEach((item) => (json(item) ? JSON.parse(item.schema) : schema(item.schema)));
    tell({ event: "parsed", channels: [...channels.values()].map((item) => item.topic), services: offered.map((item) => item.name) });
  },
  advertise: ({ topic, encoding, schemaName }) =>
    tell({ event: "advertised", topic, channel: client.advertise({ topic, encoding, schemaName }) }),
  publish: ({ channel, data }) => client.sendMessage(channel, Buffer.from(data, "base64")),
  call: ({ service, callId, request, encoding, data }) => {
    const offered = [...services.values()].filter((item) => item.name === service).pop();
    const text = encoding === "json" && Buffer.from(JSON.stringify(request));
    const bytes = data ? Buffer.from(data, "base64") : text || new MessageWriter(schema(offered.request.schema)).writeMessage(request);
    calls.set(callId, offered);
    client.sendServiceCallRequest({ serviceId: offered.id, callId, encoding, data: bytes });
  },
  fetch: ({ uri, requestId }) => client.fetchAsset(uri, requestId),
  getParameters: ({ names, id }) => client.getParameters(names, id),
  setParameters: ({ parameters, id }) => client.setParameters(parameters, id),
  subscribeParameters: ({ names }) => client.subscribeParameterUpdates(names),
  unsubscribeParameters: ({ names }) => client.unsubscribeParameterUpdates(names),
  playback,
  watchGraph: () => client.subscribeConnectionGraph(),
  raw: ({ data, text }) => socket.send(text ?? Buffer.from(data, "base64")),
  publishZeros: ({ channel, size }) => client.sendMessage(channel, Buffer.alloc(size)),
  flood: ({ channel, count, data }) => {
    for (let sent = 0; sent < count; sent++) client.sendMessage(channel, Buffer.from(data, "base64"));
  },
  joinAndLeave: async ({ count, topic, service }) => {
    for (let number = 0; number < count; number++) await joinAndLeave(topic, service);
    tell({ event: "left", count });
  },
  zeros: ({ size }) => socket.send(Buffer.alloc(size)),
  stopReading: () => socket.pause(),
  close: () => client.close(),
};
readline.createInterface({ input: process.stdin }).on("line", (line) => {
  const request = JSON.parse(line);
  actions[request.do](request);
});
process.stdin.on("end", () => process.exit(0));
