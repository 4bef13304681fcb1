// Reads an MCAP file with npm's @mcap/core, by its index and as a stream, with
// all checksums compared, and prints what it holds as one JSON object, as
// mcap_content.cc does. Fails if the two ways differ. Decodes all messages with
// protobufjs and the schemas in the file, or as JSON, as Foxglove does.
//
//   NODE_PATH=.../node_modules node mcap_peer.mjs FILE.mcap
//
// With --cut, prints only the number of messages that the stream reader returns
// before the file ends.
import { createRequire } from "node:module";
import { open, readFile } from "node:fs/promises";

const require = createRequire(`${process.env.NODE_PATH}/`);
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { crc32 } = require("@foxglove/crc");
const protobuf = require("protobufjs");
const { FileDescriptorSet } = require("protobufjs/ext/descriptor");

const path = process.argv[2];
const bytes = new Uint8Array(await readFile(path));

function add(content, record, channels) {
  if (record.type !== "Message") return;
  const topic = channels.get(record.channelId).topic;
  const entry = (content[topic] ??= { bytes: 0, count: 0, crc: 0 });
  entry.count += 1;
  entry.bytes += record.data.length;
  // A checksum that depends on the order of the messages of a topic.
  const head = new TextEncoder().encode(
    `${entry.crc} ${record.sequence} ${record.logTime} `,
  );
  const all = new Uint8Array(head.length + record.data.length);
  all.set(head);
  all.set(record.data, head.length);
  entry.crc = crc32(all);
}

// A map as an object with sorted keys.
function entries(map) {
  return Object.fromEntries([...map].sort());
}

function readStream() {
  const reader = new McapStreamReader({ validateCrcs: true });
  const channels = new Map();
  const schemas = [];
  const topics = {};
  const metadata = [];
  let dataEnd;
  // Schema and bytes of each message.
  const contents = [];
  let messages = 0;
  reader.append(bytes);
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "Schema" && dataEnd === undefined) schemas.push(record);
    if (record.type === "DataEnd") dataEnd = record.dataSectionCrc;
    if (record.type === "Message") {
      messages += 1;
      const { schemaId } = channels.get(record.channelId);
      contents.push({ schemaId, data: record.data });
    }
    if (record.type === "Metadata") {
      metadata.push([record.name, entries(record.metadata)]);
    }
    add(topics, record, channels);
  }
  const done = reader.done();
  return { done, messages, contents, topics, metadata, schemas, dataEnd };
}

const stream = readStream();
if (process.argv[3] === "--cut") {
  console.log(stream.messages);
  process.exit(0);
}

const file = await open(path);
const indexed = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, size) => {
      const buffer = new Uint8Array(Number(size));
      await file.read(buffer, 0, Number(size), Number(offset));
      return buffer;
    },
  },
});
const topics = {};
for await (const record of indexed.readMessages({ validateCrcs: true })) {
  add(topics, record, indexed.channelsById);
}
const metadata = [];
for await (const record of indexed.readMetadata()) {
  metadata.push([record.name, entries(record.metadata)]);
}
await file.close();

function check(what, a, b) {
  const text = (value) =>
    JSON.stringify(value, (key, v) => (typeof v === "bigint" ? Number(v) : v));
  if (text(a) === text(b)) return;
  console.error(`${path}: ${what} differ: ${text(a)} and ${text(b)}`);
  process.exit(1);
}
check("end of the stream", stream.done, true);
const sorted = (object) => Object.entries(object).sort();
check("messages by index and as stream", sorted(topics), sorted(stream.topics));
check("metadata", metadata, stream.metadata);
check("message counts", Number(indexed.statistics.messageCount), stream.messages);
// From the beginning of the file to the end of the data.
const end = Number(indexed.dataEndOffset);
check("checksum of the data", crc32(bytes.subarray(0, end)), stream.dataEnd);
check("schemas", indexed.schemasById.size, stream.schemas.length);

const types = new Map();
for (const schema of stream.schemas) {
  if (schema.encoding === "jsonschema") {
    JSON.parse(new TextDecoder().decode(schema.data));
    continue;
  }
  const root = protobuf.Root.fromDescriptor(
    FileDescriptorSet.decode(schema.data),
  );
  root.resolveAll();
  types.set(schema.id, root.lookupType(schema.name));
}
let images = 0;
for (const { schemaId, data } of stream.contents) {
  if (!types.has(schemaId)) {
    JSON.parse(new TextDecoder().decode(data));
    continue;
  }
  const message = types.get(schemaId).decode(data);
  if (types.get(schemaId).fullName !== ".foxglove.RawImage") continue;
  check("encoding", message.encoding, "mono8");
  check("size", message.data.length, message.width * message.height);
  check("step", message.step, message.width);
  check("name", message.frameId ?? message.frame_id, "cody-forearm");
  images += 1;
}
check("images", images, topics["/skin/frames"].count);

// In the form of mcap_content.cc.
const bytesOf = (object) => Object.fromEntries(sorted(object));
console.log(JSON.stringify({ metadata, topics: bytesOf(topics) }));
console.error(
  `@mcap/core: ${stream.messages} messages, ${indexed.chunkIndexes.length} ` +
    `chunks, ${metadata.length} metadata, ${stream.schemas.length} schemas, ` +
    "by index and as a stream, checksums compared; protobufjs: all decoded, " +
    `${images} images`,
);
