// node read_bag.cjs FILE.mcap TOPIC: how many messages each topic has, and the joint states of one, as JSON.

const fs = require("fs");
const fzstd = require("fzstd");
const { McapIndexedReader } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");

async function main(file, wanted) {
  const bytes = fs.readFileSync(file);
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => new Uint8Array(bytes.buffer, bytes.byteOffset + Number(offset), Number(size)),
  };
  const reader = await McapIndexedReader.Initialize({
    readable,
    decompressHandlers: { zstd: (data, size) => fzstd.decompress(data, new Uint8Array(Number(size))) },
  });
  const counts = {}, times = [], positions = [];
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    counts[channel.topic] = (counts[channel.topic] ?? 0) + 1;
    if (channel.topic !== wanted) continue;
    const schema = reader.schemasById.get(channel.schemaId);
    const text = new TextDecoder().decode(schema.data);
    const state = new MessageReader(parse(text, { ros2: true })).readMessage(message.data);
    times.push(Number(message.logTime));
    positions.push(Array.from(state.position));
  }
  const profile = reader.header.profile;
  console.log(JSON.stringify({ profile, counts, times, positions }));
}

main(...process.argv.slice(2));
