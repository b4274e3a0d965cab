// SPDX-License-Identifier: Apache-2.0
// What MCAP's own reader (@mcap/core) says of a file, as JSON: channels, messages, and how much was
// read for opening and for a moment (0.1 s) in its middle; with --seeks also for each of nine moments
// spread over it.
//
//     NODE_PATH=.../node_modules node official_reader.mjs FILE.mcap [--all] [--seeks]
import { createRequire } from "node:module";
import { open } from "node:fs/promises";

const require = createRequire(process.env.V2VOUCH_NODE_MODULES + "/x.js");
const { McapIndexedReader } = require("@mcap/core");
const zstd = require("@foxglove/wasm-zstd");
await zstd.isLoaded;
const decompressHandlers = { zstd: (data, size) => zstd.decompress(data, Number(size)) };

const file = await open(process.argv[2]);
const size = (await file.stat()).size;
let reads = 0, bytesRead = 0;
const readable = {
  async size() { return BigInt(size); },
  async read(offset, length) {
    ++reads;
    bytesRead += Number(length);
    const buffer = new Uint8Array(Number(length));
    await file.read(buffer, 0, Number(length), Number(offset));
    return buffer;
  },
};
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
const result = { size, chunks: reader.chunkIndexes.length, opening: { reads, bytes: bytesRead }, topics: {} };
for (const channel of reader.channelsById.values()) {
  const schema = reader.schemasById.get(channel.schemaId);
  result.topics[channel.topic] = { encoding: channel.messageEncoding, schema: schema?.name ?? "",
    schemaEncoding: schema?.encoding ?? "", count: 0 };
}
const { messageStartTime, messageEndTime } = reader.statistics;
const middle = (messageStartTime + messageEndTime) / 2n;
async function take(startTime) {
  reads = bytesRead = 0;
  let messages = 0;
  for await (const message of reader.readMessages({ startTime, endTime: startTime + 100_000_000n })) ++messages;
  return { reads, bytes: bytesRead, messages };
}
result.seek = await take(middle);
if (process.argv.includes("--seeks")) {
  result.seeks = [];
  for (let tenth = 1n; tenth < 10n; ++tenth) {
    result.seeks.push((await take(messageStartTime + (messageEndTime - messageStartTime) * tenth / 10n)).bytes);
  }
}
if (process.argv.includes("--all")) {
  let last = -1n;
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    const topic = result.topics[channel.topic];
    ++topic.count;
    if (message.logTime < last) throw new Error("messages are not in the order of their times");
    last = message.logTime;
    if (channel.messageEncoding === "json") {
      const schema = reader.schemasById.get(channel.schemaId);
      if (topic.count === 1) JSON.parse(new TextDecoder().decode(schema.data));
      const value = JSON.parse(new TextDecoder().decode(message.data));
      if ((value.tracks ?? value.entities ?? [0]).length > 0) topic.last = value;
    }
  }
  if (result.topics["TRACKS_LOCAL"]?.last) {
    result.localTracks = result.topics["TRACKS_LOCAL"].last.tracks.length;
    result.localCubes = result.topics["/v2vouch/local"].last.entities.filter((e) => e.cubes.length === 1).length;
  }
  for (const topic of Object.values(result.topics)) delete topic.last;
}
console.log(JSON.stringify(result));
